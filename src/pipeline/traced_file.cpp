// SPDX-License-Identifier: Apache-2.0
// A traced frame in a sealed file: its map, the sums of every site, and what tracing took.
#include "pipeline/traced_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "gazetrace/error.hpp"
#include "gazetrace/traced_frame_file.hpp"
#include "pipeline/sealed_file.hpp"

namespace gazetrace {
namespace {

constexpr SealedKind kTraced{"gazetrace traced 6", "file of a traced frame",
                             "give the folder that `stage` trace wrote into",
                             "trace this frame again, with `stage` trace and `resume`",
                             "trace this frame again with the settings of `stage` finish"};

// Writer and reader visit the same fields in the same order.
template <class Stats, class Visit>
void each_count(Stats& stats, Visit& visit) {
  visit(stats.samples);
  visit(stats.learning_paths);
  visit(stats.rays_primary);
  visit(stats.rays_bounce);
  visit(stats.rays_shadow);
  visit(stats.rejected_rays);
  visit(stats.non_finite_samples);
  visit(stats.regions);
  visit(stats.kernel);
}

template <class Map, class Visit>
void each_part_of_map(Map& map, Visit& visit) {
  visit(map.width_px);
  visit(map.height_px);
  visit(map.region);
  visit(map.sites);
  visit(map.tiles);
  visit(map.expected_samples);
}

template <class Region, class Visit>
void each_part_of_region(Region& region, Visit& visit) {
  visit(region.name);
  visit(region.block_px);
  visit(region.pixels);
  visit(region.sites);
  visit(region.samples);
  visit(region.nominal_samples);
}

template <class Sparse, class Visit>
void each_sum(Sparse& sparse, Visit& visit) {
  visit(sparse.width_px);
  visit(sparse.height_px);
  visit(sparse.sum);
  visit(sparse.sum_square_luminance);
  visit(sparse.count);
  visit(sparse.guides);
  visit(sparse.light_groups);
  visit(sparse.half_difference);
  visit(sparse.first_half);
  visit(sparse.surfaces);
  visit(sparse.first_surface);
  visit(sparse.first_hits);
}

template <class Bad, class Visit>
void each_part_of_bad_sample(Bad& bad, Visit& visit) {
  visit(bad.frame);
  visit(bad.x_px);
  visit(bad.y_px);
  visit(bad.sample);
  visit(bad.what);
}

void write(const TraceStats& stats, SealedWriter& writer) {
  each_count(stats, writer);
  writer(static_cast<std::uint64_t>(stats.bad_samples.size()));
  for (const BadSample& bad : stats.bad_samples) {
    each_part_of_bad_sample(bad, writer);
  }
}

// As many as a file says, but no more than it can hold.
template <class T, class Read>
void read_list(SealedReader& reader, std::vector<T>& list, const Read& read_one) {
  std::uint64_t count = 0;
  reader(count);
  for (std::uint64_t i = 0; i < count; ++i) {
    read_one(list.emplace_back());
  }
}

void read(SealedReader& reader, TraceStats& stats) {
  each_count(stats, reader);
  read_list(reader, stats.bad_samples, [&](BadSample& bad) { each_part_of_bad_sample(bad, reader); });
}

void write(const std::optional<double>& value, SealedWriter& writer) {
  writer(value.has_value());
  writer(value.value_or(0));
}

void read(SealedReader& reader, std::optional<double>& value) {
  bool has_value = false;
  double number = 0;
  reader(has_value);
  reader(number);
  value = has_value ? std::optional(number) : std::nullopt;
}

constexpr int kMostBlockPx = 65536;

// Whether sites have the pixels that the map says of them, in their own region, and each pixel has a site.
bool covers_frame(const SamplingMap& map) {
  std::uint64_t pixels = 0;
  std::vector<PixelIndex> own;
  for (const Site& site : map.sites) {
    pixels_of_site(map, site, own);
    pixels += own.size();
    if (own.empty() || own.size() != site.pixels || pixels > map.region.pixels.size() ||
        !std::all_of(own.begin(), own.end(),
                     [&](const PixelIndex& p) { return map.region(p.x, p.y) == site.region; })) {
      return false;
    }
  }
  return pixels == map.region.pixels.size();
}

// A seal tells damage; a file that another program wrote must not lead out of the arrays either.
bool fits_together(const TracedFrame& traced) {
  const SamplingMap& map = traced.map;
  const SparseFrame& sparse = traced.sparse;
  const std::size_t sites = map.sites.size();
  const auto one_each = [&](const auto& list) { return list.empty() || list.size() == sites; };
  std::uint64_t in_tiles = 0;
  for (const MapTile& tile : map.tiles) {
    if (tile.first_site != in_tiles || tile.x_px < 0 || tile.y_px < 0 || tile.x_px >= map.width_px ||
        tile.y_px >= map.height_px || tile.width_px < 1 || tile.height_px < 1) {
      return false;
    }
    in_tiles += tile.site_count;
  }
  // Regions without sites, too: filters ask each for its blocks.
  if (std::any_of(map.regions.begin(), map.regions.end(),
                  [](const auto& region) { return region.block_px < 1 || region.block_px > kMostBlockPx; })) {
    return false;
  }
  for (const Site& site : map.sites) {
    if (site.region >= map.regions.size() ||
        std::int64_t{site.block_x} * map.regions[site.region].block_px >= map.width_px ||
        std::int64_t{site.block_y} * map.regions[site.region].block_px >= map.height_px) {
      return false;
    }
  }
  if (std::any_of(map.region.pixels.begin(), map.region.pixels.end(),
                  [&](std::uint8_t region) { return region >= map.regions.size(); })) {
    return false;
  }
  for (std::size_t i = 1; i < sparse.first_surface.size(); ++i) {
    if (sparse.first_surface[i] < sparse.first_surface[i - 1] ||
        sparse.first_surface[i] - sparse.first_surface[i - 1] > kMostSurfaces) {
      return false;
    }
  }
  const bool surfaces = sparse.first_surface.empty()
                            ? sparse.surfaces.empty()
                            : sparse.first_surface.size() == sites + 1 && sparse.first_surface.front() == 0 &&
                                  sparse.first_surface.back() == sparse.surfaces.size();
  const bool sizes = in_tiles == sites && surfaces && map.region.width_px == map.width_px &&
                     map.region.height_px == map.height_px && sparse.width_px == map.width_px &&
                     sparse.height_px == map.height_px && sparse.sum.size() == sites &&
                     sparse.sum_square_luminance.size() == sites && sparse.count.size() == sites &&
                     one_each(sparse.guides) && one_each(sparse.light_groups) && one_each(sparse.half_difference) &&
                     one_each(sparse.first_half) && one_each(sparse.first_hits) && one_each(map.expected_samples) &&
                     sparse.stats.regions.size() == map.regions.size();
  return sizes && covers_frame(map);
}

}  // namespace

WrittenFile save_traced(const std::string& path, std::int32_t frame, const TracedFrame& traced,
                        const std::string& settings_digest) {
  SealedWriter writer(kTraced, settings_digest);
  writer(frame);
  each_part_of_map(traced.map, writer);
  writer(static_cast<std::uint64_t>(traced.map.regions.size()));
  for (const MapRegion& region : traced.map.regions) {
    each_part_of_region(region, writer);
  }
  each_sum(traced.sparse, writer);
  write(traced.sparse.stats, writer);
  write(traced.pilot, writer);
  write(traced.prediction.relmse, writer);
  write(traced.prediction.jod, writer);
  writer(traced.times);
  WrittenFile file = writer.save(path);
  file.frame = frame;
  return file;
}

TracedFrame load_traced(const std::string& path, std::int32_t frame, const std::string& settings_digest) {
  SealedReader reader(kTraced, path, settings_digest);
  std::int32_t held = 0;
  reader(held);
  if (held != frame) {
    throw Error(ErrorKind::input, path, fmt::format("holds frame {}", held), kTraced.when_damaged);
  }
  TracedFrame traced;
  each_part_of_map(traced.map, reader);
  read_list(reader, traced.map.regions, [&](MapRegion& region) { each_part_of_region(region, reader); });
  each_sum(traced.sparse, reader);
  read(reader, traced.sparse.stats);
  read(reader, traced.pilot);
  read(reader, traced.prediction.relmse);
  read(reader, traced.prediction.jod);
  reader(traced.times);
  reader.finish();
  if (!fits_together(traced)) {
    reader.fail();
  }
  return traced;
}

std::string read_traced_digest(const std::string& path) {
  return read_sealed_digest(kTraced, path);
}

}  // namespace gazetrace
