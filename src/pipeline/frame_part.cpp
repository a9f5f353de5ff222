// SPDX-License-Identifier: Apache-2.0
#include "pipeline/frame_part.hpp"

#include <cmath>

namespace gazetrace {

FrameRequest part_of(const FrameRequest& frame, const PixelRect& rect) {
  FrameRequest part = frame;
  part.width_px = rect.width_px;
  part.height_px = rect.height_px;
  // Pixels keep their size.
  const double share = static_cast<double>(rect.height_px) / frame.height_px;
  Projection& projection = part.camera.projection;
  projection.yfov_rad = 2 * std::atan(share * std::tan(projection.yfov_rad / 2));
  projection.ymag_m *= share;
  part.camera.middle_px = {frame.camera.middle_px.x + rect.x_px + 0.5 * (rect.width_px - frame.width_px),
                           frame.camera.middle_px.y + rect.y_px + 0.5 * (rect.height_px - frame.height_px)};
  part.view.left += part.view.step_x * rect.x_px;
  part.view.top -= part.view.step_y * rect.y_px;
  part.view.width_px = rect.width_px;
  part.view.height_px = rect.height_px;
  return part;
}

FrameRequest window_of(const FrameRequest& frame, const PixelRect& rect) {
  FrameRequest part = part_of(frame, rect);
  part.window = {rect.x_px, rect.y_px, frame.width_px, frame.height_px, frame.camera.projection};
  return part;
}

}  // namespace gazetrace
