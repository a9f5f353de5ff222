// SPDX-License-Identifier: Apache-2.0
#include "sweep/model_gain_of_test.hpp"

#include <algorithm>
#include <map>
#include <tuple>

namespace gazetrace {

std::optional<double> model_gain_of_test(const SweepTest& test, double target_jod, const NoiseCut& cut) {
  constexpr double kSlowest = 4;  // frames a second that FovVideoVDP takes for a video
  constexpr double kLeastJod = 5, kNoneVisible = 10;
  const FrameRequest& request = test.plan.frames.front();
  if (!request.gaze_direction_true || !(target_jod >= kLeastJod && target_jod < kNoneVisible)) {
    return std::nullopt;
  }
  ModelGainSettings settings;
  settings.view = request.view;
  settings.target_jod = target_jod;
  const FrameRate& fps = test.pipeline.fps;
  const double per_second = static_cast<double>(fps.numerator) / static_cast<double>(fps.denominator);
  settings.frames_per_second = test.plan.frames.size() > 1 && per_second > kSlowest ? per_second : 0;
  settings.threads = test.pipeline.threads;
  const ErrorSpectrum spectrum =
      cut.below_cpd > 0 ? cut_error(cut.below_cpd, cut.factor, fovvideovdp_geometry(request.view).pixels_per_degree())
                        : white_error();
  return model_gain(settings, *request.gaze_direction_true, spectrum).gain;
}

void add_model_gains(const SweepPlan& plan, std::vector<ResultFixedQuality>& speed_ups) {
  std::map<std::tuple<std::string, std::string, double>, std::optional<double>> known;
  for (ResultFixedQuality& one : speed_ups) {
    if (one.metric != "fovvideovdp") {
      continue;
    }
    const auto [at, is_new] = known.try_emplace({one.scene, one.gaze, one.at});
    const auto test = std::find_if(plan.tests.begin(), plan.tests.end(), [&](const SweepTest& candidate) {
      return candidate.gaze == one.gaze && plan.scenes[candidate.scene].name == one.scene;
    });
    if (is_new && test != plan.tests.end()) {
      at->second = model_gain_of_test(*test, one.at);
    }
    one.model_gain = at->second;
  }
}

}  // namespace gazetrace
