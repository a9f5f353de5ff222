// SPDX-License-Identifier: Apache-2.0
// Smooths light along surfaces: an edge-stopping a-trous transform on the sites (Dammertz et al., "Edge-Avoiding
// A-Trous Wavelet Transform for fast Global Illumination Filtering", HPG 2010), steered by the noise of the light
// itself (Schied et al., "Spatiotemporal Variance-Guided Filtering", HPG 2017).
#pragma once

#include <algorithm>
#include <cmath>

#include "reconstruct/surface_cells.hpp"

namespace gazetrace {

struct SmoothingSettings {
  int levels = 5;  // steps of 1, 2, 4 ... blocks, at most so many, and at last of 1 once more
  int fewest_levels = 3;
  double samples = 512;    // wider steps are left out where the squares of 4, 16, 64 ... blocks have as many
  float light_sigmas = 6;  // differences of light up to so many standard deviations are taken for noise
  // What guides leave out is given back where its square is larger than that of its noise, by so many standard
  // deviations of the estimate of the latter.
  float residual_doubt = 3;
  float few_samples = 8;  // with so many samples in a mean the doubt is twice as large: few say little of rare light
  float most_deviations = 4;  // of a residual's noise, in those of all around; what is beyond is a rare bright sample
  float plane = 0.25F;        // how far off a surface's plane a neighbour may lie, over its distance
};

// What a doubt is multiplied by where means are of so many samples.
inline float doubt_of_few(float samples, const SmoothingSettings& settings) {
  return 1 + settings.few_samples / std::max(samples, 1.0F);
}

// Smaller weights count as 0, so that their squares, which variances need, stay far from float's smallest.
constexpr float kLeastLikeness = 1e-6F;

// 1 at 0, falls like exp(-x) and ends at x = 3, so that what lies across an edge has no weight at all.
inline float falling(float x) {
  const float t = std::max(1.0F - x * (1.0F / 3.0F), 0.0F);
  return t * t * t;
}

// The 16th power of the cosine between normals.
inline float facing_power(float cosine) {
  const float c = std::max(cosine, 0.0F);
  const float c2 = c * c;
  const float c4 = c2 * c2;
  const float c8 = c4 * c4;
  return c8 * c8;
}

// How alike two places are: 1 on one plane with one normal, 0 across an edge. `way` leads from one to the other;
// distances up to `slack_m` count as none. There are no branches, so that loops over lanes become vectors.
[[gnu::always_inline]] inline float likeness(const Vec3f& normal_a, const Vec3f& normal_b, const Vec3f& way,
                                             float slack_m, const SmoothingSettings& settings) {
  const float off = std::max(std::fabs(dot(normal_a, way)), std::fabs(dot(normal_b, way)));
  const float like =
      facing_power(dot(normal_a, normal_b)) * falling(off / (settings.plane * std::sqrt(dot(way, way)) + slack_m));
  return like >= kLeastLikeness ? like : 0.0F;
}

// No light is lost: the sums over all cells of samples times reflected, and times albedo, stay what they are where all
// blocks are of one size, and nearly so at borders between sizes.
void smooth_surfaces(SurfaceCells& cells, const SamplingMap& map, const SmoothingSettings& settings, int threads);

}  // namespace gazetrace
