// SPDX-License-Identifier: Apache-2.0
// The sequences that the temporal benchmark renders, and their variants.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "gazetrace/gaze.hpp"
#include "gazetrace/pipeline.hpp"
#include "sequence_measures.hpp"

namespace gazetrace::temporal {

using benchmark::Luminances;
using benchmark::Reference;

constexpr std::uint32_t kStillReference = 16;

struct Options {
  std::string scene, sky, gaze, only;
  std::vector<std::string> filters{"linear"};
  Vec3d start{6, 2, -0.3};  // of the camera, which looks towards -x
  int frames = 120, height_px = 90;
  std::uint32_t reference_spp = 128;
};

struct Variant {
  std::string name;
  AccumulateSettings accumulate;
  bool orders = false;  // one of two that differ in their order alone
};
std::vector<Variant> make_variants();
// Without those of order for filters that need guides, which always come before accumulation.
std::vector<Variant> variants_of(const std::string& filter);

// Accumulation from both sides, which has no history to hand over.
std::vector<Variant> two_sided_variants();

class Bench {
 public:
  explicit Bench(const Options& options) : options_(options), log_(load_gaze_log(options.gaze, {})) {}

  [[nodiscard]] int width_px() const { return options_.height_px * 16 / 9; }

  [[nodiscard]] FramePlan plan(bool glides, int first, int last) const {
    CameraPath path;
    const auto at = [start = options_.start](double s) {
      const Vec3d eye = start + Vec3d{-0.4 * s, 0, 0.2 * std::sin(s)};
      return look_at(eye, eye + Vec3d{-1, 0.06, 0.25 * std::sin(0.7 * s)}, {0, 1, 0});
    };
    Projection projection;
    path = static_camera(at(0), projection);
    if (glides) {
      path.is_static = false;
      path.end_ns = std::int64_t{3600} * 1'000'000'000;
      path.pose_at = [at](std::int64_t t) { return at(static_cast<double>(t) * 1e-9); };
    }
    PlanSettings settings;
    settings.width_px = width_px();
    settings.height_px = options_.height_px;
    settings.display = display_by_name("paper");
    settings.transfer = GazeTransfer::fraction;
    for (int frame = first; frame <= last; ++frame) {
      settings.frames.push_back(frame);
    }
    return plan_frames(path, &log_, settings);
  }

  [[nodiscard]] PipelineSettings settings_of(const AccumulateSettings& accumulate, const std::string& filter) const {
    PipelineSettings settings;
    settings.reconstruction.filter = filter;
    settings.accumulate = accumulate;
    settings.settings_digest = "none";
    settings.trace.seed = 1;
    return settings;
  }

  // One frame is worth more samples than each of many.
  [[nodiscard]] std::uint32_t reference_spp(bool still) const {
    return options_.reference_spp * (still ? kStillReference : 1);
  }
  [[nodiscard]] PipelineSettings reference_settings(std::uint64_t seed, bool still) const {
    PipelineSettings settings;
    settings.foveation.sampling = UniformSampling{};
    settings.foveation.spp = reference_spp(still) / 2;
    settings.reconstruction.filter = "linear";
    settings.trace.learn_light = false;
    settings.trace.seed = seed;
    return settings;
  }

 private:
  Options options_;
  GazeLog log_;
};

std::vector<float> luminance_of(const Frame& frame);
// Frame by frame; adds the time that accumulation took.
Luminances render(PathTracer& tracer, const FramePlan& plan, const PipelineSettings& settings,
                  double* temporal_ms = nullptr);
// Each of two halves of the samples, and their mean. `still`: one frame stands for all.
Reference make_reference(PathTracer& tracer, const Bench& bench, const FramePlan& plan, bool still);

}  // namespace gazetrace::temporal
