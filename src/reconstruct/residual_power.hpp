// SPDX-License-Identifier: Apache-2.0
// How much of a residual is signal, judged by mean squares of residuals and of replicas of their noise, near a block
// and far around it. All of it is inline, since it is asked for every block of every band.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

#include "core/parallel.hpp"
#include "reconstruct/block_bands.hpp"

namespace gazetrace {

using Powers = Channels<3>;  // as Power

// Mean squares, relative to the picture's own.
struct Power {
  float residual = 0, noise = 0;
  float spread = 0;  // mean square of `noise`
};
inline Power power_of(const Powers::Value& value) {
  return {value[0], value[1], value[2]};
}
inline Power operator+(const Power& a, const Power& b) {
  return {a.residual + b.residual, a.noise + b.noise, a.spread + b.spread};
}
inline Power operator*(float w, const Power& a) {
  return {w * a.residual, w * a.noise, w * a.spread};
}

// Means over squares of about 16 pixels and their eight neighbours, and between their centres.
class TileMeans {
 public:
  TileMeans(const Powers& image, int block_px, int threads)
      : tile_(std::max(16 / block_px, 1)),
        columns_((image.width + tile_ - 1) / tile_),
        rows_((image.height + tile_ - 1) / tile_) {
    std::vector<Power> sums(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_));
    parallel_for(static_cast<std::size_t>(rows_), threads, [&](std::size_t row) {
      const int y0 = static_cast<int>(row) * tile_;
      const int y1 = std::min(y0 + tile_, image.height);
      for (int column = 0; column < columns_; ++column) {
        const int x0 = column * tile_;
        const int x1 = std::min(x0 + tile_, image.width);
        std::array<double, 3> sum{};
        for (int y = y0; y < y1; ++y) {
          for (int x = x0; x < x1; ++x) {
            const Power p = power_of(image.at(x, y));
            sum[0] += static_cast<double>(p.residual);
            sum[1] += static_cast<double>(p.noise);
            sum[2] += static_cast<double>(p.spread);
          }
        }
        const double blocks = static_cast<double>((x1 - x0) * (y1 - y0));
        sums[index(column, static_cast<int>(row))] = {static_cast<float>(sum[0] / blocks),
                                                      static_cast<float>(sum[1] / blocks),
                                                      static_cast<float>(sum[2] / blocks)};
      }
    });
    means_.resize(sums.size());
    for (int y = 0; y < rows_; ++y) {
      for (int x = 0; x < columns_; ++x) {
        Power& mean = means_[index(x, y)];
        for (int v = y - 1; v <= y + 1; ++v) {
          for (int u = x - 1; u <= x + 1; ++u) {
            mean = mean + (1.0F / 9) * sums[index(std::clamp(u, 0, columns_ - 1), std::clamp(v, 0, rows_ - 1))];
          }
        }
      }
    }
  }

  // So many blocks are in a mean.
  [[nodiscard]] int blocks() const { return 9 * tile_ * tile_; }

  [[nodiscard]] Power at(int x, int y) const {
    const float u = (static_cast<float>(x) + 0.5F) / static_cast<float>(tile_) - 0.5F;
    const float v = (static_cast<float>(y) + 0.5F) / static_cast<float>(tile_) - 0.5F;
    const int column = static_cast<int>(std::floor(u));
    const int row = static_cast<int>(std::floor(v));
    const float fx = u - static_cast<float>(column);
    const float fy = v - static_cast<float>(row);
    const auto mean = [&](int dx, int dy) -> const Power& {
      return means_[index(std::clamp(column + dx, 0, columns_ - 1), std::clamp(row + dy, 0, rows_ - 1))];
    };
    return (1 - fy) * ((1 - fx) * mean(0, 0) + fx * mean(1, 0)) + fy * ((1 - fx) * mean(0, 1) + fx * mean(1, 1));
  }

 private:
  [[nodiscard]] std::size_t index(int column, int row) const {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_) + static_cast<std::size_t>(column);
  }
  int tile_, columns_, rows_;
  std::vector<Power> means_;
};

// Where light is rare, some pixels have it in both halves by chance, so that their replicas are small and their
// residuals look like details. Of noise that is mostly nothing and at times s, the mean of fourth powers over that of
// squares is s squared; of normal noise it is three times its variance, which is left out. Twice s is what both halves
// show together, three times s when one of them has it twice.
inline float square_of_coincidence(const Power& wide) {
  constexpr float kEvents = 3;
  const float rare = wide.noise > 0 ? wide.spread / wide.noise - 3 * wide.noise : 0.0F;
  return rare > 0 ? kEvents * kEvents * rare : 0.0F;  // no number where squares were infinite
}

// The share of a residual that is no noise: what follows from the signal that is there on average far around and from
// the noise near the pixel (a rare bright sample is noise there), and more where there is more signal near the pixel.
// Both signals must be beyond doubt. `near` was smoothed twice; `wide` is the mean of `independent` squares.
inline float share_to_keep(const Power& near, const Power& wide, float independent, float doubt) {
  // The sum of the squares of the weights 1 4 6 4 1 / 16 in both directions: one over the number of squares in `near`.
  constexpr float kWeightsSquared = 0.0748F;
  // Less doubt far around: signal that is missed there costs more than noise that is kept.
  constexpr float kWideDoubt = 2;
  const float spread = 2 * std::max(near.spread, wide.spread);
  const float near_signal = near.residual - near.noise - doubt * std::sqrt(kWeightsSquared * spread) -
                            kWeightsSquared * square_of_coincidence(wide);
  const float wide_signal = wide.residual - wide.noise - kWideDoubt * std::sqrt(2 * wide.spread / independent);
  const float share =
      std::max(near_signal > 0 ? near_signal / near.residual : 0.0F,
               wide_signal > 0 ? wide_signal / (wide_signal + std::max(0.5F * near.noise, wide.noise)) : 0.0F);
  return share > 0 ? std::min(share, 1.0F) : 0.0F;  // no number where squares were infinite
}

// Of a residual whose replica is far beyond what residuals and noise are far around, one half of the samples knows
// nothing: a rare bright sample. It fades by the square of the excess, and the smoothed light around it keeps what the
// sample brought. `replica_squared`: relative, as squares are in `wide`.
inline float share_of_confirmed(float replica_squared, const Power& wide, float most_deviations) {
  const float most = most_deviations * most_deviations * std::max(wide.residual, wide.noise);
  return replica_squared > most ? most / replica_squared : 1.0F;
}

}  // namespace gazetrace
