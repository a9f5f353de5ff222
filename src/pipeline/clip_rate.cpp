// SPDX-License-Identifier: Apache-2.0
#include "pipeline/clip_rate.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>

#include "gazetrace/error.hpp"
#include "gazetrace/fovvideovdp.hpp"
#include "pipeline/replica_clip.hpp"
#include "pipeline/replica_noise.hpp"
#include "pipeline/trace_counts.hpp"

namespace gazetrace {
namespace {

constexpr double kFirstSpp = 1;
constexpr int kMostClipRounds = 6;
// From one round to the next the rate grows by no more than this factor: what is brighter than a display in a pilot
// says little of pictures with many more samples.
constexpr double kGrowthOfRound = 32;
constexpr double kLeastShare = 1e-6, kMostShare = 64;  // of the pilot's squared error, between which is searched

// What is looked at before a rate is chosen, in parts of the rate.
struct PilotParts {
  // The last pilot has `best` of the rate that it asks for, or between `least` and `most` of it. A replica takes four
  // renderings. At less the prediction drifts, since samples of a sequence are better than independent ones.
  double least = 0, best = 0, most = 0;
  // What stands for the reference goes through `guided`, with so much of the rate, or so many samples a pixel. Without
  // accumulation it then has less noise than the frames. Beside frames that are added up it may have more, which makes
  // the replica a little harder to see.
  double base = 0, least_base_spp = 0;
};

// Where frames are added up, a pilot of one frame is small beside all that are traced, and may look closer. It must:
// the error of such a picture stands still, so that no mean over time makes up for what a pilot has missed.
PilotParts pilot_parts(const AccumulateSettings& accumulate) {
  return accumulate.mode == AccumulateMode::two_sided ? PilotParts{1.0 / 5, 1.0 / 3, 1.0 / 1.5, 0.5, 8}
                                                      : PilotParts{1.0 / 7, 1.0 / 4, 1.0 / 2.5, 0.5, 16};
}

// What is seen of an error, and how much of it may be: Q of FovVideoVDP, or FLIP.
struct Judge {
  double wanted = 0;
  double typical_slope = 0;  // of its logarithm over that of the squared error
  std::function<double(const ReplicaNoise& noise, double share)> seen;
};

Judge judge_of(const QualityTarget& target, const ReplicaClip& clip) {
  if (target.jod) {
    return {fovvideovdp_q(*target.jod), 0.9,
            [&clip](const ReplicaNoise& noise, double share) { return clip.q_at(noise, share); }};
  }
  return {*target.flip, 0.4, [&clip](const ReplicaNoise& noise, double share) { return clip.flip_at(noise, share); }};
}

// Frames that are added up have a sample in every pixel, since the replica is one of single pixels.
double least_spp(const FrameSettings& settings) {
  const double least = settings.accumulate.mode == AccumulateMode::two_sided ? 1 : 0.25;
  return std::max(least, settings.foveation.min_spp);
}

std::string counted(int number, const char* what) {
  return fmt::format("{} {}{}", number, what, number == 1 ? "" : "s");
}

// As a whole number, no more than are worth their time.
int divisions(double ratio_of_samples) {
  constexpr double kMost = 32;
  return static_cast<int>(std::clamp(ratio_of_samples, 1.0, kMost));
}

// What was seen of an error, and how it grows near that: both in logarithms, of what is seen over the squared error's
// share of the pilot's.
struct Seen {
  double share = 0, seen = 0;  // logarithms
  double slope = 0;

  [[nodiscard]] double at(double log_share) const { return seen + slope * (log_share - share); }
  [[nodiscard]] double share_of(double wanted) const { return share + (wanted - seen) / slope; }
};

// Near the share that leaves what is wanted, within a factor of about 1 + `tolerance` of that: by secants, since what
// is seen is about a power of the error. `guess` is a share to begin with.
Seen look_near(const Judge& judge, const ReplicaNoise& noise, double guess, double tolerance) {
  constexpr int kMostSteps = 8;
  const double wanted = std::log(judge.wanted);
  const auto seen_at = [&](double x) { return std::log(std::max(judge.seen(noise, std::exp(x)), 1e-12)); };
  Seen seen{std::log(guess), seen_at(std::log(guess)), judge.typical_slope};
  for (int step = 0; step < kMostSteps && std::abs(seen.seen - wanted) > tolerance; ++step) {
    const double next = std::clamp(seen.share_of(wanted), std::log(kLeastShare), std::log(kMostShare));
    if (next == seen.share) {
      break;
    }
    const double seen_next = seen_at(next);
    seen = {next, seen_next, std::clamp((seen_next - seen.seen) / (next - seen.share), 0.1, 3.0)};
  }
  return seen;
}

}  // namespace

bool is_noise_alone(const FrameSettings& settings) {
  const std::string& filter = settings.reconstruction.filter;
  return settings.foveation.falloff == "uniform" && (filter == "none" || filter == "linear");
}

std::string ClipRate::text() const {
  return fmt::format("{:.6g} samples a pixel{}, expected to reach {}: by {}{}", spp,
                     is_least ? ", the least there is" : "",
                     predicted_jod    ? fmt::format("{:.3f} JOD", *predicted_jod)
                     : predicted_flip ? fmt::format("a mean FLIP of {:.4g}", *predicted_flip)
                                      : "nothing",
                     how, scatter_jod > 0 ? fmt::format("; looks differ by {:.3f} JOD", scatter_jod) : "");
}

// Of pixels of a few samples, what FLIP sees was off by up to 28 % of what was stated; from 30 samples on by 5 %.
std::vector<std::string> ClipRate::doubts() const {
  constexpr double kKnownToHold = 16;
  std::vector<std::string> doubts;
  if (!settled) {
    doubts.push_back(
        fmt::format("the rate for a stated quality did not settle in {} rounds: at {:.3g} samples a pixel the sequence "
                    "may be worse or better than stated",
                    rounds, spp));
  }
  if (reference_share > kMostOfReference) {
    doubts.push_back(fmt::format(
        "`target-jod`: what the sequence was judged by, {:.0f} samples a pixel on average, is still seen to be noisy: "
        "the sequence may be worse than stated",
        reference_spp));
  }
  if (looked_at_whole && scatter_jod > kMostScatterJod) {
    doubts.push_back(fmt::format(
        "`target-jod`: what is seen of these frames differs by {:.2f} JOD (one standard deviation) from one "
        "rendering to the next: the score of a still misses what was stated by about as much, that of a sequence by up "
        "to that; larger frames differ less",
        scatter_jod));
  }
  if (predicted_flip && spp * summed_frames < kKnownToHold) {
    doubts.push_back(
        fmt::format("`target-flip`: at {:.3g} samples a pixel the prediction may be off by a third of it", spp));
  }
  return doubts;
}

ClipRate clip_rate(PathTracer& tracer, const JudgedFrames& judged, const FrameSettings& settings,
                   const ColorPipeline& color) {
  constexpr double kRoughly = 0.1, kClosely = 0.01;
  const QualityTarget& target = settings.foveation.target;
  const double most = settings.foveation.max_spp;
  const PilotParts parts = pilot_parts(settings.accumulate);
  const FrameRequest& first = judged.runs.front().front();
  const double least = least_spp(settings);
  ReplicaClip clip(tracer, judged, settings, color);
  const Judge judge = judge_of(target, clip);
  ClipRate result;
  double pilot_spp = std::max(kFirstSpp, least);
  for (bool near = false; !near; pilot_spp = std::max(least, parts.best * result.spp)) {
    const auto round = static_cast<std::uint64_t>(result.rounds);
    clip.look(std::max(parts.least_base_spp, parts.base * result.spp), round);
    ReplicaNoise noise(tracer, first, settings, pilot_spp, round);
    const double guess = result.rounds == 0 ? 1 : pilot_spp / result.spp;
    noise.divide(divisions(clip.most_summed() / (ReplicaNoise::kRenderings * guess)));
    ++result.rounds;
    result.frames += ReplicaNoise::kRenderings;
    add_traces(noise.stats(), result.pilot);
    // The first pilot is far from the rate, and only has to lead to the next one.
    const bool is_first = result.rounds == 1;
    const Seen seen = look_near(judge, noise, guess, is_first ? kRoughly : kClosely);
    const double share = std::exp(seen.share_of(std::log(judge.wanted)));
    const bool is_last = result.rounds == kMostClipRounds;
    const double reach = is_last ? std::numeric_limits<double>::max() : kGrowthOfRound * pilot_spp;
    result.spp = std::clamp(pilot_spp / share, least, std::max(least, reach));
    const double part = pilot_spp / result.spp;
    result.settled = part >= parts.least && (part <= parts.most || pilot_spp == least);
    near = result.settled || is_last;
    // A first guess may be too high.
    if (!(result.spp <= (near ? 1 : 2) * most)) {
      throw Error(ErrorKind::usage, target.jod ? "`target-jod`" : "`target-flip`",
                  fmt::format("{}{} would take {}{:.3g} samples a pixel, by what {} of pilots saw; `max-spp` is {:g}",
                              target.jod ? *target.jod : *target.flip, target.jod ? " JOD" : "",
                              pilot_spp / share > result.spp ? "more than " : "", result.spp,
                              counted(result.rounds, "round"), most),
                  result.spp > least ? "ask for less, or raise `max-spp`" : "raise `max-spp`: fewer are not possible");
    }
    if (near) {
      const double expected = std::exp(seen.at(std::log(part)));
      if (target.jod) {
        result.predicted_jod = fovvideovdp_jod(expected);
      } else {
        result.predicted_flip = expected;
      }
    }
  }
  result.is_least = result.spp == least;
  result.summed_frames = clip.most_summed();
  result.frames += clip.looks();
  result.how =
      fmt::format("{}, {} of frames in all", counted(result.rounds, "pilot"), counted(result.frames, "rendering"));
  add_traces(clip.stats(), result.pilot);
  return result;
}

}  // namespace gazetrace
