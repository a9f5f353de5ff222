// SPDX-License-Identifier: Apache-2.0
// A sequence with history, rendered in one run, in two runs joined by a checkpoint, and with frames rendered before the
// first.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <string>
#include <vector>

#include "gazetrace/checkpoint.hpp"
#include "gazetrace/pipeline.hpp"
#include "gazetrace/traced_frame_file.hpp"
#include "render/tracer_scenes.hpp"
#include "support/temporary_folder.hpp"

namespace gazetrace {
namespace {

using namespace test;

constexpr std::int64_t kSecond = 1'000'000'000;

// A room with a body that moves through it.
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

FramePlan plan_of(int first, int last) {
  FramePlan plan;
  for (int frame = first; frame <= last; ++frame) {
    FrameRequest request;
    request.frame = frame;
    request.t_video_ns = kSecond * (2 * frame - 1) / 48;
    request.shutter_open_ns = request.shutter_close_ns = request.t_video_ns;
    request.width_px = 48;
    request.height_px = 32;
    request.camera = camera_at({0.05 * frame, 0.5, 5}, {0, 0, 0});
    request.view = view_of_perspective(50 * kRadPerDeg, 48, 32);
    request.gaze_direction_render = request.view.direction(8.0 + 3 * frame, 16);
    request.gaze_direction_true = request.gaze_direction_render;
    plan.frames.push_back(request);
  }
  return plan;
}

PipelineSettings settings_of() {
  PipelineSettings settings;
  settings.exposure.mode = ExposureMode::log_average;
  settings.exposure.smoothing_s = 0.2;
  std::get<RegionSampling>(settings.foveation.sampling).samples = {8, 4, 4};
  settings.reconstruction.filter = "linear";
  settings.settings_digest = "0123456789abcdef0123456789abcdef";
  settings.threads = 2;
  return settings;
}

struct Rendered {
  ImageRgb radiance;
  ImageGray sample_count, variance;
  double ev = 0;
  friend bool operator==(const Rendered&, const Rendered&) = default;
};

std::map<std::int32_t, Rendered> render(const Scene& scene, const FramePlan& plan, const PipelineSettings& settings) {
  PathTracer tracer(scene, threads(2));
  const ColorPipeline color(ColorSettings{});
  std::map<std::int32_t, Rendered> frames;
  PipelineObserver observer;
  observer.frame_ready = [&](const FrameRequest& request, const Frame& frame, double ev) {
    frames[request.frame] = {frame.radiance, frame.sample_count, frame.variance, ev};
  };
  Warnings warnings;
  (void)render_sequence(tracer, plan, color, settings, observer, starting_history(plan, settings, warnings));
  return frames;
}

TEST(History, TwoRunsJoinedByACheckpointAreOneRunToTheBit) {
  const Scene scene = room();
  const TemporaryFolder folder;
  const std::string file = folder / "history.bin";
  const auto whole = render(scene, plan_of(1, 8), settings_of());
  PipelineSettings first = settings_of();
  first.checkpoint = file;
  (void)render(scene, plan_of(1, 5), first);
  PipelineSettings second = settings_of();
  second.resume_from = file;
  const auto rest = render(scene, plan_of(6, 8), second);
  ASSERT_EQ(rest.size(), 3U);
  for (const auto& [frame, rendered] : rest) {
    EXPECT_EQ(rendered, whole.at(frame)) << frame;
  }
  // Without the history, frames differ.
  EXPECT_NE(render(scene, plan_of(6, 8), settings_of()).at(6), whole.at(6));
}

TEST(History, FramesThatAreTracedInPartsAndFinishedInOrderAreOneRunToTheBit) {
  const Scene scene = room();
  for (const char* filter : {"linear", "guided"}) {
    const TemporaryFolder folder;
    PipelineSettings settings = settings_of();
    settings.reconstruction.filter = filter;
    const auto whole = render(scene, plan_of(1, 6), settings);
    settings.output.run_name = folder / "frame";
    settings.output.exr.pattern = folder / "f.####.exr";
    PipelineSettings tracing = settings;
    tracing.stage = SequenceStage::trace;
    tracing.is_part = true;
    // Nobody is told of frames, since there are none yet.
    EXPECT_TRUE(render(scene, plan_of(4, 6), tracing).empty());
    PipelineSettings finishing = settings;
    finishing.stage = SequenceStage::finish;
    EXPECT_THROW(render(scene, plan_of(1, 6), finishing), Error);  // frames 1 to 3 are not traced
    (void)render(scene, plan_of(1, 3), tracing);
    EXPECT_EQ(render(scene, plan_of(1, 6), finishing), whole) << filter;
  }
}

TEST(Traced, EveryBitComesBackAndWhatDoesNotFitTogetherIsRefused) {
  const Scene scene = room();
  const TemporaryFolder folder;
  const std::string a = folder / "a";
  const std::string b = folder / "b";
  PipelineSettings settings = settings_of();
  settings.reconstruction.filter = "guided";
  PathTracer tracer(scene, threads(2));
  const TracedFrame traced = FrameRenderer(tracer, settings).trace(plan_of(3, 3).frames.front());
  ASSERT_FALSE(traced.sparse.surfaces.empty());
  save_traced(a, 3, traced, "d");
  const TracedFrame back = load_traced(a, 3, "d");
  EXPECT_EQ(back.sparse.stats.kernel, traced.sparse.stats.kernel);
  EXPECT_EQ(back.map.regions.front().name, traced.map.regions.front().name);
  save_traced(b, 3, back, "d");
  EXPECT_EQ(file_bytes(a), file_bytes(b));
  EXPECT_THROW((void)load_traced(a, 4, "d"), Error);
  EXPECT_THROW((void)load_traced(a, 3, "e"), Error);
  // Sealed as it should be, and wrong all the same.
  const std::vector<void (*)(TracedFrame&)> changes{
      [](TracedFrame& frame) { frame.sparse.count.pop_back(); },
      [](TracedFrame& frame) { frame.map.sites.front().region = 77; },
      [](TracedFrame& frame) { frame.map.sites.front().block_x = 60000; },
      [](TracedFrame& frame) { frame.map.tiles.front().first_site = 4'000'000'000U; },
      [](TracedFrame& frame) { frame.map.region.pixels.front() = 200; },
      [](TracedFrame& frame) { frame.sparse.first_surface.back() += 5; },
      [](TracedFrame& frame) { frame.map.width_px += 1; },
      [](TracedFrame& frame) { frame.map.tiles.front().x_px = -1; },
      [](TracedFrame& frame) { frame.map.sites.front().pixels = 0; },
      [](TracedFrame& frame) { frame.map.regions.front().block_px = 2'000'000'000; },
      [](TracedFrame& frame) {
        frame.map.regions.emplace_back().block_px = 0;  // of no site
        frame.sparse.stats.regions.emplace_back();
      },
      [](TracedFrame& frame) { frame.map.region.pixels.front() ^= 1U; },
      [](TracedFrame& frame) { frame.sparse.stats.regions.clear(); },
  };
  for (std::size_t i = 0; i < changes.size(); ++i) {
    TracedFrame wrong = traced;
    changes[i](wrong);
    save_traced(b, 3, wrong, "d");
    EXPECT_THROW((void)load_traced(b, 3, "d"), Error) << i;
  }
}

TEST(History, CheckpointsComeAsOftenAsAskedAndTheLastOneStays) {
  const Scene scene = room();
  const TemporaryFolder folder;
  PipelineSettings settings = settings_of();
  settings.checkpoint = folder / "history.bin";
  settings.checkpoint_every = 2;
  PathTracer tracer(scene, threads(2));
  const ColorPipeline color(ColorSettings{});
  std::vector<std::size_t> held;
  PipelineObserver observer;
  observer.frame_done = [&](const TimingRow&, bool) {
    held.push_back(std::filesystem::exists(settings.checkpoint)
                       ? load_checkpoint(settings.checkpoint, settings.settings_digest).passed.size()
                       : 0);
  };
  (void)render_sequence(tracer, plan_of(1, 5), color, settings, observer);
  EXPECT_EQ(held, (std::vector<std::size_t>{0, 2, 2, 4, 5}));
}

TEST(History, PrerollComesNearer) {
  const Scene scene = room();
  const auto whole = render(scene, plan_of(1, 12), settings_of());
  double previous = 1e9;
  for (const int preroll : {0, 3, 9}) {
    PipelineSettings settings = settings_of();
    settings.preroll = preroll;
    const auto some = render(scene, plan_of(12 - preroll, 12), settings);
    const double error = std::fabs(some.at(12).ev - whole.at(12).ev);
    EXPECT_LT(error, 0.7 * previous) << preroll;
    previous = error;
  }
}

TEST(History, WithoutSmoothingNothingChanges) {
  const Scene scene = room();
  PipelineSettings off = settings_of();
  off.exposure = {};
  const auto alone = render(scene, plan_of(3, 3), off);
  EXPECT_EQ(render(scene, plan_of(1, 3), off).at(3), alone.at(3));
}

TemporalHistory some_history() {
  TemporalHistory history;
  history.passed = {19, 20, 30};
  history.smoothed_ev = -1.5;
  history.smoothed_ev_t_ns = 77;
  return history;
}

TEST(Checkpoint, EveryBitComesBack) {
  const TemporaryFolder folder;
  const std::string a = folder / "a";
  const std::string b = folder / "b";
  save_checkpoint(a, some_history(), "d");
  const TemporalHistory back = load_checkpoint(a, "d");
  EXPECT_EQ(back.smoothed_ev, -1.5);
  EXPECT_EQ(back.smoothed_ev_t_ns, 77);
  EXPECT_EQ(back.passed, (std::vector<std::int32_t>{19, 20, 30}));
  save_checkpoint(b, back, "d");
  EXPECT_EQ(file_bytes(a), file_bytes(b));
  save_checkpoint(a, TemporalHistory{}, "d");
  EXPECT_FALSE(load_checkpoint(a, "d").smoothed_ev);
}

TEST(Checkpoint, DamageAndOtherSettingsAreRefused) {
  const TemporaryFolder folder;
  const std::string path = folder / "history.bin";
  save_checkpoint(path, some_history(), "these settings");
  const auto message = [&] {
    try {
      (void)load_checkpoint(path, "these settings");
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::input);
      return std::string(error.what());
    }
    return std::string("was accepted");
  };
  EXPECT_EQ(message(), "was accepted");
  EXPECT_THROW((void)load_checkpoint(path, "others"), Error);
  const std::string good = file_bytes(path);
  const auto write = [&](const std::string& bytes) { std::ofstream(path, std::ios::binary) << bytes; };
  for (std::size_t at = good.find('\n') + 1; at < good.size(); at += 3) {
    std::string bad = good;
    bad[at] = static_cast<char>(bad[at] ^ 16);
    write(bad);
    EXPECT_THAT(message(), ::testing::HasSubstr("the checkpoint is damaged")) << at;
  }
  for (const std::size_t length : {good.size() - 1, good.size() / 2, good.find('\n') + 3}) {
    write(good.substr(0, length));
    EXPECT_THAT(message(), ::testing::HasSubstr("the checkpoint is damaged")) << length;
  }
  write("something else\n");
  EXPECT_THAT(message(), ::testing::HasSubstr("is no checkpoint"));
  std::filesystem::remove(path);
  EXPECT_THAT(message(), ::testing::HasSubstr("cannot be opened"));
}

// Without a digest nothing tells whose history it is: that is an error, and no match.
TEST(Checkpoint, IsNotTakenUpWithoutADigest) {
  const TemporaryFolder folder;
  PipelineSettings settings = settings_of();
  settings.settings_digest.clear();
  settings.resume_from = folder / "history.bin";
  TemporalHistory history;
  history.passed = {5};
  save_checkpoint(settings.resume_from, history, settings.settings_digest);
  Warnings warnings;
  EXPECT_THROW((void)starting_history(plan_of(6, 6), settings, warnings), Error);
}

TEST(Checkpoint, ARunMustBeginAfterIt) {
  const Scene scene = room();
  const TemporaryFolder folder;
  PipelineSettings settings = settings_of();
  settings.resume_from = folder / "history.bin";
  TemporalHistory history;
  history.passed = {5};
  save_checkpoint(settings.resume_from, history, settings.settings_digest);
  EXPECT_THROW((void)render(scene, plan_of(5, 6), settings), Error);
  Warnings warnings;
  (void)starting_history(plan_of(6, 6), settings, warnings);
  EXPECT_TRUE(warnings.empty());
  (void)starting_history(plan_of(7, 7), settings, warnings);
  EXPECT_EQ(warnings.size(), 1U);
}

}  // namespace
}  // namespace gazetrace
