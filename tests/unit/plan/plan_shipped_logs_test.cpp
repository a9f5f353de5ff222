// SPDX-License-Identifier: Apache-2.0
// Every log in gazelogs/ reads without a warning and plans.
#include <gtest/gtest.h>

#include <filesystem>

#include "gazetrace/plan.hpp"

namespace gazetrace::plan_shipped_logs_test {
namespace {

TEST(ShippedLogs, ReadAndPlan) {
  int logs = 0;
  for (const auto& entry : std::filesystem::directory_iterator(std::string(GAZETRACE_SOURCE_DIR) + "/gazelogs")) {
    const std::string path = entry.path().string();
    if (entry.path().extension() != ".csv" || path.find("_truth") != std::string::npos) {
      continue;
    }
    ++logs;
    const GazeLog log = load_gaze_log(path, {});
    EXPECT_EQ(log.format, "gazetrace-csv") << path;
    EXPECT_TRUE(log.warnings.empty()) << log.warnings.front();
    ASSERT_TRUE(log.recording_geometry.has_value()) << path;
    PlanSettings settings;
    settings.frames = {1, 2, 3, 24};
    settings.display = log.recording_geometry;
    const FramePlan plan = plan_frames(static_camera({}, {}), &log, settings);
    ASSERT_EQ(plan.frames.size(), 4U);
    for (const FrameRequest& request : plan.frames) {
      EXPECT_NE(request.gaze_true.state, GazeState::none) << path << request.gaze_true.reason;
    }
  }
  EXPECT_GE(logs, 4);
}

}  // namespace
}  // namespace gazetrace::plan_shipped_logs_test
