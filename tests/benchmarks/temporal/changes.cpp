// SPDX-License-Identifier: Apache-2.0
#include "temporal/changes.hpp"

#include <fmt/core.h>
#include <unistd.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <utility>

#include "gazetrace/frame_renderer.hpp"

namespace gazetrace::temporal {
namespace {

constexpr std::array kAfter{0, 1, 2, 4, 8, 16};

double mean_of(const std::vector<float>& values) {
  double sum = 0;
  for (const float value : values) {
    sum += static_cast<double>(value);
  }
  return sum / static_cast<double>(values.size());
}

// Two scenes, the history handed over by a checkpoint: from the next frame on everything is the second one's.
Luminances across_a_change(PathTracer& before, PathTracer& after, const Bench& bench, const Variant& variant,
                           const std::string& filter, int first_after) {
  PipelineSettings settings = bench.settings_of(variant.accumulate, filter);
  settings.checkpoint = (std::string(std::getenv("TMPDIR") != nullptr ? std::getenv("TMPDIR") : "/tmp") +
                         fmt::format("/gazetrace_temporal_benchmark_{}.bin", getpid()));
  (void)render(before, bench.plan(false, 1, first_after - 1), settings);
  settings.resume_from = settings.checkpoint;
  settings.checkpoint.clear();
  Luminances frames = render(after, bench.plan(false, first_after, first_after + kAfter.back()), settings);
  std::remove(settings.resume_from.c_str());
  return frames;
}

// The same from both sides: frames of both scenes are in the windows of those near the change.
Luminances two_sided_across_a_change(PathTracer& before, PathTracer& after, const Bench& bench, const Variant& variant,
                                     const std::string& filter, int first_after) {
  const auto reach = static_cast<std::size_t>(variant.accumulate.window);
  const FrameSettings settings = bench.settings_of(variant.accumulate, filter);
  const FramePlan plan = bench.plan(false, first_after - variant.accumulate.window,
                                    first_after + kAfter.back() + variant.accumulate.window);
  std::vector<ReconstructedFrame> frames;
  for (const FrameRequest& request : plan.frames) {
    frames.push_back(FrameRenderer(request.frame < first_after ? before : after, settings).reconstruct(request));
  }
  Luminances joined;
  for (std::size_t own = reach; own + reach < frames.size(); ++own) {
    std::vector<const ReconstructedFrame*> window;
    for (std::size_t k = own - reach; k <= own + reach; ++k) {
      window.push_back(&frames[k]);
    }
    TemporalHistory unused;
    joined.push_back(luminance_of(FrameRenderer(after, settings).join(window, reach, unused).frame));
  }
  return joined;
}

std::vector<Variant> variants_at_a_change(const std::string& filter) {
  std::vector<Variant> variants = variants_of(filter);
  for (Variant& variant : two_sided_variants()) {
    variants.push_back(std::move(variant));
  }
  return variants;
}

Luminances frames_after(PathTracer& before, PathTracer& after, const Bench& bench, const Variant& variant,
                        const std::string& filter, int first_after) {
  return variant.accumulate.mode == AccumulateMode::two_sided
             ? two_sided_across_a_change(before, after, bench, variant, filter, first_after)
             : across_a_change(before, after, bench, variant, filter, first_after);
}

}  // namespace

// How much more than the new light is seen, relative to how much there was more before.
void light_goes_out(PathTracer& tracer, const Scene& scene, const Bench& bench, const std::string& filter) {
  constexpr int kFirst = 33;
  Scene dark = scene;
  for (Vec3f& radiance : dark.environment.radiance.pixels) {
    radiance = radiance * 0.1F;
  }
  PathTracer dark_tracer(dark, {});
  fmt::print("\nA light that goes out: what is left of it after so many frames\n\n| accumulation |");
  for (const int after : kAfter) {
    fmt::print(" {} |", after);
  }
  fmt::print("\n| --- |{}\n", " --- | --- | --- | --- | --- | --- |");
  const Luminances alone =
      render(dark_tracer, bench.plan(false, kFirst, kFirst + kAfter.back()), bench.settings_of({}, filter));
  double level = 0;
  for (const auto& frame : alone) {
    level += mean_of(frame) / static_cast<double>(alone.size());
  }
  for (const Variant& variant : variants_at_a_change(filter)) {
    const Luminances frames = frames_after(tracer, dark_tracer, bench, variant, filter, kFirst);
    fmt::print("| {} |", variant.name);
    for (const int after : kAfter) {
      fmt::print(" {:.1f} % |", 100 * (mean_of(frames[static_cast<std::size_t>(after)]) - level) / (9 * level));
    }
    fmt::print("\n");
    std::fflush(stdout);
  }
}

void body_is_gone(PathTracer& tracer, const Scene& scene, const Bench& bench, const Options& options,
                  const std::string& filter) {
  constexpr int kFirst = 33;
  Scene with_board = scene;
  Geometry board;
  for (const Vec3d& corner : {Vec3d{-2.5, -1.4, -0.7}, {-2.5, -1.4, 0.7}, {-2.5, 0.4, 0.7}, {-2.5, 0.4, -0.7}}) {
    board.positions.push_back(to_float(options.start + corner));
  }
  board.normals.assign(4, {1, 0, 0});
  board.triangles = {{0, 1, 2}, {0, 2, 3}};
  Material white;
  white.metallic = 0;
  white.base_color = {0.8F, 0.8F, 0.8F, 1};
  with_board.materials.push_back(white);
  board.material = static_cast<std::int32_t>(with_board.materials.size()) - 1;
  with_board.meshes.push_back({"board", {board}});
  with_board.instances.push_back({static_cast<std::int32_t>(with_board.meshes.size()) - 1, {}});
  PathTracer board_tracer(with_board, {});
  const FramePlan one = bench.plan(false, kFirst, kFirst);
  const SurfaceMotion seen = board_tracer.at_rest().surface_motion(one.frames[0].camera, bench.width_px(),
                                                                   options.height_px, {one.frames[0].camera, 0});
  const auto board_object = static_cast<std::uint32_t>(with_board.instances.size());
  const auto truth = [&](PathTracer& of) {
    const auto a = render(of, one, bench.reference_settings(1001, true));
    const auto b = render(of, one, bench.reference_settings(2002, true));
    std::vector<float> mean = a[0];
    for (std::size_t i = 0; i < mean.size(); ++i) {
      mean[i] = 0.5F * (mean[i] + b[0][i]);
    }
    return mean;
  };
  const std::vector<float> now = truth(tracer);
  const std::vector<float> then = truth(board_tracer);
  for (const bool uncovered : {true, false}) {
    // Of the rest only what the board changed by more than a fifth.
    std::vector<std::size_t> region;
    for (std::size_t i = 0; i < now.size(); ++i) {
      const bool on_board = seen.object.pixels[i] == board_object;
      const bool changed = std::fabs(then[i] - now[i]) > 0.2F * now[i];
      if (on_board == uncovered && (uncovered || changed)) {
        region.push_back(i);
      }
    }
    fmt::print(
        "\nA body that is gone, {} ({} pixels): what is left of the change after so many frames\n\n| accumulation |",
        uncovered ? "where it was" : "its shadow", region.size());
    for (const int after : kAfter) {
      fmt::print(" {} |", after);
    }
    fmt::print("\n| --- |{}\n", " --- | --- | --- | --- | --- | --- |");
    for (const Variant& variant : variants_at_a_change(filter)) {
      const Luminances frames = frames_after(board_tracer, tracer, bench, variant, filter, kFirst);
      fmt::print("| {} |", variant.name);
      for (const int after : kAfter) {
        // The part of the old picture in the new one, by least squares.
        double product = 0;
        double square = 0;
        for (const std::size_t i : region) {
          const double change = static_cast<double>(then[i] - now[i]);
          product +=
              (static_cast<double>(frames[static_cast<std::size_t>(after)][i]) - static_cast<double>(now[i])) * change;
          square += change * change;
        }
        fmt::print(" {:.1f} % |", 100 * product / square);
      }
      fmt::print("\n");
      std::fflush(stdout);
    }
  }
}

void seams(PathTracer& tracer, const Bench& bench, const std::string& filter) {
  constexpr int kLast = 60;
  const Variant variant = make_variants()[1];
  const Luminances whole = render(tracer, bench.plan(true, 1, kLast), bench.settings_of(variant.accumulate, filter));
  fmt::print(
      "\nA run that begins at frame {}, with frames rendered before it for their history\n\n"
      "| before | root mean square of the difference to one run, by the mean | the same of a frame's own noise |\n"
      "| --- | --- | --- |\n",
      kLast);
  const auto difference = [&](const std::vector<float>& a, const std::vector<float>& b) {
    double square = 0;
    for (std::size_t i = 0; i < a.size(); ++i) {
      square += std::pow(static_cast<double>(a[i] - b[i]), 2) / static_cast<double>(a.size());
    }
    return 100 * std::sqrt(square) / mean_of(whole.back());
  };
  PipelineSettings other = bench.settings_of(variant.accumulate, filter);
  other.trace.seed = 77;
  const Luminances other_seed = render(tracer, bench.plan(true, 1, kLast), other);
  for (const int preroll : {0, 8, 16, 32, 48}) {
    PipelineSettings settings = bench.settings_of(variant.accumulate, filter);
    settings.preroll = preroll;
    const Luminances some = render(tracer, bench.plan(true, kLast - preroll, kLast), settings);
    fmt::print("| {} | {:.3f} % | {:.3f} % |\n", preroll, difference(some.back(), whole.back()),
               difference(other_seed.back(), whole.back()) / std::sqrt(2.0));
  }
}

}  // namespace gazetrace::temporal
