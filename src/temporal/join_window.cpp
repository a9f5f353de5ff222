// SPDX-License-Identifier: Apache-2.0
#include "temporal/join_window.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <span>
#include <utility>

#include "core/luminance.hpp"
#include "core/parallel.hpp"
#include "foveation/site_images.hpp"
#include "temporal/light_changes.hpp"
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

float length_of(const Vec3f& way) {
  return std::sqrt(dot(way, way));
}

bool is_glossy(const SparseFrame& sparse, std::size_t site) {
  return std::any_of(sparse.surfaces.begin() + sparse.first_surface[site],
                     sparse.surfaces.begin() + sparse.first_surface[site + 1],
                     [](const SurfaceSums& surface) { return surface.kind == SurfaceKind::glossy; });
}

std::vector<std::uint8_t> glossy_sites(const WindowSamples& samples) {
  std::vector<std::uint8_t> glossy(samples.map->sites.size());
  for (std::size_t site = 0; site < glossy.size(); ++site) {
    glossy[site] = is_glossy(*samples.sparse, site) ? 1 : 0;
  }
  return glossy;
}

// A site of one of the frames that joins a site.
struct Joining {
  std::uint32_t frame = 0, site = 0;
};

}  // namespace

// Consecutive sites of the frame, and what joins each.
struct WindowJoin::Part {
  std::size_t begin = 0;
  std::vector<std::uint32_t> first;  // of each site and one beyond: an index into `joining`
  std::vector<Joining> joining;

  [[nodiscard]] std::size_t end() const { return begin + first.size() - 1; }
  [[nodiscard]] std::span<const Joining> of(std::size_t site) const {
    return {joining.data() + first[site - begin], joining.data() + first[site - begin + 1]};
  }
};

// Adds up the sums of one site after the other.
class WindowJoin::SiteAdder {
 public:
  SiteAdder(const std::vector<Added>& frames, const CameraRays& rays, SamplingMap& map, SparseFrame& out)
      : frames_(frames), map_(map), out_(out), sorter_(length_of(rays.placement().up_step), rays.is_perspective()) {}

  // Appends the site's surfaces to `surfaces`.
  void add_site(std::size_t site, std::span<const Joining> joining, std::vector<SurfaceSums>& surfaces) {
    joining_ = joining;
    const std::array<std::uint32_t, 2> count = add_samples(site);
    if (!out_.guides.empty()) {
      add_guides(site);
    }
    if (!out_.light_groups.empty()) {
      add_light_groups(site);
    }
    if (!out_.first_half.empty()) {
      add_first_half(site, count[0] > 0 && count[1] > 0);
    }
    add_surfaces(site, count, surfaces);
    if (!out_.first_hits.empty()) {
      add_first_hits(site, count);
    }
  }

 private:
  [[nodiscard]] const SparseFrame& sparse(const Joining& one) const { return *frames_[one.frame].samples.sparse; }
  [[nodiscard]] std::uint8_t half_of(const Joining& one) const {
    return static_cast<std::uint8_t>(frames_[one.frame].samples.frame & 1);
  }

  // SparseFrame::half_difference of sums over frames, where `own` gives that of a frame and the samples behind it: from
  // the frames of both parities; else from the halves within each frame, whose errors add up.
  template <class Own>
  float difference(const std::array<double, 2>& bright, const std::array<std::uint32_t, 2>& count,
                   const Own& own) const {
    if (count[0] > 0 && count[1] > 0) {
      return half_difference(bright, count);
    }
    double sum = 0;
    double samples = 0;
    for (const Joining& one : joining_) {
      const auto [off, behind] = own(one);
      sum += static_cast<double>(off) * behind;
      samples += behind;
    }
    return samples > 0 ? static_cast<float>(sum / samples) : 0;
  }

  std::array<std::uint32_t, 2> add_samples(std::size_t site) {
    Vec3d sum;
    double square = 0;
    double expected = 0;
    std::array<double, 2> bright{};
    std::array<std::uint32_t, 2> count{};
    std::uint32_t planned = 0;
    for (const Joining& one : joining_) {
      const Vec3d light = to_double(sparse(one).sum[one.site]);
      sum += light;
      square += static_cast<double>(sparse(one).sum_square_luminance[one.site]);
      bright[half_of(one)] += luminance(light);
      count[half_of(one)] += sparse(one).count[one.site];
      const SamplingMap& map = *frames_[one.frame].samples.map;
      planned += map.sites[one.site].samples;
      expected += map.expected(one.site);
    }
    map_.sites[site].samples = planned;
    if (!map_.expected_samples.empty()) {
      map_.expected_samples[site] = saturated(expected);
    }
    out_.sum[site] = to_float(sum);
    out_.sum_square_luminance[site] = saturated(square);
    out_.count[site] = count[0] + count[1];
    if (!out_.half_difference.empty()) {
      out_.half_difference[site] = difference(bright, count, [&](const Joining& one) {
        return std::pair(sparse(one).half_difference[one.site], static_cast<double>(sparse(one).count[one.site]));
      });
    }
    return count;
  }

  // `by_frames`: as difference() has it.
  void add_first_half(std::size_t site, bool by_frames) {
    Vec3d radiance;
    std::uint32_t samples = 0;
    for (const Joining& one : joining_) {
      if (!by_frames) {
        radiance += to_double(sparse(one).first_half[one.site].radiance);
        samples += sparse(one).first_half[one.site].count;
      } else if (half_of(one) == 0) {
        radiance += to_double(sparse(one).sum[one.site]);
        samples += sparse(one).count[one.site];
      }
    }
    out_.first_half[site] = {to_float(radiance), samples};
  }

  void add_surfaces(std::size_t site, const std::array<std::uint32_t, 2>& count, std::vector<SurfaceSums>& surfaces) {
    const std::size_t before = surfaces.size();
    if (joining_.size() == 1) {
      const SparseFrame& own = sparse(joining_[0]);
      surfaces.insert(surfaces.end(), own.surfaces.begin() + own.first_surface[joining_[0].site],
                      own.surfaces.begin() + own.first_surface[joining_[0].site + 1]);
    } else {
      for (const Joining& one : joining_) {
        for (std::size_t s = sparse(one).first_surface[one.site]; s < sparse(one).first_surface[one.site + 1]; ++s) {
          SurfaceSums surface = sparse(one).surfaces[s];
          surface.position_m += static_cast<float>(surface.count) * frames_[one.frame].moved_m[one.site];
          sorter_.add(surface, half_of(one));
        }
      }
      sorter_.finish_site(out_.first_hits.empty() ? std::array<std::uint32_t, 2>{} : count, surfaces);
    }
    out_.first_surface[site] = static_cast<std::uint32_t>(surfaces.size() - before);
  }

  void add_guides(std::size_t site) {
    Vec3d albedo;
    Vec3d normal;
    std::uint32_t hits = 0;
    for (const Joining& one : joining_) {
      const GuideSums& from = sparse(one).guides[one.site];
      albedo += to_double(from.albedo);
      normal += to_double(from.normal);
      hits += from.hits;
    }
    GuideSums& to = out_.guides[site];
    to.albedo = to_float(albedo);
    to.normal = to_float(normal);
    // Depths of other views are others: that of the frame itself stands for all.
    to.depth_m = to.hits > 0 ? to.depth_m / static_cast<float>(to.hits) * static_cast<float>(hits) : 0;
    to.hits = to.hits > 0 ? hits : 0;
  }

  void add_light_groups(std::size_t site) {
    LightGroupSums& to = out_.light_groups[site];
    for (std::size_t group = 0; group < to.sum.size(); ++group) {
      Vec3d sum;
      for (const Joining& one : joining_) {
        sum += to_double(sparse(one).light_groups[one.site].sum[group]);
      }
      to.sum[group] = to_float(sum);
    }
  }

  void add_first_hits(std::size_t site, const std::array<std::uint32_t, 2>& count) {
    Vec3d shone;
    double square_shift = 0;
    std::array<double, 2> bright{};
    std::uint32_t blended = 0;
    for (const Joining& one : joining_) {
      const FirstHitSums& from = sparse(one).first_hits[one.site];
      shone += to_double(from.shone);
      bright[half_of(one)] += luminance(to_double(from.shone));
      square_shift += static_cast<double>(from.square_shift_px2);
      blended += from.blended;
    }
    const float off = difference(bright, count, [&](const Joining& one) {
      return std::pair(sparse(one).first_hits[one.site].shone_difference,
                       static_cast<double>(sparse(one).count[one.site]));
    });
    out_.first_hits[site] = {to_float(shone), off, saturated(square_shift), blended};
  }

  const std::vector<Added>& frames_;
  SamplingMap& map_;
  SparseFrame& out_;
  SurfaceSorter sorter_;
  std::span<const Joining> joining_;
};

WindowJoin::WindowJoin(const WindowSamples& own, const HitPlaces& places, bool light_changes, int threads)
    : own_(own),
      places_(places),
      light_changes_(light_changes),
      threads_(threads),
      site_of_pixel_(sites_of_pixels(*own.map, threads)) {
  const std::size_t sites = own.map->sites.size();
  Added itself{own, std::vector<std::uint32_t>(sites), std::vector<Vec3f>(sites), glossy_sites(own), {}, {}};
  for (std::uint32_t site = 0; site < itself.target.size(); ++site) {
    itself.target[site] = site;
  }
  index_tiles(itself);
  added_.push_back(std::move(itself));
}

// Whether a site of another frame joins the frame's site `seen`, whose pixel shows its place; `pixel`: its own middle.
bool WindowJoin::joins(const WindowSamples& other, const HitPlaces& places, std::size_t site, std::size_t seen,
                       std::size_t pixel) const {
  const Vec2d px = places.px.pixels[pixel];
  const std::size_t at = places.px.index(static_cast<int>(px.x), static_cast<int>(px.y));
  if (places.object.pixels[pixel] == 0 || places_.object.pixels[at] == 0) {
    return places.object.pixels[pixel] == places_.object.pixels[at];
  }
  if (light_changes_ && places.object.pixels[pixel] != places_.object.pixels[at]) {
    return false;  // one of them may move
  }
  const Vec3f place = places.position_m.pixels[pixel];
  const float distance = length_of(place);
  if (length_of(place - places_.position_m.pixels[at]) > kSamePlace * distance) {
    return false;
  }
  const Vec3f to_own = to_float(own_.camera->pose.position_m - other.camera->pose.position_m);
  const Vec3f seen_from_other = place + to_own - places.moved_m.pixels[pixel];
  const bool perspective = own_.camera->projection.kind == ProjectionKind::perspective;
  const auto block = [](const SamplingMap& map, std::size_t i) {
    return static_cast<float>(map.regions[map.sites[i].region].block_px);
  };
  const float far = length_of(seen_from_other);
  if (block(*other.map, site) * (perspective ? far : 1) >
      kMostCoarse * block(*own_.map, seen) * (perspective ? distance : 1)) {
    return false;
  }
  const bool mirrors = places.mirrors.pixels[pixel] != 0 || places_.mirrors.pixels[at] != 0;
  const float same_view = mirrors ? kSameMirroredView : kSameGlossyView;
  return !perspective || !(mirrors || is_glossy(*other.sparse, site)) ||
         dot(place, seen_from_other) >= same_view * distance * far;
}

void WindowJoin::index_tiles(Added& added) const {
  for (const MapTile& tile : added.samples.map->tiles) {
    std::uint32_t first = kNoSite;
    std::uint32_t last = 0;
    for (std::size_t i = tile.first_site; i < tile.first_site + tile.site_count; ++i) {
      if (added.target[i] != kNoSite) {
        first = std::min(first, added.target[i]);
        last = std::max(last, added.target[i]);
      }
    }
    added.first.push_back(first);
    added.last.push_back(last);
  }
}

void WindowJoin::add(const WindowSamples& other, const HitPlaces& places) {
  const std::size_t sites = other.map->sites.size();
  Added added{other, std::vector<std::uint32_t>(sites, kNoSite), std::vector<Vec3f>(sites), glossy_sites(other), {},
              {}};
  views_differ_ = views_differ_ || !same_camera(*other.camera, *own_.camera);
  const Vec3f camera_m = to_float(other.camera->pose.position_m - own_.camera->pose.position_m);
  parallel_for(other.map->tiles.size(), threads_, [&](std::size_t t) {
    const MapTile& tile = other.map->tiles[t];
    for (std::size_t site = tile.first_site; site < tile.first_site + tile.site_count; ++site) {
      const PixelIndex middle = middle_of(*other.map, other.map->sites[site]);
      const std::size_t pixel = places.px.index(middle.x, middle.y);
      const Vec2d px = places.px.pixels[pixel];
      // Not for what is no number either.
      if (!(px.x >= 0 && px.y >= 0 && px.x < own_.map->width_px && px.y < own_.map->height_px)) {
        continue;
      }
      const std::uint32_t seen = site_of_pixel_(static_cast<int>(px.x), static_cast<int>(px.y));
      if (joins(other, places, site, seen, pixel)) {
        added.target[site] = seen;
        added.moved_m[site] = camera_m + places.moved_m.pixels[pixel];
      }
    }
  });
  index_tiles(added);
  const auto after =
      std::find_if(added_.begin(), added_.end(), [&](const Added& one) { return one.samples.frame > other.frame; });
  added_.insert(after, std::move(added));
}

// What joins the sites of a part of the frame's tiles, in ascending order of frames.
WindowJoin::Part WindowJoin::part_of(std::size_t part) const {
  const std::vector<MapTile>& tiles = own_.map->tiles;
  const std::size_t parts = std::min(tiles.size(), kMostParts);
  const MapTile& last = tiles[(part + 1) * tiles.size() / parts - 1];
  Part out;
  out.begin = tiles[part * tiles.size() / parts].first_site;
  const std::size_t end = last.first_site + last.site_count;
  const auto each = [&](const auto& visit) {
    for (std::uint32_t frame = 0; frame < added_.size(); ++frame) {
      const Added& added = added_[frame];
      for (std::size_t t = 0; t < added.first.size(); ++t) {
        if (added.first[t] == kNoSite || added.first[t] >= end || added.last[t] < out.begin) {
          continue;
        }
        const MapTile& tile = added.samples.map->tiles[t];
        for (std::uint32_t site = tile.first_site; site < tile.first_site + tile.site_count; ++site) {
          if (added.target[site] >= out.begin && added.target[site] < end) {
            visit(added.target[site] - out.begin, Joining{frame, site});
          }
        }
      }
    }
  };
  out.first.resize(end - out.begin + 1);
  each([&](std::size_t to, const Joining&) { ++out.first[to + 1]; });
  for (std::size_t i = 1; i < out.first.size(); ++i) {
    out.first[i] += out.first[i - 1];
  }
  out.joining.resize(out.first.back());
  std::vector<std::uint32_t> next(out.first.begin(), out.first.end() - 1);
  each([&](std::size_t to, const Joining& one) { out.joining[next[to]++] = one; });
  return out;
}

// Of surfaces of either kind, diffuse and glossy, the frames in whose light each block is; empty: all of them.
template <class BlockOf>
std::array<std::vector<FrameRange>, 2> WindowJoin::find_same_light(std::size_t own, const BlockOf& block_of) const {
  const std::array<bool, 2> may_differ{light_changes_, light_changes_ || views_differ_};
  std::array<std::vector<FrameRange>, 2> ranges;
  if (!may_differ[1]) {
    return ranges;
  }
  std::array<LightChanges, 2> light{LightChanges(own_.map->width_px, own_.map->height_px, added_.size()),
                                    LightChanges(own_.map->width_px, own_.map->height_px, added_.size())};
  const std::size_t parts = std::min(own_.map->tiles.size(), kMostParts);
  for (std::size_t p = 0; p < parts; ++p) {
    const Part part = part_of(p);
    for (std::size_t site = part.begin; site < part.end(); ++site) {
      for (const Joining& one : part.of(site)) {
        const Added& added = added_[one.frame];
        const std::size_t kind = added.glossy[one.site] ? 1 : 0;
        const SparseFrame& sparse = *added.samples.sparse;
        if (may_differ[kind]) {
          light[kind]
              .at(block_of(site), one.frame)
              .add(luminance(to_double(sparse.sum[one.site])),
                   static_cast<double>(sparse.sum_square_luminance[one.site]), sparse.count[one.site]);
        }
      }
    }
  }
  for (std::size_t kind = 0; kind < 2; ++kind) {
    if (may_differ[kind]) {
      ranges[kind] = light[kind].same_light(own, threads_);
    }
  }
  return ranges;
}

JoinedSamples WindowJoin::joined() const {
  const SamplingMap& own_map = *own_.map;
  const std::size_t parts = std::min(own_map.tiles.size(), kMostParts);
  const auto own = static_cast<std::size_t>(
      std::find_if(added_.begin(), added_.end(), [&](const Added& one) { return one.samples.frame == own_.frame; }) -
      added_.begin());
  const auto block_of = [&](std::size_t site) {
    const PixelIndex middle = middle_of(own_map, own_map.sites[site]);
    return LightChanges::block_of(middle.x, middle.y, own_map.width_px);
  };
  const std::array<std::vector<FrameRange>, 2> same_light = find_same_light(own, block_of);
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
  std::vector<std::vector<SurfaceSums>> surfaces(parts);
  parallel_for(parts, threads_, [&](std::size_t p) {
    const Part part = part_of(p);
    SiteAdder adder(added_, rays, all.map, out);
    std::vector<Joining> kept;
    for (std::size_t site = part.begin; site < part.end(); ++site) {
      kept.clear();
      for (const Joining& one : part.of(site)) {
        const std::vector<FrameRange>& ranges = same_light[added_[one.frame].glossy[one.site] ? 1 : 0];
        if (ranges.empty() || ranges[block_of(site)].holds(one.frame) || one.frame == own) {
          kept.push_back(one);
        }
      }
      adder.add_site(site, kept, surfaces[p]);
    }
  });
  join_surfaces(std::move(surfaces), out);
  return all;
}

}  // namespace gazetrace
