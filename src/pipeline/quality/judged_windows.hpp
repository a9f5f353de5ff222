// SPDX-License-Identifier: Apache-2.0
// Which parts of a frame are looked at closely where all of it would be too dear.
#pragma once

#include <vector>

#include "gazetrace/display.hpp"
#include "gazetrace/image.hpp"
#include "pipeline/frame_part.hpp"

namespace gazetrace {

struct JudgedWindow {
  PixelRect traced;   // the margin around what counts belongs to what filters and metrics see
  PixelRect counted;  // within it

  // A pixel of `traced`, from its corner.
  [[nodiscard]] bool counts(int x, int y) const { return counted.holds(traced.x_px + x, traced.y_px + y); }
};

struct JudgedWindows {
  std::vector<JudgedWindow> windows;
  // Of each pixel of the frame in means over it (FovVideoVdpSettings::pooling_weights); empty: all count alike.
  ImageGray weights;

  [[nodiscard]] bool is_whole_frame() const { return weights.empty(); }
  // How much of the frame is traced.
  [[nodiscard]] double share_of(const PlanarView& view) const;
};

// Windows on a jittered grid, which share what the frame has, and one at each gaze (in pixels), which stands for
// itself: the fovea is small, and worst errors there decide. A side is about three and a half degrees long. Together
// they are about a twentieth of the frame, and at least a dozen; where that would be most of the frame, it is the whole
// of it. A function of its arguments alone. Corners lie at multiples of the largest block, so that blocks are those of
// the frame. The margin is a quarter of the side, or, of a view that moves, so that more of what comes in was seen
// before, a third.
JudgedWindows judged_windows(const PlanarView& view, const std::vector<Vec2d>& gazes_px, bool view_moves = false);

}  // namespace gazetrace
