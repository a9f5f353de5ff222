// SPDX-License-Identifier: Apache-2.0
// The rate for a stated quality where filters and blocks leave a bias: looked for by rendering windows of the sequence.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "gazetrace/error.hpp"
#include "gazetrace/fovvideovdp.hpp"
#include "pipeline/adaptive_rates.hpp"
#include "pipeline/clip_rate.hpp"
#include "pipeline/trace_counts.hpp"
#include "pipeline/window_clip.hpp"

namespace gazetrace {
namespace {

constexpr double kFirstSpp = 1, kLeastSpp = 0.25;
constexpr int kMostLooks = 6;
constexpr double kGrowth = 16;    // of the rate from one look to the next
constexpr double kNear = 1.3;     // a change of the rate that needs no further look
constexpr double kSlope = -0.6;   // of the logarithm of what is seen over that of the rate, until two looks show it
constexpr double kSteepest = -1.2, kFlattest = -0.2;
constexpr double kFirstReferenceSpp = 32, kMostReferenceSpp = 16384;
// What may be seen of the reference's own error beside that of the frames. It is taken off.
constexpr double kMostOfReference = 0.5;

// Frames that do not share their rates have a pilot each.
double least_rate(const WindowClip& clip, const FrameSettings& settings, const FrameRequest& request) {
  const bool has_pilots = settings.foveation.falloff == "visible" && !clip.is_steady();
  const double least = std::max(kLeastSpp, settings.foveation.min_spp);
  return has_pilots ? std::max(least, 4 * least_pilot_spp(request)) : least;
}

// Logarithms of a rate and of what is seen at it.
struct Look {
  double rate = 0, seen = 0;
};

double slope_between(const Look& a, const Look& b) {
  return a.rate == b.rate ? kSlope : std::clamp((b.seen - a.seen) / (b.rate - a.rate), kSteepest, kFlattest);
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
  clip.refine(kFirstReferenceSpp);
  ClipRate result;
  Look last;
  double slope = kSlope;
  for (double spp = std::max(kFirstSpp, least);; spp = result.spp) {
    const WindowPictures pictures = clip.look(spp, static_cast<std::uint64_t>(result.rounds));
    double q = clip.q_of(pictures);
    while (clip.reference_q() > kMostOfReference * q && clip.reference_spp() < kMostReferenceSpp) {
      clip.refine(wanted_reference(clip, q));
      q = clip.q_of(pictures);
    }
    const Look look{std::log(spp), std::log(std::max(q, 1e-12))};
    slope = result.rounds == 0 ? kSlope : slope_between(last, look);
    last = look;
    ++result.rounds;
    const double reach = std::log(kGrowth);
    const double change = std::clamp((wanted - look.seen) / slope, -reach, reach);
    result.spp = std::max(least, spp * std::exp(change));
    result.settled = std::abs(change) < std::log(kNear) || (spp == least && result.spp == least);
    if (result.spp > 2 * most || (result.settled && result.spp > most)) {
      throw Error(ErrorKind::usage, "`target-jod`",
                  fmt::format("{} JOD would take about {:.3g} samples a pixel, by {} looks at windows of the frames; "
                              "`max-spp` is {:g}",
                              target, result.spp, result.rounds, most),
                  "ask for less, or raise `max-spp`");
    }
    if (result.settled || result.rounds == kMostLooks) {
      const double at = std::log(result.spp) - look.rate;
      result.predicted_jod = fovvideovdp_jod(std::exp(look.seen + slope * at));
      break;
    }
  }
  result.is_least = result.spp == least;
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
