// SPDX-License-Identifier: Apache-2.0
// Does the model of visible error (gazetrace/visible_error.hpp) predict what FovVideoVDP says of rendered pictures?
//   gazetrace_predicted_jod REFERENCE_SPP SPP,SPP,... OPTION=VALUE...
// The options are those of a job: scene, env, camera or eye and target, size, screen, gaze-at, filter and so on. One
// moment of the scene is rendered 16 times with other seeds, as the frames of a clip at rest at 24 frames a second, and
// once as the reference. The metric measures the last 10 of them, as displayed in 8 bits. Columns:
//   measured   JOD by FovVideoVDP
//   truth      predicted, from the reference's luminance and the true error: its variance over the frames, fresh, and
//              its mean, frozen, each with the spectrum of a sample of it
//   white      the same, if all of the error were white and fresh
//   reference  predicted, from the reference's luminance and the variance that each frame states, as white and fresh
//   frame      the same from each frame's own luminance: all that a renderer knows
#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

#include "benchmark_main.hpp"
#include "core/luminance.hpp"
#include "gazetrace/error.hpp"
#include "gazetrace/frame_renderer.hpp"
#include "gazetrace/job.hpp"
#include "gazetrace/resolve.hpp"
#include "gazetrace/visible_error.hpp"

namespace {

using namespace gazetrace;

constexpr int kFrames = 16;
constexpr double kFramesPerSecond = 24;

ImageGray luminance_of(const ImageRgb& radiance) {
  ImageGray image(radiance.width_px, radiance.height_px);
  std::transform(radiance.pixels.begin(), radiance.pixels.end(), image.pixels.begin(),
                 [](const Vec3f& c) { return luminance(c); });
  return image;
}

// As `compare` sees it: through the view, in 8 bits.
ImageGray displayed(const ImageRgb& radiance, const ColorPipeline& color, double ev) {
  const DisplayImage shown = color.apply(radiance, ev, 8);
  ImageRgb code(radiance.width_px, radiance.height_px);
  for (std::size_t i = 0; i < code.pixels.size(); ++i) {
    const auto channel = [&](std::size_t c) { return static_cast<float>(shown.bytes[3 * i + c]) / 255.0F; };
    code.pixels[i] = {channel(0), channel(1), channel(2)};
  }
  return display_luminance(code, {});
}

// Relative to the reference, so that the spectrum is not that of the picture.
ImageGray relative(const ImageGray& image, const ImageGray& less, const ImageGray& reference) {
  constexpr float kLeast = 1e-3F;
  ImageGray result = image;
  for (std::size_t i = 0; i < result.pixels.size(); ++i) {
    result.pixels[i] = (image.pixels[i] - less.pixels[i]) / std::max(reference.pixels[i], kLeast);
  }
  return result;
}

// The true error: what differs from frame to frame, and what all frames have in common.
std::vector<ErrorComponent> true_error(const std::vector<ImageGray>& frames, const ImageGray& reference) {
  ImageGray mean(reference.width_px, reference.height_px);
  ErrorComponent fresh{mean};
  ErrorComponent frozen{mean};
  frozen.correlation = 1;
  const auto count = static_cast<float>(frames.size());
  for (std::size_t i = 0; i < mean.pixels.size(); ++i) {
    float squares = 0;
    for (const ImageGray& frame : frames) {
      mean.pixels[i] += frame.pixels[i] / count;
    }
    for (const ImageGray& frame : frames) {
      squares += (frame.pixels[i] - mean.pixels[i]) * (frame.pixels[i] - mean.pixels[i]);
    }
    const float bias = mean.pixels[i] - reference.pixels[i];
    fresh.squared_error.pixels[i] = squares / (count - 1);
    frozen.squared_error.pixels[i] = std::max(0.0F, bias * bias - fresh.squared_error.pixels[i] / count);
  }
  fresh.spectrum = measured_spectrum(relative(frames.front(), mean, reference));
  frozen.spectrum = measured_spectrum(relative(mean, reference, reference));
  return {fresh, frozen};
}

std::vector<ErrorComponent> all_white(std::vector<ErrorComponent> errors) {
  for (std::size_t i = 0; i < errors.front().squared_error.pixels.size(); ++i) {
    errors.front().squared_error.pixels[i] += errors.back().squared_error.pixels[i];
  }
  return {{errors.front().squared_error}};
}

int run(int argc, char** argv) {
  if (argc < 4) {
    throw Error(ErrorKind::usage, "", "REFERENCE_SPP SPP,SPP,... OPTION=VALUE... are needed");
  }
  Job job;
  for (int i = 3; i < argc; ++i) {
    const std::string text = argv[i];
    const std::size_t equals = text.find('=');
    set_option(job, text.substr(0, equals), equals == std::string::npos ? "true" : text.substr(equals + 1));
  }
  set_option(job, "frames", "1");
  set_option(job, "spp", argv[1]);
  const ResolvedJob resolved = resolve(job);
  PathTracer tracer(*resolved.scene, tracer_options(resolved.job.settings));
  const ColorPipeline color(resolved.job.settings.color);
  const FrameRequest& request = resolved.plan.frames.front();
  const PlanarView& view = request.view;
  if (!request.gaze_direction_true) {
    throw Error(ErrorKind::usage, "`gaze-at`", "a gaze is needed");
  }
  const auto render = [&](FrameSettings settings, std::uint64_t seed) {
    settings.trace.seed = seed;
    return FrameRenderer(tracer, settings).render(request);
  };
  FrameSettings settings = resolved.pipeline;
  settings.foveation.sampling = UniformSampling{};
  settings.trace.guiding = false;
  const RenderedFrame best = render(settings, 1000003);
  settings.trace.guiding = resolved.pipeline.trace.guiding;
  const double ev = best.exposure_ev;
  const ImageGray reference = luminance_of(best.frame.radiance);
  const ImageGray reference_shown = displayed(best.frame.radiance, color, ev);
  const DisplayCurve curve = view_display_curve(color, {}, ev);
  const VisibleErrorModel model({view, kFramesPerSecond});
  VisiblePicture certain{reference, curve, request.gaze_direction_true, false};

  FovVideoVdpSettings metric_settings;
  metric_settings.geometry = fovvideovdp_geometry(view);
  metric_settings.frames_per_second = kFramesPerSecond;
  fmt::print("{}x{} pixels, {:.1f} a degree, filter {}, reference of {} spp\n{:>6}{:>10}{:>8}{:>8}{:>11}{:>8}\n",
             view.width_px, view.height_px, metric_settings.geometry.pixels_per_degree(),
             settings.reconstruction.filter, argv[1], "spp", "measured", "truth", "white", "reference", "frame");
  settings.foveation.sampling = resolved.pipeline.foveation.sampling;
  for (char* rest = argv[2]; *rest != '\0'; rest += *rest == ',' ? 1 : 0) {
    const auto spp = static_cast<std::uint32_t>(std::strtoul(rest, &rest, 10));
    settings.foveation.spp = spp;
    FovVideoVdp metric(metric_settings, view.width_px, view.height_px);
    std::vector<ImageGray> frames;
    std::vector<double> measured;
    std::vector<double> by_reference;
    std::vector<double> by_frame;
    for (int i = 0; i < kFrames; ++i) {
      const RenderedFrame rendered = render(settings, static_cast<std::uint64_t>(i) + 1);
      const ImageGray shown = displayed(rendered.frame.radiance, color, ev);
      frames.push_back(luminance_of(rendered.frame.radiance));
      if (i < metric.taps()) {
        metric.prime(reference_shown, shown);
        continue;
      }
      measured.push_back(metric.add(reference_shown, shown, view.pixel(*request.gaze_direction_true)).q);
      const std::vector<ErrorComponent> stated{{rendered.frame.variance}};
      by_reference.push_back(model.predict(certain, stated).q);
      by_frame.push_back(model.predict({frames.back(), curve, request.gaze_direction_true}, stated).q);
    }
    const std::vector<ErrorComponent> truth = true_error(frames, reference);
    fmt::print("{:>6}{:>10.3f}{:>8.3f}{:>8.3f}{:>11.3f}{:>8.3f}\n", spp, visible_jod(measured),
               fovvideovdp_jod(model.predict(certain, truth).q),
               fovvideovdp_jod(model.predict(certain, all_white(truth)).q), visible_jod(by_reference),
               visible_jod(by_frame));
    std::fflush(stdout);
  }
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  return gazetrace::benchmark::benchmark_main(run, argc, argv);
}
