// SPDX-License-Identifier: Apache-2.0
// The geometry that all frames share: how the eye sees the frame, and how gaze becomes a direction from the eye.
#pragma once

#include <optional>

#include "gazetrace/plan.hpp"

namespace gazetrace {

class GazeGeometry {
 public:
  // Error(input) for a screen log without a display, for a recording on a screen of another size without a transfer,
  // for gaze on a scene camera's picture, and for gaze directions without a perspective camera.
  GazeGeometry(const CameraPath& camera, const GazeLog* log, const PlanSettings& settings, Warnings& warnings);

  [[nodiscard]] const PlanarView& view() const { return view_; }
  // Carries the gaze over from the recording's screen to the display that is watched, and fills in the center where the
  // policy for missing gaze is to look there.
  void settle(GazeAtTime& gaze) const;
  // In the eye's frame; empty without gaze.
  [[nodiscard]] std::optional<Vec3d> direction(const GazeAtTime& gaze) const;

 private:
  PlanarView view_;
  PlanarView screen_;                    // of the whole display, in its own pixels
  std::optional<PlanarView> recording_;  // of the recording's display, where gaze is carried over by angle
};

}  // namespace gazetrace
