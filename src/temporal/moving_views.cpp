// SPDX-License-Identifier: Apache-2.0
#include "temporal/moving_views.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "core/luminance.hpp"
#include "core/parallel.hpp"
#include "foveation/site_images.hpp"
#include "gazetrace/motion.hpp"
#include "temporal/same_camera.hpp"
#include "trace/samples/surface_sums.hpp"

namespace gazetrace {
namespace {

constexpr std::uint32_t kNowhere = 0xffffffffU;
// How far off a surface's plane another one may lie, in pixels, or as a share of the site's block.
constexpr float kPlaneShare = 0.5F;
// Cosine of the angle, 5 degrees, by which the direction to the eye may differ. What counts as diffuse has a lobe as
// well, of more than 7 degrees about the half vector.
constexpr float kSameView = 0.99619F;

// Of the surfaces of other frames that belong to one of the frame's own.
struct JoinedSums {
  Vec3d reflected, albedo;
  double square = 0;
  HalfSums halves;  // of light_of(), by the number of frames away: even, odd; counts are those of samples

  [[nodiscard]] std::uint32_t samples() const { return halves.count[0] + halves.count[1]; }
};

// Where the surfaces of another frame's tile went.
struct TileTargets {
  std::vector<std::uint32_t> target;  // of each surface: an index into the own ones, or kNowhere
  std::uint32_t first = kNowhere, last = 0;
};

std::size_t first_in_tile(const std::vector<std::uint32_t>& first_surface, const MapTile& tile) {
  return first_surface[tile.first_site];
}
std::size_t end_in_tile(const std::vector<std::uint32_t>& first_surface, const MapTile& tile) {
  return first_surface[tile.first_site + tile.site_count];
}

// What others may join: the surfaces of a frame, and of its sites without samples those that the guides see.
struct OwnSums {
  std::vector<SurfaceSums> surfaces;
  std::vector<std::uint32_t> first;  // as SparseFrame::first_surface
};

// Its one sample is still to come.
SurfaceSums surface_of_guides(const Guides& guides, int x, int y) {
  SurfaceSums sums;
  sums.albedo = guides.albedo(x, y);
  sums.normal = guides.normal(x, y);
  sums.position_m = guides.camera.place(static_cast<float>(x) + 0.5F - 0.5F * static_cast<float>(guides.kind.width_px),
                                        static_cast<float>(y) + 0.5F - 0.5F * static_cast<float>(guides.kind.height_px),
                                        guides.depth_m(x, y));
  sums.kind = guides.kind(x, y);
  sums.count = 1;
  return sums;
}

OwnSums own_sums(const ViewSamples& own, const Guides& guides) {
  OwnSums sums;
  sums.first.reserve(own.map->sites.size() + 1);
  sums.surfaces.reserve(std::max(own.sparse->surfaces.size(), own.map->sites.size()));
  for (std::size_t i = 0; i < own.map->sites.size(); ++i) {
    sums.first.push_back(static_cast<std::uint32_t>(sums.surfaces.size()));
    if (own.sparse->count[i] > 0) {
      sums.surfaces.insert(sums.surfaces.end(), own.sparse->surfaces.begin() + own.sparse->first_surface[i],
                           own.sparse->surfaces.begin() + own.sparse->first_surface[i + 1]);
      continue;
    }
    const BlockRect block = block_rect(*own.map, own.map->sites[i]);
    const int x = (block.x + block.x_end) / 2;
    const int y = (block.y + block.y_end) / 2;
    const SurfaceKind kind = guides.kind(x, y);
    if ((kind == SurfaceKind::diffuse || kind == SurfaceKind::glossy) && std::isfinite(guides.depth_m(x, y))) {
      sums.surfaces.push_back(surface_of_guides(guides, x, y));
    }
  }
  sums.first.push_back(static_cast<std::uint32_t>(sums.surfaces.size()));
  return sums;
}

class OwnSurfaces {
 public:
  OwnSurfaces(const ViewSamples& own, const OwnSums& sums, const GuideCamera& camera, int threads)
      : own_(own),
        sums_(sums),
        projection_(*own.camera, own.map->width_px, own.map->height_px),
        pixel_m_(std::sqrt(dot(camera.up_step, camera.up_step))),
        perspective_(camera.perspective),
        site_of_pixel_(sites_of_pixels(*own.map, threads)) {}

  // The own surface that `surface` of another view belongs to. `pixels`: side of the site that it was seen in.
  [[nodiscard]] std::uint32_t find(const Camera& other, const SurfaceSums& surface, float pixels) const {
    const float share = 1.0F / static_cast<float>(surface.count);
    const Vec3f seen_m = share * surface.position_m;
    const Vec3d place = other.pose.position_m + to_double(seen_m);
    const Vec2d px = projection_.point(place).px;
    // Not for what is no number either.
    if (!(px.x >= 0 && px.y >= 0 && px.x < own_.map->width_px && px.y < own_.map->height_px)) {
      return kNowhere;
    }
    const std::uint32_t site = site_of_pixel_(static_cast<int>(px.x), static_cast<int>(px.y));
    const Vec3f place_m = to_float(place - own_.camera->pose.position_m);
    const float block_px = static_cast<float>(own_.map->regions[own_.map->sites[site].region].block_px);
    const float pixel_here_m = pixel_m_ * distance(place_m);
    if (pixels * distance(seen_m) > kMostCoarse * block_px * distance(place_m) || !same_view(seen_m, place_m)) {
      return kNowhere;
    }
    const float reach_m = std::max(kPlanePixels, kPlaneShare * block_px) * pixel_here_m;
    const float length = std::sqrt(dot(surface.normal, surface.normal));
    std::uint32_t nearest = kNowhere;
    float least = reach_m;
    for (std::uint32_t k = sums_.first[site]; k < sums_.first[site + 1]; ++k) {
      const SurfaceSums& candidate = sums_.surfaces[k];
      const float own_length = std::sqrt(dot(candidate.normal, candidate.normal));
      if (candidate.kind != surface.kind ||
          !(dot(candidate.normal, surface.normal) > kSameNormal * length * own_length)) {
        continue;
      }
      const Vec3f way = place_m - (1.0F / static_cast<float>(candidate.count)) * candidate.position_m;
      const float off = std::fabs(dot(candidate.normal, way)) / own_length;
      if (off < least) {
        least = off;
        nearest = k;
      }
    }
    return nearest;
  }

 private:
  [[nodiscard]] float distance(const Vec3f& place_m) const {
    return perspective_ ? std::sqrt(dot(place_m, place_m)) : 1.0F;
  }

  // An orthographic camera looks in one direction everywhere.
  [[nodiscard]] bool same_view(const Vec3f& seen_m, const Vec3f& place_m) const {
    return !perspective_ || dot(seen_m, place_m) >= kSameView * distance(seen_m) * distance(place_m);
  }

  ViewSamples own_;
  const OwnSums& sums_;
  PixelProjection projection_;
  float pixel_m_;  // the size of a pixel at 1 m (perspective), or at any depth
  bool perspective_;
  Image<std::uint32_t> site_of_pixel_;
};

TileTargets targets_of_tile(const OwnSurfaces& own, const ViewSamples& other, std::size_t t, bool same_view) {
  TileTargets out;
  const MapTile& tile = other.map->tiles[t];
  out.target.reserve(end_in_tile(other.sparse->first_surface, tile) - first_in_tile(other.sparse->first_surface, tile));
  for (std::size_t site = tile.first_site; site < tile.first_site + tile.site_count; ++site) {
    const auto pixels = static_cast<float>(other.map->regions[other.map->sites[site].region].block_px);
    for (std::size_t s = other.sparse->first_surface[site]; s < other.sparse->first_surface[site + 1]; ++s) {
      const SurfaceSums& surface = other.sparse->surfaces[s];
      const std::uint32_t target =
          same_view || surface.kind == SurfaceKind::diffuse ? own.find(*other.camera, surface, pixels) : kNowhere;
      out.target.push_back(target);
      if (target != kNowhere) {
        out.first = std::min(out.first, target);
        out.last = std::max(out.last, target);
      }
    }
  }
  return out;
}

// Sum over the samples, of luminance without texture.
double light_of(const SurfaceSums& surface) {
  return surface.count * luminance(to_double(surface.reflected)) / luminance(to_double(surface.albedo));
}

void add(const SurfaceSums& surface, std::size_t half, JoinedSums& to) {
  to.reflected += to_double(surface.reflected);
  to.albedo += to_double(surface.albedo);
  to.square += static_cast<double>(surface.square);
  to.halves.luminance[half] += light_of(surface);
  to.halves.count[half] += surface.count;
}

// Of a surface that only the guides have seen.
SurfaceSums lit_by_others(const SurfaceSums& own, const JoinedSums& others) {
  SurfaceSums sums = own;
  const Vec3d albedo = to_double(own.albedo);
  sums.reflected = to_float(albedo * Vec3d{others.reflected.x / others.albedo.x, others.reflected.y / others.albedo.y,
                                           others.reflected.z / others.albedo.z});
  sums.square = saturated(others.square / static_cast<double>(others.samples()));
  sums.half_difference = static_cast<float>(luminance(albedo)) * others.halves.difference();
  return sums;
}

SurfaceSums lit_by_all(const SurfaceSums& own, const JoinedSums& others) {
  const double count = own.count;
  const double total = count + static_cast<double>(others.samples());
  const Vec3d albedo = to_double(own.albedo);
  const Vec3d all_albedo = albedo + others.albedo;
  const Vec3d reflected = to_double(own.reflected) + others.reflected;
  SurfaceSums sums = own;
  sums.reflected =
      to_float(albedo * Vec3d{reflected.x / all_albedo.x, reflected.y / all_albedo.y, reflected.z / all_albedo.z});
  sums.square = saturated((static_cast<double>(own.square) + others.square) * count / total);
  const double mean_albedo = luminance(albedo) / count;
  const auto own_difference = static_cast<double>(own.half_difference);
  const double apart = mean_albedo * static_cast<double>(others.halves.difference());
  double difference = 0;
  if (own_difference == 0) {  // of a single sample, say: it belongs to the frames an even number away
    HalfSums all = others.halves;
    all.luminance[0] += light_of(own);
    all.count[0] += own.count;
    difference = mean_albedo * static_cast<double>(all.difference());
  } else if (apart == 0) {  // only one half of the others is there: all samples are taken to be as noisy as the own
    difference = own_difference * std::sqrt(count / total);
  } else {  // errors of different samples, which add up
    difference = (own_difference * count + apart * (total - count)) / total;
  }
  sums.half_difference = static_cast<float>(difference);
  return sums;
}

}  // namespace

JoinedSurfaces surfaces_of_views(const ViewSamples& own, const std::vector<ViewSamples>& others, const Guides& guides,
                                 int threads) {
  const OwnSums base = own_sums(own, guides);
  const OwnSurfaces surfaces(own, base, guides.camera, threads);
  std::vector<JoinedSums> sums(base.surfaces.size());
  for (const ViewSamples& other : others) {
    const bool same_view = same_camera(*own.camera, *other.camera);
    std::vector<TileTargets> tiles(other.map->tiles.size());
    parallel_for(tiles.size(), threads,
                 [&](std::size_t t) { tiles[t] = targets_of_tile(surfaces, other, t, same_view); });
    // Every part of the own surfaces is added up by one thread, always in the same order.
    constexpr std::size_t kMostParts = 64;
    const std::vector<MapTile>& own_tiles = own.map->tiles;
    const std::size_t parts = std::min(own_tiles.size(), kMostParts);
    const auto half = static_cast<std::size_t>((other.frame - own.frame) & 1);
    parallel_for(parts, threads, [&](std::size_t part) {
      const std::size_t begin = first_in_tile(base.first, own_tiles[part * own_tiles.size() / parts]);
      const std::size_t end = end_in_tile(base.first, own_tiles[(part + 1) * own_tiles.size() / parts - 1]);
      for (std::size_t t = 0; t < tiles.size(); ++t) {
        if (tiles[t].first == kNowhere || tiles[t].first >= end || tiles[t].last < begin) {
          continue;
        }
        const std::size_t first = first_in_tile(other.sparse->first_surface, other.map->tiles[t]);
        for (std::size_t k = 0; k < tiles[t].target.size(); ++k) {
          const std::size_t target = tiles[t].target[k];
          if (target >= begin && target < end) {
            add(other.sparse->surfaces[first + k], half, sums[target]);
          }
        }
      }
    });
  }
  JoinedSurfaces out;
  out.surfaces.reserve(base.surfaces.size());
  out.samples_of_others.reserve(base.surfaces.size());
  for (std::size_t site = 0; site < own.map->sites.size(); ++site) {
    out.first_surface.push_back(static_cast<std::uint32_t>(out.surfaces.size()));
    const bool is_sampled = own.sparse->count[site] > 0;
    std::uint64_t samples = 0;
    for (std::size_t s = base.first[site]; s < base.first[site + 1]; ++s) {
      const std::uint32_t added = sums[s].samples();
      samples += added;
      if (added == 0 && !is_sampled) {
        continue;  // nobody has seen it
      }
      out.surfaces.push_back(added == 0   ? base.surfaces[s]
                             : is_sampled ? lit_by_all(base.surfaces[s], sums[s])
                                          : lit_by_others(base.surfaces[s], sums[s]));
      out.samples_of_others.push_back(is_sampled ? added : added - 1);
    }
    out.others_per_pixel.push_back(static_cast<float>(samples) / static_cast<float>(own.map->sites[site].pixels));
  }
  out.first_surface.push_back(static_cast<std::uint32_t>(out.surfaces.size()));
  return out;
}

}  // namespace gazetrace
