// SPDX-License-Identifier: Apache-2.0
// Which frames of a reference are rendered.
#include <gtest/gtest.h>

#include "sweep/reference.hpp"

namespace gazetrace {
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
  reference.pipeline.accumulate.mode = AccumulateMode::running;
  EXPECT_EQ(reference_pictures(reference, Scene()), kAll);
}

}  // namespace
}  // namespace gazetrace
