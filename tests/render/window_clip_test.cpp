// SPDX-License-Identifier: Apache-2.0
// Windows of frames by which a stated quality is judged.
#include "pipeline/window_clip.hpp"

#include <gtest/gtest.h>

#include <cstdint>
#include <vector>

#include "gazetrace/color.hpp"
#include "render/tracer_scenes.hpp"

namespace gazetrace {
namespace {

using namespace test;

constexpr int kWidth = 640, kHeight = 480;

// A room with a door to the sky.
Scene room() {
  Scene scene;
  scene.materials = {diffuse_material({0.8F, 0.7F, 0.6F})};
  scene.environment = builtin_sky();
  add_mesh(scene, {quad({{{-4, -1, -4}, {-4, -1, 4}, {4, -1, 4}, {4, -1, -4}}}, 0),
                   quad({{{-4, 3, -4}, {4, 3, -4}, {4, 3, 4}, {-4, 3, 4}}}, 0),
                   quad({{{-4, -1, -4}, {4, -1, -4}, {4, 3, -4}, {-4, 3, -4}}}, 0),
                   quad({{{-4, -1, 4}, {-4, 3, 4}, {4, 3, 4}, {4, -1, 4}}}, 0),
                   quad({{{-4, -1, -4}, {-4, 3, -4}, {-4, 3, 4}, {-4, -1, 4}}}, 0),
                   quad({{{4, -1, -2}, {4, -1, 4}, {4, 3, 4}, {4, 3, -2}}}, 0)});
  return scene;
}

FrameRequest request_of(std::int32_t frame) {
  FrameRequest request = frame_request(frame, camera_at({0.3, 0.5, 3.5}, {0, 0, 0}), kWidth, kHeight);
  request.gaze_direction_render = request.gaze_direction_true = request.view.direction(0.5 * kWidth, 0.5 * kHeight);
  return request;
}

// They know what the whole frame learns, which is more than a window of it would, and one of them learns it for all.
TEST(WindowClip, WindowsAreLitByWhatTheWholeFrameLearns) {
  const Scene scene = room();
  PathTracer tracer(scene, threads(2));
  JudgedFrames judged;
  judged.sequence_frames = 24;
  judged.runs = {{request_of(1), request_of(2)}};
  FrameSettings settings;
  settings.foveation.falloff = "uniform";
  settings.foveation.uniform_spp = 1;
  settings.reconstruction.filter = "guided";
  settings.frames_per_second = 24;
  settings.threads = 2;
  const ColorPipeline color(ColorSettings{});
  WindowClip clip(tracer, judged, settings, color);
  ASSERT_FALSE(clip.windows().is_whole_frame());
  ASSERT_EQ(clip.stats().learning_paths, 0U);
  (void)clip.look(1, 0);
  const LightLearning whole = tracer.at({0, 0}).learn_light(request_of(1).camera, kWidth, kHeight, settings.trace);
  ASSERT_NE(whole.light, nullptr);
  EXPECT_EQ(clip.stats().learning_paths, whole.paths);
}

}  // namespace
}  // namespace gazetrace
