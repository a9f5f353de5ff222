// SPDX-License-Identifier: Apache-2.0
// The rate for a stated quality where filters and blocks leave a bias: looked for by rendering windows of the sequence.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include "gazetrace/error.hpp"
#include "gazetrace/fovvideovdp.hpp"
#include "pipeline/adaptive_rates.hpp"
#include "pipeline/clip_rate.hpp"
#include "pipeline/trace_counts.hpp"
#include "pipeline/window_clip.hpp"

namespace gazetrace {
namespace {

constexpr double kFirstSpp = 1, kLeastRateSpp = 0.25;
// Windows of a large frame are dear to look at, a small frame is not.
constexpr int kMostLooks = 8, kMostLooksOfWhole = 16;
// Small frames are looked at until the logarithm of what is seen at the rate has a smaller standard error: about 0.025
// JOD at 9 JOD, half of that at 9.5.
constexpr double kSure = 0.04;
constexpr double kGrowth = 16;  // of the rate from one look to the next
constexpr double kNear = 1.3;   // a change of the rate that needs no further look
// The slope of the logarithm of what is seen over that of the rate, until looks that lie apart show it.
constexpr double kSlope = -0.6;
constexpr double kTogether = 1.6;     // looks whose rates differ by no more tell of the same rate
constexpr double kLeastSpread = 0.2;  // of logarithms of rates: a sum of squares
constexpr double kSteepest = -1.2, kFlattest = -0.2;
constexpr double kFirstReferenceSpp = 128, kMostReferenceSpp = 16384;

// Frames that do not share their rates have a pilot each.
double least_rate(const WindowClip& clip, const FrameSettings& settings, const FrameRequest& request) {
  const bool has_pilots = settings.foveation.falloff == "visible" && !clip.is_steady();
  const double least = std::max(kLeastRateSpp, settings.foveation.min_spp);
  return has_pilots ? std::max(least, 4 * least_pilot_spp(request)) : least;
}

// Logarithms of a rate and of what is seen at it.
struct Look {
  double rate = 0, seen = 0;
};

class Looks {
 public:
  void add(const Look& look) { looks_.push_back(look); }
  [[nodiscard]] const Look& last() const { return looks_.back(); }
  [[nodiscard]] int near(double rate) const {
    return static_cast<int>(
        std::count_if(looks_.begin(), looks_.end(), [&](const Look& l) { return is_near(l, rate); }));
  }

  // By all looks near the last one, which the rate is carried to along the slope: few pixels say little each time.
  [[nodiscard]] double seen_at(double rate) const {
    double sum = 0;
    for (const Look& look : looks_) {
      sum += is_near(look, last().rate) ? look.seen + slope() * (rate - look.rate) : 0;
    }
    return sum / near(last().rate);
  }
  // Of seen_at(), by how the looks near the last one differ.
  [[nodiscard]] double standard_error() const {
    const int count = near(last().rate);
    return count < 2 ? std::numeric_limits<double>::infinity() : standard_deviation() / std::sqrt(count);
  }
  // Of what one look near the last one says; 0 where there are no others.
  [[nodiscard]] double standard_deviation() const {
    const int count = near(last().rate);
    if (count < 2) {
      return 0;
    }
    const double mean = seen_at(last().rate);
    double square = 0;
    for (const Look& look : looks_) {
      const double off = look.seen + slope() * (last().rate - look.rate) - mean;
      square += is_near(look, last().rate) ? off * off : 0;
    }
    return std::sqrt(square / (count - 1));
  }
  [[nodiscard]] double rate_of(double seen) const { return last().rate + (seen - seen_at(last().rate)) / slope(); }

 private:
  static bool is_near(const Look& look, double rate) { return std::abs(look.rate - rate) < std::log(kTogether); }

  // Least squares, where the looks lie apart.
  [[nodiscard]] double slope() const {
    Look mean;
    for (const Look& look : looks_) {
      mean.rate += look.rate / static_cast<double>(looks_.size());
      mean.seen += look.seen / static_cast<double>(looks_.size());
    }
    double square = 0;
    double product = 0;
    for (const Look& look : looks_) {
      square += (look.rate - mean.rate) * (look.rate - mean.rate);
      product += (look.rate - mean.rate) * (look.seen - mean.seen);
    }
    return square < kLeastSpread ? kSlope : std::clamp(product / square, kSteepest, kFlattest);
  }

  std::vector<Look> looks_;
};

// How many looks near the rate it takes at least: what is seen in few pixels differs from time to time.
int wanted_looks(const WindowClip& clip) {
  constexpr double kFew = 40000, kMany = 160000;
  const double pixels = clip.counted_px();
  return pixels < kFew ? 4 : pixels < kMany ? 2 : 1;
}

// As many samples as are likely to make the reference's own error small enough beside what is seen now.
double wanted_reference(const WindowClip& clip, double seen) {
  const double ratio = clip.reference_q() / (kMostOfReference * seen);
  return std::min(kMostReferenceSpp, clip.reference_spp() * std::clamp(1.2 * ratio, 2.0, kGrowth));
}

}  // namespace

ClipRate measured_rate(PathTracer& tracer, const JudgedFrames& judged, const FrameSettings& settings,
                       const ColorPipeline& color) {
  const double target = *settings.foveation.target.jod;
  const double wanted = std::log(fovvideovdp_q(target));
  const double most = settings.foveation.max_spp;
  WindowClip clip(tracer, judged, settings, color);
  const double least = least_rate(clip, settings, judged.runs.front().front());
  const int most_looks = clip.windows().is_whole_frame() ? kMostLooksOfWhole : kMostLooks;
  clip.refine(kFirstReferenceSpp);
  ClipRate result;
  Looks looks;
  for (double spp = std::max(kFirstSpp, least);; spp = result.spp) {
    const WindowPictures pictures = clip.look(spp, static_cast<std::uint64_t>(result.rounds));
    double q = clip.q_of(pictures);
    while (clip.reference_q() > kMostOfReference * q && clip.reference_spp() < kMostReferenceSpp) {
      clip.refine(wanted_reference(clip, q));
      q = clip.q_of(pictures);
    }
    result.reference_share = clip.reference_q() / std::max(q, 1e-12);
    looks.add({std::log(spp), std::log(std::max(q, 1e-12))});
    ++result.rounds;
    const double reach = std::log(kGrowth);
    const double change = std::clamp(looks.rate_of(wanted) - std::log(spp), -reach, reach);
    result.spp = std::max(least, spp * std::exp(change));
    const bool is_near = std::abs(change) < std::log(kNear) || (spp == least && result.spp == least);
    const bool is_sure = !clip.windows().is_whole_frame() || result.spp == least || looks.standard_error() < kSure;
    result.settled = is_near && is_sure && looks.near(std::log(spp)) >= wanted_looks(clip);
    const bool is_last = result.settled || result.rounds == most_looks;
    if (result.rounds == 1 && !is_last) {  // one look says little of what it will take
      result.spp = std::min(result.spp, std::max(most, least));
    }
    if (result.spp > (is_last ? 1 : 2) * most) {
      throw Error(ErrorKind::usage, "`target-jod`",
                  fmt::format("{} JOD would take about {:.3g} samples a pixel, by what {} {} saw; `max-spp` is {:g}",
                              target, result.spp, result.rounds, result.rounds == 1 ? "look" : "looks", most),
                  "ask for less, or raise `max-spp`");
    }
    if (is_last) {
      result.settled = is_near;
      const double seen = looks.seen_at(std::log(result.spp));
      result.predicted_jod = fovvideovdp_jod(std::exp(seen));
      result.scatter_jod = *result.predicted_jod - fovvideovdp_jod(std::exp(seen + looks.standard_deviation()));
      result.looked_at_whole = clip.windows().is_whole_frame();
      break;
    }
  }
  result.is_least = result.spp == least;
  result.reference_spp = clip.reference_spp();
  result.rates = clip.shared_rates(result.spp);
  result.how = fmt::format("{} looks at {}, beside {:.0f} samples a pixel", result.rounds,
                           clip.windows().is_whole_frame()
                               ? "whole frames"
                               : fmt::format("{} windows, {:.1f} % of the frame", clip.windows().windows.size(),
                                             100 * clip.share_of_frame()),
                           clip.reference_spp());
  add_traces(clip.stats(), result.pilot);
  return result;
}

}  // namespace gazetrace
