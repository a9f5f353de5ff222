// SPDX-License-Identifier: Apache-2.0
// What the recordings beside the project are known to do, beyond counts and spans (gaze_samples_test.cpp and
// gaze_samples_table_test.cpp): gaps, places far off the screen, steps of the clock, angles that wrap. Expected numbers
// were counted in the files by a few lines of Python.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <functional>

#include "gazetrace/gaze.hpp"

namespace gazetrace::gaze_samples_quirks_test {
namespace {

std::string sample(const std::string& name) {
  return std::string(GAZETRACE_SHARED_DIR) + "/gaze-samples/" + name;
}

#define SKIP_WITHOUT(name)                          \
  if (!std::filesystem::exists(sample(name))) {     \
    GTEST_SKIP() << sample(name) << " is not here"; \
  }

GazeReadOptions of_scene_camera() {
  GazeReadOptions options;
  options.frame = GazeFrame::scene_camera;
  return options;
}

// Sorted.
std::vector<std::int64_t> steps_ns(const GazeLog& log, std::int64_t begin_ns, std::int64_t end_ns) {
  std::vector<std::int64_t> steps;
  for (std::size_t i = 1; i < log.samples.size(); ++i) {
    if (log.samples[i - 1].t_ns >= begin_ns && log.samples[i].t_ns <= end_ns) {
      steps.push_back(log.samples[i].t_ns - log.samples[i - 1].t_ns);
    }
  }
  std::sort(steps.begin(), steps.end());
  return steps;
}
std::vector<std::int64_t> steps_ns(const GazeLog& log) {
  return steps_ns(log, log.samples.front().t_ns, log.samples.back().t_ns);
}

struct Extent {
  double low_u = INFINITY, high_u = -INFINITY, low_v = INFINITY, high_v = -INFINITY;
};
Extent extent_of(const GazeLog& log) {
  Extent e;
  for (const GazeSample& s : log.samples) {
    if (!std::isnan(s.u)) {
      e = {std::min(e.low_u, s.u), std::max(e.high_u, s.u), std::min(e.low_v, s.v), std::max(e.high_v, s.v)};
    }
  }
  return e;
}

std::size_t count(const GazeLog& log, const std::function<bool(const GazeSample&)>& is) {
  return static_cast<std::size_t>(std::count_if(log.samples.begin(), log.samples.end(), is));
}

TEST(GazeSamplesQuirks, TobiiStudioOffTheScreenAndOneEyed) {
  SKIP_WITHOUT("tobii-studio-tsv/data.tsv");
  const GazeLog log = load_gaze_log(sample("tobii-studio-tsv/data.tsv"), {});
  const Extent e = extent_of(log);
  EXPECT_EQ(e.low_u, -174.0 / 1920);
  EXPECT_EQ(e.high_u, 2136.0 / 1920);
  EXPECT_EQ(e.low_v, -194.0 / 1080);
  EXPECT_EQ(e.high_v, 2367.0 / 1080);
  EXPECT_EQ(count(log, [](const GazeSample& s) { return s.validity == GazeValidity::off_screen; }), 215U);
  std::size_t one = 0;
  for (std::size_t i = 0; i < log.eyes.size(); ++i) {
    const bool left = is_usable(log.eyes[i].left.validity);
    const bool right = is_usable(log.eyes[i].right.validity);
    if (left != right) {
      ++one;  // the combined point is that of the other eye
      const Vec3d& at = left ? log.eyes[i].left.at : log.eyes[i].right.at;
      EXPECT_EQ(log.samples[i].u, at.x) << log.samples[i].row;
      EXPECT_EQ(log.samples[i].v, at.y) << log.samples[i].row;
    }
  }
  EXPECT_EQ(one, 234U);
  // Two rows of events share their stamp with a sample, which is no duplicate.
  const auto is_sample_time = [&](const GazeEvent& event) {
    return event.type == GazeEventType::message &&
           count(log, [&](const GazeSample& s) { return s.t_ns == event.begin_ns && s.row != event.row; }) == 1;
  };
  EXPECT_EQ(std::count_if(log.events.begin(), log.events.end(), is_sample_time), 2);
}

TEST(GazeSamplesQuirks, Glasses2HasGaps) {
  SKIP_WITHOUT("tobii-glasses2/livedata.json.gz");
  const auto steps = steps_ns(load_gaze_log(sample("tobii-glasses2/livedata.json.gz"), of_scene_camera()));
  EXPECT_EQ(steps.back(), 539'708'000);
  EXPECT_EQ(steps[steps.size() / 2], 19'986'000);
  EXPECT_GT(steps.front(), 0);  // 461 lines are older than the one above
}

TEST(GazeSamplesQuirks, PupilCoreGoesAstrayAndIsUneven) {
  SKIP_WITHOUT("pupil-core/gaze_positions.csv");
  const GazeLog log = load_gaze_log(sample("pupil-core/gaze_positions.csv"), of_scene_camera());
  const Extent e = extent_of(log);
  EXPECT_NEAR(e.low_u, -0.44305702367716193, 1e-15);
  EXPECT_NEAR(e.high_u, 0.8002510798972506, 1e-15);
  EXPECT_NEAR(e.high_v, 1 + 0.2644959722811424, 1e-15);
  const auto steps = steps_ns(log);
  EXPECT_EQ(steps.front(), 217'500);
  EXPECT_EQ(steps[steps.size() / 2], 4'008'000);
  const Extent mono =
      extent_of(load_gaze_log(sample("pupil-core/gaze_positions_with_monocular.csv"), of_scene_camera()));
  EXPECT_NEAR(mono.low_v, 1 - 27.40506276374651, 1e-14);
}

TEST(GazeSamplesQuirks, SmiHasTrialsWithoutGazeAndALongGap) {
  SKIP_WITHOUT("smi-iview-txt/recording1_Samples.txt");
  const GazeLog log = load_gaze_log(sample("smi-iview-txt/recording1_Samples.txt"), {});
  const Extent e = extent_of(log);
  EXPECT_EQ(e.high_u, 6130.31 / 1024);
  EXPECT_EQ(e.high_v, 18697.09 / 768);
  std::vector<std::size_t> usable;
  std::vector<GazeEvent> trials;
  for (const GazeEvent& event : log.events) {
    if (event.type == GazeEventType::segment) {
      trials.push_back(event);
      usable.push_back(count(log, [&](const GazeSample& s) {
        return s.t_ns >= event.begin_ns && s.t_ns <= event.end_ns && is_usable(s.validity);
      }));
    }
  }
  EXPECT_EQ(usable, (std::vector<std::size_t>{0, 2216 - 1545, 0, 0, 16420 - 3015}));
  EXPECT_EQ(steps_ns(log, trials[4].begin_ns, trials[4].end_ns).back(), 98'452'276'000);
  EXPECT_EQ(steps_ns(log, trials[0].begin_ns, trials[0].end_ns).back(), 20'085'000);
}

TEST(GazeSamplesQuirks, ArffIsNotQuiteEven) {
  SKIP_WITHOUT("arff/gaze.arff");
  const auto steps = steps_ns(load_gaze_log(sample("arff/gaze.arff"), {}));
  EXPECT_EQ(std::count_if(steps.begin(), steps.end(), [](std::int64_t s) { return s != 4'000'000; }), 300);
  EXPECT_EQ(steps.front(), 1'000'000);
  EXPECT_EQ(steps.back(), 17'000'000);
}

// The device's own stamp is an int32 that has wrapped below zero.
TEST(GazeSamplesQuirks, ViveOnItsDevicesClock) {
  SKIP_WITHOUT("vive-pro-eye/TESTNA01_360VR_Fist3.csv");
  GazeReadOptions options;
  options.columns.time = "time_stamp(ms)";
  const GazeLog log = load_gaze_log(sample("vive-pro-eye/TESTNA01_360VR_Fist3.csv"), options);
  EXPECT_EQ(log.samples.front().t_ns, -1'511'527'596'000'000);
  EXPECT_EQ(log.samples.back().t_ns, -1'511'513'732'000'000);
  const auto steps = steps_ns(log);
  EXPECT_EQ(steps.front(), 8'000'000);
  EXPECT_EQ(steps.back(), 9'000'000);
}

// The roll, helmet_rot_z, passes 0 and 360 again and again; which way is up does not jump.
TEST(GazeSamplesQuirks, ViveRollWraps) {
  SKIP_WITHOUT("vive-pro-eye/TESTNA01_360VR_Fist3.csv");
  const GazeLog log = load_gaze_log(sample("vive-pro-eye/TESTNA01_360VR_Fist3.csv"), {});
  double fastest_deg = 0;
  double tilt_deg = 0;
  for (std::size_t i = 1; i < log.head.size(); ++i) {
    const Vec3d a = rotate(log.head[i - 1].orientation, {0, 1, 0});
    const Vec3d b = rotate(log.head[i].orientation, {0, 1, 0});
    fastest_deg = std::max(fastest_deg, angle_between_rad(a, b) * kDegPerRad);
    tilt_deg = std::max(tilt_deg, angle_between_rad(a, {0, 1, 0}) * kDegPerRad);
  }
  EXPECT_GT(fastest_deg, 0.01);
  EXPECT_LT(fastest_deg, 5);
  EXPECT_LT(tilt_deg, 45);  // a person who stands
}

TEST(GazeSamplesQuirks, PicoRepeatsItsGaze) {
  SKIP_WITHOUT("pico-neo3-pro/boxing_VR.csv");
  const GazeLog log = load_gaze_log(sample("pico-neo3-pro/boxing_VR.csv"), {});
  std::size_t repeats = 0;
  for (std::size_t i = 1; i < log.samples.size(); ++i) {
    const bool both_lost = !is_finite(log.samples[i].direction) && !is_finite(log.samples[i - 1].direction);
    repeats += both_lost || log.samples[i].direction == log.samples[i - 1].direction ? 1 : 0;
  }
  EXPECT_EQ(repeats, 182U);
  // Not the foveated direction, of which the first is (0.014, 0.2719, -0.9622).
  EXPECT_NEAR(log.samples[0].direction.x, 0.0133, 2e-5);
  EXPECT_NEAR(log.samples[0].direction.y, 0.2678, 2e-5);
}

}  // namespace
}  // namespace gazetrace::gaze_samples_quirks_test
