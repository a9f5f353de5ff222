// SPDX-License-Identifier: Apache-2.0
#include "pipeline/rehearsal.hpp"

#include <algorithm>
#include <cstdint>
#include <memory>
#include <utility>

#include "core/hash.hpp"
#include "core/stopwatch.hpp"
#include "pipeline/adaptive_rates.hpp"
#include "pipeline/frame_stages.hpp"
#include "pipeline/pilot.hpp"
#include "pipeline/timing_row.hpp"
#include "pipeline/trace_counts.hpp"

namespace gazetrace {
namespace {

// The frame that is rehearsed at its full size may take about this part of the time for its samples, within these
// rates.
constexpr double kRehearsalShare = 0.03;
constexpr double kLeastRehearsal = 1.0 / 16, kMostRehearsal = 8;
constexpr double kMoreShare = 0.1;        // of the time, for the second rehearsal; at least
constexpr double kLeastMore = 2;          // times the samples of the first
constexpr double kPilotShare = 1.0 / 16;  // of a frame's samples, that a pilot at the frame's rates may have
// FrameCost::filter_share of `guided`. In Sponza it was 0.14 and 0.15, between 0.01 and about 1 sample a pixel; from
// there to 256 the filter took no longer. With less than that frames come nearest to the budget, since a sample costs
// less where there are more of them.
constexpr double kFilterShare = 0.1;
constexpr std::uint64_t kRehearsalTag =
    0x52454845415253ULL;  // "REHEARS": no sample of the frame has a part in its rate
// Until the first frame's files are written: milliseconds a megapixel of a common machine.
constexpr double kExrMs = 60, kDisplayMs = 200;
// Of the pilots, which differ in their scrambling; round 0 is that of the frame's own first pilot.
constexpr std::uint64_t kRoughRound = 2, kEvenRound = 3, kPlacedRound = 4;

double guessed_output_ms(const OutputSettings& output, double pixels) {
  return 1e-6 * pixels *
         ((output.exr.pattern.empty() ? 0 : kExrMs) + (output.display.pattern.empty() ? 0 : kDisplayMs));
}

// Processor time of a sample: of a pilot, wall time says nothing, since its few tiles do not occupy all processors.
double cpu_ms_of_sample(const TraceStats& stats) {
  double ns = 0;
  for (const RegionTraceStats& region : stats.regions) {
    ns += static_cast<double>(region.cpu_ns);
  }
  return 1e-6 * ns / std::max(1.0, static_cast<double>(stats.samples));
}

double mean_trace_ms(const StageTimes& times, const TraceStats& stats) {
  return times.trace_ms / std::max(1.0, static_cast<double>(stats.samples));
}

TracedSamples traced_samples_of(const StageTimes& times, const TraceStats& stats) {
  return {times.trace_ms, static_cast<double>(stats.samples)};
}

ImageGray scaled(ImageGray rates, double by) {
  for (float& rate : rates.pixels) {
    rate = static_cast<float>(by * static_cast<double>(rate));
  }
  return rates;
}

// A pilot of the frame's own rates has 1 / cell_pixels of its samples, which in small frames is many.
Pilot small_pilot(const PosedScene& scene, const FrameRequest& request, const FrameSettings& settings,
                  const ImageGray& rates, std::uint64_t round, TraceStats& discarded) {
  const double cell_pixels = static_cast<double>(pilot_cell_px(request)) * pilot_cell_px(request);
  Pilot pilot = trace_pilot(scene, request, settings, scaled(rates, std::min(1.0, kPilotShare * cell_pixels)), round);
  add_traces(pilot.stats, discarded);
  return pilot;
}

// The settings of what traces no whole frame: with the light that the frame would learn.
FrameSettings with_light_learned(const PosedScene& scene, const FrameRequest& request, FrameSettings settings,
                                 KnownLight& known, double& learn_ms) {
  if (settings.trace.learn_light) {
    LightLearning learning = timed(learn_ms, [&] {
      return scene.learn_light(request.camera, request.width_px, request.height_px, settings.trace);
    });
    settings.trace.learned = std::move(learning.light);
    known = {request, settings.trace.learned};
  }
  return settings;
}

// Roughly, by a pilot: what a sample costs.
double rough_sample_ms(const PosedScene& scene, const FrameRequest& request, const FrameSettings& settings,
                       TraceStats& discarded) {
  const Pilot pilot = small_pilot(scene, request, settings, ImageGray(1, 1, 1), kRoughRound, discarded);
  return mean_trace_ms(pilot.times, pilot.stats);
}

// Of the frame at its full size. `learned` is the light that the frame knows.
FrameSettings full_size_settings(const FrameSettings& settings, double spp,
                                 const std::shared_ptr<const LearnedLight>& learned) {
  FrameSettings result = with_budget(settings, spp);
  result.light_of = [learned](const FrameRequest&) { return learned; };
  result.trace.seed = hash_combine(result.trace.seed, kRehearsalTag);
  if (settings.foveation.falloff == "visible") {
    result.foveation.falloff = "uniform";
  }
  return result;
}

// Samples a pixel of the frame with few samples, and of that with more, if a sample costs `sample_ms`.
double few_spp(double budget_ms, double sample_ms, double pixels, double least) {
  return std::clamp(kRehearsalShare * budget_ms / (sample_ms * pixels), std::max(kLeastRehearsal, least),
                    std::max(kMostRehearsal, least));
}
double more_spp(double budget_ms, double sample_ms, double pixels, double few, double most) {
  const double wanted = std::min(kMoreShare * budget_ms / (sample_ms * pixels), kLeastMore * kMostRehearsal);
  return std::min(std::max(wanted, kLeastMore * few), most);
}

void add_frame_traces(const TraceStats& samples, const TraceStats& first_look, TraceStats& discarded) {
  add_traces(samples, discarded);
  add_traces(first_look, discarded);
}

FrameCost cost_of_frame(const RenderedFrame& frame) {
  TimingRow row;
  add_times(frame.times, row);
  add_samples(frame.samples, frame.first_look, frame.map, row);
  return cost_of(row);
}

// What deciding the rates of `visible` takes, and how much more or less a sample costs where they put it.
void add_cost_of_placing(const PosedScene& scene, const FrameRequest& request, const FrameSettings& settings,
                         double spp, Rehearsal& rehearsal) {
  const Stopwatch deciding;
  const AdaptiveRates adaptive = adaptive_rates(scene, request, with_budget(settings, spp));
  const double deciding_ms = deciding.elapsed_ms();
  add_traces(adaptive.pilot, rehearsal.discarded);
  const Pilot even = small_pilot(scene, request, settings, ImageGray(1, 1, static_cast<float>(adaptive.spp)),
                                 kEvenRound, rehearsal.discarded);
  const Pilot placed = small_pilot(scene, request, settings, adaptive.rates, kPlacedRound, rehearsal.discarded);
  FrameCost& cost = rehearsal.cost;
  cost.fixed_ms += std::max(0.0, deciding_ms - cost.sample_ms * static_cast<double>(adaptive.pilot.samples));
  cost.sample_ms *= cpu_ms_of_sample(placed.stats) / std::max(cpu_ms_of_sample(even.stats), 1e-12);
}

}  // namespace

FrameSettings with_budget(const FrameSettings& settings, double spp) {
  FrameSettings result = settings;
  result.foveation.target = {};
  result.foveation.budget_spp = spp;
  return result;
}

Rehearsal rehearse(PathTracer& tracer, const FrameSettings& settings, const OutputSettings& output,
                   const FrameRequest& request, const TemporalHistory& history, KnownLight& known) {
  const Stopwatch watch;
  Rehearsal rehearsal;
  const double budget_ms = 1e3 * settings.foveation.target.time_s.value();
  const double pixels = pixels_of(request);
  const double least = least_budget_spp(settings.foveation, request);
  const double most = std::max(least, settings.foveation.max_spp);
  const PosedScene scene = tracer.at({request.shutter_open_ns, request.shutter_close_ns});

  const FrameSettings looking = with_light_learned(scene, request, settings, known, rehearsal.learn_ms);
  const double rough_ms = rough_sample_ms(scene, request, looking, rehearsal.discarded);

  // The frame with few samples, and its samples alone with more: the difference is the cost of a sample. Where less
  // than a sample falls on a pixel, every further one is a further pixel's, too, and costs more.
  const auto renderer_at = [&](double spp) {
    return FrameRenderer(tracer, full_size_settings(settings, spp, looking.trace.learned));
  };
  const double low = few_spp(budget_ms, rough_ms, pixels, least);
  TemporalHistory scratch = history;
  const RenderedFrame few = renderer_at(low).render(request, scratch);
  add_frame_traces(few.samples, few.first_look, rehearsal.discarded);
  rehearsal.cost = cost_of_frame(few);
  // Where the least that is allowed takes all of the time already, there is nothing to choose, and where more samples
  // would not fit into it, the few must do.
  const bool is_spent = watch.elapsed_ms() > budget_ms;
  const double high = more_spp(budget_ms, mean_trace_ms(few.times, few.samples), pixels, low, most);
  if (high > low && watch.elapsed_ms() + high / low * few.times.trace_ms < budget_ms) {
    const TracedFrame more = renderer_at(high).trace(request);
    add_frame_traces(more.sparse.stats, more.first_look, rehearsal.discarded);
    rehearsal.cost = with_slope(rehearsal.cost, traced_samples_of(more.times, more.sparse.stats),
                                traced_samples_of(few.times, few.samples));
  }
  rehearsal.cost.fixed_ms += guessed_output_ms(output, pixels);
  rehearsal.cost.filter_share = Reconstruction(settings.reconstruction).needs().surfaces ? kFilterShare : 0;

  if (settings.foveation.falloff == "visible" && !is_spent) {
    const double spp = affordable_spp(budget_ms - watch.elapsed_ms(), rehearsal.cost, pixels, least, most);
    add_cost_of_placing(scene, request, looking, spp, rehearsal);
  }
  rehearsal.total_ms = watch.elapsed_ms();
  return rehearsal;
}

}  // namespace gazetrace
