// SPDX-License-Identifier: Apache-2.0
#include "pipeline/quality/rate_looks.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace gazetrace {
namespace {

constexpr double kTogether = 1.6;       // looks whose rates differ by no more tell of the same rate
constexpr double kTypicalSlope = -0.6;  // until looks that lie apart show it
constexpr double kLeastSpread = 0.2;    // of logarithms of rates: a sum of squares
constexpr double kSteepest = -1.2, kFlattest = -0.2;

bool is_near(const RateLook& look, double rate) {
  return std::abs(look.rate - rate) < std::log(kTogether);
}

}  // namespace

int RateLooks::near(double rate) const {
  return static_cast<int>(
      std::count_if(looks_.begin(), looks_.end(), [&](const RateLook& look) { return is_near(look, rate); }));
}

double RateLooks::seen_at(double rate) const {
  double sum = 0;
  for (const RateLook& look : looks_) {
    sum += is_near(look, last().rate) ? look.seen + slope() * (rate - look.rate) : 0;
  }
  return sum / near(last().rate);
}

double RateLooks::rate_of(double seen) const {
  return last().rate + (seen - seen_at(last().rate)) / slope();
}

double RateLooks::standard_deviation() const {
  const int count = near(last().rate);
  if (count < 2) {
    return 0;
  }
  const double mean = seen_at(last().rate);
  double square = 0;
  for (const RateLook& look : looks_) {
    const double off = look.seen + slope() * (last().rate - look.rate) - mean;
    square += is_near(look, last().rate) ? off * off : 0;
  }
  return std::sqrt(square / (count - 1));
}

double RateLooks::standard_error() const {
  const int count = near(last().rate);
  return count < 2 ? std::numeric_limits<double>::infinity() : standard_deviation() / std::sqrt(count);
}

double RateLooks::slope() const {
  const auto count = static_cast<double>(looks_.size());
  RateLook mean;
  for (const RateLook& look : looks_) {
    mean.rate += look.rate / count;
    mean.seen += look.seen / count;
  }
  double square = 0;
  double product = 0;
  for (const RateLook& look : looks_) {
    square += (look.rate - mean.rate) * (look.rate - mean.rate);
    product += (look.rate - mean.rate) * (look.seen - mean.seen);
  }
  return square < kLeastSpread ? kTypicalSlope : std::clamp(product / square, kSteepest, kFlattest);
}

}  // namespace gazetrace
