// SPDX-License-Identifier: Apache-2.0
#include "metrics/flip_kernels.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "gazetrace/math.hpp"

namespace gazetrace {
namespace {

// sqrt(a sqrt(pi / b)) exp(-pi^2 x^2 / b) at x in degrees: its product along x and y is one Gaussian of the paper's
// equation 3.
std::vector<double> csf_kernel(double a, double b, int radius_px, double pixels_per_degree) {
  std::vector<double> kernel;
  for (int i = -radius_px; i <= radius_px; ++i) {
    const double x_deg = i / pixels_per_degree;
    kernel.push_back(std::sqrt(a * std::sqrt(kPi / b)) * std::exp(-kPi * kPi * x_deg * x_deg / b));
  }
  return kernel;
}

double sum_of(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0);
}

std::vector<float> scaled(const std::vector<double>& values, double factor) {
  std::vector<float> result;
  for (const double value : values) {
    result.push_back(static_cast<float>(value * factor));
  }
  return result;
}

// Positive weights add up to 1 and negative ones to -1.
std::vector<float> balanced(const std::vector<double>& values) {
  double positive = 0;
  double negative = 0;
  for (const double value : values) {
    (value > 0 ? positive : negative) += std::fabs(value);
  }
  std::vector<float> result;
  for (const double value : values) {
    result.push_back(static_cast<float>(value / (value > 0 ? positive : negative)));
  }
  return result;
}

}  // namespace

FlipKernels make_flip_kernels(double pixels_per_degree) {
  constexpr double kWidestB = 0.04;      // of the blue-yellow channel, in deg^2
  constexpr double kFeatureDeg = 0.082;  // width of the detectors
  FlipKernels kernels;
  const int csf_radius = static_cast<int>(std::ceil(3 * std::sqrt(kWidestB / (2 * kPi * kPi)) * pixels_per_degree));
  kernels.csf_radius_px = csf_radius;
  const std::vector<double> achromatic = csf_kernel(1, 0.0047, csf_radius, pixels_per_degree);
  const std::vector<double> red_green = csf_kernel(1, 0.0053, csf_radius, pixels_per_degree);
  const std::vector<double> blue_yellow_1 = csf_kernel(34.1, 0.04, csf_radius, pixels_per_degree);
  const std::vector<double> blue_yellow_2 = csf_kernel(13.5, 0.025, csf_radius, pixels_per_degree);
  kernels.achromatic = scaled(achromatic, 1 / sum_of(achromatic));
  kernels.red_green = scaled(red_green, 1 / sum_of(red_green));
  const double both = 1 / std::hypot(sum_of(blue_yellow_1), sum_of(blue_yellow_2));
  kernels.blue_yellow_1 = scaled(blue_yellow_1, both);
  kernels.blue_yellow_2 = scaled(blue_yellow_2, both);

  // Kernels of three pixels, once balanced, do not depend on sigma; below this one their outer weights would underflow.
  constexpr double kLeastSigmaPx = 0.03;
  const double sigma_px = std::max(0.5 * kFeatureDeg * pixels_per_degree, kLeastSigmaPx);
  const int feature_radius = static_cast<int>(std::ceil(3 * sigma_px));
  kernels.feature_radius_px = feature_radius;
  std::vector<double> gaussian;
  std::vector<double> edge;
  std::vector<double> point;
  for (int k = -feature_radius; k <= feature_radius; ++k) {
    const double g = std::exp(-k * k / (2 * sigma_px * sigma_px));
    gaussian.push_back(g);
    edge.push_back(-k * g);
    point.push_back((k * k / (sigma_px * sigma_px) - 1) * g);
  }
  kernels.gaussian = scaled(gaussian, 1 / sum_of(gaussian));
  kernels.edge = balanced(edge);
  kernels.point = balanced(point);
  return kernels;
}

}  // namespace gazetrace
