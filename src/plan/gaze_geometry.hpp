// SPDX-License-Identifier: Apache-2.0
// What is the same for every frame: how the eye sees the frame, and how a gaze becomes a direction from the eye.
#pragma once

#include <optional>

#include "gazetrace/plan.hpp"

namespace gazetrace {

class GazeGeometry {
 public:
  // Error(input) for a screen log without its screen, for a recording on another screen without a transfer, for gaze on
  // a scene camera's picture, and for gaze directions without a perspective camera.
  GazeGeometry(const CameraPath& camera, const GazeLog* log, const PlanSettings& settings, Warnings& warnings);

  [[nodiscard]] const PlanarView& view() const { return view_; }
  // From the log's screen or view to the one it is watched on, and the center where that is the policy.
  void settle(GazeAtTime& gaze) const;
  // In the eye's frame; empty without gaze.
  [[nodiscard]] std::optional<Vec3d> direction(const GazeAtTime& gaze) const;

 private:
  PlanarView view_;
  PlanarView screen_;                    // of the whole display, in its own pixels
  std::optional<PlanarView> recording_;  // of the recording's display where gaze is carried over by angle
};

}  // namespace gazetrace
