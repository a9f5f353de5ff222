// SPDX-License-Identifier: Apache-2.0
#include "reconstruct/surface_smoothing.hpp"

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/luminance.hpp"
#include "core/parallel.hpp"

namespace gazetrace {
namespace {

constexpr std::array<float, 2> kBinomial{0.5F, 0.25F};  // 1 2 1 in x and y, half
// What a surface itself counts among its neighbours. Less than the binomial's quarter, since what is above the largest
// sum of weights near by is kept anyway.
constexpr float kOwnShare = 0.1F;

// What is smoothed of a cell; the rest of it stays.
struct CellLight {
  Vec3f reflected, albedo;
  float light = 0, variance = 0;
};

// Another surface near by, and how much it counts by place and orientation: the same both ways.
struct Tie {
  std::uint32_t other = 0;
  float like = 0;
};

// Of the cells of a map's tile, one after the other.
struct TileTies {
  std::vector<Tie> ties;
  std::vector<std::uint32_t> end;  // of each cell's
};

class Smoother {
 public:
  Smoother(SurfaceCells& cells, const SamplingMap& map, const SmoothingSettings& settings, int threads)
      : lattice_(cells),
        map_(map),
        settings_(settings),
        threads_(threads),
        lights_(cells.cells.size()),
        next_(cells.cells.size()),
        total_(cells.cells.size()),
        flows_(map.tiles.size()) {
    for (std::size_t i = 0; i < lights_.size(); ++i) {
      const SurfaceCell& cell = cells.cells[i];
      lights_[i] = {cell.reflected, cell.albedo, cell.light, cell.variance};
    }
  }

  // The surfaces of blocks that lie `step` blocks apart, eight of them and the own.
  [[nodiscard]] std::vector<TileTies> find_ties(int step) const {
    std::vector<TileTies> found(map_.tiles.size());
    for_each_tile([&](std::size_t t) {
      const MapTile& tile = map_.tiles[t];
      TileTies& out = found[t];
      for (std::size_t site = tile.first_site; site < tile.first_site + tile.site_count; ++site) {
        for (std::size_t i = lattice_.first[site]; i < lattice_.first[site + 1]; ++i) {
          find_ties_of(site, i, step, out.ties);
          out.end.push_back(static_cast<std::uint32_t>(out.ties.size()));
        }
      }
    });
    return found;
  }

  // Noise from the spread of all samples of the nearest blocks: a site's own few say little about it.
  void estimate_variance(const std::vector<TileTies>& near) {
    for_each_tile([&](std::size_t t) {
      for_each_cell(near, t, [&](std::size_t i, const Tie* begin, const Tie* end, std::size_t) {
        const SurfaceCell& own = lattice_.cells[i];
        double weight = static_cast<double>(kBinomial[0] * kBinomial[0] * own.samples);
        double light = weight * static_cast<double>(own.light);
        double square = weight * static_cast<double>(own.square);
        for (const Tie* tie = begin; tie != end; ++tie) {
          const SurfaceCell& other = lattice_.cells[tie->other];
          const double w = static_cast<double>(tie->like * other.samples);
          weight += w;
          light += w * static_cast<double>(other.light);
          square += w * static_cast<double>(other.square);
        }
        const double mean = light / weight;
        lights_[i].variance = static_cast<float>(std::max(square / weight - mean * mean, 0.0)) / own.samples;
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
          const float w = flows_[t][at] * lattice_.cells[tie->other].samples / std::max(total_[i], total_[tie->other]);
          taken += w;
          sum.reflected += w * other.reflected;
          sum.albedo += w * other.albedo;
          sum.variance += w * w * other.variance;
        }
        const float kept = 1 - taken;
        CellLight& smooth = next_[i];
        smooth.reflected = kept * own.reflected + sum.reflected;
        smooth.albedo = kept * own.albedo + sum.albedo;
        smooth.variance = kept * kept * own.variance + sum.variance;
        smooth.light = luminance(smooth.reflected) / std::max(luminance(smooth.albedo), kLeastAlbedo);
      });
    });
    lights_.swap(next_);
  }

  void store() const {
    for (std::size_t i = 0; i < lights_.size(); ++i) {
      SurfaceCell& cell = lattice_.cells[i];
      cell.reflected = lights_[i].reflected;
      cell.albedo = lights_[i].albedo;
      cell.light = lights_[i].light;
      cell.variance = lights_[i].variance;
    }
  }

 private:
  // Weights by likeness and by light, and their sums.
  void weigh(const std::vector<TileTies>& ties, std::size_t t) {
    flows_[t].resize(ties[t].ties.size());
    for_each_cell(ties, t, [&](std::size_t i, const Tie* begin, const Tie* end, std::size_t at) {
      const CellLight& own = lights_[i];
      float total = kOwnShare * lattice_.cells[i].samples;
      for (const Tie* tie = begin; tie != end; ++tie, ++at) {
        const CellLight& other = lights_[tie->other];
        // Of the difference, so that both sides judge alike.
        const float noise = settings_.light_sigmas * std::sqrt(own.variance + other.variance) +
                            1e-6F * std::max(std::fabs(own.light), std::fabs(other.light)) + 1e-30F;
        const float w = tie->like * falling(std::fabs(other.light - own.light) / noise);
        flows_[t][at] = w;
        total += w * lattice_.cells[tie->other].samples;
      }
      total_[i] = total;
    });
  }

  void find_ties_of(std::size_t site, std::size_t i, int step, std::vector<Tie>& out) const {
    const int block = map_.regions[map_.sites[site].region].block_px;
    const int x = map_.sites[site].block_x * block + block / 2;
    const int y = map_.sites[site].block_y * block + block / 2;
    for (int dy = -1; dy <= 1; ++dy) {
      const int py = y + dy * step * block;
      if (py < 0 || py >= map_.height_px) {
        continue;
      }
      for (int dx = -1; dx <= 1; ++dx) {
        const int px = x + dx * step * block;
        if (px < 0 || px >= map_.width_px) {
          continue;
        }
        // A block may be cut by a border between regions: its own site is this one, whatever pixel is in the middle.
        const std::size_t other = dx == 0 && dy == 0 ? site : lattice_.site_of_pixel(px, py);
        const float kernel =
            kBinomial[static_cast<std::size_t>(std::abs(dx))] * kBinomial[static_cast<std::size_t>(std::abs(dy))];
        for (std::size_t k = lattice_.first[other]; k < lattice_.first[other + 1]; ++k) {
          const float like = k == i ? 0.0F : kernel * likeness(lattice_.cells[i], lattice_.cells[k]);
          if (like > 0) {
            out.push_back({static_cast<std::uint32_t>(k), like});
          }
        }
      }
    }
  }

  [[nodiscard]] float likeness(const SurfaceCell& a, const SurfaceCell& b) const {
    if (a.kind != b.kind) {
      return 0;
    }
    return surface_likeness(a.normal, a.place_m, b.normal, b.place_m, 0.5F * std::min(a.footprint_m, b.footprint_m),
                            settings_);
  }

  template <class Visit>
  void for_each_tile(const Visit& visit) const {
    parallel_for(map_.tiles.size(), threads_, visit);
  }

  // visit(cell, its ties, where the first of them is among the tile's).
  template <class Visit>
  void for_each_cell(const std::vector<TileTies>& ties, std::size_t t, const Visit& visit) const {
    const TileTies& of_tile = ties[t];
    const std::size_t first = lattice_.first[map_.tiles[t].first_site];
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
  std::vector<float> total_;               // of each cell
  std::vector<std::vector<float>> flows_;  // of each tile's ties
};

}  // namespace

void smooth_surfaces(SurfaceCells& cells, const SamplingMap& map, const SmoothingSettings& settings, int threads) {
  Smoother smoother(cells, map, settings, threads);
  const std::vector<TileTies> near = smoother.find_ties(1);
  smoother.estimate_variance(near);
  smoother.exchange(near);
  for (int level = 1; level < settings.levels; ++level) {
    smoother.exchange(smoother.find_ties(1 << level));
  }
  // What wide steps leave is dots as far apart as the first of them.
  smoother.exchange(near);
  smoother.store();
}

}  // namespace gazetrace
