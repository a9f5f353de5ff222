// SPDX-License-Identifier: Apache-2.0
#include "trace/samples/surface_sums.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "core/luminance.hpp"

namespace gazetrace {

SurfaceSorter::Surface& SurfaceSorter::surface_of(SurfaceKind kind, const Vec3f& normal, const Vec3f& place) {
  Surface* nearest = nullptr;
  float least = std::numeric_limits<float>::infinity();
  for (std::size_t k = 0; k < used_; ++k) {
    Surface& surface = surfaces_[k];
    const float facing = dot(surface.first_normal, normal);
    const float apart = std::fabs(dot(surface.first_normal, place - surface.first_place));
    if (surface.kind == kind && facing > kSameNormal && apart < surface.reach) {
      return surface;
    }
    const float cost = (1.0F - facing) + std::min(apart / surface.reach, 1e6F) + (surface.kind == kind ? 0.0F : 1e6F);
    if (nearest == nullptr || cost < least) {
      least = cost;
      nearest = &surface;
    }
  }
  if (used_ == kMostSurfaces) {
    return *nearest;
  }
  Surface& fresh = surfaces_[used_++];
  fresh = {};
  fresh.kind = kind;
  fresh.first_normal = normal;
  fresh.first_place = place;
  const float distance = perspective_ ? std::sqrt(dot(place, place)) : 1.0F;
  fresh.reach = std::max(kPlanePixels * pixel_m_ * distance, std::numeric_limits<float>::min());
  return fresh;
}

void SurfaceSorter::add(const SurfaceBatch& batch, std::size_t slot, const Vec3d& radiance, std::uint8_t half) {
  const SurfaceKind kind = batch.kind[slot];
  if (kind == SurfaceKind::miss || kind == SurfaceKind::unlit) {
    return;
  }
  const Vec3f normal{batch.normal_x[slot], batch.normal_y[slot], batch.normal_z[slot]};
  const Vec3f place{batch.place_x[slot], batch.place_y[slot], batch.place_z[slot]};
  const Vec3d albedo{batch.albedo_r[slot], batch.albedo_g[slot], batch.albedo_b[slot]};
  const Vec3d reflected = radiance - Vec3d{batch.shone_r[slot], batch.shone_g[slot], batch.shone_b[slot]};
  Surface& surface = surface_of(kind, normal, place);
  surface.reflected += reflected;
  surface.albedo += albedo;
  surface.normal += to_double(normal);
  surface.place += to_double(place);
  const double shone = luminance(reflected);
  surface.halves.add(shone, half);
  const double albedo_luminance = luminance(albedo);
  surface.albedo_of_half[half] += albedo_luminance;
  const double ratio = shone / albedo_luminance;
  surface.square += ratio * ratio;
  ++surface.count;
}

void SurfaceSorter::add(const SurfaceSums& sums, std::uint8_t half) {
  const float share = 1.0F / static_cast<float>(sums.count);
  const float length = std::sqrt(dot(sums.normal, sums.normal));
  Surface& surface = surface_of(sums.kind, (length > 0 ? 1.0F / length : 0.0F) * sums.normal, share * sums.position_m);
  surface.reflected += to_double(sums.reflected);
  surface.albedo += to_double(sums.albedo);
  surface.normal += to_double(sums.normal);
  surface.place += to_double(sums.position_m);
  surface.square += static_cast<double>(sums.square);
  surface.halves.luminance[half] += luminance(to_double(sums.reflected));
  surface.halves.count[half] += sums.count;
  surface.albedo_of_half[half] += luminance(to_double(sums.albedo));
  surface.count += sums.count;
}

void SurfaceSorter::finish_site(const std::array<std::uint32_t, 2>& samples, std::vector<SurfaceSums>& out) {
  for (std::size_t k = 0; k < used_; ++k) {
    const Surface& s = surfaces_[k];
    out.push_back({to_float(s.reflected), to_float(s.albedo), to_float(s.normal), to_float(s.place),
                   saturated(s.square), s.halves.difference(), s.count, s.kind,
                   half_difference(s.albedo_of_half, samples)});
  }
  used_ = 0;
}

void join_surfaces(std::vector<std::vector<SurfaceSums>> parts, SparseFrame& out) {
  std::uint32_t total = 0;
  for (std::uint32_t& entry : out.first_surface) {
    total += std::exchange(entry, total);
  }
  out.surfaces.reserve(total);
  for (std::vector<SurfaceSums>& part : parts) {
    out.surfaces.insert(out.surfaces.end(), part.begin(), part.end());
    part = {};
  }
}

}  // namespace gazetrace
