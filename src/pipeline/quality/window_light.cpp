// SPDX-License-Identifier: Apache-2.0
#include "pipeline/quality/window_light.hpp"

#include <utility>
#include <vector>

#include "core/hash.hpp"
#include "pipeline/quality/discarded.hpp"
#include "trace/guiding/guiding_field.hpp"

namespace gazetrace {
namespace {

constexpr std::size_t kMostLightBytes = std::size_t{256} << 20U;  // of guiding fields, kept at once

}  // namespace

WindowLight::WindowLight(PathTracer& tracer, const JudgedFrames& judged, const FrameSettings& settings)
    : tracer_(tracer), judged_(judged), settings_(settings) {
  for (const std::vector<FrameRequest>& run : judged.runs) {
    for (const FrameRequest& request : run) {
      requests_.emplace(request.frame, &request);
    }
  }
  for (const FrameRequest& request : judged.around) {
    requests_.emplace(request.frame, &request);
  }
}

std::shared_ptr<const GuidingField> WindowLight::of(std::int32_t frame, TraceStats& stats) {
  if (!settings_.trace.guiding) {
    return nullptr;
  }
  const std::int32_t lit = judged_.view_moves ? frame : judged_.runs.front().front().frame;
  if (const auto known = kept_.find(lit); known != kept_.end()) {
    return known->second;
  }
  if (!last_.request || last_.request->frame != lit) {
    const FrameRequest& whole = *requests_.at(lit);
    TraceSettings own = settings_.trace;
    own.seed = hash_combine(own.seed, kLookTag);
    TrainedGuiding training = tracer_.at({whole.shutter_open_ns, whole.shutter_close_ns})
                                  .train_guiding(whole.camera, whole.width_px, whole.height_px, own);
    stats.training_paths += training.paths;
    last_ = {whole, std::move(training.field)};
  }
  // Fields that no longer fit are trained anew for each window, bit by bit the same.
  const std::size_t bytes = last_.field ? last_.field->bytes() : 0;
  if (kept_bytes_ + bytes <= kMostLightBytes) {
    kept_bytes_ += bytes;
    kept_.emplace(lit, last_.field);
  }
  return last_.field;
}

}  // namespace gazetrace
