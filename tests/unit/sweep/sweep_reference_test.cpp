// SPDX-License-Identifier: Apache-2.0
// Which frames of a reference are rendered, and that an estimate counts those.
#include <gtest/gtest.h>

#include <memory>

#include "sweep/reference.hpp"

namespace gazetrace::sweep_reference_test {
namespace {

SweepReference reference_of(int frames) {
  SweepReference reference;
  for (int k = 11; k < 11 + frames; ++k) {
    FrameRequest request;
    request.frame = k;
    reference.plan.frames.push_back(request);
  }
  return reference;
}

const std::vector<std::int32_t> kAll{11, 12, 13};

TEST(ReferencePictures, OneStandsForAllWhereNothingMoves) {
  EXPECT_EQ(reference_pictures(reference_of(3), Scene()), std::vector<std::int32_t>{11});
}

TEST(ReferencePictures, AllWhereTheCameraMovesOrZooms) {
  SweepReference moves = reference_of(3);
  moves.plan.frames[2].camera.pose.position_m.x = 1e-9;
  EXPECT_EQ(reference_pictures(moves, Scene()), kAll);
  SweepReference zooms = reference_of(3);
  zooms.plan.frames[1].camera.projection.yfov_rad *= 1.001;
  EXPECT_EQ(reference_pictures(zooms, Scene()), kAll);
  SweepReference focuses = reference_of(3);
  focuses.plan.frames[1].camera.lens.focus_distance_m = 2;
  EXPECT_EQ(reference_pictures(focuses, Scene()), kAll);
  SweepReference blurs = reference_of(3);
  blurs.plan.frames[0].camera.shutter_poses.resize(2);
  EXPECT_EQ(reference_pictures(blurs, Scene()), kAll);
}

TEST(ReferencePictures, AllWhereTheSceneMovesOrDeforms) {
  Scene moves;
  moves.motions.emplace_back();
  EXPECT_EQ(reference_pictures(reference_of(3), moves), kAll);
  Scene deforms;
  deforms.deformations.emplace_back();
  EXPECT_EQ(reference_pictures(reference_of(3), deforms), kAll);
}

// What is gathered over time differs from frame to frame.
TEST(ReferencePictures, AllWhereItAccumulates) {
  SweepReference reference = reference_of(3);
  reference.pipeline.accumulate.mode = AccumulateMode::window;
  EXPECT_EQ(reference_pictures(reference, Scene()), kAll);
}

// Two references of one scene and one of another, 3 frames of 8 x 4 pixels each, of 4 scramblings of 16 samples.
struct Planned {
  SweepPlan plan;
  std::vector<int> loads = std::vector<int>(2);
};

std::unique_ptr<Planned> planned(const std::vector<Scene>& scenes) {
  auto made = std::make_unique<Planned>();
  for (std::size_t s = 0; s < scenes.size(); ++s) {
    const auto scene = std::make_shared<const Scene>(scenes[s]);
    made->plan.scenes.push_back({"scene",
                                 "",
                                 [scene, count = &made->loads[s]] {
                                   ++*count;
                                   return scene;
                                 },
                                 {}});
  }
  for (const std::size_t of : {std::size_t{0}, std::size_t{0}, std::size_t{1}}) {
    SweepReference reference = reference_of(3);
    reference.scene = of;
    reference.pipeline.foveation.spp = 16;
    reference.seeds = {1, 2, 3, 4};
    for (FrameRequest& request : reference.plan.frames) {
      request.width_px = 8;
      request.height_px = 4;
    }
    made->plan.references.push_back(reference);
  }
  return made;
}

constexpr double kOneFrame = 8 * 4 * 16;

std::vector<double> samples_of(const SweepEstimate& estimate) {
  std::vector<double> samples;
  for (const SweepEstimate::Row& row : estimate.rows) {
    samples.push_back(row.samples);
  }
  return samples;
}

TEST(ReferenceEstimate, CountsOneFrameWhereNothingMoves) {
  Scene moves;
  moves.motions.emplace_back();
  const auto made = planned({Scene(), moves});
  const SweepEstimate estimate = estimate_sweep(made->plan);
  EXPECT_EQ(samples_of(estimate), (std::vector<double>{kOneFrame, kOneFrame, 3 * kOneFrame}));
  EXPECT_EQ(estimate.rows[0].repeats, 4);
  EXPECT_EQ(estimate.samples, (1 + 1 + 3) * 4 * kOneFrame);
  EXPECT_EQ(made->loads, (std::vector<int>{1, 1}));  // once for all references of a scene
}

// Loading is slow: no scene is asked where the camera or the settings have answered, or there is one frame anyway.
TEST(ReferenceEstimate, LoadsNothingWhereTheSceneDecidesNothing) {
  const auto made = planned({Scene(), Scene()});
  std::vector<SweepReference>& references = made->plan.references;
  references[0].plan.frames[1].camera.pose.position_m.x = 1;
  references[1].pipeline.accumulate.mode = AccumulateMode::window;
  references[2].plan.frames.resize(1);
  EXPECT_EQ(samples_of(estimate_sweep(made->plan)), (std::vector<double>{3 * kOneFrame, 3 * kOneFrame, kOneFrame}));
  EXPECT_EQ(made->loads, (std::vector<int>{0, 0}));
}

}  // namespace
}  // namespace gazetrace::sweep_reference_test
