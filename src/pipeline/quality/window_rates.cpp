// SPDX-License-Identifier: Apache-2.0
#include "pipeline/quality/window_rates.hpp"

#include <algorithm>
#include <utility>

#include "core/hash.hpp"
#include "core/statistics.hpp"
#include "foveation/site_images.hpp"
#include "pipeline/quality/adaptive_rates.hpp"
#include "pipeline/quality/discarded.hpp"
#include "pipeline/trace_counts.hpp"

namespace gazetrace {
namespace {

constexpr std::uint64_t kRatesTag = 0x5241544553ULL;  // "RATES"
constexpr std::uint64_t kPilots = 4;                  // whose rates are averaged, where all frames share them

}  // namespace

WindowRates::WindowRates(PathTracer& tracer, const JudgedFrames& judged, const JudgedWindows& windows,
                         const FrameSettings& settings, WindowLight& light)
    : tracer_(tracer), judged_(judged), windows_(windows), settings_(settings), light_(light) {}

bool WindowRates::is_steady() const {
  const FrameRequest& first = judged_.runs.front().front();
  const auto same = [&](const FrameRequest& request) {
    return request.gaze_direction_render == first.gaze_direction_render;
  };
  const auto all_same = [&](const std::vector<FrameRequest>& run) { return std::all_of(run.begin(), run.end(), same); };
  return !judged_.gaze_moves && !(looks_first(settings_.foveation.sampling) && judged_.view_moves) &&
         std::all_of(judged_.runs.begin(), judged_.runs.end(), all_same) && all_same(judged_.around);
}

RatesOfLook WindowRates::of_look(double spp, std::uint64_t round, TraceStats& stats) {
  RatesOfLook rates{is_steady(), {}};
  const auto find = [&](const std::vector<FrameRequest>& requests) {
    for (const FrameRequest& request : requests) {
      if (rates.by_number.contains(rates.number(request))) {
        continue;
      }
      const ImageGray expected = expected_spp(request, spp, round, stats);
      const double full = static_cast<double>(*std::max_element(expected.pixels.begin(), expected.pixels.end()));
      for (const JudgedWindow& window : windows_.windows) {
        rates.by_number[rates.number(request)].push_back({cut_out(expected, window.traced), full});
      }
    }
  };
  for (const std::vector<FrameRequest>& run : judged_.runs) {
    find(run);
  }
  find(judged_.around);
  return rates;
}

// Blocks share what they expect, as in the frame.
ImageGray WindowRates::expected_spp(const FrameRequest& request, double spp, std::uint64_t round, TraceStats& stats) {
  FrameSettings own = discarded(settings_, hash_combine(kRatesTag, round));
  own.foveation.spp = spp;
  if (!looks_first(own.foveation.sampling)) {
    return expected_spp_of(planned_sampling_map(own.foveation, request, own.trace.seed, settings_.threads));
  }
  ImageGray rates;
  if (is_steady()) {
    // Of pilots that may be larger than those of such a frame; what they say of the rates is brought to their mean.
    own.foveation.spp = std::max(spp, 16 * least_pilot_spp(request));
    shared_ = rates_between(sum_of_pilots(request, own, stats), spp, own.foveation.min_spp, own.foveation.max_spp);
    rates = shared_;
  } else {
    rates = pilot_rates(request, own, stats);
  }
  own.foveation.spp = mean_of(rates);
  MapContext context = map_context(request, own.trace.seed, settings_.threads);
  context.density = &rates;
  return expected_spp_of(make_sampling_map(own.foveation, request.view, request.gaze_direction_render, context));
}

ImageGray WindowRates::sum_of_pilots(const FrameRequest& request, FrameSettings settings, TraceStats& stats) {
  ImageGray sum;
  for (std::uint64_t k = 0; k < kPilots; ++k) {
    settings.trace.seed = hash_combine(settings.trace.seed, k);
    const ImageGray one = pilot_rates(request, settings, stats);
    if (sum.empty()) {
      sum = one;
      continue;
    }
    for (std::size_t i = 0; i < sum.pixels.size(); ++i) {
      sum.pixels[i] += one.pixels[i];
    }
  }
  return sum;
}

ImageGray WindowRates::pilot_rates(const FrameRequest& request, FrameSettings settings, TraceStats& stats) {
  settings.trace.guiding_field = light_.of(request.frame, stats);
  AdaptiveRates adaptive =
      adaptive_rates(tracer_.at({request.shutter_open_ns, request.shutter_close_ns}), request, settings);
  add_traces(adaptive.pilot, stats);
  return std::move(adaptive.rates);
}

ImageGray WindowRates::shared(double spp) const {
  const FoveationSettings& limits = settings_.foveation;
  return shared_.empty() ? ImageGray() : rates_between(shared_, spp, limits.min_spp, limits.max_spp);
}

}  // namespace gazetrace
