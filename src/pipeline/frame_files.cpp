// SPDX-License-Identifier: Apache-2.0
#include "pipeline/frame_files.hpp"

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "gazetrace/version.hpp"
#include "output/written_file.hpp"
#include "pipeline/frame_stages.hpp"

namespace gazetrace {
namespace {

double samples_of_every_pixel(const ImageGray& samples) {
  const float first = samples.pixels.front();
  const bool same = std::all_of(samples.pixels.begin(), samples.pixels.end(), [&](float n) { return n == first; });
  return same ? static_cast<double>(first) : 0;
}

FrameHeader header_of(const FrameRequest& request, const FramePlan& plan, const PipelineSettings& settings,
                      const RenderedFrame& rendered) {
  FrameHeader header;
  header.frame = request.frame;
  header.t_video_ns = request.t_video_ns;
  header.fps = settings.fps;
  header.camera = request.camera;
  header.window = request.window;
  header.shutter_open_ns = request.shutter_open_ns;
  header.shutter_close_ns = request.shutter_close_ns;
  header.gaze_render = request.gaze_render;
  header.gaze_true = request.gaze_true;
  header.gaze = gaze_numbers(request);
  header.gaze_processing = plan.gaze_processing;
  header.exposure_ev = rendered.exposure_ev;
  header.seed = settings.trace.seed;
  header.settings_digest = settings.settings_digest;
  header.mean_digest = settings.mean_digest;
  header.samples_per_pixel = samples_of_every_pixel(rendered.frame.sample_count);
  header.software = std::string("gazetrace ") + kVersion;
  return header;
}

// The light of the surfaces alone, of pixels that they cover in part.
ImageRgb straight(const ImageRgb& radiance, const ImageGray& alpha) {
  ImageRgb color = radiance;
  for (std::size_t i = 0; i < color.pixels.size(); ++i) {
    color.pixels[i] = alpha.pixels[i] > 0 ? radiance.pixels[i] / alpha.pixels[i] : Vec3f{};
  }
  return color;
}

// Whether half of the pixels are below 2 % of white in every colour.
bool is_dark(const DisplayImage& image) {
  const double white = image.bits == 8 ? 255 : 65535;
  const auto pixels = static_cast<std::size_t>(image.width_px) * static_cast<std::size_t>(image.height_px);
  std::size_t dark = 0;
  for (std::size_t i = 0; i < pixels; ++i) {
    double most = 0;
    for (std::size_t channel = 3 * i; channel < 3 * i + 3; ++channel) {
      std::uint16_t code = image.bits == 8 ? image.bytes[channel] : 0;
      if (image.bits != 8) {
        std::memcpy(&code, &image.bytes[2 * channel], sizeof(code));
      }
      most = std::max(most, static_cast<double>(code));
    }
    dark += most < 0.02 * white ? 1 : 0;
  }
  return 2 * dark > pixels;
}

bool writes_anything(const OutputSettings& output) {
  return !output.exr.pattern.empty() || !output.display.pattern.empty() || !output.map_pattern.empty();
}

}  // namespace

void write_frame_files(const FrameRequest& request, const FramePlan& plan, const RenderedFrame& rendered,
                       const ColorPipeline& color, const PipelineSettings& settings, TimingRow& row,
                       SequenceResult& result) {
  const OutputSettings& output = settings.output;
  const FrameHeader header = header_of(request, plan, settings, rendered);
  const auto list = [&](const std::string& path, WrittenFile file) {
    file.frame = request.frame;
    result.files.insert_or_assign(name_in_record(folder_of_run(output.run_name), path), std::move(file));
  };
  const auto& aovs = output.exr.aovs;
  const bool wants_eccentricity =
      !output.map_pattern.empty() || std::find(aovs.begin(), aovs.end(), "eccentricity") != aovs.end();
  std::optional<ImageGray> eccentricity;
  const Stopwatch map_watch;
  if (wants_eccentricity && request.gaze_direction_true) {
    eccentricity = eccentricity_image(request.view, *request.gaze_direction_true);
  } else if (wants_eccentricity) {
    // Without gaze there is no eccentricity; the channel stays, so that a sequence has the same ones in every frame.
    eccentricity = ImageGray(request.width_px, request.height_px, std::numeric_limits<float>::quiet_NaN());
  }
  const ImageGray* eccentricity_deg = eccentricity ? &*eccentricity : nullptr;
  if (!output.map_pattern.empty()) {
    const std::string path = frame_file_name(output.map_pattern, request.frame);
    list(path, write_sampling_map_exr(path, rendered.map, eccentricity_deg, request.window));
  }
  row.write_ms += map_watch.elapsed_ms();
  if (!output.display.pattern.empty()) {
    std::uint64_t clamped = 0;
    const ImageGray& alpha = rendered.layers.alpha;
    const DisplayImage image = timed(row.color_ms, [&] {
      return color.apply(alpha.empty() ? rendered.frame.radiance : straight(rendered.frame.radiance, alpha),
                         rendered.exposure_ev, display_image_bits(output.display), settings.threads, &clamped);
    });
    const Stopwatch watch;
    const std::string path = frame_file_name(output.display.pattern, request.frame);
    list(path, write_display_image(path, image, header, output.display, alpha.empty() ? nullptr : &alpha));
    row.write_ms += watch.elapsed_ms();
    result.clamped_view_pixels += clamped;
    result.dark_pictures += alpha.empty() && is_dark(image) ? 1 : 0;
  }
  if (!output.exr.pattern.empty()) {
    const std::string path = frame_file_name(output.exr.pattern, request.frame);
    WrittenExr written = timed(row.write_ms, [&] {
      return write_frame_exr(path, rendered.frame, eccentricity_deg, header, output.exr, settings.threads,
                             rendered.layers);
    });
    result.clamped_half_values += written.clamped_values;
    list(path, std::move(written.file));
  }
}

std::vector<std::string> output_files(const PipelineSettings& settings, const std::vector<std::int32_t>& frames) {
  const OutputSettings& output = settings.output;
  std::vector<std::string> files;
  if (!writes_anything(output)) {
    return files;
  }
  const std::string list = format_frame_list(frames);
  files.push_back(run_record_file_name(output.run_name, list, settings.is_part));
  files.push_back(timing_file_name(output.run_name, list, settings.is_part));
  for (const std::int32_t frame : frames) {
    for (const std::string& pattern : {output.map_pattern, output.display.pattern, output.exr.pattern}) {
      if (!pattern.empty()) {
        files.push_back(frame_file_name(pattern, frame));
      }
    }
  }
  return files;
}

}  // namespace gazetrace
