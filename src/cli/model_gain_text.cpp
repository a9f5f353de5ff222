// SPDX-License-Identifier: Apache-2.0
#include "cli/model_gain_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "gazetrace/error.hpp"

namespace gazetrace {
namespace {

constexpr double kCutFactor = 0.1;

const std::vector<NoiseKind>& noise_kinds() {
  static const std::vector<NoiseKind> kKinds{{"white", false, 0},
                                             {"cut_below_4_cpd", false, 4},
                                             {"cut_below_2_cpd", false, 2},
                                             {"white_even_resolution", true, 0}};
  return kKinds;
}

double angle_deg(double from, double to) {
  return (std::atan(to) - std::atan(from)) * kDegPerRad;
}

std::vector<const FrameRequest*> frames_to_look_at(const FramePlan& plan, std::size_t& with_gaze) {
  constexpr std::size_t kMost = 24;
  std::vector<const FrameRequest*> all;
  for (const FrameRequest& request : plan.frames) {
    if (request.gaze_direction_true) {
      all.push_back(&request);
    }
  }
  with_gaze = all.size();
  if (all.size() <= kMost) {
    return all;
  }
  std::vector<const FrameRequest*> some;
  for (std::size_t i = 0; i < kMost; ++i) {
    some.push_back(all[i * (all.size() - 1) / (kMost - 1)]);
  }
  return some;
}

bool same_direction(const Vec3d& a, const Vec3d& b) {
  return a.x == b.x && a.y == b.y && a.z == b.z;
}

std::string words_of(const NoiseKind& kind) {
  if (kind.even_resolution) {
    return "white noise, on a screen of even pixels a degree";
  }
  return kind.cut_below_cpd == 0
             ? "white noise"
             : fmt::format("its variance below {:g} cycles a degree cut tenfold", kind.cut_below_cpd);
}

}  // namespace

GainOfPlan gain_of_plan(const FramePlan& plan, double frames_per_second, int threads) {
  constexpr double kSlowest = 4;  // frames a second; FovVideoVDP sees 250 ms, and needs two frames for its channels
  GainOfPlan result;
  const std::vector<const FrameRequest*> frames = frames_to_look_at(plan, result.frames_with_gaze);
  if (frames.empty()) {
    throw Error(ErrorKind::usage, "--model-gain", "no frame has gaze", "give `gaze-at` or `gaze`");
  }
  result.frames = frames.size();
  const PlanarView& view = frames.front()->view;
  result.settings.view = view;
  result.settings.frames_per_second = frames_per_second > kSlowest ? frames_per_second : 0;
  result.settings.threads = threads;
  result.width_deg = angle_deg(view.left, view.left + view.step_x * view.width_px);
  result.height_deg = angle_deg(view.top - view.step_y * view.height_px, view.top);
  result.pixels_per_degree = fovvideovdp_geometry(view).pixels_per_degree();
  const auto count = static_cast<double>(frames.size());
  for (const NoiseKind& kind : noise_kinds()) {
    const ErrorSpectrum spectrum =
        kind.cut_below_cpd == 0 ? white_error() : cut_error(kind.cut_below_cpd, kCutFactor, result.pixels_per_degree);
    GainOfKind mean{kind, 0, 0, 0};
    ModelGain last;
    for (std::size_t i = 0; i < frames.size(); ++i) {
      const Vec3d& gaze = *frames[i]->gaze_direction_true;
      if (i == 0 || !same_direction(gaze, *frames[i - 1]->gaze_direction_true)) {
        ModelGainSettings settings = result.settings;
        settings.view = frames[i]->view;
        settings.even_resolution = kind.even_resolution;
        last = model_gain(settings, gaze, spectrum);
      }
      mean.gain += last.gain / count;
      mean.uniform_spp += last.uniform_spp / count;
      mean.allocated_spp += last.allocated_spp / count;
    }
    result.kinds.push_back(mean);
  }
  return result;
}

std::string gain_as_text(const GainOfPlan& gain) {
  const ModelGainSettings& settings = gain.settings;
  const std::string frames = gain.frames == gain.frames_with_gaze
                                 ? fmt::format("{} frame{}", gain.frames, gain.frames == 1 ? "" : "s")
                                 : fmt::format("{} of {} frames", gain.frames, gain.frames_with_gaze);
  const std::string rate = settings.frames_per_second > 0
                               ? fmt::format("{:g} frames a second", settings.frames_per_second)
                               : std::string("still pictures");
  std::string text = fmt::format(
      "Samples of uniform sampling over those of the best sampling by eccentricity alone, at equal visible error by\n"
      "FovVideoVDP's model ({:g} JOD). The mean over {} with gaze; {:.1f} x {:.1f} degrees,\n"
      "{:.1f} pixels a degree, {}.\n",
      settings.target_jod, frames, gain.width_deg, gain.height_deg, gain.pixels_per_degree, rate);
  for (const GainOfKind& kind : gain.kinds) {
    text += fmt::format("  {:<54}{:>6.2f} times\n", words_of(kind.kind), kind.gain);
  }
  return text +
         fmt::format(
             "Content and masking are left out: the noise has one relative size everywhere, on an even grey of {:g}\n"
             "cd/m2, while pictures differ in noise from place to place, and their contrast hides it. So this is no\n"
             "bound. Off its middle a flat screen has more pixels a degree, which makes noise finer there; the last\n"
             "line is without that, as behind the lenses of some headsets.\n",
             settings.luminance_cd_m2);
}

std::string gain_as_json(const GainOfPlan& gain) {
  nlohmann::ordered_json kinds = nlohmann::ordered_json::array();
  for (const GainOfKind& kind : gain.kinds) {
    kinds.push_back({{"noise", kind.kind.name},
                     {"even_resolution", kind.kind.even_resolution},
                     {"cut_below_cpd", kind.kind.cut_below_cpd},
                     {"cut_factor", kind.kind.cut_below_cpd > 0 ? kCutFactor : 1},
                     {"gain", kind.gain},
                     {"uniform_spp", kind.uniform_spp},
                     {"allocated_spp", kind.allocated_spp}});
  }
  const nlohmann::ordered_json json = {{"frames", gain.frames},
                                       {"frames_with_gaze", gain.frames_with_gaze},
                                       {"width_deg", gain.width_deg},
                                       {"height_deg", gain.height_deg},
                                       {"pixels_per_degree", gain.pixels_per_degree},
                                       {"frames_per_second", gain.settings.frames_per_second},
                                       {"luminance_cd_m2", gain.settings.luminance_cd_m2},
                                       {"target_jod", gain.settings.target_jod},
                                       {"noise_contrast_of_one_sample", 1},
                                       {"content_and_masking", false},
                                       {"gains", kinds}};
  return json.dump(2) + "\n";
}

}  // namespace gazetrace
