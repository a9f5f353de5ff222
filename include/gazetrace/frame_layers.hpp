// SPDX-License-Identifier: Apache-2.0
// Layers of a frame beside its picture, on request: mattes, motion, positions and light passes.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "gazetrace/coverage.hpp"
#include "gazetrace/cryptomatte.hpp"
#include "gazetrace/image.hpp"
#include "gazetrace/light_groups.hpp"

namespace gazetrace {

// Where the surface behind a pixel's centre is and was, through a pinhole in the middle of the frame's time.
struct MotionLayers {
  // In pixels, x right and y up, from the pixel to where the same point of the surface is in the frame before
  // (backward) or after (forward) at the frame rate, whichever frames are rendered; 0 where it is not in front of that
  // camera.
  Image<Vec2f> backward_px, forward_px;
  ImageRgb position_m;  // world axes; 0 where there is nothing but the environment
};

// Which of them a frame is asked for.
struct LayerSettings {
  bool forward = false, backward = false, position = false;
  bool light = false;               // FrameLayers::light
  bool alpha = false;               // FrameLayers::alpha
  std::vector<std::string> mattes;  // some of cryptomatte_layers()
  // Of mattes and alpha. Filter, footprint and seed are those that the frame's samples are traced with.
  CoverageSettings coverage;
  [[nodiscard]] bool any() const { return forward || backward || position || light || alpha || !mattes.empty(); }
};

struct FrameLayers {
  // One for each Cryptomatte layer that was asked for.
  std::shared_ptr<const std::vector<MatteTable>> tables;
  std::vector<Coverage> mattes;
  // The share of each pixel that surfaces cover, by CoverageSettings::rays first hits that are its own: it has no noise
  // but at edges, and does not follow the spread of samples, filters or windows. Where it is 0, the picture is black.
  ImageGray alpha;
  MotionLayers motion;  // images are empty where they were not asked for
  // One for each LightGroup, or none. Under the filters none and linear, whose weights do not depend
  // on the light, each is the group's own samples, filtered. Under other filters, and where frames are
  // accumulated, a group is the picture itself times the group's share of the light, as the
  // filter `linear` (or, in single pixels, the samples' mean) finds it in the frame's own samples. Both ways the layers
  // add up to the picture, apart from rounding.
  std::vector<ImageRgb> light;
};

}  // namespace gazetrace
