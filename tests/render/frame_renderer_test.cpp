// SPDX-License-Identifier: Apache-2.0
// One frame: the stages by hand, the renderer, and a sequence of files give the same bits.
#include "gazetrace/frame_renderer.hpp"

#include <gtest/gtest.h>

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "gazetrace/error.hpp"
#include "gazetrace/pipeline.hpp"
#include "render/tracer_scenes.hpp"
#include "support/picture_evidence.hpp"

namespace gazetrace::frame_renderer_test {
namespace {

using namespace test;

constexpr std::int64_t kSecond = 1'000'000'000;
constexpr int kWidth = 64, kHeight = 40;

// A body that moves through a room.
Scene room() {
  Scene scene;
  scene.materials = {diffuse_material({0.8F, 0.7F, 0.6F}), diffuse_material({0.2F, 0.5F, 0.8F})};
  scene.environment = builtin_sky();
  add_mesh(scene, {quad({{{-4, -1, -4}, {-4, -1, 4}, {4, -1, 4}, {4, -1, -4}}}, 0),
                   quad({{{-4, -1, -4}, {4, -1, -4}, {4, 4, -4}, {-4, 4, -4}}}, 0)});
  add_mesh(scene, box(0.6F, false, 1));
  scene.motions.push_back({[](std::int64_t t) {
    return make_affine({-1 + 2 * static_cast<double>(t) / kSecond, 0, 0}, {}, {1, 1, 1});
  }});
  scene.instances[1].motion = 0;
  return scene;
}

FrameRequest request_of(std::int32_t frame) {
  FrameRequest request;
  request.frame = frame;
  request.t_video_ns = frame * kSecond / 8;
  request.shutter_open_ns = request.shutter_close_ns = request.t_video_ns;
  request.width_px = kWidth;
  request.height_px = kHeight;
  request.camera = camera_at({0.05 * frame, 0.5, 5}, {0, 0, 0});
  request.view = view_of_perspective(50 * kRadPerDeg, kWidth, kHeight);
  request.gaze_direction_render = request.gaze_direction_true = request.view.direction(10.0 + 9 * frame, 18);
  return request;
}

FrameSettings settings_of(const std::string& filter) {
  FrameSettings settings;
  DensitySampling density = parse_density("mar");
  density.full_rate_spp = 8;
  settings.foveation.sampling = density;
  settings.reconstruction.filter = filter;
  settings.threads = 2;
  return settings;
}

TEST(FrameRenderer, MakesOfAFrameWhatItsStagesMakeOfIt) {
  const Scene scene = room();
  const FrameRequest request = request_of(3);
  for (const std::string filter : {"none", "linear", "guided"}) {
    const FrameSettings settings = settings_of(filter);
    PathTracer tracer(scene, threads(2));
    const RenderedFrame rendered = FrameRenderer(tracer, settings).render(request);

    PathTracer other(scene, threads(1));
    const PosedScene by_hand = other.at({request.t_video_ns, request.t_video_ns});
    const SamplingMap map = make_sampling_map(settings.foveation, request.view, request.gaze_direction_render,
                                              map_context(request, settings.trace.seed));
    TraceSettings trace = settings.trace;
    trace.surfaces = filter == "guided";
    trace.halves = filter == "guided";
    trace.guiding_field = by_hand.train_guiding(request.camera, kWidth, kHeight, trace).field;
    const SparseFrame sparse = by_hand.trace(request.camera, request.frame, map, trace);
    const Guides guides = by_hand.guides(request.camera, kWidth, kHeight, {.edge_rays = 4});
    const Frame frame = Reconstruction({filter}).frame(sparse, map, filter == "guided" ? &guides : nullptr);
    EXPECT_TRUE(same_picture(rendered.frame.radiance, frame.radiance, filter));
    EXPECT_EQ(rendered.frame.variance, frame.variance);
    EXPECT_EQ(rendered.samples.samples, map.samples());
    EXPECT_EQ(rendered.pilot.samples, 0U);  // the paths that it trains from are none
    EXPECT_GT(rendered.pilot.training_paths, 0U);
    EXPECT_EQ(rendered.times.guides_ms > 0, filter == "guided");
  }
}

TEST(FrameRenderer, IsWhatASequenceIsMadeOf) {
  const Scene scene = room();
  FramePlan plan;
  for (std::int32_t frame = 1; frame <= 4; ++frame) {
    plan.frames.push_back(request_of(frame));
  }
  const ColorPipeline color(ColorSettings{});
  PipelineSettings settings;
  static_cast<FrameSettings&>(settings) = settings_of("guided");
  settings.exposure.mode = ExposureMode::log_average;
  PathTracer tracer(scene, threads(2));
  std::vector<std::pair<ImageRgb, double>> frames;
  PipelineObserver observer;
  observer.frame_ready = [&](const FrameRequest&, const Frame& frame, double ev) {
    frames.emplace_back(frame.radiance, ev);
  };
  std::vector<RenderedFrame> taken;
  observer.take_frame = [&](const FrameRequest& request, RenderedFrame&& rendered, const TimingRow& row) {
    EXPECT_EQ(request.frame, row.frame);
    EXPECT_GT(row.total_ms, 0);
    taken.push_back(std::move(rendered));
  };
  const SequenceResult result = render_sequence(tracer, plan, color, settings, observer);

  const FrameRenderer renderer(tracer, settings);
  for (std::size_t i = 0; i < plan.frames.size(); ++i) {
    const RenderedFrame rendered = renderer.render(plan.frames[i]);
    EXPECT_TRUE(same_picture(rendered.frame.radiance, frames[i].first, std::to_string(i + 1)));
    EXPECT_EQ(rendered.exposure_ev, frames[i].second);
    EXPECT_TRUE(same_picture(rendered.frame.radiance, taken.at(i).frame.radiance, std::to_string(i + 1)));
    EXPECT_EQ(taken[i].map.samples(), rendered.map.samples());
    EXPECT_EQ(rendered.samples.samples + rendered.pilot.samples, result.rows[i].samples);
  }
}

// The pose is that which each frame asks for, whoever else uses the tracer.
TEST(FrameRenderer, TwoShareATracerAndDoNotMeet) {
  const Scene scene = room();
  PathTracer tracer(scene, threads(2));
  const FrameRenderer one(tracer, settings_of("linear"));
  const FrameRenderer two(tracer, settings_of("guided"));
  std::vector<ImageRgb> expected;
  for (std::int32_t frame = 1; frame <= 3; ++frame) {
    expected.push_back(one.render(request_of(frame)).frame.radiance);
  }
  for (std::int32_t frame = 1; frame <= 3; ++frame) {
    const ImageRgb picture = one.render(request_of(frame)).frame.radiance;
    EXPECT_TRUE(same_picture(picture, expected[static_cast<std::size_t>(frame - 1)], std::to_string(frame)));
    (void)two.render(request_of(7 - frame));
  }
}

TEST(FrameRenderer, RefusesToGuessAFilter) {
  const Scene scene = room();
  PathTracer tracer(scene, threads(1));
  EXPECT_THROW(FrameRenderer(tracer, FrameSettings{}), Error);
}

}  // namespace
}  // namespace gazetrace::frame_renderer_test
