// SPDX-License-Identifier: Apache-2.0
#include "visible/masked_moment.hpp"

#include <algorithm>
#include <cmath>

#include "core/fast_math.hpp"
#include "gazetrace/math.hpp"
#include "gazetrace/visible_error.hpp"
#include "metrics/band_sensitivity.hpp"
#include "metrics/masking.hpp"

namespace gazetrace {
namespace {

// The masked difference never exceeds its limit.
constexpr float kMostMoment = 1.2181e6F;  // 10000^1.52134

}  // namespace

double absolute_moment(double p) {
  return std::exp2(p / 2) * std::tgamma((p + 1) / 2) / std::sqrt(kPi);
}

MaskedMoments::MaskedMoments(float mask_exponent) : log2_left_(kContrasts * kDeviations) {
  constexpr int kNodes = 256;
  constexpr double kFarthest = 7;  // standard deviations
  std::vector<double> z(kNodes);
  std::vector<double> weight(kNodes);
  double sum = 0;
  for (std::size_t i = 0; i < z.size(); ++i) {
    z[i] = kFarthest * ((2 * static_cast<double>(i) + 1) / kNodes - 1);
    weight[i] = std::exp(-z[i] * z[i] / 2);
    sum += weight[i];
  }
  const double moment = absolute_moment(kVisiblePooling);
  for (std::size_t j = 0; j < kDeviations; ++j) {
    const double s = std::exp2(kLeastLog2S + static_cast<double>(j) / kStepsPerOctave);
    for (std::size_t i = 0; i < kContrasts; ++i) {
      const double u = std::exp2(kLeastLog2U + static_cast<double>(i) / kStepsPerOctave);
      double expected = 0;
      for (std::size_t k = 0; k < z.size(); ++k) {
        const float difference =
            masked_difference(static_cast<float>(u + s * z[k]), static_cast<float>(u), mask_exponent);
        expected += weight[k] * static_cast<double>(pow_fast(difference, static_cast<float>(kPoolSpace)));
      }
      log2_left_[j * kContrasts + i] =
          static_cast<float>(std::log2(expected / sum / (moment * std::pow(s, kVisiblePooling))));
    }
  }
}

const MaskedMoments& MaskedMoments::sustained() {
  static const MaskedMoments kTable(kMaskSustained);
  return kTable;
}

const MaskedMoments& MaskedMoments::transient() {
  static const MaskedMoments kTable(kMaskTransient);
  return kTable;
}

float MaskedMoments::operator()(float contrast, float deviation) const {
  constexpr float kLeastNormal = 1e-30F;
  if (!(deviation > kLeastNormal)) {
    return 0;
  }
  static const auto kLog2Moment = static_cast<float>(std::log2(absolute_moment(kVisiblePooling)));
  constexpr auto kSteps = static_cast<float>(kStepsPerOctave);
  const float log2_s = log2_fast(deviation);
  const float log2_u = log2_fast(std::max(contrast < 0 ? -contrast : contrast, kLeastNormal));
  const auto place = [](float log2_value, int least, std::size_t count) {
    const float at = (log2_value - static_cast<float>(least)) * kSteps;
    return std::min(std::max(at, 0.0F), static_cast<float>(count - 1));
  };
  const float i = place(log2_u, kLeastLog2U, kContrasts);
  const float j = place(log2_s, kLeastLog2S, kDeviations);
  const auto column = std::min(static_cast<std::size_t>(i), kContrasts - 2);
  const auto row = std::min(static_cast<std::size_t>(j), kDeviations - 2);
  const float fi = i - static_cast<float>(column);
  const float fj = j - static_cast<float>(row);
  const float* at = &log2_left_[row * kContrasts + column];
  const float low = at[0] + fi * (at[1] - at[0]);
  const float high = at[kContrasts] + fi * (at[kContrasts + 1] - at[kContrasts]);
  const float log2_left = low + fj * (high - low);
  return std::min(exp2_fast(log2_left + kLog2Moment + static_cast<float>(kVisiblePooling) * log2_s), kMostMoment);
}

}  // namespace gazetrace
