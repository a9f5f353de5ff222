// SPDX-License-Identifier: Apache-2.0
// Windows of frames by which a stated quality is judged.
#include "pipeline/quality/window_clip.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/luminance.hpp"
#include "gazetrace/color.hpp"
#include "pipeline/quality/discarded.hpp"
#include "render/tracer_scenes.hpp"
#include "render/tracer_statistics.hpp"

namespace gazetrace::window_clip_test {
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

// They know what the whole frame trains, which is more than a window of it would, and one of them trains it for all.
TEST(WindowClip, WindowsAreLitByWhatTheGuidingOfTheWholeFrame) {
  const Scene scene = room();
  PathTracer tracer(scene, threads(2));
  JudgedFrames judged;
  judged.sequence_frames = 24;
  judged.runs = {{request_of(1), request_of(2)}};
  FrameSettings settings;
  settings.foveation.sampling = UniformSampling{};
  settings.foveation.spp = 1;
  settings.reconstruction.filter = "guided";
  settings.frames_per_second = 24;
  settings.threads = 2;
  settings.trace.max_bounces = 3;  // for which training clearly pays in this room
  settings.trace.russian_roulette = false;
  const ColorPipeline color(ColorSettings{});
  WindowClip clip(tracer, judged, settings, color);
  ASSERT_FALSE(clip.windows().is_whole_frame());
  ASSERT_EQ(clip.stats().training_paths, 0U);
  (void)clip.look(1, 0);
  const TrainedGuiding whole = tracer.at({0, 0}).train_guiding(request_of(1).camera, kWidth, kHeight, settings.trace);
  ASSERT_NE(whole.field, nullptr);
  EXPECT_EQ(clip.stats().training_paths, whole.paths);
}

FrameSettings settings_of(std::uint64_t seed) {
  FrameSettings settings;
  settings.trace.max_bounces = 3;  // for which training clearly pays in this room
  settings.trace.russian_roulette = false;
  settings.trace.seed = seed;
  settings.threads = 2;
  return settings;
}

// Those of a job, none of which are a reference's.
FrameSettings job_settings(std::uint64_t seed) {
  FrameSettings settings = settings_of(seed);
  settings.reconstruction.filter = "guided";
  settings.trace.guiding = true;
  settings.trace.clamp_indirect = 0.1;
  settings.foveation.sampling = AdaptiveSampling{};
  settings.foveation.spp = 1;
  settings.foveation.min_spp = 20;
  settings.foveation.target.jod = 9;
  return settings;
}

ImageRgb uniform_picture(PathTracer& tracer, const FrameRequest& request, double spp, std::uint64_t seed) {
  return FrameRenderer(tracer, raw(settings_of(seed), spp, "none")).render(request).frame.radiance;
}

double mean_luminance(const ImageRgb& picture) {
  double sum = 0;
  for (const Vec3f& light : picture.pixels) {
    sum += static_cast<double>(luminance(light));
  }
  return sum / static_cast<double>(picture.pixels.size());
}

// Mean squared difference in luminance, of the pixels that count.
double squared_difference(const ImageRgb& a, const ImageRgb& b, const JudgedWindow& window) {
  double sum = 0;
  double count = 0;
  for (int y = 0; y < a.height_px; ++y) {
    for (int x = 0; x < a.width_px; ++x) {
      if (window.counts(x, y)) {
        const auto off = static_cast<double>(luminance(a(x, y) - b(x, y)));
        sum += off * off;
        count += 1;
      }
    }
  }
  return sum / count;
}

// One where the door is, and one at the frame's corner, of which other shares count.
JudgedWindows two_windows() {
  JudgedWindows windows;
  windows.windows = {{{464, 208, 64, 64}, {480, 224, 32, 32}}, {{0, 0, 48, 48}, {0, 0, 32, 32}}};
  return windows;
}

class WindowReferenceTest : public ::testing::Test {
 protected:
  const Scene scene_ = room();
  PathTracer tracer_{scene_, threads(2)};
  const JudgedWindows windows_ = two_windows();
  const FrameRequest request_ = request_of(1);
};

TEST_F(WindowReferenceTest, SpendsWhatItIsToldAndLessAroundWhatCounts) {
  const FrameSettings settings = job_settings(1);
  WindowReference reference(tracer_, windows_, {&request_}, settings);
  reference.refine(16);
  const std::uint64_t before = reference.stats().samples;
  reference.refine(48);
  constexpr double kPixels = 64 * 64 + 48 * 48;
  EXPECT_NEAR(static_cast<double>(reference.stats().samples - before), 32 * kPixels, 0.02 * 32 * kPixels);
  EXPECT_EQ(reference.spp(), 48);
  // 2048 pixels count, and a quarter of the other 4352.
  constexpr double kOfCounted = kPixels / (2048 + 0.25 * 4352);
  for (std::size_t w = 0; w < 2; ++w) {
    const ImageGray& rates = reference.rates().at(w);
    const int first = w == 0 ? 16 : 0;
    for (const int inside : {first, first + 31}) {
      EXPECT_NEAR(rates(inside, inside), kOfCounted, 1e-5) << w;
    }
    EXPECT_NEAR(rates(first + 32, 20), 0.25 * kOfCounted, 1e-5) << w;
    EXPECT_NEAR(rates(20, first + 32), 0.25 * kOfCounted, 1e-5) << w;
  }
  EXPECT_NEAR(reference.rates().at(0)(15, 20), 0.25 * kOfCounted, 1e-5);
}

TEST_F(WindowReferenceTest, EachHalfHasASampleInEveryPixel) {
  const FrameSettings settings = job_settings(1);
  WindowReference reference(tracer_, windows_, {&request_}, settings);
  reference.refine(2);  // around what counts 0.5 in each half, and 2 where it counts
  constexpr double kOfCounted = (64 * 64 + 48 * 48) / (2048 + 0.25 * 4352);
  const double expected = 2 * (kOfCounted * 2048 + 4352);
  EXPECT_NEAR(static_cast<double>(reference.stats().samples), expected, 0.03 * expected);
}

// Light that is clamped, filters, and rates are the job's alone, and windows trains nothing for themselves.
TEST_F(WindowReferenceTest, IsTheSameForAllJobs) {
  const FrameSettings job = job_settings(1);
  const FrameSettings plain = settings_of(1);
  EXPECT_FALSE(raw(job, 16, "none").trace.guiding);  // too little is guided of windows_ as small as these
  WindowReference of_job(tracer_, windows_, {&request_}, job);
  WindowReference of_plain(tracer_, windows_, {&request_}, plain);
  of_job.refine(16);
  of_plain.refine(16);
  for (std::size_t w = 0; w < 2; ++w) {
    EXPECT_TRUE(of_job.pictures().at(0).at(w).pixels == of_plain.pictures().at(0).at(w).pixels) << w;
  }
}

// That pixels have unlike numbers of samples, and more are added later, changes no mean: against uniform frames.
TEST_F(WindowReferenceTest, ShowsTheLightThatUniformFramesShow) {
  for (std::size_t w = 0; w < 2; ++w) {
    Repeats by_rates;
    Repeats uniform;
    for (std::uint64_t seed = 1; seed <= 32; ++seed) {
      const FrameSettings settings = job_settings(seed);
      WindowReference reference(tracer_, windows_, {&request_}, settings);
      reference.refine(16);
      reference.refine(32);
      by_rates.means.push_back(mean_luminance(reference.pictures().at(0).at(w)));
      const FrameRequest part = part_of(request_, windows_.windows[w].traced);
      uniform.means.push_back(mean_luminance(uniform_picture(tracer_, part, 16, 1000 + seed)));
    }
    EXPECT_LT(std::abs(welch_t(by_rates, uniform)), kCriticalT)
        << w << ": " << by_rates.mean() << ", " << uniform.mean();
    EXPECT_NEAR(by_rates.mean() / uniform.mean(), 1, 0.02) << w;
  }
}

// Bounces that follow what the whole frame has guided show the same light with less noise, where the job trains.
TEST_F(WindowReferenceTest, FollowsTheGuidingOfTheJobAndShowsTheSameLight) {
  const TrainedGuiding whole = tracer_.at({0, 0}).train_guiding(request_.camera, kWidth, kHeight, settings_of(5).trace);
  ASSERT_NE(whole.field, nullptr);
  const auto light_of = [&](const FrameRequest&) { return whole.field; };
  const JudgedWindow& window = windows_.windows[1];
  const FrameRequest part = part_of(request_, window.traced);
  const ImageRgb truth = uniform_picture(tracer_, part, 1024, 77);
  Repeats with;
  Repeats without;
  double error_with = 0;
  double error_without = 0;
  for (std::uint64_t seed = 1; seed <= 16; ++seed) {
    const FrameSettings settings = job_settings(seed);
    WindowReference guided(tracer_, windows_, {&request_}, settings, light_of);
    WindowReference plain(tracer_, windows_, {&request_}, settings);
    guided.refine(32);
    plain.refine(32);
    with.means.push_back(mean_luminance(guided.pictures().at(0).at(1)));
    without.means.push_back(mean_luminance(plain.pictures().at(0).at(1)));
    error_with += squared_difference(guided.pictures().at(0).at(1), truth, window);
    error_without += squared_difference(plain.pictures().at(0).at(1), truth, window);
  }
  EXPECT_LT(std::abs(welch_t(with, without)), kCriticalT) << with.mean() << ", " << without.mean();
  EXPECT_NEAR(with.mean() / without.mean(), 1, 0.02);
  EXPECT_LT(error_with / error_without, 0.9);
  FrameSettings job = job_settings(1);
  job.trace.guiding = false;
  WindowReference told(tracer_, windows_, {&request_}, job, light_of);
  WindowReference plain(tracer_, windows_, {&request_}, job);
  told.refine(4);
  plain.refine(4);
  EXPECT_TRUE(told.pictures().at(0).at(1).pixels == plain.pictures().at(0).at(1).pixels);
}

// Against the truth: samples that are added in two steps are worth as much as all of them at once, raw and weighted as
// they must be, and pictures that are as far off are as far off.
TEST_F(WindowReferenceTest, ItsErrorIsThatOfItsSamplesAndIsKnown) {
  for (std::size_t w = 0; w < 2; ++w) {
    const JudgedWindow& window = windows_.windows[w];
    const FrameRequest part = part_of(request_, window.traced);
    const ImageRgb truth = uniform_picture(tracer_, part, 1024, 77);
    double at_once = 0;
    double in_steps = 0;
    double known = 0;
    double raw_error = 0;
    for (std::uint64_t seed = 1; seed <= 4; ++seed) {
      const FrameSettings settings = job_settings(seed);
      WindowReference once(tracer_, windows_, {&request_}, settings);
      once.refine(32);
      WindowReference stepped(tracer_, windows_, {&request_}, settings);
      stepped.refine(8);
      stepped.refine(32);
      at_once += squared_difference(once.pictures().at(0).at(w), truth, window);
      in_steps += squared_difference(stepped.pictures().at(0).at(w), truth, window);
      known += squared_difference(once.as_far_off().at(0).at(w), once.pictures().at(0).at(w), window);
      const double own_spp = 32 * static_cast<double>(once.rates().at(w)(20, 20));
      raw_error += squared_difference(uniform_picture(tracer_, part, own_spp, 900 + seed), truth, window);
    }
    // A sequence of samples that is cut into parts loses something of what it has over independent ones.
    EXPECT_NEAR(in_steps / at_once, 1, 0.25) << w;
    EXPECT_NEAR(known / at_once, 1, 0.25) << w;
    EXPECT_NEAR(at_once / raw_error, 1.1, 0.25) << w;
  }
}

// A display would cut off what is twice as bright.
TEST_F(WindowReferenceTest, WhatIsAsFarOffHasNoBrightSpecksInWhatCounts) {
  const FrameSettings settings = job_settings(1);
  WindowReference reference(tracer_, windows_, {&request_}, settings);
  reference.refine(2);
  const WindowPictures off = reference.as_far_off();
  int brighter_around = 0;
  int darker = 0;
  for (std::size_t w = 0; w < 2; ++w) {
    const ImageRgb& mean = reference.pictures().at(0).at(w);
    for (int y = 0; y < mean.height_px; ++y) {
      for (int x = 0; x < mean.width_px; ++x) {
        const auto light = static_cast<double>(luminance(mean(x, y)));
        const auto other = static_cast<double>(luminance(off.at(0).at(w)(x, y)));
        if (windows_.windows[w].counts(x, y)) {
          EXPECT_LE(other, 1.501 * light);
          darker += other < 0.499 * light ? 1 : 0;
        } else {
          brighter_around += other > 1.501 * light ? 1 : 0;
        }
      }
    }
  }
  EXPECT_GT(darker, 0);
  EXPECT_GT(brighter_around, 0);
}

}  // namespace
}  // namespace gazetrace::window_clip_test
