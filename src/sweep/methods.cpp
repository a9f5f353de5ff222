// SPDX-License-Identifier: Apache-2.0
// The paragraph for a paper: it states everything that a number of the sweep depends on.
#include <fmt/format.h>

#include <algorithm>

#include "gazetrace/build_info.hpp"
#include "gazetrace/version.hpp"
#include "sweep/conclude.hpp"
#include "sweep/scorer.hpp"

namespace gazetrace {
namespace {

std::string list_of(const NamedValues& values) {
  std::string text;
  for (const auto& [name, value] : values) {
    text += fmt::format("{}{} {}", text.empty() ? "" : ", ", name, value);
  }
  return text;
}

std::string scenes_of(const SweepPlan& plan) {
  std::string text;
  for (const SweepScene& scene : plan.scenes) {
    text += fmt::format("{}{} ({})", text.empty() ? "" : "; ", scene.name, scene.description);
  }
  return text;
}

// The settings of the tests, each of them once.
std::string settings_of(const SweepPlan& plan) {
  std::vector<std::string> settings;
  for (const SweepTest& test : plan.tests) {
    const std::string one = fmt::format("{} ({})", test.label, list_of(test.settings));
    if (std::find(settings.begin(), settings.end(), one) == settings.end()) {
      settings.push_back(one);
    }
  }
  return fmt::format("{}", fmt::join(settings, "; "));
}

// The texts in their order, each of them once.
std::string each_once(const std::vector<std::string>& texts) {
  std::vector<std::string> result;
  for (const std::string& text : texts) {
    if (std::find(result.begin(), result.end(), text) == result.end()) {
      result.push_back(text);
    }
  }
  return fmt::format("{}", fmt::join(result, " or "));
}

std::string views_of(const SweepPlan& plan) {
  std::vector<std::string> views;
  for (const SweepReference& reference : plan.references) {
    views.push_back(ColorPipeline(reference.color).description());
  }
  return each_once(views);
}

// Said where frames use others that come after them.
std::string not_causal(const SweepPlan& plan) {
  const bool reads_ahead = std::any_of(plan.tests.begin(), plan.tests.end(), [](const SweepTest& test) {
    return test.pipeline.accumulate.future_frames > 0;
  });
  return reads_ahead
             ? "Rows whose `accumulate-future` is not 0s are not causal (causal = false): their frames use frames that "
               "come after them, which cannot be done while somebody looks. "
             : "";
}

// How the light of the references was computed, which may differ from how that of the tests was.
std::string light_of_references(const SweepPlan& plan) {
  std::vector<std::string> texts;
  for (const SweepReference& reference : plan.references) {
    const TraceSettings& trace = reference.pipeline.trace;
    texts.push_back(
        fmt::format("{} bounces, {}, {}, {}, filter {}", trace.max_bounces,
                    trace.clamp_indirect > 0 ? fmt::format("indirect light clamped at {:g}", trace.clamp_indirect)
                                             : "indirect light not clamped",
                    trace.russian_roulette ? "Russian roulette" : "no Russian roulette",
                    trace.guiding ? "path guiding" : "no path guiding", reference.pipeline.reconstruction.filter));
  }
  return each_once(texts);
}

const char* name_of(DisplayResponse response) {
  switch (response) {
    case DisplayResponse::srgb:
      return "sRGB";
    case DisplayResponse::gamma22:
      return "gamma 2.2";
    case DisplayResponse::gamma24:
      return "gamma 2.4";
    case DisplayResponse::linear:
      return "linear";
    case DisplayResponse::pq:
      return "PQ";
    case DisplayResponse::linear_hdr:
      return "linear HDR";
  }
  return "";
}
const char* name_of(FlipToneMapper tone_mapper) {
  switch (tone_mapper) {
    case FlipToneMapper::aces:
      return "ACES";
    case FlipToneMapper::hable:
      return "Hable's curve";
    case FlipToneMapper::reinhard:
      return "Reinhard's curve";
  }
  return "";
}

std::string exposures_of(const FlipExposureSettings& flip) {
  const auto place = [](const std::optional<double>& ev) {
    return ev ? fmt::format("{:g} stops", *ev) : std::string("that of the first reference frame");
  };
  return fmt::format("hdr_flip through {} at {} exposures from {} to {}", name_of(flip.tone_mapper),
                     flip.count ? std::to_string(*flip.count) : "as many as needed", place(flip.start_ev),
                     place(flip.stop_ev));
}

// The settings of single metrics.
std::string metric_settings(const SweepPlan& plan) {
  const ComparisonSettings& c = plan.measure.comparison;
  const auto has = [&](const char* name) {
    return std::find(c.metrics.begin(), c.metrics.end(), name) != c.metrics.end();
  };
  std::vector<std::string> texts;
  if (has("relmse")) {
    texts.push_back(fmt::format("relmse with an epsilon of {:g}", c.metric.relmse_epsilon));
  }
  if (has("hdr_flip")) {
    texts.push_back(exposures_of(c.metric.hdr_flip));
  }
  if (has("flicker")) {
    texts.push_back(fmt::format("{}", fmt::join(flicker_ranges(plan), "; ")));
  }
  if (has("fovvideovdp")) {
    texts.push_back(fmt::format(
        "{}, {}", kFovVideoVdpParameters,
        c.original_border ? "the right border as its authors' program treats it" : "the right border corrected"));
  }
  return texts.empty() ? std::string() : fmt::format(" ({})", fmt::join(texts, "; "));
}

// Said of clips whose reference is a single picture.
std::string standing_pictures(const Results& results) {
  const bool stands = std::any_of(results.references.begin(), results.references.end(),
                                  [](const ResultReference& reference) { return reference.pictures == 1; });
  const bool is_clip =
      std::any_of(results.rows.begin(), results.rows.end(), [](const ResultRow& row) { return row.frames.size() > 1; });
  return stands && is_clip ? ", once for all frames where neither camera nor scene moves" : "";
}

}  // namespace

std::string sweep_methods(const SweepPlan& plan, const Results& results) {
  const SweepMeasure& m = plan.measure;
  const FrameRequest& request = plan.tests.front().plan.frames.front();
  const SweepReference& reference = plan.references.front();
  const DisplayPhotometry& p = m.comparison.photometry;
  std::string text = fmt::format(
      "Images were rendered with gazetrace {} ({}, {}; build {}) on {}, using {} threads, at {}x{} pixels and {:.4g} "
      "pixels per degree in the middle of the view. Scenes: {}. Gaze: {}. Settings that did not vary: {}; options that "
      "are "
      "not named were at the defaults of this version (results.json lists them). Measured settings: {}. ",
      kVersion, build_description(), instruction_set(), results.build.digest.substr(0, 12), results.machine.cpu,
      results.machine.threads.value_or(0), request.width_px, request.height_px, 1 / (request.view.step_x * kDegPerRad),
      scenes_of(plan), list_of(plan.gazes), list_of(plan.stated_settings), settings_of(plan));
  text += not_causal(plan);
  text += fmt::format("Pictures were shown and scored through the view {}. ", views_of(plan));
  text += fmt::format(
      "The reference of each scene is the mean of {} renderings of {} samples per pixel with independent scramblings "
      "(seeds {}), rendered with {}{}; no test shares a seed with it. Its own error was measured as the score of the "
      "mean of the first "
      "half "
      "of these against that of the second; scores better than it are reported as unresolved, and a quarter of the "
      "halves' mean squared difference, the variance of the reference, was subtracted from squared errors. ",
      reference.seeds.size(), reference.pipeline.foveation.spp.value_or(kUsualSpp), fmt::join(reference.seeds, ", "),
      light_of_references(plan), standing_pictures(results));
  text += fmt::format(
      "Every row was rendered {} times with different seeds, in rounds over all rows of a scene whose order "
      "alternates, "
      "after {} unmeasured frame(s) of each row; intervals are 95 % by Student's t over the repeats, those of "
      "speed-ups over the logarithms of pairwise ratios, and those of errors by the logarithm of their mean. Times are "
      "of the sampling map, training of path guiding, path tracing, "
      "reconstruction and "
      "temporal "
      "accumulation (and bilinear upscaling of linear light, where a picture was rendered on fewer pixels), without "
      "exposure, colour and files; speed-up is "
      "t_uniform / t_foveated at {} samples per pixel, through the same filter and temporal stage. ",
      m.repeats, m.warm_up, m.baselines.reference_spp);
  if (m.write_png || m.write_exr) {
    text += fmt::format(
        "End-to-end ratios are of these times and those of exposure, view and writing of the pictures ({}) in the "
        "first repeat; reading the scene, done once for all rows, is not in them. ",
        m.write_png && m.write_exr ? "PNG and EXR"
        : m.write_png              ? "PNG"
                                   : "EXR");
  }
  text += fmt::format(
      "Efficiency is the expected over the measured time of tracing and reconstruction, the expected one from the cost "
      "of a "
      "sample in each region of a frame with {} samples in every pixel. Equal-sample baselines have the test's "
      "mean number of samples per pixel; rates of equal-time baselines were found by measurement and then measured "
      "like "
      "all others. ",
      m.efficiency_spp);
  text += fmt::format(
      "Metrics: {}{}; display of {} response and {:g} cd/m2 at a contrast of {:g}:1 under {:g} lux, of which a share "
      "of {:g} comes back. Eccentricity is the angle between the rays to the recorded gaze and to a pixel; bands of it "
      "begin at {} "
      "degrees. With any regions of a test, the fovea of the scores ends at {:g} and the intermediate region at "
      "{:g} "
      "degrees. Scores are means over frames in which the eye fixates or, where no frame is known to be of a fixation, "
      "over all with gaze",
      fmt::join(m.comparison.metrics, ", "), metric_settings(plan), name_of(m.comparison.metric.response), p.peak_cd_m2,
      p.contrast, p.ambient_lux, p.reflectivity, fmt::join(kEccentricityBandsDeg, ", "),
      m.comparison.regions.end_deg[0], m.comparison.regions.end_deg[1]);
  text += m.leave_out_s > 0 ? fmt::format(", the first {:g} s of each clip left out.", m.leave_out_s) : ".";
  return text + "\n";
}

}  // namespace gazetrace
