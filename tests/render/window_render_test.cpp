// SPDX-License-Identifier: Apache-2.0
// Sequences whose frames read those around them: what that gains, what it must not show, and that a frame does not
// depend on which others are rendered.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "gazetrace/pipeline.hpp"
#include "render/tracer_scenes.hpp"

namespace gazetrace::window_render_test {
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

PipelineSettings uniform(const char* filter, std::uint32_t spp, int past = 0, int future = 0) {
  PipelineSettings settings;
  settings.accumulate.mode = past + future > 0 ? AccumulateMode::window : AccumulateMode::off;
  settings.accumulate.past_frames = past;
  settings.accumulate.future_frames = future;
  settings.foveation.sampling = UniformSampling{};
  settings.foveation.spp = spp;
  settings.reconstruction.filter = filter;
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
Frame reference_of(const Scene& scene, int frame, bool moves) {
  PipelineSettings exact = uniform("none", 2048);
  exact.trace.seed = 99;
  return render(scene, plan_of({frame}, {}, moves), exact).at(frame);
}

TEST(WindowRender, AFrameDoesNotDependOnWhichOthersAreRendered) {
  for (const bool body_moves : {false, true}) {
    const Scene scene = room(body_moves);
    for (const char* sampling : {"uniform", "regions"}) {
      for (const char* filter : {"none", "guided"}) {
        SCOPED_TRACE(std::string(filter) + " " + sampling);
        PipelineSettings settings = uniform(filter, 2, 2, 1);
        settings.foveation.sampling = parse_sampling(sampling);
        const auto whole = render(scene, plan_of(numbers(1, 9), {}, true), settings);
        settings.threads = 1;
        const auto middle = render(scene, plan_of({4, 6}, {2, 3, 5, 7}, true), settings);
        expect_same_bits(middle.at(4), whole.at(4));
        expect_same_bits(middle.at(6), whole.at(6));
        const auto alone = render(scene, plan_of({4}, {}, true), settings);
        EXPECT_NE(alone.at(4).radiance, whole.at(4).radiance) << "without the frames around it";
      }
    }
  }
}

// Whatever is traced is counted once: in the row of the frame itself or, of frames that are only read, in that of the
// first frame that reads them.
TEST(WindowRender, WhatIsTracedOnlyToBeReadIsCounted) {
  const Scene scene = room(false);
  const auto samples = [&](const FramePlan& plan, const PipelineSettings& with) {
    PathTracer tracer(scene, threads(2));
    std::vector<std::uint64_t> counts;
    for (const TimingRow& row : render_sequence(tracer, plan, ColorPipeline(ColorSettings{}), with, {}).rows) {
      counts.push_back(row.samples);
    }
    return counts;
  };
  const std::uint64_t alone = samples(plan_of({4}, {}, false), uniform("linear", 1)).front();
  EXPECT_EQ(samples(plan_of({4, 5}, {2, 3, 6, 7}, false), uniform("linear", 1, 2, 2)),
            (std::vector<std::uint64_t>{4 * alone, 2 * alone}));
}

// At rest a frame shows the plain mean of its window's frames, weighted by their samples.
TEST(WindowRender, AtRestNothingIsLost) {
  for (const bool body_moves : {false, true}) {  // a body that could move stands still in two frames of one time
    const Scene scene = room(body_moves);
    FramePlan plan = plan_of(numbers(1, 5), {}, false);
    for (FrameRequest& request : plan.frames) {
      request.t_video_ns = request.shutter_open_ns = request.shutter_close_ns = kSecond / 2;
    }
    const auto all = render(scene, plan, uniform("none", 1, 4, 4));
    const auto off = render(scene, plan, uniform("none", 1));
    for (const int number : numbers(1, 5)) {
      const Frame& frame = all.at(number);
      for (std::size_t i = 0; i < frame.radiance.pixels.size(); ++i) {
        double sum = 0;
        for (const auto& [other, one] : off) {
          sum += static_cast<double>(one.radiance.pixels[i].y);
        }
        ASSERT_EQ(frame.sample_count.pixels[i], 5.0F) << i;
        ASSERT_NEAR(frame.radiance.pixels[i].y, sum / 5, 1e-6 * sum / 5) << i;
      }
      EXPECT_EQ(frame.radiance, all.at(1).radiance) << "all show the same sum";
    }
  }
}

// Of two halves of a site's samples, those of frames with odd and with even numbers: as noisy as they say.
TEST(WindowRender, HalvesSayHowNoisyTheSumIs) {
  const Scene scene = room(false);
  const Frame reference = reference_of(scene, 1, false);
  const auto frames = render(scene, plan_of(numbers(1, 6), {}, false), uniform("none", 1, 5, 5));
  double stated = 0;
  for (const float variance : frames.at(3).variance.pixels) {
    stated += static_cast<double>(variance);
  }
  stated /= static_cast<double>(reference.radiance.pixels.size());
  double off = 0;
  for (std::size_t i = 0; i < reference.radiance.pixels.size(); ++i) {
    const auto light = [&](const Frame& frame) {
      const Vec3f& c = frame.radiance.pixels[i];
      return 0.2126 * static_cast<double>(c.x) + 0.7152 * static_cast<double>(c.y) + 0.0722 * static_cast<double>(c.z);
    };
    off += (light(frames.at(3)) - light(reference)) * (light(frames.at(3)) - light(reference));
  }
  off /= static_cast<double>(reference.radiance.pixels.size());
  EXPECT_LT(stated, 2 * off);
  EXPECT_GT(stated, off / 2);
}

// What the camera's motion leaves in view joins: the error falls as by three times the samples at least, where eight
// other frames have seen nearly everything.
TEST(WindowRender, ErrorFallsWhileTheCameraMoves) {
  const Scene scene = room(false);
  const Frame reference = reference_of(scene, 5, true);
  const FramePlan plan = plan_of(numbers(1, 9), {}, true);
  for (const char* filter : {"none", "guided"}) {
    SCOPED_TRACE(filter);
    const double joined = error_of(render(scene, plan, uniform(filter, 1, 4, 4)).at(5), reference);
    EXPECT_LT(joined, error_of(render(scene, plan, uniform(filter, 3)).at(5), reference));
  }
}

// A body that moves takes its light along, and leaves nothing where it was.
TEST(WindowRender, ABodyInMotionIsNotSmeared) {
  const Scene scene = room(true);
  const Frame reference = reference_of(scene, 5, false);
  const FramePlan plan = plan_of(numbers(1, 9), {}, false);
  const double alone = error_of(render(scene, plan, uniform("none", 16)).at(5), reference);
  const double joined = error_of(render(scene, plan, uniform("none", 16, 4, 4)).at(5), reference);
  EXPECT_LT(joined, alone / 2);
}

double mean_of(const Frame& frame) {
  double sum = 0;
  for (const Vec3f& color : frame.radiance.pixels) {
    sum += static_cast<double>(color.y);
  }
  return sum / static_cast<double>(frame.radiance.pixels.size());
}

// A light goes on between two frames. Neither does it show before, nor does the dark show after.
TEST(WindowRender, LightThatChangesDoesNotShowInOtherFrames) {
  const Scene dark = room(true);
  Scene bright = room(true);
  for (Vec3f& radiance : bright.environment.radiance.pixels) {
    radiance = radiance * 4.0F;
  }
  PathTracer before(dark, threads(2));
  PathTracer after(bright, threads(2));
  const FrameSettings settings = uniform("none", 1, 4, 4);
  std::vector<WindowFrame> frames;
  for (int k = 1; k <= 9; ++k) {
    TrainedField light;
    frames.push_back(FrameRenderer(k <= 5 ? before : after, settings).window_frame(request_of(k, false), light));
  }
  std::vector<const WindowFrame*> window;
  for (const WindowFrame& frame : frames) {
    window.push_back(&frame);
  }
  for (const int own : {5, 6}) {
    const RenderedFrame joined =
        FrameRenderer(own == 5 ? before : after, settings).finish(window, static_cast<std::size_t>(own - 1));
    const double expected = mean_of(reference_of(own == 5 ? dark : bright, own, false));
    EXPECT_NEAR(mean_of(joined.frame), expected, 0.03 * expected) << own;
    double samples = 0;
    for (const float count : joined.frame.sample_count.pixels) {
      samples += static_cast<double>(count);
    }
    EXPECT_GT(samples / 3072, 3) << "those of the same light join";
  }
}

// A mirror shows other things from other places: what a pixel shows of it keeps its bits. Beside the sky, which joins,
// a pixel shows both.
TEST(WindowRender, WhatLooksDifferentFromElsewhereDoesNotJoin) {
  Scene scene = room(false);
  Material mirror = diffuse_material({0.9F, 0.9F, 0.9F});
  mirror.metallic = 1;
  mirror.roughness = 0.02F;
  scene.materials = {mirror, mirror};
  const FramePlan plan = plan_of(numbers(1, 5), {}, true);
  PipelineSettings settings = uniform("none", 4);
  settings.trace.guides = true;
  const Frame alone = render(scene, plan, settings).at(3);
  settings = uniform("none", 4, 2, 2);
  settings.trace.guides = true;
  const Frame joined = render(scene, plan, settings).at(3);
  int mirrors = 0;
  int sky = 0;
  for (int y = 2; y < 46; ++y) {
    for (int x = 2; x < 62; ++x) {
      bool is_inside = true;
      for (int k = 0; k < 25; ++k) {  // a pixel that a sample hits may show the sky in its middle
        is_inside = is_inside && std::isfinite(alone.depth_m(x + k % 5 - 2, y + k / 5 - 2));
      }
      if (is_inside) {
        ++mirrors;
        EXPECT_EQ(joined.radiance(x, y), alone.radiance(x, y)) << x << ' ' << y;
        EXPECT_EQ(joined.sample_count(x, y), 4) << x << ' ' << y;
      } else {
        sky += joined.sample_count(x, y) > 4 ? 1 : 0;
      }
    }
  }
  EXPECT_GT(mirrors, 1000);
  EXPECT_GT(sky, 100);
}

TEST(WindowRender, FramesAtRestTrainOnce) {
  const Scene scene = room(false);
  for (const int reach : {0, 1}) {
    for (const bool moves : {false, true}) {
      PathTracer tracer(scene, threads(2));
      const auto rows = render_sequence(tracer, plan_of(numbers(1, 3), {}, moves), ColorPipeline(ColorSettings{}),
                                        uniform("none", 1, reach, reach), {})
                            .rows;
      EXPECT_GT(rows[0].training_paths, 0U);
      EXPECT_EQ(rows[1].training_paths > 0, moves);
      EXPECT_EQ(rows[2].training_paths > 0, moves);
    }
  }
}

}  // namespace
}  // namespace gazetrace::window_render_test
