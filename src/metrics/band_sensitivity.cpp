// SPDX-License-Identifier: Apache-2.0
#include "metrics/band_sensitivity.hpp"

#include <cmath>
#include <numeric>

#include "core/fast_math.hpp"
#include "core/parallel.hpp"
#include "metrics/contrast_sensitivity.hpp"

namespace gazetrace {
namespace {

constexpr float kSensitivityCorrection = 16.2596F / 20;  // log10
constexpr float kLog2Of10 = 3.32192809F;

}  // namespace

BandGeometry band_geometry(const FovVideoVdpGeometry& geometry, bool foveated, double rho_cpd, int width_px,
                           int height_px, int threads) {
  BandGeometry band;
  band.log2_rho_centre = static_cast<float>(std::log2(rho_cpd));
  for (int x = 0; x < width_px; ++x) {
    band.azimuth_deg.push_back(static_cast<float>(geometry.view_direction_deg(x + 0.5, 0, width_px, height_px).x));
  }
  for (int y = 0; y < height_px; ++y) {
    band.elevation_deg.push_back(static_cast<float>(geometry.view_direction_deg(0, y + 0.5, width_px, height_px).y));
  }
  if (foveated) {
    band.log2_rho = ImageGray(width_px, height_px);
    parallel_for(static_cast<std::size_t>(height_px), threads, [&](std::size_t row) {
      const int y = static_cast<int>(row);
      for (int x = 0; x < width_px; ++x) {
        const Vec2d direction{static_cast<double>(band.azimuth_deg[static_cast<std::size_t>(x)]),
                              static_cast<double>(band.elevation_deg[row])};
        band.log2_rho(x, y) = static_cast<float>(std::log2(rho_cpd * geometry.magnification(direction)));
      }
    });
  }
  return band;
}

void band_sensitivity(const BandGeometry& band, const std::optional<Vec2f>& gaze_deg, int y,
                      const std::vector<float>& background, std::vector<float>& sustained,
                      std::vector<float>& transient) {
  const SensitivityTable& table = SensitivityTable::get();
  sustained.resize(background.size());
  transient.resize(background.size());
  const float dy = gaze_deg ? band.elevation_deg[static_cast<std::size_t>(y)] - gaze_deg->y : 0;
  for (std::size_t x = 0; x < background.size(); ++x) {
    SensitivityTable::Query query{band.log2_rho_centre, log2_fast(background[x]), 0};
    if (gaze_deg) {
      const float dx = band.azimuth_deg[x] - gaze_deg->x;
      query.log2_rho = band.log2_rho(static_cast<int>(x), y);
      query.sqrt_eccentricity = std::sqrt(std::sqrt(dx * dx + dy * dy));
    }
    const std::array<float, 2> log2_s = table.log2_sensitivity(query);
    sustained[x] = log2_s[0] + kSensitivityCorrection * kLog2Of10;
    transient[x] = log2_s[1] + kSensitivityCorrection * kLog2Of10;
  }
  for (std::size_t x = 0; x < background.size(); ++x) {
    sustained[x] = exp2_fast(sustained[x]);
    transient[x] = exp2_fast(transient[x]);
  }
}

double pooled_over_bands(const std::vector<double>& sustained, const std::vector<double>& transient) {
  const double steady = std::accumulate(sustained.begin(), sustained.end(), 0.0);
  const double changing = kTransientWeight * std::accumulate(transient.begin(), transient.end(), 0.0);
  return std::pow(std::pow(steady, kPoolChannels) + std::pow(changing, kPoolChannels), 1 / kPoolChannels);
}

}  // namespace gazetrace
