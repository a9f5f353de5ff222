// SPDX-License-Identifier: Apache-2.0
// How pixels take the light from the surfaces of the blocks around them. Pixels that lie between the same four blocks
// are computed together, one in each lane.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "gazetrace/guides.hpp"
#include "reconstruct/surface_cells.hpp"
#include "reconstruct/surface_smoothing.hpp"

namespace gazetrace {

inline constexpr std::size_t kGatherLanes = 16;  // blocks of 4x4 pixels

template <class T>
struct alignas(64) GatherArray {
  T data[kGatherLanes] = {};  // gcc 12 makes no vectors of a std::array in a reference
  T& operator[](std::size_t i) { return data[i]; }
  const T& operator[](std::size_t i) const { return data[i]; }
};
using GatherLane = GatherArray<float>;

// What the pixels see; lanes from `count` on hold arbitrary values.
struct SurfaceLanes {
  GatherLane x_px, y_px, depth_m;  // continuous coordinates from the frame's centre; as in Guides
  GatherLane normal_x, normal_y, normal_z, place_x, place_y, place_z;
  GatherArray<std::int32_t> kind;
  std::array<GatherLane, 4> tent;  // bilinear weight of each of the four blocks
  std::size_t count = 0;
};

// Weighted sums over cells; after divide_light, `reflected` is light: reflected over albedo.
struct LightLanes {
  GatherLane reflected_r, reflected_g, reflected_b, albedo_r, albedo_g, albedo_b;
  GatherLane variance, replica, error, weight;
  GatherLane all;  // sum of the weights without regard to likeness
};

// Places from coordinates and depths, and tents: the first of the four blocks' centres is at (x_px, y_px).
void locate_lanes(const GuideCamera& camera, float x_px, float y_px, float block_px, SurfaceLanes& pixels);

// Adds a cell of block `k` to all lanes, to each as far as it is like what the pixel sees.
void add_cell(const SurfaceCell& cell, std::size_t k, const SurfaceLanes& pixels, const SmoothingSettings& settings,
              LightLanes& sums);

void divide_light(LightLanes& sums);

}  // namespace gazetrace
