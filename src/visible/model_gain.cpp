// SPDX-License-Identifier: Apache-2.0
#include "gazetrace/model_gain.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <vector>

#include "gazetrace/error.hpp"
#include "metrics/band_sensitivity.hpp"
#include "visible/channel_gain.hpp"
#include "visible/gaze_angles.hpp"
#include "visible/masked_moment.hpp"

namespace gazetrace {
namespace {

constexpr double kP = kVisiblePooling;

// s of the header, and s^p times E|z|^p, for each band and channel and each pixel of the raster: the sustained bands
// first, then the transient ones.
struct BandPowers {
  std::size_t sustained_bands = 0;
  std::vector<std::vector<float>> deviation;
  std::vector<std::vector<double>> at;
};

// Sensitivities change slowly over the field, so one raster serves all bands.
int raster_cell_px(const PlanarView& view) {
  constexpr int kMostSide = 128;
  int cell = 1;
  while (std::max(view.width_px, view.height_px) / cell > kMostSide) {
    cell *= 2;
  }
  return cell;
}

BandPowers band_powers(const ModelGainSettings& settings, const Vec3d& gaze_direction, const ErrorSpectrum& spectrum,
                       int width, int height) {
  const PlanarView& view = settings.view;
  const FovVideoVdpGeometry geometry = fovvideovdp_geometry(view);
  const std::vector<double> frequencies =
      fovvideovdp_bands_cpd(geometry.pixels_per_degree(), view.width_px, view.height_px);
  const ChannelGains channels = channel_gains(settings.frames_per_second, 0, {});
  const Vec2f gaze_deg = metric_gaze_deg(view, geometry, gaze_direction);
  const double moment = absolute_moment(kP);
  const std::vector<float> background(static_cast<std::size_t>(width), static_cast<float>(settings.luminance_cd_m2));
  const std::size_t channel_count = settings.frames_per_second > 0 ? 2 : 1;
  BandPowers powers;
  powers.sustained_bands = frequencies.size();
  for (std::size_t c = 0; c < channel_count; ++c) {
    for (std::size_t b = 0; b < frequencies.size(); ++b) {
      BandGeometry band = band_geometry(geometry, true, frequencies[b], width, height, settings.threads);
      if (settings.even_resolution) {
        std::fill(band.log2_rho.pixels.begin(), band.log2_rho.pixels.end(), band.log2_rho_centre);
      }
      const double per_contrast =
          static_cast<double>(band_contrast_gain(b)) * std::sqrt(spectrum.gain[b] * channels.variance[c]);
      std::vector<double> power;
      std::vector<float> deviation;
      std::vector<float> sensitivity_sustained;
      std::vector<float> sensitivity_transient;
      for (int y = 0; y < height; ++y) {
        band_sensitivity(band, gaze_deg, y, background, sensitivity_sustained, sensitivity_transient);
        for (const float s : c == 0 ? sensitivity_sustained : sensitivity_transient) {
          deviation.push_back(static_cast<float>(per_contrast * static_cast<double>(s)));
          power.push_back(moment * std::pow(static_cast<double>(deviation.back()), kP));
        }
      }
      powers.at.push_back(std::move(power));
      powers.deviation.push_back(std::move(deviation));
    }
  }
  return powers;
}

struct PooledRates {
  double q = 0;
  std::vector<double> slope;  // r dQ / dA of every band and channel
};

PooledRates pooled(const BandPowers& powers, const std::vector<double>& rates) {
  std::vector<double> falls(rates.size());
  for (std::size_t i = 0; i < rates.size(); ++i) {
    falls[i] = std::pow(rates[i], -kP / 2);
  }
  std::vector<double> band_q;
  for (const std::vector<double>& power : powers.at) {
    const double sum = std::inner_product(power.begin(), power.end(), falls.begin(), 0.0);
    band_q.push_back(std::pow(sum / static_cast<double>(rates.size()), 1 / kPoolSpace));
  }
  const auto middle = band_q.begin() + static_cast<std::ptrdiff_t>(powers.sustained_bands);
  const std::vector<double> sustained(band_q.begin(), middle);
  const std::vector<double> transient(middle, band_q.end());
  PooledRates result;
  result.q = pooled_over_bands(sustained, transient);
  for (std::size_t k = 0; k < band_q.size(); ++k) {
    const bool is_sustained = k < powers.sustained_bands;
    const std::vector<double>& of_channel = is_sustained ? sustained : transient;
    const double weight = is_sustained ? 1 : kTransientWeight;
    const double channel = weight * std::accumulate(of_channel.begin(), of_channel.end(), 0.0);
    result.slope.push_back(band_q[k] > 0 ? weight * std::pow(result.q / channel, 1 - kPoolChannels) *
                                               std::pow(band_q[k], 1 - kPoolSpace)
                                         : 0);
  }
  return result;
}

// The rates that the slopes ask for, with a mean of 1.
std::vector<double> best_rates(const BandPowers& powers, const std::vector<double>& slope) {
  std::vector<double> rates(powers.at.front().size());
  for (std::size_t k = 0; k < powers.at.size(); ++k) {
    for (std::size_t i = 0; i < rates.size(); ++i) {
      rates[i] += slope[k] * powers.at[k][i];
    }
  }
  double sum = 0;
  for (double& rate : rates) {
    rate = std::pow(rate, 1 / (1 + kP / 2));
    sum += rate;
  }
  for (double& rate : rates) {
    rate *= static_cast<double>(rates.size()) / sum;
  }
  return rates;
}

// Q of `spp` samples a pixel on average, at these rates, with the metric's limit of each difference.
double limited_q(const BandPowers& powers, const std::vector<double>& rates, double spp) {
  std::vector<float> fall(rates.size());
  for (std::size_t i = 0; i < rates.size(); ++i) {
    fall[i] = static_cast<float>(1 / std::sqrt(spp * rates[i]));
  }
  std::vector<double> sustained;
  std::vector<double> transient;
  for (std::size_t k = 0; k < powers.deviation.size(); ++k) {
    const bool is_sustained = k < powers.sustained_bands;
    const MaskedMoments& moments = is_sustained ? MaskedMoments::sustained() : MaskedMoments::transient();
    double sum = 0;
    for (std::size_t i = 0; i < rates.size(); ++i) {
      sum += static_cast<double>(moments(0, powers.deviation[k][i] * fall[i]));
    }
    (is_sustained ? sustained : transient).push_back(std::pow(sum / static_cast<double>(rates.size()), 1 / kPoolSpace));
  }
  return pooled_over_bands(sustained, transient);
}

// The samples a pixel that reach a Q (which the limit must not make impossible): without the limit, Q falls as their
// power of -p / (2 r), and the limit only makes it fall more slowly, so that steps by that power settle from above or
// below.
double spp_for(const BandPowers& powers, const std::vector<double>& rates, double wanted_q) {
  constexpr int kMostSteps = 60;
  constexpr double kSettled = 1e-6;
  double spp = std::pow(pooled(powers, rates).q / wanted_q, 2 * kPoolSpace / kP);
  for (int step = 0; step < kMostSteps; ++step) {
    const double factor = std::pow(limited_q(powers, rates, spp) / wanted_q, 2 * kPoolSpace / kP);
    spp *= factor;
    if (std::fabs(factor - 1) < kSettled) {
      break;
    }
  }
  return spp;
}

}  // namespace

ModelGain model_gain(const ModelGainSettings& settings, const Vec3d& gaze_direction, const ErrorSpectrum& spectrum) {
  constexpr double kLeast = 5;
  constexpr double kNone = 10;
  if (!(settings.target_jod >= kLeast && settings.target_jod < kNone)) {
    throw Error(ErrorKind::usage, "visible error", fmt::format("a target of {} JOD", settings.target_jod),
                fmt::format("it must be at least {:g} and below {:g}", kLeast, kNone));
  }
  const int cell = raster_cell_px(settings.view);
  const int width = (settings.view.width_px + cell - 1) / cell;
  const int height = (settings.view.height_px + cell - 1) / cell;
  const BandPowers powers = band_powers(settings, gaze_direction, spectrum, width, height);
  std::vector<double> rates(powers.at.front().size(), 1.0);
  double q = pooled(powers, rates).q;
  // The fixed point, approached in the mean of logarithms, which damps oscillation.
  constexpr int kMostSteps = 100;
  constexpr double kSettled = 1e-6;  // relative change of Q
  for (int step = 0; step < kMostSteps; ++step) {
    const std::vector<double> next = best_rates(powers, pooled(powers, rates).slope);
    double sum = 0;
    for (std::size_t i = 0; i < rates.size(); ++i) {
      rates[i] = std::sqrt(rates[i] * next[i]);
      sum += rates[i];
    }
    for (double& rate : rates) {
      rate *= static_cast<double>(rates.size()) / sum;
    }
    const double before = q;
    q = pooled(powers, rates).q;
    if (std::fabs(before - q) < kSettled * q) {
      break;
    }
  }
  const std::vector<double> uniform(rates.size(), 1.0);
  const double wanted = fovvideovdp_q(settings.target_jod);
  ModelGain result;
  result.uniform_spp = spp_for(powers, uniform, wanted);
  result.allocated_spp = spp_for(powers, rates, wanted);
  result.gain = result.uniform_spp / result.allocated_spp;
  result.density = ImageGray(width, height);
  for (std::size_t i = 0; i < rates.size(); ++i) {
    result.density.pixels[i] = static_cast<float>(rates[i]);
  }
  return result;
}

}  // namespace gazetrace
