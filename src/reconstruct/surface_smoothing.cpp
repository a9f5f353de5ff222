// SPDX-License-Identifier: Apache-2.0
#include "reconstruct/surface_smoothing.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/hash.hpp"
#include "core/instruction_sets.hpp"
#include "core/luminance.hpp"
#include "core/parallel.hpp"

namespace gazetrace {
namespace {

constexpr std::array<float, 2> kBinomial{0.5F, 0.25F};  // 1 2 1 in x and y, half
// The weight of a surface itself among its neighbours. It is less than the binomial's quarter, since a surface keeps
// what is above the largest sum of weights near by in any case.
constexpr float kOwnShare = 0.1F;

// The part of a cell that is smoothed; the rest of it stays.
struct CellLight {
  Vec3f reflected, albedo;
  float light = 0, variance = 0;
  float reflected_replica = 0;  // of the error of the luminance of `reflected`

  [[nodiscard]] float replica() const { return reflected_replica / std::max(luminance(albedo), kLeastAlbedo); }
};

// Another surface near by, and its weight by place and orientation, which is the same in both directions.
struct Tie {
  std::uint32_t other = 0;
  float like = 0;
};

// The ties of the cells of one tile of the map, one cell after the other.
struct TileTies {
  std::vector<Tie> ties;
  std::vector<std::uint32_t> end;  // of each cell's
};

// The part of a SurfaceCell that says where it lies and how it faces: half a cache line.
struct alignas(32) Orientation {
  Vec3f normal, position_m;
  float footprint_m = 0;
  SurfaceKind kind = SurfaceKind::diffuse;
};

// Surfaces that a tie may lead to, side by side; lanes past `count` hold what was there before.
struct Candidates {
  static constexpr std::size_t kLanes = 16;
  static constexpr std::size_t kMost = (9 * kMostSurfaces + kLanes) / kLanes * kLanes;
  template <class T>
  struct alignas(64) Lanes {
    T data[kMost] = {};
    T& operator[](std::size_t i) { return data[i]; }
    const T& operator[](std::size_t i) const { return data[i]; }
  };
  Lanes<float> normal_x, normal_y, normal_z, place_x, place_y, place_z, footprint, like;
  Lanes<std::uint32_t> cell;
  std::size_t count = 0;

  // Keeps what was written there where `taken`. `kernel`: what it counts by its place among the nine blocks.
  void add(const Orientation& surface, std::uint32_t index, float kernel, bool taken) {
    const std::size_t k = count;
    normal_x[k] = surface.normal.x;
    normal_y[k] = surface.normal.y;
    normal_z[k] = surface.normal.z;
    place_x[k] = surface.position_m.x;
    place_y[k] = surface.position_m.y;
    place_z[k] = surface.position_m.z;
    footprint[k] = surface.footprint_m;
    like[k] = kernel;
    cell[k] = index;
    count += taken ? 1U : 0U;
  }
};

// Multiplies `like` by likeness(), on lanes.
GAZETRACE_CLONES void compare(const Orientation& own, const SmoothingSettings& settings, Candidates& near) {
  const Vec3f n = own.normal;
  const Vec3f p = own.position_m;
  const std::size_t lanes = (near.count + Candidates::kLanes - 1) / Candidates::kLanes * Candidates::kLanes;
  for (std::size_t first = 0; first < lanes; first += Candidates::kLanes) {
    for (std::size_t i = first; i < first + Candidates::kLanes; ++i) {
      const Vec3f normal{near.normal_x[i], near.normal_y[i], near.normal_z[i]};
      const Vec3f way{near.place_x[i] - p.x, near.place_y[i] - p.y, near.place_z[i] - p.z};
      near.like[i] *= likeness(n, normal, way, 0.5F * std::min(own.footprint_m, near.footprint[i]), settings);
    }
  }
}

int levels_of(const MapRegion& region, const SmoothingSettings& settings) {
  const double samples =
      static_cast<double>(region.samples) / static_cast<double>(std::max<std::uint64_t>(region.sites, 1));
  int levels = settings.fewest_levels;
  while (levels < settings.levels && std::ldexp(samples, 2 * levels) < settings.samples) {
    ++levels;
  }
  return levels;
}

static_assert(1 << (SmoothingSettings{}.levels - 1) <= BlockCells::kReach);

class Smoother {
 public:
  Smoother(SurfaceCells& cells, const SamplingMap& map, const SmoothingSettings& settings, int threads)
      : lattice_(cells),
        map_(map),
        settings_(settings),
        threads_(threads),
        lights_(cells.cells.size()),
        next_(cells.cells.size()),
        samples_(cells.cells.size()),
        total_(cells.cells.size()),
        orientations_(cells.cells.size()),
        flows_(map.tiles.size()) {
    for_each_tile([&](std::size_t t) {
      for (std::size_t i = first_cell(t); i < end_cell(t); ++i) {
        const SurfaceCell& cell = cells.cells[i];
        lights_[i] = {cell.reflected, cell.albedo, cell.light, cell.variance,
                      cell.replica * std::max(luminance(cell.albedo), kLeastAlbedo)};
        samples_[i] = cell.samples;
        orientations_[i] = {cell.normal, cell.position_m, cell.footprint_m, cell.kind};
      }
    });
  }

  // So many steps does the region that smooths most take.
  [[nodiscard]] int most_levels() const {
    int most = settings_.fewest_levels;
    for (const MapRegion& region : map_.regions) {
      most = region.sites > 0 ? std::max(most, levels_of(region, settings_)) : most;
    }
    return most;
  }

  // The surfaces of blocks that lie `step` blocks apart, eight of them and the own. `found`: what it holds is lost.
  void find_ties(int step, std::vector<TileTies>& found) const {
    found.resize(map_.tiles.size());
    std::vector<bool> takes_part;
    for (const MapRegion& region : map_.regions) {
      takes_part.push_back(step < 1 << levels_of(region, settings_));
    }
    for_each_tile([&](std::size_t t) {
      const MapTile& tile = map_.tiles[t];
      TileTies& out = found[t];
      out.ties.clear();
      out.end.clear();
      Candidates near;
      for (std::size_t site = tile.first_site; site < tile.first_site + tile.site_count; ++site) {
        for (std::size_t i = lattice_.first[site]; i < lattice_.first[site + 1]; ++i) {
          if (takes_part[map_.sites[site].region]) {
            find_ties_of(site, i, step, near, out.ties);
          }
          out.end.push_back(static_cast<std::uint32_t>(out.ties.size()));
        }
      }
    });
  }

  // Noise from the spread of all samples of the nearest blocks: a site's own few say little about it.
  void estimate_variance(const std::vector<TileTies>& near) {
    for_each_tile([&](std::size_t t) {
      for_each_cell(near, t, [&](std::size_t i, const Tie* begin, const Tie* end, std::size_t) {
        const SurfaceCell& own = lattice_.cells[i];
        double samples = static_cast<double>(own.samples);
        double weight = static_cast<double>(kBinomial[0] * kBinomial[0]) * samples;
        double light = weight * static_cast<double>(own.light);
        double square = weight * static_cast<double>(own.square);
        for (const Tie* tie = begin; tie != end; ++tie) {
          const SurfaceCell& other = lattice_.cells[tie->other];
          const double w = static_cast<double>(tie->like * other.samples);
          weight += w;
          samples += static_cast<double>(other.samples);
          light += w * static_cast<double>(other.light);
          square += w * static_cast<double>(other.square);
        }
        const double mean = light / weight;
        // Of a single sample nobody knows the spread: it counts as large as the light.
        const double spread = samples > 1 ? (square / weight - mean * mean) * samples / (samples - 1) : mean * mean;
        lights_[i].variance = static_cast<float>(std::max(spread, 0.0)) / own.samples;
        if (lights_[i].reflected_replica == 0) {
          // One of the halves has no sample here, so that nothing confirms what the other one saw. The error is as
          // large as the spread, or as all that this light is off the others', and has either sign.
          const float sign = (hash32(static_cast<std::uint32_t>(i)) & 1U) != 0 ? 1.0F : -1.0F;
          const float off = std::max(std::sqrt(lights_[i].variance), std::fabs(own.light - static_cast<float>(mean)));
          lights_[i].reflected_replica = sign * off * std::max(luminance(own.albedo), kLeastAlbedo);
        }
      });
    });
  }

  // Light flows between two surfaces by the same amount both ways, so that none is lost: with n samples and weights w
  //   n_i n_j w_ij / max(W_i, W_j) times the difference,   W_i = sum over j of n_j w_ij
  // Where the sums are alike this is the weighted mean of the neighbours.
  void exchange(const std::vector<TileTies>& ties) {
    for_each_tile([&](std::size_t t) { weigh(ties, t); });
    for_each_tile([&](std::size_t t) {
      for_each_cell(ties, t, [&](std::size_t i, const Tie* begin, const Tie* end, std::size_t at) {
        const CellLight& own = lights_[i];
        CellLight sum;
        float taken = 0;
        for (const Tie* tie = begin; tie != end; ++tie, ++at) {
          const CellLight& other = lights_[tie->other];
          const float w = flows_[t][at] * samples_[tie->other] / std::max(total_[i], total_[tie->other]);
          taken += w;
          sum.reflected += w * other.reflected;
          sum.albedo += w * other.albedo;
          sum.variance += w * w * other.variance;
          sum.reflected_replica += w * other.reflected_replica;
        }
        const float kept = 1 - taken;
        CellLight& smooth = next_[i];
        smooth.reflected = kept * own.reflected + sum.reflected;
        smooth.albedo = kept * own.albedo + sum.albedo;
        smooth.variance = kept * kept * own.variance + sum.variance;
        smooth.reflected_replica = kept * own.reflected_replica + sum.reflected_replica;
        smooth.light = luminance(smooth.reflected) / std::max(luminance(smooth.albedo), kLeastAlbedo);
      });
    });
    lights_.swap(next_);
  }

  void store() const {
    for_each_tile([&](std::size_t t) {
      for (std::size_t i = first_cell(t); i < end_cell(t); ++i) {
        SurfaceCell& cell = lattice_.cells[i];
        cell.reflected = lights_[i].reflected;
        cell.albedo = lights_[i].albedo;
        cell.light = lights_[i].light;
        cell.variance = lights_[i].variance;
        cell.replica = lights_[i].replica();
      }
    });
  }

 private:
  // Weights by likeness and by light, and their sums.
  void weigh(const std::vector<TileTies>& ties, std::size_t t) {
    flows_[t].resize(ties[t].ties.size());
    for_each_cell(ties, t, [&](std::size_t i, const Tie* begin, const Tie* end, std::size_t at) {
      const CellLight& own = lights_[i];
      float total = kOwnShare * samples_[i];
      for (const Tie* tie = begin; tie != end; ++tie, ++at) {
        const CellLight& other = lights_[tie->other];
        // Of the difference, so that both sides judge alike.
        const float noise = settings_.light_sigmas * std::sqrt(own.variance + other.variance) +
                            1e-6F * std::max(std::fabs(own.light), std::fabs(other.light)) + 1e-30F;
        const float w = tie->like * falling(std::fabs(other.light - own.light) / noise);
        flows_[t][at] = w;
        total += w * samples_[tie->other];
      }
      total_[i] = total;
    });
  }

  void find_ties_of(std::size_t site, std::size_t i, int step, Candidates& near, std::vector<Tie>& out) const {
    const Site& place = map_.sites[site];
    const BlockCells& blocks = lattice_.blocks[place.region];
    const Orientation& own = orientations_[i];
    near.count = 0;
    for (int dy = -1; dy <= 1; ++dy) {
      for (int dx = -1; dx <= 1; ++dx) {
        const std::uint32_t code = blocks.at(place.block_x + dx * step, place.block_y + dy * step);
        const float kernel =
            kBinomial[static_cast<std::size_t>(std::abs(dx))] * kBinomial[static_cast<std::size_t>(std::abs(dy))];
        const std::uint32_t end = (code >> 2U) + (code & 3U);
        for (std::uint32_t k = code >> 2U; k < end; ++k) {
          const Orientation& other = orientations_[k];
          near.add(other, k, kernel, (static_cast<int>(other.kind == own.kind) & static_cast<int>(k != i)) != 0);
        }
      }
    }
    compare(own, settings_, near);
    std::size_t end = out.size();
    out.resize(end + near.count);
    for (std::size_t k = 0; k < near.count; ++k) {
      out[end] = {near.cell[k], near.like[k]};
      end += near.like[k] > 0 ? 1U : 0U;
    }
    out.resize(end);
  }

  [[nodiscard]] std::size_t first_cell(std::size_t t) const { return lattice_.first[map_.tiles[t].first_site]; }
  [[nodiscard]] std::size_t end_cell(std::size_t t) const {
    return lattice_.first[map_.tiles[t].first_site + map_.tiles[t].site_count];
  }

  template <class Visit>
  void for_each_tile(const Visit& visit) const {
    parallel_for(map_.tiles.size(), threads_, visit);
  }

  // visit(cell, its ties, where the first of them is among the tile's).
  template <class Visit>
  void for_each_cell(const std::vector<TileTies>& ties, std::size_t t, const Visit& visit) const {
    const TileTies& of_tile = ties[t];
    const std::size_t first = first_cell(t);
    std::size_t begin = 0;
    for (std::size_t k = 0; k < of_tile.end.size(); ++k) {
      visit(first + k, of_tile.ties.data() + begin, of_tile.ties.data() + of_tile.end[k], begin);
      begin = of_tile.end[k];
    }
  }

  SurfaceCells& lattice_;
  const SamplingMap& map_;
  const SmoothingSettings& settings_;
  int threads_;
  std::vector<CellLight> lights_, next_;
  std::vector<float> samples_, total_;  // of each cell
  std::vector<Orientation> orientations_;
  std::vector<std::vector<float>> flows_;  // of each tile's ties
};

}  // namespace

void smooth_surfaces(SurfaceCells& cells, const SamplingMap& map, const SmoothingSettings& settings, int threads) {
  Smoother smoother(cells, map, settings, threads);
  std::vector<TileTies> near;
  smoother.find_ties(1, near);
  smoother.estimate_variance(near);
  smoother.exchange(near);
  std::vector<TileTies> wide;
  for (int level = 1; level < smoother.most_levels(); ++level) {
    smoother.find_ties(1 << level, wide);
    smoother.exchange(wide);
  }
  // Wide steps leave dots that are as far apart as the first step; a last narrow one removes them.
  smoother.exchange(near);
  smoother.store();
}

}  // namespace gazetrace
