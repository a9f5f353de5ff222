// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "gazetrace/plan.hpp"

namespace gazetrace::shutter_test {
namespace {

TEST(Shutter, Forms) {
  const Shutter half{0.25, 0.75};
  EXPECT_EQ(parse_shutter("0.5"), half);
  EXPECT_EQ(parse_shutter("180deg"), half);
  EXPECT_EQ(parse_shutter(" 0.25, 0.75 "), half);
  EXPECT_EQ(parse_shutter("1"), (Shutter{0, 1}));
  EXPECT_EQ(parse_shutter("0,0.5"), (Shutter{0, 0.5}));
  EXPECT_FALSE(parse_shutter("0").blurs());
  for (const char* text : {"0.5", "0.125,1", "0"}) {
    const Shutter shutter = parse_shutter(text);
    EXPECT_EQ(parse_shutter(to_string(shutter)), shutter) << text;
  }
  for (const char* text :
       {"", "deg", "1.5", "-0.5", "361deg", "0.7,0.2", "0.3,0.3", "0.5,1.5", "nan", "half", "0.1,0.2,0.3"}) {
    EXPECT_THROW(static_cast<void>(parse_shutter(text)), Error) << text;
  }
}

CameraPath sliding() {
  CameraPath path = static_camera(CameraPose{}, {});
  path.is_static = false;
  path.begin_ns = 0;
  path.end_ns = 1'000'000'000;
  path.pose_at = [](std::int64_t t) {
    EXPECT_TRUE(t >= 0 && t <= 1'000'000'000) << t;
    return CameraPose{{static_cast<double>(t), 0, 0}, {}};
  };
  return path;
}

PlanSettings settings_with(const Shutter& shutter) {
  PlanSettings settings;
  settings.frames = {1, 2, 10};
  settings.fps = {10, 1};
  settings.shutter = shutter;
  return settings;
}

TEST(Shutter, PlanTakesPosesFromOpeningToClosing) {
  const FramePlan plan = plan_frames(sliding(), nullptr, settings_with({0.25, 1}));
  const FrameRequest& second = plan.frames[1];
  EXPECT_EQ(second.t_video_ns, 150'000'000);
  EXPECT_EQ(second.shutter_open_ns, 125'000'000);
  EXPECT_EQ(second.shutter_close_ns, 200'000'000);
  EXPECT_EQ(second.camera.pose.position_m.x, 150e6);  // the middle of the frame, wherever the shutter is
  const std::vector<CameraPose>& poses = second.camera.shutter_poses;
  ASSERT_GE(poses.size(), 2U);
  for (std::size_t i = 0; i < poses.size(); ++i) {
    EXPECT_NEAR(poses[i].position_m.x, 125e6 + 75e6 * static_cast<double>(i) / static_cast<double>(poses.size() - 1),
                1);
  }
}

TEST(Shutter, OffAndStillCamerasHaveNoPoses) {
  const FramePlan off = plan_frames(sliding(), nullptr, settings_with({}));
  EXPECT_TRUE(off.frames[0].camera.shutter_poses.empty());
  EXPECT_EQ(off.frames[0].shutter_open_ns, off.frames[0].t_video_ns);
  EXPECT_EQ(off.frames[0].shutter_close_ns, off.frames[0].t_video_ns);
  const FramePlan still = plan_frames(static_camera(CameraPose{}, {}), nullptr, settings_with({0, 1}));
  EXPECT_TRUE(still.frames[0].camera.shutter_poses.empty());
  EXPECT_LT(still.frames[0].shutter_open_ns, still.frames[0].shutter_close_ns);
}

TEST(Shutter, HoldsThePathsEnds) {
  CameraPath path = sliding();
  path.begin_ns = 40'000'000;
  path.pose_at = [](std::int64_t t) {
    EXPECT_GE(t, 40'000'000);
    return CameraPose{{static_cast<double>(t), 0, 0}, {}};
  };
  const FramePlan plan = plan_frames(path, nullptr, settings_with({0, 1}));
  EXPECT_EQ(plan.frames[0].camera.shutter_poses.front().position_m.x, 40e6);
}

}  // namespace
}  // namespace gazetrace::shutter_test
