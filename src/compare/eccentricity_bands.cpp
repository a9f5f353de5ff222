// SPDX-License-Identifier: Apache-2.0
#include "compare/eccentricity_bands.hpp"

#include <fmt/format.h>

#include <vector>

#include "core/fast_math.hpp"
#include "core/parallel.hpp"

namespace gazetrace {

std::string eccentricity_band_name(std::size_t band) {
  const double from = kEccentricityBandsDeg[band];
  return band + 1 < kEccentricityBandsDeg.size() ? fmt::format("{}-{}", from, kEccentricityBandsDeg[band + 1])
                                                 : fmt::format("{}+", from);
}

void BandSums::add(const BandSums& other) {
  for (std::size_t b = 0; b < bands.size(); ++b) {
    bands[b].sum += other.bands[b].sum;
    bands[b].pixels += other.bands[b].pixels;
  }
  for (std::size_t r = 0; r < regions.size(); ++r) {
    regions[r].sum += other.regions[r].sum;
    regions[r].pixels += other.regions[r].pixels;
  }
  weighted_sum += other.weighted_sum;
  weight += other.weight;
}

EccentricityBands eccentricity_bands(const PlanarView& view, const Vec2d& gaze_px, const RetinalRegions& regions,
                                     int threads) {
  constexpr float kDegPerTurn = 360;
  constexpr float kHalfMagnificationDeg = 0.75F;
  const Vec3d gaze = normalize(view.direction(gaze_px.x, gaze_px.y));
  EccentricityBands result{Image<std::uint8_t>(view.width_px, view.height_px),
                           Image<std::uint8_t>(view.width_px, view.height_px),
                           ImageGray(view.width_px, view.height_px)};
  parallel_for(static_cast<std::size_t>(view.height_px), threads, [&](std::size_t row) {
    const int y = static_cast<int>(row);
    for (int x = 0; x < view.width_px; ++x) {
      const Vec3d direction = view.direction(x + 0.5, y + 0.5);
      const float deg = kDegPerTurn * atan2_turns(static_cast<float>(length(cross(gaze, direction))),
                                                  static_cast<float>(dot(gaze, direction)));
      std::uint8_t band = 0;
      while (band + 1U < kEccentricityBandsDeg.size() && static_cast<double>(deg) >= kEccentricityBandsDeg[band + 1U]) {
        ++band;
      }
      result.band(x, y) = band;
      const auto exact = static_cast<double>(deg);
      result.region(x, y) = static_cast<std::uint8_t>(exact < regions.end_deg[0]   ? 0
                                                      : exact < regions.end_deg[1] ? 1
                                                                                   : 2);
      result.weight(x, y) = 1 / ((deg + kHalfMagnificationDeg) * (deg + kHalfMagnificationDeg));
    }
  });
  return result;
}

BandSums sum_by_band(const EccentricityBands& bands, const ImageGray& map, int margin_px, int threads) {
  std::vector<BandSums> rows(static_cast<std::size_t>(map.height_px - 2 * margin_px));
  parallel_for(rows.size(), threads, [&](std::size_t row) {
    const int y = static_cast<int>(row) + margin_px;
    for (int x = margin_px; x < map.width_px - margin_px; ++x) {
      const auto value = static_cast<double>(map(x, y));
      const auto weight = static_cast<double>(bands.weight(x, y));
      BandSum& band = rows[row].bands[bands.band(x, y)];
      BandSum& region = rows[row].regions[bands.region(x, y)];
      for (BandSum* part : {&band, &region}) {
        part->sum += value;
        part->pixels += 1;
      }
      rows[row].weighted_sum += weight * value;
      rows[row].weight += weight;
    }
  });
  BandSums total;
  for (const BandSums& row : rows) {
    total.add(row);
  }
  return total;
}

}  // namespace gazetrace
