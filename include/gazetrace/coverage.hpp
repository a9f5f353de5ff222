// SPDX-License-Identifier: Apache-2.0
// How much of each pixel each surface covers: a pass of its own over the whole frame, of first hits only, with the same
// number of rays in every pixel however the frame's samples are spread.
#pragma once

#include <cstdint>
#include <vector>

#include "gazetrace/image.hpp"
#include "gazetrace/trace.hpp"

namespace gazetrace {

// One thing: surfaces of the same identifier. 0: not counted, as if nothing were there.
struct SurfaceIds {
  bool by_material = false;        // of Scene::materials; otherwise of Scene::instances
  std::vector<std::uint32_t> ids;  // one for each of them
};

struct CoverageSettings {
  int rays = 64;  // in each pixel, 1..1024; powers of two are spread most evenly
  int ranks = 6;  // so many identifiers are kept for a pixel, 1..16: those that cover most of it
  PixelFilter filter = PixelFilter::box;  // as TraceSettings::filter: rays fall as samples do
  double footprint = 1;                   // as TraceSettings::footprint
  std::uint64_t seed = 0;
};

// The identifiers of a pixel, from the one that covers most of it to the one that covers least; of two that cover the
// same share, the smaller one first.
struct Coverage {
  // Images of the frame's size, one for each rank. An identifier is stored as the bits of a float; unused ranks are 0.
  std::vector<ImageGray> id;
  // The share of the pixel's rays, 0..1. The shares of a pixel add up to less than 1 where rays miss everything, and
  // where more surfaces meet than there are ranks.
  std::vector<ImageGray> share;
};

}  // namespace gazetrace
