// SPDX-License-Identifier: Apache-2.0
// Importance sampling of a latitude-longitude environment. Radiance is the bilinear interpolation of the picture (u
// wraps, v is clamped at the poles). The density is constant over cells of whole pixels (of one pixel up to 2048
// columns), proportional to the interpolated luminance averaged over the cell; samples are uniform in solid angle
// inside a cell. Rows and columns are found by inverting cumulative sums with guide tables. This takes constant
// expected time and, unlike an alias table, keeps the stratification of the samples.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "gazetrace/scene.hpp"

namespace gazetrace {

class EnvironmentSampler {
 public:
  EnvironmentSampler() = default;
  // Keeps a reference to the picture, which must outlive it. An absent environment is black.
  explicit EnvironmentSampler(const Environment& environment);

  struct Value {
    Vec3f radiance;
    float pdf = 0;  // over solid angle
  };
  struct Sample {
    Vec3f direction;  // world
    Vec3f radiance;
    float pdf = 0;
  };
  // May be called only where total() > 0.
  [[nodiscard]] Sample sample(const Vec2f& u) const noexcept;
  [[nodiscard]] Value value(const Vec3f& direction) const noexcept;
  [[nodiscard]] Vec3f radiance(const Vec3f& direction) const noexcept;
  [[nodiscard]] float pdf(const Vec3f& direction) const noexcept;

  // The same for many samples at once, with the same results. Tables are prefetched, so that the waits for memory (most
  // of the cost of a single sample) overlap.
  void sample_many(const Vec2f* u, std::size_t count, Sample* out) const noexcept;
  void value_many(const Vec3f* directions, std::size_t count, Value* out) const noexcept;

  // The integral of luminance over all directions, W/m^2.
  [[nodiscard]] double total() const noexcept { return total_; }

 private:
  struct Place {
    float u, v;
  };
  struct Choice {
    std::uint32_t index;
    float fraction;  // position inside the chosen interval, 0..1
  };
  [[nodiscard]] static Place place_of(const Vec3f& direction, float rotation_turns) noexcept;
  [[nodiscard]] Vec3f lookup(const Place& at) const noexcept;
  [[nodiscard]] float cell_pdf(const Place& at) const noexcept;
  [[nodiscard]] std::size_t cell_at(const Place& at) const noexcept;
  void prefetch(const Place& at) const noexcept;
  struct Direction {
    Vec3f direction;  // world
    Place place;
  };
  struct CellPoint {
    float cosine, sine_squared, u;  // of the polar angle; horizontal position in the picture
  };
  [[nodiscard]] CellPoint point_in_cell(const Choice& row, const Choice& column) const noexcept;
  [[nodiscard]] static Direction direction_of(const CellPoint& point, float rotation_turns) noexcept;
  static Choice invert(const float* cumulative, const std::uint16_t* guide, std::uint32_t count, float u) noexcept;

  const ImageRgb* picture_ = nullptr;
  float rotation_turns_ = 0;
  float columns_per_u_ = 0, rows_per_v_ = 0;
  std::uint32_t columns_ = 0, rows_ = 0;
  std::vector<float> column_edges_;       // in u; columns + 1 values
  std::vector<double> row_edges_;         // cosine of the polar angle, from 1 to -1; rows + 1 values
  std::vector<float> row_cumulative_;     // upper ends of the rows' intervals
  std::vector<std::uint16_t> row_guide_;  // one entry per row
  std::vector<float> cell_cumulative_;    // [row][column]
  std::vector<std::uint16_t> cell_guide_;
  std::vector<float> cell_pdf_;
  double total_ = 0;
};

}  // namespace gazetrace
