// SPDX-License-Identifier: Apache-2.0
#include "pipeline/clip_rate.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>

#include "gazetrace/error.hpp"
#include "gazetrace/fovvideovdp.hpp"
#include "pipeline/replica_clip.hpp"
#include "pipeline/replica_noise.hpp"
#include "pipeline/trace_counts.hpp"

namespace gazetrace {
namespace {

constexpr double kFirstSpp = 1;
constexpr double kLeastSpp = 0.25;
// The last pilot has a quarter of the rate that it asks for, since the four renderings of a replica are then as many
// samples as a frame has, or between these parts of it. At less the prediction drifts, since samples of a sequence are
// better than independent ones.
constexpr double kPilotPart = 1.0 / 4, kLeastPart = 1.0 / 7, kMostPart = 1.0 / 2.5;
constexpr int kMostClipRounds = 4;
// What stands for the reference goes through `guided`: with half of the samples of a frame, or this many, it has less
// noise than the frames.
constexpr double kBasePart = 0.5, kLeastBaseSpp = 16;
constexpr double kLeastShare = 1e-6, kMostShare = 64;  // of the pilot's squared error, between which is searched

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

// The share of the pilot's squared error that leaves what is wanted, within a factor of about 1 + `tolerance` of that:
// by secants in the logarithms of both, since what is seen is about a power of the error.
double share_for(const Judge& judge, const ReplicaNoise& noise, double tolerance) {
  constexpr int kMostSteps = 8;
  const double wanted = std::log(judge.wanted);
  const auto seen_at = [&](double x) { return std::log(std::max(judge.seen(noise, std::exp(x)), 1e-12)); };
  double x = 0;
  double y = seen_at(0);
  double slope = judge.typical_slope;
  for (int step = 0; step < kMostSteps && std::abs(y - wanted) > tolerance; ++step) {
    const double next = std::clamp(x + (wanted - y) / slope, std::log(kLeastShare), std::log(kMostShare));
    if (next == x) {
      break;
    }
    const double y_next = seen_at(next);
    slope = std::clamp((y_next - y) / (next - x), 0.1, 3.0);
    x = next;
    y = y_next;
  }
  return std::exp(x + (wanted - y) / slope);
}

}  // namespace

std::string ClipRate::text() const {
  return fmt::format("{:.6g} samples a pixel, expected to reach {}: by {} pilots, {} renderings of frames in all", spp,
                     predicted_jod    ? fmt::format("{:.3f} JOD", *predicted_jod)
                     : predicted_flip ? fmt::format("a mean FLIP of {:.4g}", *predicted_flip)
                                      : "nothing",
                     rounds, frames);
}

ClipRate clip_rate(PathTracer& tracer, const JudgedFrames& judged, const FrameSettings& settings,
                   const ColorPipeline& color) {
  constexpr double kRoughly = 0.1, kClosely = 0.01;
  const QualityTarget& target = settings.foveation.target;
  const double most = settings.foveation.max_spp;
  ReplicaClip clip(tracer, judged, settings, color);
  const Judge judge = judge_of(target, clip);
  ClipRate result;
  double pilot_spp = kFirstSpp;
  for (bool near = false; !near; pilot_spp = std::max(kLeastSpp, kPilotPart * result.spp)) {
    const auto round = static_cast<std::uint64_t>(result.rounds);
    clip.look(std::max(kLeastBaseSpp, kBasePart * result.spp), round);
    const ReplicaNoise noise(tracer, judged.runs.front().front(), settings, pilot_spp, round);
    ++result.rounds;
    result.frames += ReplicaNoise::kRenderings;
    add_traces(noise.stats(), result.pilot);
    // The first pilot is far from the rate, and only has to lead to the next one.
    const double share = share_for(judge, noise, result.rounds == 1 ? kRoughly : kClosely);
    result.spp = std::max(kLeastSpp, pilot_spp / share);
    const double part = pilot_spp / result.spp;
    near = result.rounds == kMostClipRounds || pilot_spp == kLeastSpp || (part >= kLeastPart && part <= kMostPart);
    // A first guess may be too high.
    if (!(result.spp <= (near ? 1 : 2) * most)) {
      throw Error(ErrorKind::usage, target.jod ? "`target-jod`" : "`target-flip`",
                  fmt::format("{}{} would take {:.3g} samples a pixel, by {} rounds of pilots; `max-spp` is {:g}",
                              target.jod ? *target.jod : *target.flip, target.jod ? " JOD" : "", result.spp,
                              result.rounds, most),
                  "ask for less, or raise `max-spp`");
    }
    if (near) {
      const double seen = judge.seen(noise, part);
      if (target.jod) {
        result.predicted_jod = fovvideovdp_jod(seen);
      } else {
        result.predicted_flip = seen;
      }
    }
  }
  result.frames += static_cast<std::size_t>(clip.looks());
  add_traces(clip.stats(), result.pilot);
  return result;
}

}  // namespace gazetrace
