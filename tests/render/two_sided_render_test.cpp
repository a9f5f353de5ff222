// SPDX-License-Identifier: Apache-2.0
// Sequences whose frames read those on both sides: what they gain while nothing moves, and that a frame does not depend
// on which others are rendered.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "core/statistics.hpp"
#include "gazetrace/pipeline.hpp"
#include "render/tracer_scenes.hpp"

namespace gazetrace {
namespace {

using namespace test;

constexpr std::int64_t kSecond = 1'000'000'000;

// A room with a body in it, which moves on request.
Scene room(bool moves) {
  Scene scene;
  scene.materials = {diffuse_material({0.8F, 0.7F, 0.6F}), diffuse_material({0.2F, 0.5F, 0.8F})};
  scene.environment = builtin_sky();
  add_mesh(scene, {quad({{{-4, -1, -4}, {-4, -1, 4}, {4, -1, 4}, {4, -1, -4}}}, 0),
                   quad({{{-4, -1, -4}, {4, -1, -4}, {4, 4, -4}, {-4, 4, -4}}}, 0)});
  add_mesh(scene, box(0.6F, false, 1));
  if (moves) {
    scene.motions.push_back({[](std::int64_t t) {
      return make_affine({-1 + 2 * static_cast<double>(t) / kSecond, 0, 0}, {}, {1, 1, 1});
    }});
    scene.instances[1].motion = 0;
  }
  return scene;
}

FrameRequest request_of(int frame, bool moves) {
  FrameRequest request;
  request.frame = frame;
  request.t_video_ns = kSecond * (2 * frame - 1) / 48;
  request.shutter_open_ns = request.shutter_close_ns = request.t_video_ns;
  request.width_px = 64;
  request.height_px = 48;
  request.camera = camera_at({moves ? 0.05 * frame : 0.3, 0.5, 5}, {0, 0, 0});
  request.view = view_of_perspective(50 * kRadPerDeg, 64, 48);
  request.gaze_direction_render = request.view.direction(moves ? 8.0 + 3 * frame : 32.0, 24);
  request.gaze_direction_true = request.gaze_direction_render;
  return request;
}

FramePlan plan_of(const std::vector<int>& frames, const std::vector<int>& around, bool moves) {
  FramePlan plan;
  for (const int frame : frames) {
    plan.frames.push_back(request_of(frame, moves));
  }
  for (const int frame : around) {
    plan.around.push_back(request_of(frame, moves));
  }
  return plan;
}

PipelineSettings settings_of(AccumulateMode mode, int window = 4) {
  PipelineSettings settings;
  settings.accumulate.mode = mode;
  settings.accumulate.window = window;
  std::get<RegionSampling>(settings.foveation.sampling).samples = {8, 4, 4};
  settings.reconstruction.filter = "linear";
  settings.threads = 2;
  return settings;
}

std::map<std::int32_t, Frame> render(const Scene& scene, const FramePlan& plan, const PipelineSettings& settings) {
  PathTracer tracer(scene, threads(2));
  const ColorPipeline color(ColorSettings{});
  std::map<std::int32_t, Frame> frames;
  PipelineObserver observer;
  observer.frame_ready = [&](const FrameRequest& request, const Frame& frame, double) {
    frames[request.frame] = frame;
  };
  (void)render_sequence(tracer, plan, color, settings, observer);
  return frames;
}

std::vector<int> numbers(int first, int last) {
  std::vector<int> list;
  for (int k = first; k <= last; ++k) {
    list.push_back(k);
  }
  return list;
}

void expect_same_bits(const Frame& a, const Frame& b) {
  EXPECT_EQ(a.radiance, b.radiance);
  EXPECT_EQ(a.sample_count, b.sample_count);
  EXPECT_EQ(a.variance, b.variance);
}

TEST(TwoSidedRender, AWindowOfNothingIsNoAccumulation) {
  const Scene scene = room(true);
  const FramePlan plan = plan_of(numbers(1, 3), {}, true);
  const auto off = render(scene, plan, settings_of(AccumulateMode::off));
  const auto alone = render(scene, plan, settings_of(AccumulateMode::two_sided, 0));
  for (const auto& [number, frame] : off) {
    expect_same_bits(alone.at(number), frame);
  }
}

TEST(TwoSidedRender, AFrameDoesNotDependOnWhichOthersAreRendered) {
  const Scene scene = room(true);
  for (const char* filter : {"linear", "guided"}) {
    SCOPED_TRACE(filter);
    PipelineSettings settings = settings_of(AccumulateMode::two_sided, 2);
    settings.reconstruction.filter = filter;
    const auto whole = render(scene, plan_of(numbers(1, 9), {}, true), settings);
    const auto middle = render(scene, plan_of({4, 6}, {2, 3, 5, 7, 8}, true), settings);
    expect_same_bits(middle.at(4), whole.at(4));
    expect_same_bits(middle.at(6), whole.at(6));
    const auto end = render(scene, plan_of({8, 9}, {6, 7}, true), settings);
    expect_same_bits(end.at(9), whole.at(9));
    const auto alone = render(scene, plan_of({4, 6}, {}, true), settings);
    EXPECT_NE(alone.at(4).radiance, whole.at(4).radiance) << "without the frames around it";
  }
}

// Whatever is traced is counted once: in the row of the frame itself or, of frames that are only read, in that of the
// first frame that reads them.
TEST(TwoSidedRender, WhatIsTracedOnlyToBeReadIsCounted) {
  const Scene scene = room(false);
  const PipelineSettings settings = settings_of(AccumulateMode::two_sided, 2);
  const auto samples = [&](const FramePlan& plan, const PipelineSettings& with) {
    PathTracer tracer(scene, threads(2));
    std::vector<std::uint64_t> counts;
    for (const TimingRow& row : render_sequence(tracer, plan, ColorPipeline(ColorSettings{}), with, {}).rows) {
      EXPECT_GT(row.rays_primary, 0U);
      EXPECT_EQ(row.pilot_samples, 0U);
      counts.push_back(row.samples);
    }
    return counts;
  };
  const std::uint64_t alone = samples(plan_of({4}, {}, false), settings_of(AccumulateMode::off)).front();
  EXPECT_EQ(samples(plan_of({4, 5}, {2, 3, 6, 7}, false), settings),
            (std::vector<std::uint64_t>{4 * alone, 2 * alone}));
}

TEST(TwoSidedRender, AllSamplesOfTheWindowCountWhileNothingMoves) {
  const Scene scene = room(false);
  PipelineSettings settings = settings_of(AccumulateMode::two_sided, 2);
  settings.accumulate.frames = 0;
  settings.accumulate.clip_sigmas = 0;
  const auto all = render(scene, plan_of(numbers(1, 5), {}, false), settings);
  const auto off = render(scene, plan_of(numbers(1, 5), {}, false), settings_of(AccumulateMode::off));
  const Frame& frame = all.at(3);
  for (std::size_t i = 0; i < frame.radiance.pixels.size(); ++i) {
    Vec3d sum;
    double count = 0;
    for (const auto& [number, one] : off) {
      const auto samples = static_cast<double>(one.sample_count.pixels[i]);
      sum += samples * to_double(one.radiance.pixels[i]);
      count += samples;
    }
    ASSERT_NEAR(frame.sample_count.pixels[i], count, 1e-4 * count);
    ASSERT_NEAR(frame.radiance.pixels[i].y, sum.y / count, 1e-5 * std::fabs(sum.y / count) + 1e-7);
  }
}

double error_of(const Frame& frame, const Frame& reference) {
  double squares = 0;
  for (std::size_t i = 0; i < frame.radiance.pixels.size(); ++i) {
    const double difference =
        static_cast<double>(frame.radiance.pixels[i].y) - static_cast<double>(reference.radiance.pixels[i].y);
    squares += difference * difference;
  }
  return squares / static_cast<double>(frame.radiance.pixels.size());
}

// Many samples of another seed, unfiltered, of what the camera of a frame sees.
Frame reference_of(const Scene& scene, int frame = 1, bool moves = false) {
  PipelineSettings exact = settings_of(AccumulateMode::off);
  exact.foveation.sampling = UniformSampling{};
  exact.foveation.spp = 2048;
  exact.reconstruction.filter = "none";
  exact.trace.seed = 99;
  return render(scene, plan_of({frame}, {}, moves), exact).at(frame);
}

// Noise falls as samples add up: 2 N + 1 frames on both sides are worth what as many are at the end of one side.
TEST(TwoSidedRender, ErrorFallsWithTheWindowAsFromOneSide) {
  const Scene scene = room(false);
  const Frame reference = reference_of(scene);
  const auto uniform = [&](AccumulateMode mode, int window) {
    PipelineSettings settings = settings_of(mode, window);
    settings.foveation.sampling = UniformSampling{};
    settings.foveation.spp = 4;
    settings.reconstruction.filter = "none";
    settings.accumulate.frames = 0;
    return settings;
  };
  const auto error = [&](AccumulateMode mode, int window, int frame) {
    return error_of(render(scene, plan_of(numbers(1, 9), {}, false), uniform(mode, window)).at(frame), reference);
  };
  const double off = error(AccumulateMode::off, 0, 5);
  const double one = error(AccumulateMode::two_sided, 1, 5);
  const double four = error(AccumulateMode::two_sided, 4, 5);
  const double past = error(AccumulateMode::reproject, 0, 9);
  EXPECT_LT(one, 0.5 * off);
  EXPECT_LT(four, 0.5 * one);
  EXPECT_LT(four, 1.2 * past);
}

PipelineSettings guided(AccumulateMode mode, int window, std::uint32_t spp) {
  PipelineSettings settings = settings_of(mode, window);
  settings.foveation.sampling = UniformSampling{};
  settings.foveation.spp = spp;
  settings.reconstruction.filter = "guided";
  return settings;
}

// While nothing moves, a filter sees the samples of the whole window, with less bias than in the mean of what it made
// of each frame's few. They are worth more than half as many in one frame, though not as many, since every frame
// spreads its few over a pixel by itself.
TEST(TwoSidedRender, AFilterSeesAllSamplesOfTheWindowWhileNothingMoves) {
  const Scene scene = room(false);
  const Frame reference = reference_of(scene);
  const auto window = render(scene, plan_of(numbers(1, 9), {}, false), guided(AccumulateMode::two_sided, 4, 4));
  const auto apart = render(scene, plan_of(numbers(1, 9), {}, false), guided(AccumulateMode::off, 0, 4));
  const Frame half = render(scene, plan_of({1}, {}, false), guided(AccumulateMode::off, 0, 18)).at(1);
  Frame mean = apart.at(1);
  for (std::size_t i = 0; i < mean.radiance.pixels.size(); ++i) {
    Vec3d sum;
    for (const auto& [number, frame] : apart) {
      sum += to_double(frame.radiance.pixels[i]);
    }
    mean.radiance.pixels[i] = to_float(sum / 9.0);
  }
  const double joined = error_of(window.at(5), reference);
  EXPECT_LT(joined, error_of(half, reference));
  EXPECT_LT(joined, 0.8 * error_of(mean, reference));
  EXPECT_NE(window.at(1).radiance, window.at(5).radiance) << "the first frame reads four others, the fifth eight";
}

TEST(TwoSidedRender, AFrameAtRestDoesNotDependOnWhichOthersAreRendered) {
  const Scene scene = room(false);
  PipelineSettings settings = guided(AccumulateMode::two_sided, 2, 1);
  const auto whole = render(scene, plan_of(numbers(1, 9), {}, false), settings);
  settings.threads = 1;
  const auto middle = render(scene, plan_of({4, 6}, {2, 3, 5, 7, 8}, false), settings);
  expect_same_bits(middle.at(4), whole.at(4));
  expect_same_bits(middle.at(6), whole.at(6));
}

// Frames 4 to 6 show the samples that are in the windows of all three, and not those of 1 and of 9.
TEST(TwoSidedRender, FramesThatHoldShowOneSum) {
  const Scene scene = room(false);
  PipelineSettings settings = settings_of(AccumulateMode::two_sided, 4);
  settings.accumulate.hold = 3;
  const auto held = render(scene, plan_of(numbers(1, 10), {}, false), settings);
  expect_same_bits(held.at(4), held.at(5));
  expect_same_bits(held.at(4), held.at(6));
  EXPECT_NE(held.at(4).radiance, held.at(3).radiance);
  EXPECT_NE(held.at(6).radiance, held.at(7).radiance);
  settings.accumulate = settings_of(AccumulateMode::two_sided, 3).accumulate;
  settings.accumulate.hold = 1;
  expect_same_bits(held.at(5), render(scene, plan_of(numbers(1, 10), {}, false), settings).at(5));
}

// The eye may move meanwhile.
TEST(TwoSidedRender, AFrameThatHoldsDoesNotDependOnWhichOthersAreRendered) {
  const Scene scene = room(false);
  PipelineSettings settings = guided(AccumulateMode::two_sided, 3, 1);
  settings.accumulate.hold = 3;
  settings.foveation.sampling = AdaptiveSampling{};
  settings.foveation.spp = 8;
  settings.foveation.max_block_px = 1;
  const auto look_along = [](std::vector<FrameRequest>& frames) {
    for (FrameRequest& request : frames) {
      request.gaze_direction_render = request.view.direction(8.0 + 5 * request.frame, 24);
      request.gaze_direction_true = request.gaze_direction_render;
    }
  };
  FramePlan all = plan_of(numbers(1, 9), {}, false);
  look_along(all.frames);
  const auto whole = render(scene, all, settings);
  settings.threads = 1;
  FramePlan some = plan_of({5, 6}, {2, 3, 4, 7, 8, 9}, false);
  look_along(some.frames);
  look_along(some.around);
  const auto middle = render(scene, some, settings);
  expect_same_bits(middle.at(5), whole.at(5));
  expect_same_bits(middle.at(6), whole.at(6));
  EXPECT_EQ(whole.at(5).radiance, whole.at(6).radiance) << "one group";
  EXPECT_NE(whole.at(3).radiance, whole.at(4).radiance) << "two groups";
}

// The last group has a single frame, which shows what is in its own window.
TEST(TwoSidedRender, AGroupEndsWithTheSequence) {
  const Scene scene = room(false);
  PipelineSettings settings = settings_of(AccumulateMode::two_sided, 3);
  settings.accumulate.hold = 3;
  const FramePlan plan = plan_of(numbers(1, 7), {}, false);
  const Frame last = render(scene, plan, settings).at(7);
  settings.accumulate.hold = 1;
  expect_same_bits(last, render(scene, plan, settings).at(7));
}

// What is learned does not depend on the frames, so that the first one learns for all that nothing moves between.
TEST(TwoSidedRender, FramesAtRestLearnOnce) {
  const Scene scene = room(false);
  for (const AccumulateMode mode : {AccumulateMode::off, AccumulateMode::two_sided}) {
    for (const bool moves : {false, true}) {
      PathTracer tracer(scene, threads(2));
      const auto rows = render_sequence(tracer, plan_of(numbers(1, 3), {}, moves), ColorPipeline(ColorSettings{}),
                                        settings_of(mode, 1), {})
                            .rows;
      EXPECT_GT(rows[0].learning_paths, 0U);
      EXPECT_EQ(rows[1].learning_paths > 0, moves);
      EXPECT_EQ(rows[2].learning_paths > 0, moves);
    }
  }
}

// Where only the camera moves, a filter sees what the whole window saw of a frame's surfaces. Edges, which few pixels
// are on, stay as well known as by the frame's own samples, so that the median over the pixels is what tells. Frames of
// other views have no mean to compare with: a frame alone with half as many samples as the window is the measure.
TEST(TwoSidedRender, AFilterSeesWhatOtherViewsSawOfASurface) {
  const Scene scene = room(false);
  const Frame reference = reference_of(scene, 5, true);
  const auto error = [&](AccumulateMode mode, std::uint32_t spp) {
    const Frame frame = render(scene, plan_of(numbers(1, 9), {}, true), guided(mode, 4, spp)).at(5);
    std::vector<float> off;
    for (std::size_t i = 0; i < frame.radiance.pixels.size(); ++i) {
      off.push_back(std::fabs(frame.radiance.pixels[i].y - reference.radiance.pixels[i].y));
    }
    return upper_median(off);
  };
  EXPECT_LT(error(AccumulateMode::two_sided, 1), error(AccumulateMode::off, 4));
}

TEST(TwoSidedRender, AFrameOfAViewThatMovesDoesNotDependOnWhichOthersAreRendered) {
  const Scene scene = room(false);
  for (const char* sampling : {"uniform", "regions"}) {
    PipelineSettings settings = guided(AccumulateMode::two_sided, 2, 2);
    settings.foveation.sampling = parse_sampling(sampling);
    const auto whole = render(scene, plan_of(numbers(1, 9), {}, true), settings);
    settings.threads = 1;
    const auto middle = render(scene, plan_of({4, 6}, {2, 3, 5, 7, 8}, true), settings);
    expect_same_bits(middle.at(4), whole.at(4));
    expect_same_bits(middle.at(6), whole.at(6));
    EXPECT_NE(render(scene, plan_of({4}, {}, true), settings).at(4).radiance, whole.at(4).radiance)
        << "without the frames around it";
  }
}

TEST(TwoSidedRender, ViewsAcrossASaccadeAreNotReadWhereThatIsAskedFor) {
  const Scene scene = room(false);
  FramePlan plan = plan_of(numbers(1, 6), {}, true);
  plan.frames[3].saccade_since_last_frame = true;  // of frame 4
  PipelineSettings settings = guided(AccumulateMode::two_sided, 5, 2);
  const auto read = render(scene, plan, settings);
  settings.accumulate.reset_at_saccades = true;
  const auto reset = render(scene, plan, settings);
  const auto before = render(scene, plan_of(numbers(1, 3), {}, true), settings);
  const auto after = render(scene, plan_of(numbers(4, 6), {}, true), settings);
  for (const int frame : numbers(1, 6)) {
    EXPECT_NE(reset.at(frame).radiance, read.at(frame).radiance) << frame;
    expect_same_bits(reset.at(frame), (frame < 4 ? before : after).at(frame));
  }
}

// A camera that stops, and later goes on: its frames at rest join their samples, and look up those from before and
// after.
TEST(TwoSidedRender, FramesAtRestAreReadBesideThoseThatMove) {
  const Scene scene = room(false);
  FramePlan plan = plan_of(numbers(1, 3), {}, true);
  for (const int frame : numbers(4, 8)) {
    FrameRequest request = request_of(frame, false);
    request.camera = plan.frames.back().camera;
    plan.frames.push_back(request);
  }
  const auto count = [](const Frame& frame) {
    double sum = 0;
    for (const float samples : frame.sample_count.pixels) {
      sum += static_cast<double>(samples);
    }
    return sum / static_cast<double>(frame.sample_count.pixels.size());
  };
  FrameRequest next = request_of(9, false);
  next.camera = plan.frames[1].camera;
  plan.frames.push_back(next);
  const auto frames = render(scene, plan, guided(AccumulateMode::two_sided, 2, 4));
  EXPECT_NEAR(count(frames.at(6)), 5 * 4, 1e-3) << "4 to 8, all at rest";
  EXPECT_GT(count(frames.at(4)), 4 * 4 + 0.5) << "3 to 6 at rest, and what 2 saw";
  EXPECT_LT(count(frames.at(4)), 5 * 4 + 1e-3);
  EXPECT_GT(count(frames.at(8)), 3 * 4 + 0.5) << "6 to 8 at rest, and what 9 saw";
  EXPECT_LT(count(frames.at(8)), 4 * 4 + 1e-3);
  FramePlan end;
  end.frames = {plan.frames[3], plan.frames[4]};
  end.around = {plan.frames[1], plan.frames[2], plan.frames[5], plan.frames[6]};
  const auto again = render(scene, end, guided(AccumulateMode::two_sided, 2, 4));
  expect_same_bits(again.at(4), frames.at(4));
  expect_same_bits(again.at(5), frames.at(5));
}

// A light goes on between two frames. What shows of it before is no more than what shows after a light has gone out,
// from one side.
TEST(TwoSidedRender, WhatIsStillToComeDoesNotShow) {
  const Scene dark = room(false);
  Scene bright = room(false);
  for (Vec3f& radiance : bright.environment.radiance.pixels) {
    radiance = radiance * 20.0F;
  }
  PathTracer before(dark, threads(2));
  PathTracer after(bright, threads(2));
  const FrameSettings two_sided = settings_of(AccumulateMode::two_sided, 4);
  const FrameSettings one_sided = settings_of(AccumulateMode::reproject);
  std::vector<ReconstructedFrame> frames;
  for (int k = 1; k <= 9; ++k) {
    frames.push_back(FrameRenderer(k <= 5 ? before : after, two_sided).reconstruct(request_of(k, false)));
  }
  std::vector<const ReconstructedFrame*> window;
  for (const ReconstructedFrame& frame : frames) {
    window.push_back(&frame);
  }
  TemporalHistory unused;
  const Frame last_dark = FrameRenderer(before, two_sided).join(window, 4, unused).frame;
  TemporalHistory history;
  for (int k = 1; k <= 8; ++k) {
    (void)FrameRenderer(after, one_sided).render(request_of(k, false), history);
  }
  const Frame first_dark = FrameRenderer(before, one_sided).render(request_of(9, false), history).frame;
  double leak_before = 0;
  double leak_after = 0;
  const Frame still_dark =
      FrameRenderer(before, settings_of(AccumulateMode::off)).reconstruct(request_of(9, false)).frame;
  for (std::size_t i = 0; i < last_dark.radiance.pixels.size(); ++i) {
    leak_before += static_cast<double>(last_dark.radiance.pixels[i].y - frames[4].frame.radiance.pixels[i].y);
    leak_after += static_cast<double>(first_dark.radiance.pixels[i].y - still_dark.radiance.pixels[i].y);
  }
  EXPECT_LE(std::fabs(leak_before), std::fabs(leak_after));
}

TEST(TwoSidedRender, OneFrameAloneIsRefused) {
  const Scene scene = room(false);
  PathTracer tracer(scene, threads(1));
  TemporalHistory history;
  EXPECT_THROW(
      (void)FrameRenderer(tracer, settings_of(AccumulateMode::two_sided)).render(request_of(1, false), history), Error);
}

}  // namespace
}  // namespace gazetrace
