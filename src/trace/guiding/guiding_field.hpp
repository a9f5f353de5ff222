// SPDX-License-Identifier: Apache-2.0
// Where the light of a frame arrives from, as paths of the frame itself found it: a mixture partner for the BSDF when a
// path chooses its next direction. This is path guiding by an octree over places, with a table of directions in each
// cell (in the spirit of Müller, Gross and Novák, "Practical Path Guiding", 2017).
//
// A cell is a cube of space for surfaces that face about one way. Its table is a density over the sphere: the root of
// the second moment of what arrives, times the cosine (Rath et al., "Variance-Aware Path Guiding", 2020). A cell that
// has seen few paths is drawn towards the larger cell that it is in, and the largest one towards even light. Means stay
// unbiased whatever was found, since the BSDF always keeps at least a tenth of the choice.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "gazetrace/math.hpp"
#include "trace/guiding/direction_bins.hpp"

namespace gazetrace {

// What a path found along one of its bounces.
struct TrainingRecord {
  Vec3f position, normal;  // of the surface that it left; the normal is the shading normal
  Vec3f direction;         // of unit length
  float pdf = 0;           // with which the direction was drawn, over solid angle
  float bsdf_pdf = 0;      // what the BSDF alone would have had; `pdf` where no table took part
  float radiance = 0;  // luminance that arrived along it, with the weight that MIS gave to what light samples find too
  std::uint32_t path = 0;  // paths of even and of odd number judge each other's tables
};

// The density of one cell, as cumulative sums.
struct alignas(64) DirectionTable {
  std::array<float, kBands> band{};                          // upper ends of the bands' intervals; the last is 1
  std::array<std::array<float, kSectors>, kBands> sector{};  // of the sectors of a band; the last is 1

  struct Sample {
    Vec3f direction;
    float pdf = 0;  // over solid angle
  };
  // `u` in [0, 1); neighbouring numbers give neighbouring directions, so that stratified numbers stay stratified.
  [[nodiscard]] Sample sample(const Vec2f& u) const noexcept;
  [[nodiscard]] float pdf(const Vec3f& direction) const noexcept;
};

class GuidingField {
 public:
  // Untrained: cell_at() finds nothing.
  GuidingField() { roots_.fill(-1); }
  // The result does not depend on the number of threads. Records that carry no finite light are passed over.
  GuidingField(const std::vector<TrainingRecord>& records, int threads);

  // The smallest cell for a place and a normal, or a negative number.
  [[nodiscard]] std::int32_t cell_at(const Vec3f& position, const Vec3f& normal) const noexcept;
  [[nodiscard]] const DirectionTable& table(std::int32_t cell) const noexcept {
    return tables_[static_cast<std::size_t>(cell)];
  }
  // How much of the choice of a diffuse direction the table should have, 0 .. 0.9: what would have had the least
  // variance for the paths that did not make the table.
  [[nodiscard]] float share(std::int32_t cell) const noexcept { return shares_[static_cast<std::size_t>(cell)]; }

  // False where no cell's table is of use.
  [[nodiscard]] bool pays() const noexcept { return pays_; }
  // Whether more paths are likely to find something of use, by a cell that saves variance, however few paths it has
  // seen.
  [[nodiscard]] bool promises() const noexcept { return promises_; }
  [[nodiscard]] std::size_t cell_count() const noexcept { return nodes_.size(); }
  [[nodiscard]] std::size_t bytes() const noexcept;

 private:
  static constexpr std::size_t kFacings = 27;
  static constexpr unsigned kDepth = 10;
  using Children = std::array<std::int32_t, 8>;
  struct Branch;  // the cells of one facing
  class BranchBuilder;

  struct Place {
    std::array<std::uint32_t, 3> at;
  };
  [[nodiscard]] Place place_of(const Vec3f& position) const noexcept;
  static std::size_t facing_of(const Vec3f& normal) noexcept;

  Vec3f origin_;
  float steps_per_m_ = 0;
  std::array<std::int32_t, kFacings> roots_;
  std::vector<Children> nodes_;
  std::vector<DirectionTable> tables_;
  std::vector<float> shares_;
  bool pays_ = false, promises_ = false;
};

}  // namespace gazetrace
