// SPDX-License-Identifier: Apache-2.0
// The light that falls on the surface that a pixel or a ray sees, taken from similar surfaces of the blocks near by,
// for one pixel at a time. Where the four nearest blocks suffice, fill_squares.hpp computes several pixels together.
#pragma once

#include <algorithm>
#include <cstddef>

#include "core/luminance.hpp"
#include "gazetrace/guides.hpp"
#include "reconstruct/filter.hpp"
#include "reconstruct/surface_cells.hpp"
#include "reconstruct/surface_smoothing.hpp"

namespace gazetrace {

struct GatheredLight {
  Vec3f reflected, albedo;
  float variance = 0, replica = 0, error = 0;
  float weight = 0;
  float all = 0;  // sum of the weights without regard to likeness

  void add(float w, const SurfaceCell& cell) {
    reflected += w * cell.reflected;
    albedo += w * cell.albedo;
    variance += w * w * cell.variance;
    replica += w * cell.replica;
    error += w * cell.variance;
    weight += w;
  }
};

// Where less than this share of the nearest samples is on a similar surface, farther blocks are used as well.
inline constexpr float kEnoughLike = 0.02F;
inline bool enough_alike(float weight, float all) {
  return weight > kEnoughLike * all && weight > 0;
}

struct PixelSurface {
  Vec3f normal, position_m;
  SurfaceKind kind = SurfaceKind::diffuse;
};

class SurfaceLookup {
 public:
  SurfaceLookup(const FilterInput& input, const SurfaceCells& lattice, const SmoothingSettings& settings)
      : map_(input.map), guides_(*input.guides), lattice_(lattice), settings_(settings) {}

  // The light that falls on a surface that pixel (x, y) sees; its weight is 0 where no sample is near.
  [[nodiscard]] GatheredLight light_at(int x, int y, const PixelSurface& pixel) const;
  // For places where the nearest four blocks have too few samples.
  [[nodiscard]] GatheredLight farther(int x, int y, const PixelSurface& pixel) const;

  [[nodiscard]] PixelSurface surface_of(int x, int y) const;
  [[nodiscard]] PixelSurface surface_of(const EdgeSurface& seen) const;

 private:
  void add_block(std::size_t region, int bx, int by, float tent, const PixelSurface& pixel, bool alike,
                 GatheredLight& light) const;
  [[nodiscard]] GatheredLight nearest_four(int x, int y, const PixelSurface& pixel) const;
  [[nodiscard]] GatheredLight square(int x, int y, const PixelSurface& pixel, bool alike) const;

  const SamplingMap& map_;
  const Guides& guides_;
  const SurfaceCells& lattice_;
  const SmoothingSettings& settings_;
};

// For a miss or an unlit surface the guides say everything: no light has to be taken from samples.
inline bool only_shines(SurfaceKind kind) {
  return kind == SurfaceKind::miss || kind == SurfaceKind::unlit;
}

struct PixelValue {
  Vec3f radiance;
  float variance = 0;
  float replica = 0;  // of the error of its luminance
  float error = 0;    // estimated squared error of its luminance
};

// What the filter has found so far.
struct SurfacePicture {
  ImageRgb radiance;
  ImageGray variance, replica, error;  // as PixelValue
  // What first hits brought in addition, which better light does not take away: the samples' own mean has it as well.
  // Empty without SparseFrame::first_hits.
  ImageGray first_hits_variance, first_hits_error;

  SurfacePicture(int width_px, int height_px)
      : radiance(width_px, height_px),
        variance(width_px, height_px),
        replica(width_px, height_px),
        error(width_px, height_px) {}
  [[nodiscard]] PixelValue at(std::size_t pixel) const {
    return {radiance.pixels[pixel], variance.pixels[pixel], replica.pixels[pixel], error.pixels[pixel]};
  }
  void put(std::size_t pixel, const PixelValue& value) {
    radiance.pixels[pixel] = value.radiance;
    variance.pixels[pixel] = value.variance;
    replica.pixels[pixel] = value.replica;
    error.pixels[pixel] = value.error;
  }
};

// The value of a surface that reflects. `unknown()` returns what to show where no sample is near.
template <class Unknown>
PixelValue shaded(const GatheredLight& light, const Vec3f& albedo, const Vec3f& emission, const Unknown& unknown) {
  if (!(light.weight > 0)) {
    const SiteValue value = unknown();
    return {value.radiance, value.variance, 0, value.variance};
  }
  const float least = kLeastAlbedo * light.weight;
  const float scale = luminance(albedo) / light.weight;
  return {emission + Vec3f{albedo.x * light.reflected.x / std::max(light.albedo.x, least),
                           albedo.y * light.reflected.y / std::max(light.albedo.y, least),
                           albedo.z * light.reflected.z / std::max(light.albedo.z, least)},
          scale * scale * light.variance, scale * light.replica, scale * scale * light.error * light.weight};
}

}  // namespace gazetrace
