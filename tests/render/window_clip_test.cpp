// SPDX-License-Identifier: Apache-2.0
// Windows of frames by which a stated quality is judged.
#include "pipeline/window_clip.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/luminance.hpp"
#include "gazetrace/color.hpp"
#include "pipeline/discarded.hpp"
#include "render/tracer_scenes.hpp"
#include "render/tracer_statistics.hpp"

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

FrameSettings raw_settings(std::uint64_t seed) {
  FrameSettings settings;
  settings.trace.seed = seed;
  settings.threads = 2;
  return raw(settings, 16, "none");
}

double mean_luminance(const ImageRgb& picture) {
  double sum = 0;
  for (const Vec3f& light : picture.pixels) {
    sum += static_cast<double>(luminance(light));
  }
  return sum / static_cast<double>(picture.pixels.size());
}

// One where the door is, and one in a corner.
JudgedWindows two_windows() {
  JudgedWindows windows;
  windows.windows = {{{464, 208, 64, 64}, {480, 224, 32, 32}}, {{96, 64, 64, 64}, {112, 80, 32, 32}}};
  return windows;
}

TEST(WindowReference, SpendsWhatItIsToldAndLessAroundWhatCounts) {
  const Scene scene = room();
  PathTracer tracer(scene, threads(2));
  const JudgedWindows windows = two_windows();
  const FrameRequest request = request_of(1);
  const FrameSettings settings = raw_settings(1);
  WindowReference reference(tracer, windows, {&request}, settings);
  reference.refine(16);
  const std::uint64_t before = reference.stats().samples;
  reference.refine(48);
  EXPECT_NEAR(static_cast<double>(reference.stats().samples - before), 32.0 * 2 * 64 * 64, 0.02 * 32 * 2 * 64 * 64);
  EXPECT_EQ(reference.spp(), 48);
  for (const ImageGray& rates : reference.rates()) {
    double all = 0;
    for (const float rate : rates.pixels) {
      all += static_cast<double>(rate);
    }
    EXPECT_NEAR(all / (64 * 64), 1, 1e-4);
    EXPECT_FLOAT_EQ(rates(20, 40), 4 * rates(5, 40));
  }
}

// That pixels have unlike numbers of samples, and more are added later, changes no mean: against uniform frames.
TEST(WindowReference, ShowsTheLightThatUniformFramesShow) {
  const Scene scene = room();
  PathTracer tracer(scene, threads(2));
  const JudgedWindows windows = two_windows();
  const FrameRequest request = request_of(1);
  for (std::size_t w = 0; w < 2; ++w) {
    Repeats by_rates;
    Repeats uniform;
    for (std::uint64_t seed = 1; seed <= 32; ++seed) {
      const FrameSettings settings = raw_settings(seed);
      WindowReference reference(tracer, windows, {&request}, settings);
      reference.refine(16);
      reference.refine(32);
      by_rates.means.push_back(mean_luminance(reference.pictures().at(0).at(w)));
      TemporalHistory none;
      const FrameRequest part = part_of(request, windows.windows[w].traced);
      uniform.means.push_back(
          mean_luminance(FrameRenderer(tracer, raw_settings(1000 + seed)).render(part, none).frame.radiance));
    }
    EXPECT_LT(std::abs(welch_t(by_rates, uniform)), kCriticalT)
        << w << ": " << by_rates.mean() << ", " << uniform.mean();
    EXPECT_NEAR(by_rates.mean() / uniform.mean(), 1, 0.02) << w;
  }
}

}  // namespace
}  // namespace gazetrace
