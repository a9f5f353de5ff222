// SPDX-License-Identifier: Apache-2.0
#include "pipeline/time_budget.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "pipeline/rehearsal.hpp"
#include "pipeline/timing_row.hpp"
#include "pipeline/trace_counts.hpp"

namespace gazetrace {
namespace {

// Where tracing took less than this part of the budget, and was not expected to take more, its time does not tell what
// samples cost.
constexpr double kTellingShare = 0.1;
constexpr double kLate = 1.1;   // over the budget: worth a warning
constexpr double kEarly = 0.5;  // and under it, where more samples were allowed

}  // namespace

TimeBudget::TimeBudget(PathTracer& tracer, const FrameSettings& settings, const OutputSettings& output)
    : tracer_(tracer),
      settings_(settings),
      output_(output),
      budget_ms_(1e3 * settings.foveation.target.time_s.value()) {}

FrameSettings TimeBudget::settings_for(const FrameRequest& request, const TemporalHistory& history, KnownLight& known) {
  if (known_frames_ == 0) {
    Rehearsal rehearsal = rehearse(tracer_, settings_, output_, request, history, known);
    cost_ = rehearsal.cost;
    learn_ms_ = rehearsal.learn_ms;
    rehearsal_ = std::move(rehearsal.discarded);
    rehearsal_ms_ = rehearsal.total_ms;
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
