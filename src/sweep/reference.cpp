// SPDX-License-Identifier: Apache-2.0
#include "sweep/reference.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <filesystem>

#include "core/parallel.hpp"
#include "sweep/scorer.hpp"
#include "sweep/state.hpp"

namespace gazetrace {
namespace {

namespace fs = std::filesystem;

constexpr std::array<const char*, 2> kHalves{"half-1.####.exr", "half-2.####.exr"};
constexpr const char* kMean = "reference.####.exr";

std::string scrambling_folder(const std::string& directory, std::size_t scrambling) {
  return directory + fmt::format("/scrambling-{}", scrambling + 1);
}

void render_scrambling(PathTracer& tracer, const SweepReference& reference, const std::vector<std::int32_t>& pictures,
                       const ColorPipeline& color, const std::string& directory, std::size_t scrambling) {
  PipelineSettings settings = reference.pipeline;
  settings.trace.seed = reference.seeds[scrambling];
  settings.output = {};
  settings.output.run_directory = scrambling_folder(directory, scrambling);
  settings.output.exr.pattern = settings.output.run_directory + "/frame.####.exr";
  settings.output.exr.pixels = ExrPixels::float32;
  settings.output.resume = true;
  settings.settings_digest =
      digest_settings({{"reference", reference.digest}, {"seed", std::to_string(settings.trace.seed)}});
  fs::create_directories(settings.output.run_directory);
  render_sequence(tracer, only_frames(reference.plan, pictures), color, settings, {});
}

void write_mean(const std::string& path, const Frame& frame, const FrameRequest& request,
                const SweepReference& reference) {
  FrameHeader header;
  header.frame = request.frame;
  header.t_video_ns = request.t_video_ns;
  header.fps = reference.pipeline.fps;
  header.camera = request.camera;
  header.settings_digest = reference.digest;
  ExrSettings settings;
  settings.pixels = ExrPixels::float32;
  write_frame_exr(path, frame, nullptr, header, settings, reference.pipeline.threads);
}

// The mean of some scramblings of a frame, summed in double precision.
ImageRgb mean_of(const std::string& directory, std::size_t first, std::size_t count, std::int32_t frame, int threads) {
  Image<Vec3d> sum;
  for (std::size_t k = first; k < first + count; ++k) {
    const ImageRgb one = read_exr_rgb(frame_file_name(scrambling_folder(directory, k) + "/frame.####.exr", frame));
    if (sum.empty()) {
      sum = Image<Vec3d>(one.width_px, one.height_px);
    }
    parallel_for(static_cast<std::size_t>(one.height_px), threads, [&](std::size_t row) {
      const std::size_t begin = row * static_cast<std::size_t>(one.width_px);
      for (std::size_t i = begin; i < begin + static_cast<std::size_t>(one.width_px); ++i) {
        sum.pixels[i] = sum.pixels[i] + to_double(one.pixels[i]);
      }
    });
  }
  ImageRgb mean(sum.width_px, sum.height_px);
  for (std::size_t i = 0; i < mean.pixels.size(); ++i) {
    mean.pixels[i] = to_float(sum.pixels[i] / static_cast<double>(count));
  }
  return mean;
}

ImageRgb mean_of_two(const ImageRgb& a, const ImageRgb& b) {
  ImageRgb mean(a.width_px, a.height_px);
  for (std::size_t i = 0; i < mean.pixels.size(); ++i) {
    mean.pixels[i] = (a.pixels[i] + b.pixels[i]) * 0.5F;
  }
  return mean;
}

// Writes the two halves first and the mean last, so that a frame that has its mean is complete. A frame between two
// pictures shows the earlier one.
void average_frames(const SweepReference& reference, const std::vector<std::int32_t>& pictures,
                    const ColorPipeline& color, CertifiedReference& certified) {
  TemporalHistory history;
  const std::size_t half = reference.seeds.size() / 2;
  const int threads = reference.pipeline.threads;
  std::array<ImageRgb, 2> halves;
  for (const FrameRequest& request : reference.plan.frames) {
    const std::int32_t frame = request.frame;
    const bool is_new = std::find(pictures.begin(), pictures.end(), frame) != pictures.end();
    for (std::size_t h = 0; h < halves.size(); ++h) {
      if (is_new) {
        halves[h] = mean_of(certified.directory, h * half, half, frame, threads);
      }
      Frame picture;
      picture.radiance = halves[h];
      write_mean(certified.half_path(static_cast<int>(h), frame), picture, request, reference);
    }
    Frame mean;
    mean.radiance = mean_of_two(halves[0], halves[1]);
    const double ev = choose_exposure_ev(mean.radiance, request.t_video_ns, reference.pipeline.exposure, history);
    certified.ev[frame] = ev;
    FrameHeader header;
    header.frame = frame;
    header.exposure_ev = ev;
    write_display_image(frame_file_name(certified.directory + "/reference.####.png", frame),
                        color.apply(mean.radiance, ev, 8, threads), header, {});
    write_mean(certified.mean_path(frame), mean, request, reference);
  }
}

// Pictures may have been lost since; rendered again they are the same to the bit.
bool has_pictures(const CertifiedReference& certified, const SweepReference& reference) {
  return std::all_of(reference.plan.frames.begin(), reference.plan.frames.end(), [&](const FrameRequest& request) {
    const std::int32_t frame = request.frame;
    return certified.ev.contains(frame) && fs::is_regular_file(certified.mean_path(frame)) &&
           fs::is_regular_file(certified.half_path(0, frame)) && fs::is_regular_file(certified.half_path(1, frame));
  });
}

}  // namespace

std::string CertifiedReference::half_path(int half, std::int32_t frame) const {
  return frame_file_name(directory + "/" + kHalves.at(static_cast<std::size_t>(half)), frame);
}

std::string CertifiedReference::mean_path(std::int32_t frame) const {
  return frame_file_name(directory + "/" + kMean, frame);
}

bool scene_decides_pictures(const SweepReference& reference) {
  const std::vector<FrameRequest>& frames = reference.plan.frames;
  const auto is_like_first = [&](const FrameRequest& request) {
    const Camera& a = frames.front().camera;
    const Camera& b = request.camera;
    return a.pose == b.pose && a.projection == b.projection && a.lens == b.lens && b.shutter_poses.empty();
  };
  return frames.size() > 1 && reference.pipeline.accumulate.mode == AccumulateMode::off &&
         std::all_of(frames.begin(), frames.end(), is_like_first);
}

std::vector<std::int32_t> reference_pictures(const SweepReference& reference, const Scene& scene) {
  if (scene_decides_pictures(reference) && scene.motions.empty() && scene.deformations.empty()) {
    return {reference.plan.frames.front().frame};
  }
  std::vector<std::int32_t> all;
  for (const FrameRequest& request : reference.plan.frames) {
    all.push_back(request.frame);
  }
  return all;
}

FramePlan only_frames(const FramePlan& plan, const std::vector<std::int32_t>& frames) {
  FramePlan part = plan;
  std::erase_if(part.frames, [&](const FrameRequest& request) {
    return std::find(frames.begin(), frames.end(), request.frame) == frames.end();
  });
  return part;
}

std::string reference_folder(const SweepReference& reference) {
  return "references/" + reference.key;
}

MetricPicture metric_picture(ImageRgb light, const ColorPipeline& color, double ev, int threads) {
  MetricPicture picture;
  picture.code = viewed(light, color, ev, threads);
  picture.light = std::move(light);
  return picture;
}

CertifiedReference ensure_reference(PathTracer& tracer, const Scene& scene, const SweepReference& reference,
                                    const ColorPipeline& color, const std::string& sweep_directory,
                                    const SweepObserver& observer) {
  CertifiedReference certified;
  certified.directory = sweep_directory + "/" + reference_folder(reference);
  certified.spp =
      static_cast<double>(reference.pipeline.foveation.uniform_spp) * static_cast<double>(reference.seeds.size());
  const std::vector<std::int32_t> pictures = reference_pictures(reference, scene);
  certified.pictures = pictures.size();
  const std::string record = certified.directory + "/reference.json";
  if (const auto kept = load_exposures(record, reference.digest)) {
    certified.ev = *kept;
    if (has_pictures(certified, reference)) {
      return certified;
    }
    certified.ev.clear();
  }
  for (std::size_t k = 0; k < reference.seeds.size(); ++k) {
    if (observer.tell) {
      observer.tell(fmt::format("reference {}: scrambling {} of {}", reference.key, k + 1, reference.seeds.size()));
    }
    render_scrambling(tracer, reference, pictures, color, certified.directory, k);
  }
  average_frames(reference, pictures, color, certified);
  save_exposures(record, reference.digest, certified.ev);
  for (std::size_t k = 0; k < reference.seeds.size(); ++k) {
    fs::remove_all(scrambling_folder(certified.directory, k));
  }
  return certified;
}

ScoreTable ensure_floor(const CertifiedReference& reference, const ColorPipeline& color,
                        const ComparisonSettings& settings, const std::vector<ResultFrame>& frames,
                        const std::string& digest) {
  const std::string path = reference.directory + "/floor-" + digest + ".json";
  if (auto kept = load_scores(path)) {
    return *kept;
  }
  const int threads = settings.metric.threads;
  std::unique_ptr<Scorer> scorer;
  for (const ResultFrame& frame : frames) {
    const double ev = reference.ev.at(frame.index);
    const MetricPicture a = metric_picture(read_exr_rgb(reference.half_path(0, frame.index)), color, ev, threads);
    const MetricPicture b = metric_picture(read_exr_rgb(reference.half_path(1, frame.index)), color, ev, threads);
    if (!scorer) {
      // The exposures that tests are scored at: those of the first frame of the whole reference.
      ComparisonSettings fixed = settings;
      fix_flip_exposures(fixed, read_exr_rgb(reference.mean_path(frame.index)));
      scorer = std::make_unique<Scorer>(fixed, frames, a.light.width_px, a.light.height_px);
    }
    scorer->add(a, b);
  }
  ScoreTable scores = scorer ? scorer->over_scored_frames() : ScoreTable{};
  save_scores(path, scores);
  return scores;
}

}  // namespace gazetrace
