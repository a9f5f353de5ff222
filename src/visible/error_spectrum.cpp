// SPDX-License-Identifier: Apache-2.0
// How the pyramid of metrics/pyramid.hpp responds to frequencies.
//
// A value of band b is a weighted sum of the picture's pixels, and the Fourier transform of its weights is
//   H(fx, fy) = K_b(fx) K_b(fy) - E_b(fx) E_b(fy),
// with K_b(f) the product of k(2^i f) over i < b, k(f) = 0.4 + 0.5 cos(2 pi f) + 0.1 cos(4 pi f) the kernel, and E_b
// what interpolation from level b + 1 gives: K_(b+1)(f) times 0.8 + 0.2 cos(2 pi 2^(b+1) f) at the even pixels of level
// b, and times cos(2 pi 2^b f) at the odd ones. So the variance of band b is the integral of H^2 times the power of the
// error over all frequencies, at each of the four kinds of pixels, whatever is aliased on the way.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <functional>
#include <numeric>
#include <vector>

#include "core/parallel.hpp"
#include "gazetrace/error.hpp"
#include "gazetrace/math.hpp"
#include "gazetrace/visible_error.hpp"
#include "metrics/pyramid.hpp"
#include "visible/pyramid_rows.hpp"

namespace gazetrace {
namespace {

// Frequencies of quadrature in (0, 1/2), closer together where they are low, and their weights over (-1/2, 1/2).
struct FrequencyGrid {
  std::vector<double> f, weight;
};

// Nodes and weights of Gauss-Legendre quadrature over (-1, 1), by Newton's method on the Legendre polynomial.
FrequencyGrid gauss_legendre(int count) {
  FrequencyGrid rule;
  for (int i = 0; i < count; ++i) {
    double x = std::cos(kPi * (i + 0.75) / (count + 0.5));
    double slope = 1;
    for (int step = 0; step < 50; ++step) {
      double before = 1;
      double value = x;
      for (int n = 2; n <= count; ++n) {
        const double next = ((2 * n - 1) * x * value - (n - 1) * before) / n;
        before = value;
        value = next;
      }
      slope = count * (x * value - before) / (x * x - 1);
      const double move = value / slope;
      x -= move;
      if (std::fabs(move) < 1e-15) {
        break;
      }
    }
    rule.f.push_back(x);
    rule.weight.push_back(2 / ((1 - x * x) * slope * slope));
  }
  return rule;
}

double kernel_response(double f) {
  return 0.4 + 0.5 * std::cos(2 * kPi * f) + 0.1 * std::cos(4 * kPi * f);
}

// K_b, and E_b at even and odd pixels, at every frequency of the grid.
struct BandResponse {
  std::vector<double> level;
  std::array<std::vector<double>, 2> interpolated;
};

std::vector<BandResponse> band_responses(const FrequencyGrid& grid) {
  std::vector<BandResponse> bands(kMostVisibleBands);
  std::vector<double> level(grid.f.size(), 1.0);
  for (std::size_t b = 0; b < bands.size(); ++b) {
    const double step_px = std::exp2(static_cast<double>(b));
    bands[b].level = level;
    for (std::size_t i = 0; i < grid.f.size(); ++i) {
      const double f = grid.f[i];
      level[i] *= kernel_response(step_px * f);
      bands[b].interpolated[0].push_back(level[i] * (0.8 + 0.2 * std::cos(4 * kPi * step_px * f)));
      bands[b].interpolated[1].push_back(level[i] * std::cos(2 * kPi * step_px * f));
    }
  }
  return bands;
}

// The gain of a band whose pixels have these variances, see ErrorSpectrum.
double pooled_gain(const std::vector<double>& variances) {
  double sum = 0;
  for (const double variance : variances) {
    sum += std::pow(std::max(variance, 0.0), kVisiblePooling / 2);
  }
  return std::pow(sum / static_cast<double>(variances.size()), 2 / kVisiblePooling);
}

const FrequencyGrid& frequency_grid() {
  // Panels of one octave each, down to the lowest band of a picture of any size.
  static const FrequencyGrid kGrid = [] {
    constexpr int kOctaves = 16;
    constexpr int kQuadratureNodes = 12;
    const FrequencyGrid rule = gauss_legendre(kQuadratureNodes);
    FrequencyGrid grid;
    for (int octave = 0; octave <= kOctaves; ++octave) {
      const double upper = 0.5 * std::exp2(-octave);
      const double lower = octave == kOctaves ? 0 : upper / 2;
      for (std::size_t i = 0; i < rule.f.size(); ++i) {
        grid.f.push_back((lower + upper) / 2 + (upper - lower) / 2 * rule.f[i]);
        grid.weight.push_back((upper - lower) * rule.weight[i]);  // half of the panel's width, for both signs
      }
    }
    return grid;
  }();
  return kGrid;
}

// The spectrum of an error whose power at (fx, fy), in cycles a pixel, is this; 1: white noise of unit variance. The
// power must be even in both frequencies.
ErrorSpectrum spectrum_of_power(const std::function<double(double fx, double fy)>& power) {
  const FrequencyGrid& grid = frequency_grid();
  static const std::vector<BandResponse> kBands = band_responses(frequency_grid());
  std::array<std::array<double, 4>, kMostVisibleBands> variance{};
  for (std::size_t i = 0; i < grid.f.size(); ++i) {
    for (std::size_t j = 0; j < grid.f.size(); ++j) {
      const double share = grid.weight[i] * grid.weight[j] * power(grid.f[i], grid.f[j]);
      for (std::size_t b = 0; b < kMostVisibleBands; ++b) {
        const BandResponse& band = kBands[b];
        for (std::size_t kind = 0; kind < 4; ++kind) {
          const double h =
              band.level[i] * band.level[j] - band.interpolated[kind % 2][i] * band.interpolated[kind / 2][j];
          variance[b][kind] += share * h * h;
        }
      }
    }
  }
  ErrorSpectrum spectrum;
  for (std::size_t b = 0; b < kMostVisibleBands; ++b) {
    spectrum.gain[b] = pooled_gain({variance[b].begin(), variance[b].end()});
  }
  return spectrum;
}

}  // namespace

ErrorSpectrum white_error() {
  static const ErrorSpectrum kWhite = spectrum_of_power([](double, double) { return 1.0; });
  return kWhite;
}

ErrorSpectrum block_error(int block_px) {
  if (block_px < 1) {
    throw Error(ErrorKind::usage, "visible error", fmt::format("a block of {} pixels", block_px));
  }
  // Within a block nothing varies, so what a fine band holds lies along the borders between blocks: the mean over all
  // places of a block, far from the picture's border.
  constexpr int kMostBlock = 64;
  const int block = std::min(block_px, kMostBlock);
  const std::size_t levels = static_cast<std::size_t>(std::bit_width(static_cast<unsigned>(block))) + 4;
  const int size = 16 << levels;
  const std::vector<LevelRows> rows = pyramid_rows(size, levels);
  ErrorSpectrum spectrum;
  for (std::size_t b = 0; b < kMostVisibleBands; ++b) {
    if (b >= levels) {
      spectrum.gain[b] = spectrum.gain[b - 1] / 4;  // blocks are as good as points
      continue;
    }
    const NoiseSums sums = noise_sums(rows[b], block);
    const auto step = static_cast<std::size_t>(1) << b;
    const std::size_t period = std::lcm(static_cast<std::size_t>(block), 2 * step) / step;
    const std::size_t from = sums.kk.size() / 2;
    std::vector<double> variances;
    for (std::size_t j = 0; j < period; ++j) {
      for (std::size_t i = 0; i < period; ++i) {
        variances.push_back(static_cast<double>(noise_variance(sums, sums, from + i, from + j)));
      }
    }
    spectrum.gain[b] = pooled_gain(variances);
  }
  return spectrum;
}

ErrorSpectrum low_pass_error(double sigma_px) {
  if (!(sigma_px >= 0)) {
    throw Error(ErrorKind::usage, "visible error", fmt::format("a Gaussian of {} pixels", sigma_px));
  }
  const auto along = [sigma_px](double f) {
    const double angular = 2 * kPi * f * sigma_px;
    return std::exp(-angular * angular);
  };
  const FrequencyGrid& grid = frequency_grid();
  double mean = 0;
  for (std::size_t i = 0; i < grid.f.size(); ++i) {
    mean += grid.weight[i] * along(grid.f[i]);
  }
  return spectrum_of_power([&](double fx, double fy) { return along(fx) * along(fy) / (mean * mean); });
}

ErrorSpectrum cut_error(double below_cpd, double factor, double pixels_per_degree) {
  if (!(factor >= 0) || !(pixels_per_degree > 0)) {
    throw Error(ErrorKind::usage, "visible error",
                fmt::format("{} times the power, at {} pixels a degree", factor, pixels_per_degree));
  }
  const double below = below_cpd / pixels_per_degree;
  return spectrum_of_power([&](double fx, double fy) { return std::hypot(fx, fy) < below ? factor : 1.0; });
}

ErrorSpectrum measured_spectrum(const ImageGray& error, int threads) {
  constexpr int kLeastSide = 8;
  if (std::min(error.width_px, error.height_px) < kLeastSide) {
    throw Error(ErrorKind::usage, "visible error",
                fmt::format("{}x{} pixels are too few to tell a spectrum", error.width_px, error.height_px));
  }
  double mean = 0;
  for (const float value : error.pixels) {
    mean += static_cast<double>(value);
  }
  mean /= static_cast<double>(error.pixels.size());
  double variance = 0;
  for (const float value : error.pixels) {
    variance += (static_cast<double>(value) - mean) * (static_cast<double>(value) - mean);
  }
  variance /= static_cast<double>(error.pixels.size());
  ErrorSpectrum spectrum = white_error();
  if (!(variance > 0)) {
    return spectrum;
  }
  ImageGray level = error;
  std::size_t b = 0;
  for (; b < kMostVisibleBands && std::min(level.width_px, level.height_px) > 1; ++b) {
    const ImageGray coarse = halved(level, false, threads);
    const ImageGray blurred = doubled(coarse, level.width_px, level.height_px, threads);
    std::array<double, 4> sum{};
    std::array<double, 4> count{};
    // At the border mirrored pixels make noise larger; the model knows that by itself.
    constexpr int kBorder = 2;
    const int left_out = std::min(level.width_px, level.height_px) > 4 * kBorder ? kBorder : 0;
    for (int y = left_out; y < level.height_px - left_out; ++y) {
      for (int x = left_out; x < level.width_px - left_out; ++x) {
        const auto kind = static_cast<std::size_t>(2 * (y % 2) + x % 2);
        const double value = static_cast<double>(level(x, y)) - static_cast<double>(blurred(x, y));
        sum[kind] += value * value;
        count[kind] += 1;
      }
    }
    for (std::size_t kind = 0; kind < sum.size(); ++kind) {
      sum[kind] /= count[kind] * variance;
    }
    spectrum.gain[b] = pooled_gain({sum.begin(), sum.end()});
    level = coarse;
  }
  // Bands that a picture of this size does not have are not used either.
  std::fill(spectrum.gain.begin() + static_cast<std::ptrdiff_t>(b), spectrum.gain.end(), 0.0);
  return spectrum;
}

}  // namespace gazetrace
