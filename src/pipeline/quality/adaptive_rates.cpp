// SPDX-License-Identifier: Apache-2.0
#include "pipeline/quality/adaptive_rates.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <utility>
#include <vector>

#include "core/statistics.hpp"
#include "gazetrace/error.hpp"
#include "pipeline/quality/visible_noise.hpp"
#include "pipeline/trace_counts.hpp"

namespace gazetrace {
namespace {

// A first pilot takes about this part of a budget, within these bounds of samples a pixel (of the pilot).
constexpr double kFirstShare = 0.04;
constexpr double kLeastFirst = 2, kMostFirst = 64;
// Further pilots take at most this part of the frame's samples, unless that would be less than kLeastRound a pixel. In
// frames of 512 rows and more they take a sixty-fourth; only small frames have pilots that are large beside them.
constexpr double kRoundShare = 1.0 / 32;
constexpr double kLeastRound = 4;
// On a budget a second pilot is left out where it would take more than this part.
constexpr double kMostSecond = 0.1;
constexpr double kMostOfRest = 0.25;  // nor where it would take more than this part of what the first one left
constexpr double kFirstForTarget = 16;
constexpr int kMostRounds = 3;        // after the first
constexpr double kCloseEnough = 1.1;  // a change of the rate that needs no further round
constexpr double kMostGrowth = 16;    // of the rate from one round to the next
constexpr double kDefensiveShare = 0.25;
constexpr double kLeastRate = 1e-3;  // samples a pixel: below, nothing can be extrapolated

// Samples a pixel, the pilot's among them.
double budget_spp_of(const FoveationSettings& foveation) {
  return foveation.spp.value_or(kUsualSpp);
}

// Of the first pilot on a budget, in samples a pixel of its own.
double first_pilot_spp(double spp, double cell_px) {
  return std::clamp(std::round(kFirstShare * spp * cell_px * cell_px), kLeastFirst, kMostFirst);
}

ImageGray clamped(const ImageGray& wanted, double scale, double least, double most) {
  ImageGray rates = wanted;
  for (float& value : rates.pixels) {
    value = static_cast<float>(std::clamp(scale * static_cast<double>(value), least, most));
  }
  return rates;
}

// Of light that a pilot missed altogether it says nothing: no rate is below a share of the mean.
ImageGray defended(ImageGray wanted) {
  const auto least = static_cast<float>(kDefensiveShare * mean_of(wanted));
  for (float& value : wanted.pixels) {
    value = std::max(value, least);
  }
  return wanted;
}

class RateFinder {
 public:
  RateFinder(const PosedScene& scene, const FrameRequest& request, const FrameSettings& settings)
      : scene_(scene), request_(request), settings_(settings), noise_(request, settings) {}

  AdaptiveRates find() {
    const QualityTarget& target = settings_.foveation.target;
    if (target.relmse) {
      meet_target();
    } else {
      check_pilot_budget(settings_.foveation, request_);
      spend(budget_spp_of(settings_.foveation));
    }
    result_.spp = mean_of(result_.rates);
    return std::move(result_);
  }

 private:
  void look(const ImageGray& rates) {
    Pilot pilot = trace_pilot(scene_, request_, settings_, rates, static_cast<std::uint64_t>(result_.rounds));
    ++result_.rounds;
    add_traces(pilot.stats, result_.pilot);
    noise_.learn(std::move(pilot));
  }
  // At `rates`, or in proportion to them. As many samples a pixel as the frame would be the best to learn from.
  [[nodiscard]] double share_of_round() const {
    const double cell = pilot_cell_px(request_);
    return std::clamp(std::max(kRoundShare * cell * cell, kLeastRound / mean_of(result_.rates)), 0.0, 1.0);
  }
  void look_again() { look(clamped(result_.rates, share_of_round(), 0, settings_.foveation.max_spp)); }
  void look(double spp) { look(ImageGray(1, 1, static_cast<float>(spp))); }

  // A frame whose error is measured by its relative square is given the best rates for that.
  [[nodiscard]] ImageGray wanted_rates() const {
    return defended(settings_.foveation.target.relmse ? noise_.wanted_for_relmse() : noise_.wanted_by_eye());
  }

  [[nodiscard]] double pilot_spp() const { return static_cast<double>(result_.pilot.samples) / pixels_of(request_); }

  void set_rates(double spp) {
    const FoveationSettings& foveation = settings_.foveation;
    result_.rates = rates_between(wanted_rates(), spp, foveation.min_spp, foveation.max_spp);
  }

  // A second pilot looks at the frame at the rates that the first one asks for.
  void spend(double spp) {
    const double cell = pilot_cell_px(request_);
    look(first_pilot_spp(spp, cell));
    set_rates(spp - pilot_spp());
    // One of too few samples would tell less than the first, and one that is large beside what is left leaves no frame.
    const double second = share_of_round() * mean_of(result_.rates);
    const double most = std::min(kMostSecond * spp, kMostOfRest * (spp - pilot_spp())) * cell * cell;
    if (second >= 0.999 * kLeastRound && second < most) {
      look_again();
      set_rates(spp - pilot_spp());
    }
    predict();
  }

  void predict() { result_.prediction.relmse = noise_.relmse_at(result_.rates); }

  // How far the frame is from the target at these rates: 1 where it is met, more where it is noisier. About a power of
  // the rate.
  [[nodiscard]] double excess_at(const ImageGray& rates) const {
    return noise_.relmse_at(rates) / *settings_.foveation.target.relmse;
  }

  // Each round looks at the frame at the rates that the one before asks for. So the filter's gain is seen where it will
  // be, and only what is left of a change in the rate is extrapolated, as if the error fell with 1 / n.
  void meet_target() {
    look(kFirstForTarget);
    double before = kFirstForTarget;
    for (int round = 0;; ++round) {
      find_rates(before);
      const double spp = mean_of(result_.rates);
      const double change = spp / before;
      if (round == kMostRounds || (round > 0 && change < kCloseEnough && change > 1 / kCloseEnough)) {
        predict();
        return;
      }
      look_again();
      before = spp;
    }
  }

  // The rates at which the target is met, or that are kMostGrowth times as many as before, or as few: by secants in the
  // logarithms of rate and excess.
  void find_rates(double before) {
    constexpr int kMostSteps = 12;
    constexpr double kTolerance = 0.004;
    const FoveationSettings& foveation = settings_.foveation;
    ImageGray wanted = wanted_rates();
    if (!(mean_of(wanted) > 0)) {
      wanted = ImageGray(wanted.width_px, wanted.height_px, 1);  // nothing is noisy, as in a black frame
    }
    const double start = std::log(before / std::max(mean_of(wanted), 1e-30));
    const double reach = std::log(kMostGrowth);
    double at = start;
    double slope = 1;
    double last_at = 0;
    double last_excess = 0;
    for (int step = 0; step < kMostSteps; ++step) {
      result_.rates = clamped(wanted, std::exp(at), std::max(foveation.min_spp, kLeastRate), foveation.max_spp);
      const double excess = std::log(std::max(excess_at(result_.rates), 1e-12));
      if (step > 0 && at != last_at) {
        slope = std::clamp((last_excess - excess) / (at - last_at), 0.3, 3.0);
      }
      last_at = at;
      last_excess = excess;
      const double next = std::clamp(at + excess / slope, start - reach, start + reach);
      if (std::abs(excess) < kTolerance || next == at) {
        return;
      }
      at = next;
    }
  }

  const PosedScene& scene_;
  const FrameRequest& request_;
  const FrameSettings& settings_;
  VisibleNoise noise_;
  AdaptiveRates result_;
};

}  // namespace

ImageGray rates_between(const ImageGray& wanted, double spp, double least, double most) {
  least = std::min(least, spp);
  most = std::max(most, spp);
  if (!(mean_of(wanted) > 0)) {
    return ImageGray(wanted.width_px, wanted.height_px, static_cast<float>(spp));
  }
  // The mean grows with the scale, from `least` to `most`.
  double low = 0;
  double high = spp / mean_of(wanted);
  for (int step = 0; step < 200 && mean_of(clamped(wanted, high, least, most)) < spp; ++step) {
    low = high;
    high *= 2;
  }
  for (int step = 0; step < 50; ++step) {
    const double middle = 0.5 * (low + high);
    (mean_of(clamped(wanted, middle, least, most)) < spp ? low : high) = middle;
  }
  return clamped(wanted, high, least, most);
}

void check_pilot_budget(const FoveationSettings& settings, const FrameRequest& request) {
  const double spp = budget_spp_of(settings);
  const int cell_px = pilot_cell_px(request);
  const PlanarView view = pilot_view(request, cell_px);
  const double pilot = first_pilot_spp(spp, cell_px) * view.width_px * view.height_px;
  if (!(pilot < spp * pixels_of(request))) {
    throw Error(
        ErrorKind::usage, "`spp`",
        fmt::format(
            "the pilot of `sampling` adaptive takes {:.0f} samples of a frame of {} x {} pixels, and it may have "
            "{:.0f}",
            pilot, request.width_px, request.height_px, spp * pixels_of(request)),
        "give more");
  }
}

double least_pilot_spp(const FrameRequest& request) {
  const double cell_px = pilot_cell_px(request);
  return kLeastFirst / (cell_px * cell_px);
}

AdaptiveRates adaptive_rates(const PosedScene& scene, const FrameRequest& request, const FrameSettings& settings) {
  return RateFinder(scene, request, settings).find();
}

}  // namespace gazetrace
