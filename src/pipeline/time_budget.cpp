// SPDX-License-Identifier: Apache-2.0
#include "pipeline/time_budget.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "core/hash.hpp"
#include "core/stopwatch.hpp"
#include "pipeline/adaptive_rates.hpp"
#include "pipeline/first_look.hpp"
#include "pipeline/frame_stages.hpp"
#include "pipeline/pilot.hpp"
#include "pipeline/timing_row.hpp"
#include "pipeline/trace_counts.hpp"

namespace gazetrace {
namespace {

constexpr double kLeastSpp = 1.0 / 16;
// The frame that is rehearsed at its full size may take about this part of the time for its samples, within these
// rates.
constexpr double kRehearsalShare = 0.03;
constexpr double kLeastRehearsal = 1.0 / 16, kMostRehearsal = 8;
constexpr double kMoreShare = 0.1;        // of the time, for the second rehearsal; at least
constexpr double kLeastMore = 2;          // times the samples of the first
constexpr double kPilotShare = 1.0 / 16;  // of a frame's samples, that a pilot at the frame's rates may have
// Where tracing took less than this part of the budget, and was not expected to take more, its time does not tell what
// samples cost.
constexpr double kTellingShare = 0.1;
// FrameCost::filter_share of `guided`. In Sponza it was 0.14 and 0.15, between 0.01 and about 1 sample a pixel; from
// there to 256 the filter took no longer. With less than that frames come nearest to the budget, since a sample costs
// less where there are more of them.
constexpr double kFilterShare = 0.1;
constexpr std::uint64_t kRehearsalTag =
    0x52454845415253ULL;        // "REHEARS": no sample of the frame has a part in its rate
constexpr double kLate = 1.1;   // over the budget: worth a warning
constexpr double kEarly = 0.5;  // and under it, where more samples were allowed
// Until the first frame's files are written: milliseconds a megapixel of a common machine.
constexpr double kExrMs = 60, kDisplayMs = 200;

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

FrameSettings with_budget(const FrameSettings& settings, double spp) {
  FrameSettings result = settings;
  result.foveation.target = {};
  result.foveation.budget_spp = spp;
  return result;
}

// Samples of a pilot are traced in pilot_ms, those of a first look in trace_ms.
double traced_samples(const TimingRow& row) {
  return std::max(1.0, static_cast<double>(row.samples - (row.pilot_ms > 0 ? row.pilot_samples : 0)));
}

// Of all but tracing and learning; of a pilot, what its samples do not take.
double fixed_ms_of(const TimingRow& row, double sample_ms) {
  return row.plan_ms + row.guides_ms + row.reconstruct_ms + row.temporal_ms + row.exposure_ms + row.layers_ms +
         row.color_ms + row.write_ms + std::max(0.0, row.pilot_ms - sample_ms * static_cast<double>(row.pilot_samples));
}

ImageGray scaled(ImageGray rates, double by) {
  for (float& rate : rates.pixels) {
    rate = static_cast<float>(by * static_cast<double>(rate));
  }
  return rates;
}

}  // namespace

FrameCost cost_of(const TimingRow& row) {
  FrameCost cost;
  cost.samples = traced_samples(row);
  cost.sample_ms = row.trace_ms / cost.samples;
  cost.fixed_ms = fixed_ms_of(row, cost.sample_ms);
  return cost;
}

FrameCost cost_of(const TimingRow& row, const FrameCost& known, double telling_ms) {
  FrameCost cost = cost_of(row);
  cost.filter_share = known.filter_share;
  const double expected_ms = known.base_ms + known.sample_ms * traced_samples(row);
  if (std::max(row.trace_ms, expected_ms) < telling_ms) {
    cost.base_ms = known.base_ms;
    cost.sample_ms = known.sample_ms;
    cost.fixed_ms = fixed_ms_of(row, known.sample_ms);
    return cost;
  }
  if (expected_ms > 0) {
    cost.base_ms = known.base_ms * row.trace_ms / expected_ms;
    cost.sample_ms = known.sample_ms * row.trace_ms / expected_ms;
  }
  return cost;
}

FrameCost mean_cost(const FrameCost& known, const FrameCost& next) {
  const auto mean = [](double before, double now) {
    return now < before ? 2 * before * now / (before + now) : 0.5 * (before + now);
  };
  return {mean(known.fixed_ms, next.fixed_ms), mean(known.base_ms, next.base_ms), mean(known.sample_ms, next.sample_ms),
          0.5 * (known.samples + next.samples), 0.5 * (known.filter_share + next.filter_share)};
}

FrameCost with_slope(FrameCost cost, const TracedSamples& more, const TracedSamples& fewer) {
  const double slope = (more.trace_ms - fewer.trace_ms) / std::max(1.0, more.samples - fewer.samples);
  // Chance may make it anything; the cost of a sample falls with the rate, and not without end.
  constexpr double kLeastOfMean = 0.4;
  const double mean = more.trace_ms / std::max(1.0, more.samples);
  cost.sample_ms = std::clamp(slope, kLeastOfMean * mean, mean);
  cost.base_ms = (mean - cost.sample_ms) * more.samples;
  return cost;
}

double affordable_spp(double budget_ms, const FrameCost& cost, double pixels, double least, double most) {
  // What the filter takes for samples, up to one a pixel.
  const double filter_ms = cost.filter_share * cost.sample_ms;
  const double without_ms = std::max(0.0, cost.fixed_ms - filter_ms * std::min(cost.samples, pixels));
  const double left_ms = std::max(0.0, budget_ms - without_ms - cost.base_ms);
  double samples = left_ms / std::max(cost.sample_ms + filter_ms, 1e-12);
  if (samples > pixels) {
    samples = (left_ms - filter_ms * pixels) / std::max(cost.sample_ms, 1e-12);
  }
  return std::clamp(samples / pixels, std::min(least, most), most);
}

double least_budget_spp(const FoveationSettings& foveation, const FrameRequest& request) {
  constexpr double kRoom = 1.25;
  double least = foveation.min_spp > 0 ? foveation.min_spp : kLeastSpp;
  if (foveation.falloff == "visible") {
    least = std::max(least, kRoom * least_pilot_spp(request));
  } else if (foveation.contrast_strength > 0 && request.gaze_direction_render) {
    least = std::max(least, kRoom * first_look_spp(request));
  }
  return least;
}

TimeBudget::TimeBudget(PathTracer& tracer, const FrameSettings& settings, const OutputSettings& output)
    : tracer_(tracer),
      settings_(settings),
      output_(output),
      budget_ms_(1e3 * settings.foveation.target.time_s.value()) {}

FrameSettings TimeBudget::settings_for(const FrameRequest& request, const TemporalHistory& history, KnownLight& known) {
  if (known_frames_ == 0) {
    rehearse(request, history, known);
  }
  const bool learns = settings_.trace.learn_light && !FrameRenderer(tracer_, settings_).knows_light(known, request);
  const FoveationSettings& foveation = settings_.foveation;
  const double least = least_budget_spp(foveation, request);
  const double left_ms = budget_ms_ - rehearsal_ms_ - (learns ? learn_ms_ : 0);
  const double most = std::max(least, foveation.max_spp);
  const double spp = affordable_spp(left_ms, cost_, pixels_of(request), least, most);
  at_least_ = spp <= least;
  at_most_ = spp >= most;
  return with_budget(settings_, spp);
}

void TimeBudget::rehearse(const FrameRequest& request, const TemporalHistory& history, KnownLight& known) {
  const Stopwatch watch;
  const double pixels = pixels_of(request);
  const bool by_pilot = settings_.foveation.falloff == "visible";
  const PosedScene scene = tracer_.at({request.shutter_open_ns, request.shutter_close_ns});
  const double least = least_budget_spp(settings_.foveation, request);
  const double most = std::max(least, settings_.foveation.max_spp);

  FrameSettings looking = settings_;  // of what traces no whole frame
  if (looking.trace.learn_light) {
    LightLearning learning = timed(learn_ms_, [&] {
      return scene.learn_light(request.camera, request.width_px, request.height_px, looking.trace);
    });
    looking.trace.learned = std::move(learning.light);
    known = {request, looking.trace.learned};  // the frame would learn the same
  }

  // Roughly, by a pilot: what a sample costs.
  std::uint64_t round = 1;  // the scrambling of round 0 is that of the frame's own first pilot
  const auto pilot_at = [&](const ImageGray& rates) {
    const double cell_pixels = static_cast<double>(pilot_cell_px(request)) * pilot_cell_px(request);
    // A pilot of the frame's own rates has 1 / cell_pixels of its samples, which in small frames is many.
    Pilot pilot =
        trace_pilot(scene, request, looking, scaled(rates, std::min(1.0, kPilotShare * cell_pixels)), ++round);
    add_traces(pilot.stats, rehearsal_);
    return pilot;
  };
  const Pilot first = pilot_at(ImageGray(1, 1, 1));
  const double first_ms = first.times.trace_ms / std::max(1.0, static_cast<double>(first.stats.samples));

  // The frame with few samples, and its samples alone with more: the difference is the cost of a sample. Where less
  // than a sample falls on a pixel, every further one is a further pixel's, too, and costs more.
  const auto settings_at = [&](double spp) {
    FrameSettings settings = with_budget(settings_, spp);
    settings.light_of = [&](const FrameRequest&) { return looking.trace.learned; };
    settings.trace.seed = hash_combine(settings.trace.seed, kRehearsalTag);
    if (by_pilot) {
      settings.foveation.falloff = "uniform";
    }
    return settings;
  };
  const double low = std::clamp(kRehearsalShare * budget_ms_ / (first_ms * pixels), std::max(kLeastRehearsal, least),
                                std::max(kMostRehearsal, least));
  TemporalHistory scratch = history;
  const RenderedFrame few = FrameRenderer(tracer_, settings_at(low)).render(request, scratch);
  TimingRow row;
  add_times(few.times, row);
  add_samples(few.samples, few.first_look, few.map, row);
  add_traces(few.samples, rehearsal_);
  add_traces(few.first_look, rehearsal_);
  cost_ = cost_of(row);
  // Where the least that is allowed takes all of the time already, there is nothing to choose, and where more samples
  // would not fit into it, the few must do.
  const bool is_spent = watch.elapsed_ms() > budget_ms_;
  const double low_ms = few.times.trace_ms / std::max(1.0, static_cast<double>(few.samples.samples));
  const double wanted = std::min(kMoreShare * budget_ms_ / (low_ms * pixels), kLeastMore * kMostRehearsal);
  const double high = std::min(std::max(wanted, kLeastMore * low), most);
  if (high > low && watch.elapsed_ms() + high / low * few.times.trace_ms < budget_ms_) {
    const TracedFrame more = FrameRenderer(tracer_, settings_at(high)).trace(request);
    add_traces(more.sparse.stats, rehearsal_);
    add_traces(more.first_look, rehearsal_);
    cost_ = with_slope(cost_, {more.times.trace_ms, static_cast<double>(more.sparse.stats.samples)},
                       {few.times.trace_ms, static_cast<double>(few.samples.samples)});
  }
  cost_.fixed_ms += guessed_output_ms(output_, pixels);
  cost_.filter_share = Reconstruction(settings_.reconstruction).needs().surfaces ? kFilterShare : 0;

  if (by_pilot && !is_spent) {
    // What deciding the rates takes, and how much more or less a sample costs where they put it.
    const double spp = affordable_spp(budget_ms_ - watch.elapsed_ms(), cost_, pixels, least, most);
    const Stopwatch deciding;
    AdaptiveRates adaptive = adaptive_rates(scene, request, with_budget(looking, spp));
    const double deciding_ms = deciding.elapsed_ms();
    add_traces(adaptive.pilot, rehearsal_);
    const double anywhere = cpu_ms_of_sample(pilot_at(ImageGray(1, 1, static_cast<float>(adaptive.spp))).stats);
    cost_.fixed_ms += std::max(0.0, deciding_ms - cost_.sample_ms * static_cast<double>(adaptive.pilot.samples));
    cost_.sample_ms *= cpu_ms_of_sample(pilot_at(adaptive.rates).stats) / std::max(anywhere, 1e-12);
  }
  rehearsal_ms_ = watch.elapsed_ms();
}

void TimeBudget::learn(TimingRow& row) {
  const FrameCost cost = cost_of(row, cost_, kTellingShare * budget_ms_);
  cost_ = known_frames_ == 0 ? cost : mean_cost(cost_, cost);
  if (row.learning_paths > 0) {
    learn_ms_ = row.learn_ms;
  }
  ++known_frames_;
  add_pilot(rehearsal_, row);
  row.pilot_ms += rehearsal_ms_;
  rehearsal_ = {};
  rehearsal_ms_ = 0;
}

void TimeBudget::check(const TimingRow& row) {
  ++frames_;
  early_frames_ += row.total_ms < kEarly * budget_ms_ && !at_most_ ? 1 : 0;
  if (!(row.total_ms > kLate * budget_ms_)) {
    return;
  }
  ++late_frames_;
  late_at_least_ += at_least_ ? 1 : 0;
  if (row.total_ms > latest_ms_) {
    latest_ms_ = row.total_ms;
    latest_frame_ = row.frame;
  }
}

std::string TimeBudget::warning() const {
  std::string text;
  if (late_frames_ > 0) {
    text = fmt::format("{} of {} frames took longer than {:g} s by more than a tenth; frame {} took {:.3g} s",
                       late_frames_, frames_, 1e-3 * budget_ms_, latest_frame_, 1e-3 * latest_ms_);
  }
  if (late_at_least_ > 0) {
    text += fmt::format("; {} of them had the fewest samples that `min-spp` or a pilot allow", late_at_least_);
  }
  if (early_frames_ > 0) {
    text += fmt::format("{}{} of {} frames took less than half of {:g} s, though more samples were allowed",
                        text.empty() ? "" : "; ", early_frames_, frames_, 1e-3 * budget_ms_);
  }
  return text.empty() ? text : "`time-budget`: " + text;
}

}  // namespace gazetrace
