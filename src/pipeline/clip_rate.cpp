// SPDX-License-Identifier: Apache-2.0
#include "pipeline/clip_rate.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "gazetrace/error.hpp"
#include "gazetrace/fovvideovdp.hpp"
#include "pipeline/replica_clip.hpp"
#include "pipeline/trace_counts.hpp"

namespace gazetrace {
namespace {

constexpr double kFirstSpp = 1;
constexpr double kLeastSpp = 0.25;
// The last pilot has a quarter of the rate that it asks for, or between these parts of it. At less the prediction
// drifts, since samples of a sequence are better than independent ones; at more, chance in the pilot hides what it
// shows.
constexpr double kPilotPart = 1.0 / 4, kLeastPart = 1.0 / 7, kMostPart = 1.0 / 2.5;
constexpr int kMostRounds = 4;
constexpr double kLeastShare = 1e-6, kMostShare = 64;  // of the pilot's squared error, between which is searched

double q_of_jod(double jod) {
  double low = 0;
  double high = 1;
  while (fovvideovdp_jod(high) > jod && high < 1e12) {
    high *= 2;
  }
  for (int step = 0; step < 60; ++step) {
    const double middle = 0.5 * (low + high);
    (fovvideovdp_jod(middle) > jod ? low : high) = middle;
  }
  return high;
}

// The share of the pilot's squared error that leaves this Q: by secants in the logarithms of both, since Q is about a
// power of the error.
double share_for(const ReplicaClip& pilot, double q, double q_of_all) {
  constexpr int kMostSteps = 8;
  constexpr double kCloseEnough = 0.003;
  const double wanted = std::log(q);
  double x = 0;
  double y = std::log(std::max(q_of_all, 1e-12));
  double slope = 0.9;  // typical
  for (int step = 0; step < kMostSteps && std::abs(y - wanted) > kCloseEnough; ++step) {
    const double next = std::clamp(x + (wanted - y) / slope, std::log(kLeastShare), std::log(kMostShare));
    if (next == x) {
      break;
    }
    const double y_next = std::log(std::max(pilot.q_at(std::exp(next)), 1e-12));
    slope = std::clamp((y_next - y) / (next - x), 0.2, 3.0);
    x = next;
    y = y_next;
  }
  return std::exp(x);
}

}  // namespace

std::string ClipRate::text() const {
  return fmt::format(
      "{:.6g} samples a pixel, expected to reach {:.3f} JOD: by {} pilots, {} renderings of frames in all", spp,
      predicted_jod, rounds, frames);
}

ClipRate clip_rate(PathTracer& tracer, const JudgedFrames& judged, const FrameSettings& settings,
                   const ColorPipeline& color) {
  const double target = *settings.foveation.target.jod;
  const double wanted = q_of_jod(target);
  const double most = settings.foveation.max_spp;
  std::size_t judged_frames = 0;
  for (const std::vector<FrameRequest>& run : judged.runs) {
    judged_frames += run.size();
  }
  ClipRate result;
  double pilot_spp = kFirstSpp;
  for (bool near = false; !near; pilot_spp = std::max(kLeastSpp, kPilotPart * result.spp)) {
    const ReplicaClip pilot(tracer, judged, settings, color, pilot_spp, static_cast<std::uint64_t>(result.rounds));
    ++result.rounds;
    result.frames += 2 * judged_frames + 1;
    add_traces(pilot.stats(), result.pilot);
    result.spp = std::max(kLeastSpp, pilot_spp / share_for(pilot, wanted, pilot.q_at(1)));
    result.predicted_jod = fovvideovdp_jod(pilot.q_at(pilot_spp / result.spp));
    const double part = pilot_spp / result.spp;
    near = result.rounds == kMostRounds || pilot_spp == kLeastSpp || (part >= kLeastPart && part <= kMostPart);
    // A first guess may be too high.
    if (!(result.spp <= (near ? 1 : 2) * most)) {
      throw Error(ErrorKind::usage, "`target-jod`",
                  fmt::format("{} JOD would take {:.3g} samples a pixel, by {} rounds of pilots; `max-spp` is {:g}",
                              target, result.spp, result.rounds, most),
                  "ask for less, or raise `max-spp`");
    }
  }
  return result;
}

}  // namespace gazetrace
