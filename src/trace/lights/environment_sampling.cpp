// SPDX-License-Identifier: Apache-2.0
#include "trace/lights/environment_sampling.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "core/fast_math.hpp"
#include "core/instruction_sets.hpp"
#include "core/luminance.hpp"

namespace gazetrace {
namespace {

constexpr int kCellsAcross = 2048;

// The mean of the bilinear interpolation over each pixel, which has the weights 1, 6, 1 (eighths) along each axis.
std::vector<double> interpolated_luminance(const ImageRgb& picture) {
  const int w = picture.width_px;
  const int h = picture.height_px;
  std::vector<double> plain(picture.pixels.size());
  std::transform(picture.pixels.begin(), picture.pixels.end(), plain.begin(),
                 [](const Vec3f& c) { return luminance(to_double(c)); });
  std::vector<double> result(plain.size());
  const auto blurred_row = [&](int x, int y) {
    const int left = x == 0 ? w - 1 : x - 1;
    const int right = x + 1 == w ? 0 : x + 1;
    return 0.125 * (plain[picture.index(left, y)] + 6 * plain[picture.index(x, y)] + plain[picture.index(right, y)]);
  };
  for (int y = 0; y < h; ++y) {
    for (int x = 0; x < w; ++x) {
      result[picture.index(x, y)] =
          0.125 * (blurred_row(x, std::max(y - 1, 0)) + 6 * blurred_row(x, y) + blurred_row(x, std::min(y + 1, h - 1)));
    }
  }
  return result;
}

// Computes the guide and the upper ends of the intervals for `weights`, whose sum must be positive.
void accumulate(const double* weights, std::size_t count, float* cumulative, std::uint16_t* guide) {
  double sum = 0;
  for (std::size_t i = 0; i < count; ++i) {
    sum += weights[i];
  }
  double partial = 0;
  std::size_t last = 0;
  for (std::size_t i = 0; i < count; ++i) {
    partial += weights[i];
    cumulative[i] = static_cast<float>(std::min(partial / sum, 1.0));
    last = weights[i] > 0 ? i : last;
  }
  std::fill(cumulative + last, cumulative + count, 1.0F);
  std::size_t i = 0;
  for (std::size_t g = 0; g < count; ++g) {
    while (cumulative[i] <= static_cast<float>(g) / static_cast<float>(count)) {
      ++i;
    }
    guide[g] = static_cast<std::uint16_t>(i);
  }
}

double probability(const float* cumulative, std::size_t i) {
  return static_cast<double>(cumulative[i]) - (i == 0 ? 0.0 : static_cast<double>(cumulative[i - 1]));
}

}  // namespace

EnvironmentSampler::EnvironmentSampler(const Environment& environment) {
  if (!environment.present()) {
    return;
  }
  picture_ = &environment.radiance;
  const double turns = environment.rotation_rad / (2 * kPi);
  rotation_turns_ = static_cast<float>(turns - std::floor(turns));
  const int w = picture_->width_px;
  const int h = picture_->height_px;
  const int k = (std::max(w, h) + kCellsAcross - 1) / kCellsAcross;
  columns_ = static_cast<std::uint32_t>((w + k - 1) / k);
  rows_ = static_cast<std::uint32_t>((h + k - 1) / k);
  columns_per_u_ = static_cast<float>(w) / static_cast<float>(k);
  rows_per_v_ = static_cast<float>(h) / static_cast<float>(k);
  column_edges_.resize(columns_ + 1);
  for (std::uint32_t c = 0; c <= columns_; ++c) {
    column_edges_[c] = static_cast<float>(std::min(1.0, static_cast<double>(c) * k / w));
  }
  row_edges_.resize(rows_ + 1);
  for (std::uint32_t r = 0; r <= rows_; ++r) {
    row_edges_[r] = std::cos(kPi * std::min(1.0, static_cast<double>(r) * k / h));
  }

  // The weight of a cell is the luminance of its pixels times their solid angles.
  const std::vector<double> mean = interpolated_luminance(*picture_);
  std::vector<double> cells(static_cast<std::size_t>(columns_) * rows_);
  std::vector<double> row_weights(rows_);
  for (int y = 0; y < h; ++y) {
    const double solid_angle = (std::cos(kPi * y / h) - std::cos(kPi * (y + 1) / h)) * 2 * kPi / w;
    const auto r = static_cast<std::size_t>(y / k);
    for (int x = 0; x < w; ++x) {
      const double weight = std::max(mean[picture_->index(x, y)], 0.0) * solid_angle;
      cells[r * columns_ + static_cast<std::size_t>(x / k)] += weight;
      row_weights[r] += weight;
    }
  }
  for (const double weight : row_weights) {
    total_ += weight;
  }
  cell_pdf_.assign(cells.size(), 0.0F);
  if (!(total_ > 0)) {
    total_ = 0;
    return;
  }

  row_cumulative_.resize(rows_);
  row_guide_.resize(rows_);
  accumulate(row_weights.data(), rows_, row_cumulative_.data(), row_guide_.data());
  cell_cumulative_.resize(cells.size());
  cell_guide_.resize(cells.size());
  for (std::size_t r = 0; r < rows_; ++r) {
    if (!(row_weights[r] > 0)) {
      continue;  // never chosen
    }
    const std::size_t first = r * columns_;
    float* cumulative = cell_cumulative_.data() + first;
    accumulate(cells.data() + first, columns_, cumulative, cell_guide_.data() + first);
    // The density is computed from the rounded sums, which are what the inversion uses.
    const double row_probability = probability(row_cumulative_.data(), r);
    const double height = row_edges_[r] - row_edges_[r + 1];
    for (std::size_t c = 0; c < columns_; ++c) {
      const double width = static_cast<double>(column_edges_[c + 1]) - static_cast<double>(column_edges_[c]);
      cell_pdf_[first + c] =
          static_cast<float>(row_probability * probability(cumulative, c) / (height * width * 2 * kPi));
    }
  }
}

EnvironmentSampler::Choice EnvironmentSampler::invert(const float* cumulative, const std::uint16_t* guide,
                                                      std::uint32_t count, float u) noexcept {
  const auto at = std::min(static_cast<std::uint32_t>(u * static_cast<float>(count)), count - 1);
  std::uint32_t i = guide[at];
  while (i > 0 && cumulative[i - 1] > u) {  // where the product above was rounded up
    --i;
  }
  while (cumulative[i] <= u) {
    ++i;
  }
  const float low = i == 0 ? 0.0F : cumulative[i - 1];
  return {i, (u - low) / (cumulative[i] - low)};
}

inline EnvironmentSampler::Place EnvironmentSampler::place_of(const Vec3f& d, float rotation_turns) noexcept {
  float u = 0.5F + atan2_turns(d.x, -d.z) - rotation_turns;
  u -= std::floor(u);
  return {std::min(u, 0x1.fffffep-1F), 2.0F * atan2_turns(std::sqrt(d.x * d.x + d.z * d.z), d.y)};
}

Vec3f EnvironmentSampler::lookup(const Place& at) const noexcept {
  const int w = picture_->width_px;
  const int h = picture_->height_px;
  const float x = at.u * static_cast<float>(w) + 0.5F;
  const float y = at.v * static_cast<float>(h) + 0.5F;
  const auto ix = static_cast<int>(x);
  const auto iy = static_cast<int>(y);
  const float fx = x - static_cast<float>(ix);
  const float fy = y - static_cast<float>(iy);
  const int x0 = ix == 0 ? w - 1 : ix - 1;
  const int x1 = ix >= w ? 0 : ix;
  const int y0 = std::clamp(iy - 1, 0, h - 1);
  const int y1 = std::min(iy, h - 1);
  const ImageRgb& p = *picture_;
  return (p(x0, y0) * (1 - fx) + p(x1, y0) * fx) * (1 - fy) + (p(x0, y1) * (1 - fx) + p(x1, y1) * fx) * fy;
}

EnvironmentSampler::CellPoint EnvironmentSampler::point_in_cell(const Choice& row,
                                                                const Choice& column) const noexcept {
  // In double, since near the poles a float cosine cannot distinguish directions.
  const double upper = row_edges_[row.index];
  const double cosine = upper + (row_edges_[row.index + 1] - upper) * static_cast<double>(row.fraction);
  const float left = column_edges_[column.index];
  return {static_cast<float>(cosine), static_cast<float>((1 - cosine) * (1 + cosine)),
          left + (column_edges_[column.index + 1] - left) * column.fraction};
}

inline EnvironmentSampler::Direction EnvironmentSampler::direction_of(const CellPoint& point,
                                                                      float rotation_turns) noexcept {
  const float sine = std::sqrt(std::max(point.sine_squared, 0.0F));
  float azimuth = point.u + 0.5F + rotation_turns;  // u - 0.5 turns, and a whole one
  azimuth -= std::floor(azimuth);
  const Vec2f circle = cos_sin_2pi(azimuth);
  return {{sine * circle.y, point.cosine, -sine * circle.x},
          {std::min(point.u, 0x1.fffffep-1F), 2.0F * atan2_turns(sine, point.cosine)}};
}

EnvironmentSampler::Sample EnvironmentSampler::sample(const Vec2f& u) const noexcept {
  const Choice row = invert(row_cumulative_.data(), row_guide_.data(), rows_, u.y);
  const std::size_t first = static_cast<std::size_t>(row.index) * columns_;
  const Choice column = invert(cell_cumulative_.data() + first, cell_guide_.data() + first, columns_, u.x);
  const Direction chosen = direction_of(point_in_cell(row, column), rotation_turns_);
  return {chosen.direction, lookup(chosen.place), cell_pdf_[first + column.index]};
}

std::size_t EnvironmentSampler::cell_at(const Place& at) const noexcept {
  const auto c = std::min(static_cast<std::uint32_t>(at.u * columns_per_u_), columns_ - 1);
  const auto r = std::min(static_cast<std::uint32_t>(at.v * rows_per_v_), rows_ - 1);
  return static_cast<std::size_t>(r) * columns_ + c;
}

float EnvironmentSampler::cell_pdf(const Place& at) const noexcept {
  return cell_pdf_[cell_at(at)];
}

void EnvironmentSampler::prefetch(const Place& at) const noexcept {
  const int x = std::min(static_cast<int>(at.u * static_cast<float>(picture_->width_px)), picture_->width_px - 1);
  const int y = std::min(static_cast<int>(at.v * static_cast<float>(picture_->height_px)), picture_->height_px - 1);
  const std::size_t pixel = picture_->index(x, y);
  const auto row = static_cast<std::size_t>(picture_->width_px);
  __builtin_prefetch(&picture_->pixels[pixel]);
  __builtin_prefetch(&picture_->pixels[pixel >= row ? pixel - row : pixel]);
  __builtin_prefetch(&picture_->pixels[pixel + row < picture_->pixels.size() ? pixel + row : pixel]);
}

GAZETRACE_CLONES [[gnu::flatten]] void EnvironmentSampler::sample_many(const Vec2f* u, std::size_t count,
                                                                       Sample* out) const noexcept {
  constexpr std::size_t kStage = 32;
  alignas(64) std::array<float, kStage> cosine{};
  alignas(64) std::array<float, kStage> sine_squared{};
  alignas(64) std::array<float, kStage> place_u{};
  alignas(64) std::array<float, kStage> x;
  alignas(64) std::array<float, kStage> z;
  alignas(64) std::array<float, kStage> place_v;
  std::array<Choice, kStage> row;
  std::array<std::size_t, kStage> cell;
  const float rotation = rotation_turns_;
  const auto guide_at = [&](float c) {
    return std::min(static_cast<std::uint32_t>(c * static_cast<float>(columns_)), columns_ - 1);
  };
  for (std::size_t begin = 0; begin < count; begin += kStage) {
    const std::size_t n = std::min(kStage, count - begin);
    for (std::size_t i = 0; i < n; ++i) {
      row[i] = invert(row_cumulative_.data(), row_guide_.data(), rows_, u[begin + i].y);
      const std::size_t first = static_cast<std::size_t>(row[i].index) * columns_;
      __builtin_prefetch(&cell_guide_[first + guide_at(u[begin + i].x)]);
    }
    for (std::size_t i = 0; i < n; ++i) {
      const std::size_t first = static_cast<std::size_t>(row[i].index) * columns_;
      __builtin_prefetch(&cell_cumulative_[first + cell_guide_[first + guide_at(u[begin + i].x)]]);
    }
    for (std::size_t i = 0; i < n; ++i) {
      const std::size_t first = static_cast<std::size_t>(row[i].index) * columns_;
      const Choice column =
          invert(cell_cumulative_.data() + first, cell_guide_.data() + first, columns_, u[begin + i].x);
      cell[i] = first + column.index;
      __builtin_prefetch(&cell_pdf_[cell[i]]);
      const CellPoint point = point_in_cell(row[i], column);
      cosine[i] = point.cosine;
      sine_squared[i] = point.sine_squared;
      place_u[i] = point.u;
    }
    for (std::size_t i = 0; i < kStage; ++i) {
      const Direction chosen = direction_of({cosine[i], sine_squared[i], place_u[i]}, rotation);
      x[i] = chosen.direction.x;
      z[i] = chosen.direction.z;
      place_u[i] = chosen.place.u;
      place_v[i] = chosen.place.v;
    }
    for (std::size_t i = 0; i < n; ++i) {
      prefetch({place_u[i], place_v[i]});
    }
    for (std::size_t i = 0; i < n; ++i) {
      out[begin + i] = {{x[i], cosine[i], z[i]}, lookup({place_u[i], place_v[i]}), cell_pdf_[cell[i]]};
    }
  }
}

GAZETRACE_CLONES [[gnu::flatten]] void EnvironmentSampler::value_many(const Vec3f* directions, std::size_t count,
                                                                      Value* out) const noexcept {
  constexpr std::size_t kStage = 32;
  if (picture_ == nullptr) {
    std::fill_n(out, count, Value{});
    return;
  }
  alignas(64) std::array<float, kStage> x{};
  alignas(64) std::array<float, kStage> y{};
  alignas(64) std::array<float, kStage> z{};
  alignas(64) std::array<float, kStage> place_u;
  alignas(64) std::array<float, kStage> place_v;
  const float rotation = rotation_turns_;
  for (std::size_t begin = 0; begin < count; begin += kStage) {
    const std::size_t n = std::min(kStage, count - begin);
    for (std::size_t i = 0; i < n; ++i) {
      x[i] = directions[begin + i].x;
      y[i] = directions[begin + i].y;
      z[i] = directions[begin + i].z;
    }
    for (std::size_t i = 0; i < kStage; ++i) {
      const Place at = place_of({x[i], y[i], z[i]}, rotation);
      place_u[i] = at.u;
      place_v[i] = at.v;
    }
    for (std::size_t i = 0; i < n; ++i) {
      prefetch({place_u[i], place_v[i]});
      __builtin_prefetch(&cell_pdf_[cell_at({place_u[i], place_v[i]})]);
    }
    for (std::size_t i = 0; i < n; ++i) {
      out[begin + i] = {lookup({place_u[i], place_v[i]}), cell_pdf({place_u[i], place_v[i]})};
    }
  }
}

EnvironmentSampler::Value EnvironmentSampler::value(const Vec3f& direction) const noexcept {
  if (picture_ == nullptr) {
    return {};
  }
  const Place at = place_of(direction, rotation_turns_);
  return {lookup(at), cell_pdf(at)};
}

Vec3f EnvironmentSampler::radiance(const Vec3f& direction) const noexcept {
  return picture_ == nullptr ? Vec3f{} : lookup(place_of(direction, rotation_turns_));
}

float EnvironmentSampler::pdf(const Vec3f& direction) const noexcept {
  return picture_ == nullptr ? 0.0F : cell_pdf(place_of(direction, rotation_turns_));
}

}  // namespace gazetrace
