// SPDX-License-Identifier: Apache-2.0
#include "pipeline/quality/clip_rate.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "core/stopwatch.hpp"
#include "gazetrace/error.hpp"
#include "gazetrace/fovvideovdp.hpp"
#include "pipeline/quality/adaptive_rates.hpp"
#include "pipeline/quality/rate_looks.hpp"
#include "pipeline/quality/window_clip.hpp"
#include "pipeline/timing_row.hpp"
#include "pipeline/trace_counts.hpp"

namespace gazetrace {
namespace {

constexpr double kFirstSpp = 1, kLeastRateSpp = 0.25;
// Many pixels are dear to look at, few are not.
constexpr int kMostLooks = 8, kMostLooksOfFew = 16;
// Few pixels are looked at until the logarithm of what is seen at the rate has a smaller standard error: about 0.025
// JOD at 9 JOD, half of that at 9.5.
constexpr double kSure = 0.04;
constexpr double kGrowth = 16;  // of the rate from one look to the next
constexpr double kNear = 1.3;   // a change of the rate that needs no further look
// If the rate that would do is so many times lower than the least there is, no further look at that one is needed.
constexpr double kClearly = 2;
constexpr double kFirstReferenceSpp = 128, kMostReferenceSpp = 16384;

// Frames that do not share their rates have a pilot each.
double least_rate(const WindowClip& clip, const FrameSettings& settings, const FrameRequest& request) {
  const bool has_pilots = looks_first(settings.foveation.sampling) && !clip.is_steady();
  const double least = std::max(kLeastRateSpp, settings.foveation.min_spp);
  return has_pilots ? std::max(least, 4 * least_pilot_spp(request)) : least;
}

// What is seen in few pixels differs from time to time. Small frames, which are looked at as a whole, take no part of
// the time that is worth saving, and are looked at until that is known.
struct LooksWanted {
  int least = 1, most = kMostLooks;  // near the rate, and in all
  bool until_sure = false;           // until kSure
};

LooksWanted wanted_looks(const WindowClip& clip) {
  constexpr double kFew = 40000, kMany = 160000;
  const double pixels = clip.counted_px();
  const int least = pixels < kFew ? 4 : pixels < kMany ? 2 : 1;
  return clip.windows().is_whole_frame() && pixels < kMany ? LooksWanted{least, kMostLooksOfFew, true}
                                                           : LooksWanted{least, kMostLooks, false};
}

// As many samples as are likely to make the reference's own error small enough beside what is seen now.
double wanted_reference(const WindowClip& clip, double seen) {
  const double ratio = clip.reference_q() / (kMostOfReference * seen);
  return std::min(kMostReferenceSpp, clip.reference_spp() * std::clamp(1.2 * ratio, 2.0, kGrowth));
}

}  // namespace

std::string ClipRate::text() const {
  return fmt::format(
      "{:.6g} samples a pixel{}, expected to reach {:.3f} JOD: by {} probe render{} of {}, beside {:.0f} samples a "
      "pixel on average{}",
      spp, is_least ? ", the least there is" : "", predicted_jod, looks, looks == 1 ? "" : "s", looked_at,
      reference_spp, scatter_jod > 0 ? fmt::format("; probe renders differ by {:.3f} JOD", scatter_jod) : "");
}

std::vector<std::string> ClipRate::doubts() const {
  std::vector<std::string> doubts;
  if (!settled) {
    doubts.push_back(fmt::format(
        "the rate for a stated quality did not settle in {} probe renders: at {:.3g} samples a pixel the sequence "
        "may be worse or better than stated",
        looks, spp));
  }
  if (reference_share > kMostOfReference) {
    doubts.push_back(fmt::format(
        "`target-jod`: the reference of the probe renders, {:.0f} samples a pixel on average, is still visibly noisy: "
        "the sequence may be worse than stated",
        reference_spp));
  }
  if (looked_at_whole && scatter_jod > kMostScatterJod) {
    doubts.push_back(fmt::format(
        "`target-jod`: scores of these frames differ by {:.2f} JOD (one standard deviation) from one "
        "rendering to the next: a still misses the stated score by about as much, a sequence by up to that; larger "
        "frames differ less",
        scatter_jod));
  }
  return doubts;
}

ClipRate clip_rate(PathTracer& tracer, const JudgedFrames& judged, const FrameSettings& settings,
                   const ColorPipeline& color) {
  const Stopwatch watch;
  const double target = *settings.foveation.target.jod;
  const double wanted = std::log(fovvideovdp_q(target));
  const double most = settings.foveation.max_spp;
  WindowClip clip(tracer, judged, settings, color);
  const double least = least_rate(clip, settings, judged.runs.front().front());
  const LooksWanted looks_wanted = wanted_looks(clip);
  clip.refine(kFirstReferenceSpp);
  ClipRate result;
  RateLooks looks;
  for (double spp = std::max(kFirstSpp, least);; spp = result.spp) {
    const WindowPictures pictures = clip.look(spp, static_cast<std::uint64_t>(result.looks));
    double q = clip.q_of(pictures);
    while (clip.reference_q() > kMostOfReference * q && clip.reference_spp() < kMostReferenceSpp) {
      clip.refine(wanted_reference(clip, q));
      q = clip.q_of(pictures);
    }
    result.reference_share = clip.reference_q() / std::max(q, 1e-12);
    looks.add({std::log(spp), std::log(std::max(q, 1e-12))});
    ++result.looks;
    const double reach = std::log(kGrowth);
    const double change = std::clamp(looks.rate_of(wanted) - std::log(spp), -reach, reach);
    result.spp = std::max(least, spp * std::exp(change));
    const bool stays_least = spp == least && result.spp == least;
    const bool is_near = stays_least || std::abs(change) < std::log(kNear);
    const bool is_sure = !looks_wanted.until_sure || stays_least || looks.standard_error() < kSure;
    const bool is_plenty = stays_least && looks.rate_of(wanted) < std::log(least / kClearly);
    result.settled = is_plenty || (is_near && is_sure && looks.near(std::log(spp)) >= looks_wanted.least);
    const bool is_last = result.settled || result.looks == looks_wanted.most;
    if (result.looks == 1 && !is_last) {  // one look says little of what it will take
      result.spp = std::min(result.spp, std::max(most, least));
    }
    if (result.spp > (is_last ? 1 : 2) * most) {
      throw Error(ErrorKind::usage, "`target-jod`",
                  fmt::format("{} JOD would take about {:.3g} samples a pixel, by {} probe {}; `max-spp` is {:g}",
                              target, result.spp, result.looks, result.looks == 1 ? "render" : "renders", most),
                  result.spp > least ? "ask for less, or raise `max-spp`" : "raise `max-spp`: fewer are not possible");
    }
    if (is_last) {
      result.settled = is_near;
      const double seen = looks.seen_at(std::log(result.spp));
      result.predicted_jod = fovvideovdp_jod(std::exp(seen));
      const double deviation = std::sqrt(static_cast<double>(clip.stills_a_look())) * looks.standard_deviation();
      result.scatter_jod = result.predicted_jod - fovvideovdp_jod(std::exp(seen + deviation));
      result.looked_at_whole = clip.windows().is_whole_frame();
      break;
    }
  }
  result.is_least = result.spp == least;
  result.reference_spp = clip.reference_spp();
  result.rates = clip.shared_rates(result.spp);
  result.looked_at = result.looked_at_whole ? "whole frames"
                                            : fmt::format("{} windows, {:.1f} % of the frame",
                                                          clip.windows().windows.size(), 100 * clip.share_of_frame());
  add_traces(clip.stats(), result.discarded);
  result.ms = watch.elapsed_ms();
  return result;
}

FrameSettings with_rate(FrameSettings settings, const ClipRate& rate) {
  settings.foveation.target = {};
  settings.foveation.spp = rate.spp;
  if (!rate.rates.empty()) {
    settings.rates_of = [rates = rate.rates](const FrameRequest&) { return FrameRates{rates, 0}; };
  }
  return settings;
}

void add_rate(const ClipRate& rate, bool is_first, TimingRow& row) {
  add_prediction({{}, rate.predicted_jod}, row);
  if (!is_first) {
    return;
  }
  TraceStats discarded = rate.discarded;
  discarded.training_paths = 0;  // whose time is in pilot_ms with all that the choice took
  add_pilot(discarded, row);
  row.pilot_ms += rate.ms;
  row.total_ms += rate.ms;
}

}  // namespace gazetrace
