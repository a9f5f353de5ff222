// SPDX-License-Identifier: Apache-2.0
// Sorts the samples of a site by the surface that they hit, and puts the surfaces of all sites into a frame.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "core/luminance.hpp"
#include "gazetrace/trace.hpp"
#include "trace/kernel/path_batch.hpp"

namespace gazetrace {

// A sample joins the first surface of its kind whose normal is within acos(kSameNormal) of its own, and whose plane is
// no farther away than `kPlanePixels` times the size of a pixel there.
inline constexpr float kSameNormal = 0.8F;
inline constexpr float kPlanePixels = 2.0F;

// Sums of squares end at float's largest value.
inline float saturated(double value) {
  return static_cast<float>(std::min(value, static_cast<double>(std::numeric_limits<float>::max())));
}

// SparseFrame::half_difference, from the sums and the numbers of samples of both halves.
inline float half_difference(const std::array<double, 2>& sum, const std::array<std::uint32_t, 2>& count) {
  if (count[0] == 0 || count[1] == 0) {
    return 0;
  }
  const double a = count[0];
  const double b = count[1];
  return static_cast<float>((sum[0] / a - sum[1] / b) * std::sqrt(a * b) / (a + b));
}

// Luminance of the two halves of a site's samples.
struct HalfSums {
  std::array<double, 2> luminance{};
  std::array<std::uint32_t, 2> count{};

  void add(double value, std::uint8_t half) {
    luminance[half] += value;
    ++count[half];
  }
  // SparseFrame::half_difference.
  [[nodiscard]] float difference() const { return half_difference(luminance, count); }
};

class SurfaceSorter {
 public:
  // `pixel_m`: the size of a pixel at 1 m (perspective), or at any depth.
  SurfaceSorter(float pixel_m, bool perspective) : pixel_m_(pixel_m), perspective_(perspective) {}

  // `radiance` must be finite. Samples that miss, and those on unlit surfaces, are left out.
  void add(const SurfaceBatch& batch, std::size_t slot, const Vec3d& radiance, std::uint8_t half);
  // Sums of a surface of the same site, all of whose samples belong to `half`.
  void add(const SurfaceSums& sums, std::uint8_t half);
  // Appends the site's surfaces and starts a new site. `samples`: of each half, in all; 0 leaves out albedo_difference.
  void finish_site(const std::array<std::uint32_t, 2>& samples, std::vector<SurfaceSums>& out);

 private:
  struct Surface {
    Vec3d reflected, albedo, normal, place;
    double square = 0;
    HalfSums halves;
    std::array<double, 2> albedo_of_half{};
    std::uint32_t count = 0;
    SurfaceKind kind = SurfaceKind::diffuse;
    Vec3f first_normal, first_place;
    float reach = 0;  // how far others may be from the plane of its first sample, m
  };
  Surface& surface_of(SurfaceKind kind, const Vec3f& normal, const Vec3f& place);

  float pixel_m_;
  bool perspective_;
  std::size_t used_ = 0;
  std::array<Surface, kMostSurfaces> surfaces_;
};

// Adds up what the samples of a site saw first.
class FirstHitSummer {
 public:
  void add(const SurfaceBatch& batch, std::size_t slot, std::uint8_t half) {
    const Vec3d shone{batch.shone_r[slot], batch.shone_g[slot], batch.shone_b[slot]};
    shone_ += shone;
    halves_.add(luminance(shone), half);
    square_shift_ += static_cast<double>(batch.square_shift_px2[slot]);
    blended_ += batch.blended[slot];
  }
  [[nodiscard]] const std::array<std::uint32_t, 2>& samples() const { return halves_.count; }
  // The sums of the site; starts a new one.
  FirstHitSums finish_site() {
    const FirstHitSums sums{to_float(shone_), halves_.difference(), static_cast<float>(square_shift_), blended_};
    *this = {};
    return sums;
  }

 private:
  Vec3d shone_;
  HalfSums halves_;
  double square_shift_ = 0;
  std::uint32_t blended_ = 0;
};

// Puts the surfaces of all sites into a frame, in the order of the sites: those of the parts, one after the other. On
// entry SparseFrame::first_surface holds the number of surfaces of each site; empty: there are none.
void join_surfaces(std::vector<std::vector<SurfaceSums>> parts, SparseFrame& out);

}  // namespace gazetrace
