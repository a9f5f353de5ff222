// SPDX-License-Identifier: Apache-2.0
#include "temporal/join_window.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <optional>
#include <span>
#include <utility>

#include "core/luminance.hpp"
#include "core/parallel.hpp"
#include "foveation/site_images.hpp"
#include "temporal/moving_edges.hpp"
#include "temporal/same_camera.hpp"
#include "trace/rays/camera_rays.hpp"
#include "trace/samples/surface_sums.hpp"

namespace gazetrace {
namespace {

constexpr std::uint32_t kNoSite = 0xffffffffU;
constexpr std::size_t kMostParts = 64;

// Where a site's samples are taken to be.
PixelIndex middle_of(const SamplingMap& map, const Site& site) {
  const BlockRect block = block_rect(map, site);
  return {static_cast<std::uint16_t>((block.x + block.x_end) / 2),
          static_cast<std::uint16_t>((block.y + block.y_end) / 2)};
}

std::size_t pixel_index(const SamplingMap& map, int x_px, int y_px) {
  return static_cast<std::size_t>(y_px) * static_cast<std::size_t>(map.width_px) + static_cast<std::size_t>(x_px);
}

}  // namespace

std::vector<std::uint8_t> glossy_sites(const SparseFrame& sparse) {
  std::vector<std::uint8_t> glossy(sparse.first_surface.empty() ? 0 : sparse.first_surface.size() - 1);
  for (std::size_t site = 0; site < glossy.size(); ++site) {
    const auto first = sparse.surfaces.begin() + sparse.first_surface[site];
    const auto end = sparse.surfaces.begin() + sparse.first_surface[site + 1];
    glossy[site] = std::any_of(first, end, [](const SurfaceSums& s) { return s.kind == SurfaceKind::glossy; }) ? 1 : 0;
  }
  return glossy;
}

// Consecutive sites of the frame in batches, and of each batch, frame by frame, what joins it.
struct WindowJoin::Part {
  std::size_t begin = 0, end = 0;
  std::vector<std::uint32_t> first;  // of each frame of each batch, and one beyond: an index into `joining`
  std::vector<Joining> joining;
};

WindowJoin::WindowJoin(const WindowSamples& own, const HitPlaces& places, bool light_changes, int threads)
    : own_(own), light_changes_(light_changes), threads_(threads), seen_(own.map->region.pixels.size()) {
  const Image<std::uint32_t> site_of_pixel = sites_of_pixels(*own.map, threads);
  parallel_for(static_cast<std::size_t>(own.map->height_px), threads, [&](std::size_t row) {
    const std::size_t begin = pixel_index(*own.map, 0, static_cast<int>(row));
    for (std::size_t pixel = begin; pixel < begin + static_cast<std::size_t>(own.map->width_px); ++pixel) {
      const HitPlace place = places.at(pixel);
      const std::uint32_t site = site_of_pixel.pixels[pixel];
      const int block_px = own.map->regions[own.map->sites[site].region].block_px;
      seen_[pixel] = {place.position_m, place.object, site, static_cast<std::uint16_t>(block_px), place.mirrors};
    }
  });
  Added itself{own, std::vector<std::uint32_t>(own.map->sites.size()), {}, {}, {}, {}};
  for (std::uint32_t site = 0; site < itself.target.size(); ++site) {
    itself.target[site] = site;
  }
  for (const MapTile& tile : own.map->tiles) {
    itself.first.push_back(tile.site_count > 0 ? tile.first_site : kNoSite);
    itself.last.push_back(tile.first_site + tile.site_count - 1);
  }
  added_.push_back(std::move(itself));
}

// Whether a site of another frame, which sees `place`, joins the frame's site where that is. `to_own`: from the frame's
// camera to the other.
bool WindowJoin::joins(const WindowSamples& other, const Vec3f& to_own, const HitPlace& place, const Seen& seen,
                       std::size_t site) const {
  if (place.object == 0 || seen.object == 0) {
    return place.object == seen.object;
  }
  if (light_changes_ && place.object != seen.object) {
    return false;  // one of them may move
  }
  const auto square = [](const Vec3f& way) { return dot(way, way); };
  const float distance = square(place.position_m);
  if (square(place.position_m - seen.position_m) > kSamePlace * kSamePlace * distance) {
    return false;
  }
  const Vec3f seen_from_other = place.position_m + to_own - place.moved_m;
  const float far = square(seen_from_other);
  const bool perspective = own_.camera->projection.kind == ProjectionKind::perspective;
  const auto own_block = static_cast<float>(seen.block_px);
  const auto block = static_cast<float>(other.map->regions[other.map->sites[site].region].block_px);
  if (block * block * (perspective ? far : 1) >
      kMostCoarse * kMostCoarse * own_block * own_block * (perspective ? distance : 1)) {
    return false;
  }
  const bool mirrors = place.mirrors || seen.mirrors;
  const float same_view = mirrors ? kSameMirroredView : kSameGlossyView;
  return !perspective || !(mirrors || (*other.glossy)[site] != 0) ||
         dot(place.position_m, seen_from_other) >= same_view * std::sqrt(distance) * std::sqrt(far);
}

void WindowJoin::add(const WindowSamples& other, const HitPlaces& places, const HitPlaces* back) {
  const SamplingMap& map = *other.map;
  std::optional<MovingEdges> theirs;
  std::optional<MovingEdges> ours;
  if (light_changes_ && back != nullptr) {
    theirs.emplace(places, *own_.camera, map.width_px, map.height_px, threads_);
    ours.emplace(*back, *other.camera, map.width_px, map.height_px, threads_);
  }
  // What a site at an outline saw of a body leaves with the body, though its middle saw what is behind and stays.
  const auto would_leave_a_ghost = [&](const PixelIndex& middle, int block_px, const Seen& seen) {
    if (!theirs || !theirs->at(middle.x, middle.y, block_px)) {
      return false;
    }
    const PixelIndex there = middle_of(*own_.map, own_.map->sites[seen.site]);
    return !ours->at(there.x, there.y, seen.block_px);
  };
  const std::size_t tiles = map.tiles.size();
  Added added{other,
              std::vector<std::uint32_t>(map.sites.size()),
              to_float(other.camera->pose.position_m - own_.camera->pose.position_m),
              std::vector<Vec3f>(light_changes_ ? map.sites.size() : 0),
              std::vector<std::uint32_t>(tiles, kNoSite),
              std::vector<std::uint32_t>(tiles)};
  views_differ_ = views_differ_ || !same_camera(*other.camera, *own_.camera);
  const Vec3f to_own = to_float(own_.camera->pose.position_m - other.camera->pose.position_m);
  parallel_for(tiles, threads_, [&](std::size_t t) {
    const MapTile& tile = map.tiles[t];
    for (std::size_t site = tile.first_site; site < tile.first_site + tile.site_count; ++site) {
      std::uint32_t& target = added.target[site];
      target = kNoSite;
      const PixelIndex middle = middle_of(map, map.sites[site]);
      const HitPlace place = places.at(pixel_index(map, middle.x, middle.y));
      // Not for what is no number either.
      if (!(place.px.x >= 0 && place.px.y >= 0 && place.px.x < map.width_px && place.px.y < map.height_px)) {
        continue;
      }
      const Seen& seen = seen_[pixel_index(map, static_cast<int>(place.px.x), static_cast<int>(place.px.y))];
      if (!joins(other, to_own, place, seen, site) ||
          would_leave_a_ghost(middle, map.regions[map.sites[site].region].block_px, seen)) {
        continue;
      }
      target = seen.site;
      added.first[t] = std::min(added.first[t], target);
      added.last[t] = std::max(added.last[t], target);
      if (light_changes_) {
        added.moved_m[site] = added.camera_m + place.moved_m;
      }
    }
  });
  const auto after =
      std::find_if(added_.begin(), added_.end(), [&](const Added& one) { return one.samples.frame > other.frame; });
  added_.insert(after, std::move(added));
}

// What joins the sites of a part of the frame's tiles.
WindowJoin::Part WindowJoin::part_of(std::size_t part, std::size_t own, const SameLight& light) const {
  const std::vector<MapTile>& tiles = own_.map->tiles;
  const std::size_t parts = std::min(tiles.size(), kMostParts);
  const MapTile& last = tiles[(part + 1) * tiles.size() / parts - 1];
  Part out;
  out.begin = tiles[part * tiles.size() / parts].first_site;
  out.end = last.first_site + last.site_count;
  const auto each = [&](const auto& visit) {
    for (std::size_t frame = 0; frame < added_.size(); ++frame) {
      const Added& added = added_[frame];
      const std::vector<std::uint8_t>& glossy = *added.samples.glossy;
      for (std::size_t t = 0; t < added.first.size(); ++t) {
        if (added.first[t] == kNoSite || added.first[t] >= out.end || added.last[t] < out.begin) {
          continue;
        }
        const MapTile& tile = added.samples.map->tiles[t];
        for (std::uint32_t site = tile.first_site; site < tile.first_site + tile.site_count; ++site) {
          const std::uint32_t target = added.target[site];
          if (target < out.begin || target >= out.end) {
            continue;
          }
          const std::vector<FrameRange>& ranges = light.ranges[glossy[site]];
          if (frame == own || ranges.empty() || ranges[light.block[target]].holds(frame)) {
            const std::size_t to = target - out.begin;
            visit(to / SiteAdder::kBatchSites * added_.size() + frame,
                  Joining{site, static_cast<std::uint32_t>(to % SiteAdder::kBatchSites)});
          }
        }
      }
    }
  };
  const std::size_t batches = (out.end - out.begin + SiteAdder::kBatchSites - 1) / SiteAdder::kBatchSites;
  out.first.resize(batches * added_.size() + 1);
  each([&](std::size_t list, const Joining&) { ++out.first[list + 1]; });
  for (std::size_t i = 1; i < out.first.size(); ++i) {
    out.first[i] += out.first[i - 1];
  }
  out.joining.resize(out.first.back());
  std::vector<std::uint32_t> next(out.first.begin(), out.first.end() - 1);
  each([&](std::size_t list, const Joining& one) { out.joining[next[list]++] = one; });
  return out;
}

WindowJoin::SameLight WindowJoin::find_same_light(std::size_t own) const {
  const SamplingMap& map = *own_.map;
  const std::array<bool, 2> may_differ{light_changes_, light_changes_ || views_differ_};
  SameLight same;
  if (!may_differ[1]) {
    return same;
  }
  same.block.resize(map.sites.size());
  for (std::size_t site = 0; site < same.block.size(); ++site) {
    const PixelIndex middle = middle_of(map, map.sites[site]);
    same.block[site] = static_cast<std::uint32_t>(LightChanges::block_of(middle.x, middle.y, map.width_px));
  }
  std::array<LightChanges, 2> light{LightChanges(map.width_px, map.height_px, added_.size()),
                                    LightChanges(map.width_px, map.height_px, added_.size())};
  parallel_for(added_.size(), threads_, [&](std::size_t frame) {
    const Added& added = added_[frame];
    const SparseFrame& sparse = *added.samples.sparse;
    const std::vector<std::uint8_t>& glossy = *added.samples.glossy;
    for (std::size_t site = 0; site < added.target.size(); ++site) {
      if (added.target[site] != kNoSite && may_differ[glossy[site]]) {
        light[glossy[site]]
            .at(same.block[added.target[site]], frame)
            .add(luminance(to_double(sparse.sum[site])), static_cast<double>(sparse.sum_square_luminance[site]),
                 sparse.count[site]);
      }
    }
  });
  for (std::size_t kind = 0; kind < 2; ++kind) {
    if (may_differ[kind]) {
      same.ranges[kind] = light[kind].same_light(own, threads_);
    }
  }
  return same;
}

JoinedSamples WindowJoin::joined() const {
  const SamplingMap& own_map = *own_.map;
  const std::size_t parts = std::min(own_map.tiles.size(), kMostParts);
  const auto own = static_cast<std::size_t>(
      std::find_if(added_.begin(), added_.end(), [&](const Added& one) { return one.samples.frame == own_.frame; }) -
      added_.begin());
  const SameLight light = find_same_light(own);
  JoinedSamples all;
  all.map = own_map;
  SparseFrame& out = all.sparse;
  const SparseFrame& first = *own_.sparse;
  out.width_px = first.width_px;
  out.height_px = first.height_px;
  out.sum.resize(first.sum.size());
  out.sum_square_luminance.resize(first.sum.size());
  out.count.resize(first.sum.size());
  out.guides = first.guides;
  out.light_groups.resize(first.light_groups.size());
  out.half_difference.resize(first.half_difference.size());
  out.first_half.resize(first.first_half.size());
  out.first_surface.resize(first.first_surface.size());
  out.first_hits.resize(first.first_hits.size());
  const CameraRays rays(*own_.camera, own_map.height_px);
  // Sums are rounded by their order: windows at rest, which hold the same samples, add them in the same order.
  std::vector<std::size_t> order(added_.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return added_[a].samples.scrambling < added_[b].samples.scrambling;
  });
  std::vector<std::vector<SurfaceSums>> surfaces(parts);
  parallel_for(parts, threads_, [&](std::size_t p) {
    const Part part = part_of(p, own, light);
    SiteAdder adder(rays, all.map, out);
    std::vector<JoiningFrame> frames;
    for (const std::size_t place : order) {
      const Added& added = added_[place];
      frames.push_back(
          {added.samples.scrambling, added.samples.map, added.samples.sparse, added.camera_m, added.moved_m, {}});
    }
    std::size_t batch = 0;
    for (std::size_t site = part.begin; site < part.end; site += SiteAdder::kBatchSites) {
      for (std::size_t k = 0; k < frames.size(); ++k) {
        const std::size_t list = batch + order[k];
        frames[k].joining = std::span(part.joining).subspan(part.first[list], part.first[list + 1] - part.first[list]);
      }
      batch += frames.size();
      adder.add(site, std::min(SiteAdder::kBatchSites, part.end - site), frames, surfaces[p]);
    }
  });
  join_surfaces(std::move(surfaces), out);
  return all;
}

}  // namespace gazetrace
