// SPDX-License-Identifier: Apache-2.0
#include "pipeline/judged_rate.hpp"

#include <utility>

#include "pipeline/frame_stages.hpp"
#include "pipeline/timing_row.hpp"

namespace gazetrace {

void JudgedRate::choose(PathTracer& tracer, const JudgedFrames& judged, const ColorPipeline& color,
                        FrameSettings& settings) {
  rate_ = timed(ms_, [&] {
    return is_noise_alone(settings) && !judged.view_moves ? clip_rate(tracer, judged, settings, color)
                                                          : measured_rate(tracer, judged, settings, color);
  });
  settings.foveation.target = {};
  settings.foveation.budget_spp = rate_->spp;
  if (!rate_->rates.empty()) {
    settings.rates_of = [rates = rate_->rates](const FrameRequest&) { return FrameRates{rates, 0}; };
  }
}

std::string JudgedRate::text() const {
  return rate_->text();
}

void JudgedRate::warn(Warnings& warnings) const {
  for (std::string& doubt : rate_->doubts()) {
    warnings.push_back(std::move(doubt));
  }
}

void JudgedRate::enter(TimingRow& row) {
  if (!rate_) {
    return;
  }
  add_prediction({{}, rate_->predicted_jod}, row);
  rate_->pilot.learning_paths = 0;  // whose time is in pilot_ms with all that the choice took
  add_pilot(rate_->pilot, row);
  row.pilot_ms += ms_;
  row.total_ms += ms_;
  rate_->pilot = {};
  ms_ = 0;
}

}  // namespace gazetrace
