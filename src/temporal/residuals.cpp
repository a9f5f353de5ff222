// SPDX-License-Identifier: Apache-2.0
#include "temporal/residuals.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace gazetrace {
namespace {

constexpr int kResidualReach = 2;  // the neighborhood is 5x5 pixels
// Residuals count as a bias where they exceed what noise does by chance by so many standard deviations: kLasting in the
// product of two frames, kBeyondStated against the stated variance. kCaution weights a bias above its mean over the
// neighborhood, since pixels differ. All three are measured: fewer deviations take away more of what was gathered (with
// none three quarters), and more deviations or less caution blur texture.
constexpr double kLasting = 1.5;
constexpr double kBeyondStated = 2.5;
constexpr double kCaution = 4;

}  // namespace

double Residuals::share_kept(const SurfaceMotion& motion, double count, double past_count, int x, int y) const {
  // A single sample says nothing of its own variance: the deviations below divide by count - 1. Nor is anything known
  // against a past without samples.
  if (!(count > 1) || !(past_count > 0)) {
    return 1;
  }
  const std::uint32_t object = motion.object(x, y);
  double squares = 0;
  double squares_before = 0;
  double products = 0;
  double variance = 0;
  int taps = 0;
  for (int j = std::max(y - kResidualReach, 0); j <= std::min(y + kResidualReach, now.height_px - 1); ++j) {
    for (int i = std::max(x - kResidualReach, 0); i <= std::min(x + kResidualReach, now.width_px - 1); ++i) {
      if ((i != x || j != y) && motion.object(i, j) == object) {
        const auto a = static_cast<double>(now(i, j));
        const auto b = static_cast<double>(before(i, j));
        squares += a * a;
        squares_before += b * b;
        products += a * b;
        variance += static_cast<double>(noise(i, j));
        ++taps;
      }
    }
  }
  if (taps == 0) {
    return 1;
  }
  // Standard deviations by chance, for normal noise: the first is that of a sum of products. The second, relative to
  // its mean, is that of a sum of squares; it includes that of the stated variance, which grows as samples get fewer.
  const double of_products = std::sqrt(squares * squares_before / taps);
  const double of_squares = std::sqrt(2.0 / taps * count / (count - 1));
  const double stated = variance * (1 + count / past_count);
  const double bias = std::min(
      std::max(products - kLasting * of_products, squares - stated * (1 + kBeyondStated * of_squares)), squares);
  if (!(bias > 0)) {
    return 1;
  }
  const double apart = 0.5 * (squares + squares_before) - products;  // half of the squared difference of the two
  const double ratio = bias / std::max(std::min(variance, apart), 1e-12 * bias);
  return 1 / (1 + kCaution * past_count / count * ratio * (1 + ratio));
}

}  // namespace gazetrace
