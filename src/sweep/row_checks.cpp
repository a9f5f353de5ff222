// SPDX-License-Identifier: Apache-2.0
#include "sweep/row_checks.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <functional>

#include "gazetrace/error.hpp"

namespace gazetrace {
namespace {

constexpr std::array kOverTime{"fovvideovdp", "flicker", "temporal_bias"};

}  // namespace

void check_new(const std::vector<SweepTest>& tests, const SweepTest& test, const std::string& place) {
  for (const SweepTest& other : tests) {
    if (other.digest == test.digest && other.gaze == test.gaze && other.scene == test.scene &&
        other.resolution_scale == test.resolution_scale) {
      throw Error(ErrorKind::input, place, fmt::format("'{}' and '{}' are the same setting", other.label, test.label),
                  "leave one out");
    }
  }
}

void check_gaze(const std::vector<SweepTest>& tests, const SweepTest& test, const std::string& place) {
  const auto differs = [](const FrameRequest& a, const FrameRequest& b) {
    return a.gaze_direction_true != b.gaze_direction_true || a.gaze_true.no_gaze != b.gaze_true.no_gaze ||
           gaze_class_of(a.gaze_true) != gaze_class_of(b.gaze_true);
  };
  for (const SweepTest& other : tests) {
    const auto& a = other.plan.frames;
    const auto& b = test.plan.frames;
    if (other.gaze == test.gaze && other.reference == test.reference &&
        !std::equal(a.begin(), a.end(), b.begin(), b.end(), std::not_fn(differs))) {
      throw Error(ErrorKind::input, place,
                  fmt::format("with '{}' the eye looks elsewhere than with '{}', and both are gaze '{}'", test.label,
                              other.label, test.gaze),
                  "give options that move the gaze in a [[gaze]] of another name");
    }
  }
}

void check_seeds(const SweepFile& file, const std::vector<SweepTestPlace>& tests) {
  const auto repeats = static_cast<std::uint64_t>(file.measure.repeats);
  const auto scramblings = static_cast<std::uint64_t>(file.reference.scramblings);
  for (const auto& [place, seed] : tests) {
    if (seed < file.reference.seed + scramblings && file.reference.seed < seed + repeats) {
      throw Error(ErrorKind::input, place,
                  fmt::format("seeds {} to {} are of the reference, too", seed, seed + repeats - 1),
                  "give [reference] another seed");
    }
  }
}

void check_frames(const std::string& plan_file, const std::vector<std::string>& metrics,
                  const std::vector<SweepTest>& tests) {
  const auto over_time =
      std::find_if(metrics.begin(), metrics.end(), [](const std::string& name) { return is_among(kOverTime, name); });
  if (over_time == metrics.end()) {
    return;
  }
  for (const SweepTest& test : tests) {
    const auto& frames = test.plan.frames;
    if (frames.back().frame - frames.front().frame + 1 != static_cast<std::int32_t>(frames.size())) {
      throw Error(ErrorKind::input, plan_file,
                  *over_time + " sees time, but frames are missing between the first and the last",
                  "name consecutive frames, or leave the metric out of [measure]");
    }
  }
}

}  // namespace gazetrace
