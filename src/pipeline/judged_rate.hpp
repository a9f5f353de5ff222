// SPDX-License-Identifier: Apache-2.0
// The rate of a whole sequence that is to reach a stated quality (QualityTarget::jod, ::flip), and what choosing it
// took.
#pragma once

#include <optional>
#include <string>

#include "gazetrace/color.hpp"
#include "gazetrace/frame_renderer.hpp"
#include "gazetrace/output.hpp"
#include "pipeline/clip_rate.hpp"

namespace gazetrace {

class JudgedRate {
 public:
  // Gives `settings` the rate in the place of the target.
  void choose(PathTracer& tracer, const JudgedFrames& judged, const ColorPipeline& color, FrameSettings& settings);
  [[nodiscard]] std::string text() const;  // for the run record; once it is chosen
  void warn(Warnings& warnings) const;
  // The choice is counted in the first row that is rendered. Nothing where no rate was to be chosen.
  void enter(TimingRow& row);

 private:
  std::optional<ClipRate> rate_;
  double ms_ = 0;
};

}  // namespace gazetrace
