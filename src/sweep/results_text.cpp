// SPDX-License-Identifier: Apache-2.0
// What a person reads: the table on the terminal, and the paragraph for a paper.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "gazetrace/sweep.hpp"
#include "gazetrace/version.hpp"

namespace gazetrace {
namespace {

// "0.1234 +-0.0012"
std::string with_spread(const Interval& interval, const char* unit = "") {
  std::string text = fmt::format("{:.4g}{}", interval.mean, unit);
  if (interval.low && interval.high) {
    text += fmt::format(" +-{:.2g}", (*interval.high - *interval.low) / 2);
  }
  return text;
}

// "3.05 (2.91 to 3.2)": intervals of ratios are not symmetric.
std::string ratio_text(const Interval& ratio) {
  return fmt::format("{:.4g}", ratio.mean) +
         (ratio.low && ratio.high ? fmt::format(" ({:.3g} to {:.3g})", *ratio.low, *ratio.high) : std::string());
}

std::string score_text(const SweepRow& row, const std::string& metric) {
  const auto parts = row.scores.find(metric);
  if (parts == row.scores.end() || !parts->second.contains("whole")) {
    return "-";
  }
  const SweepScore& score = parts->second.at("whole");
  return with_spread(score.value) + (score.resolved ? "" : " unresolved");
}

std::string place_heading(const SweepRow& row) {
  return fmt::format("\n{}, gaze {}\n", row.scene, row.gaze);
}

std::string aligned(const std::vector<std::vector<std::string>>& lines) {
  std::vector<std::size_t> widths(lines.front().size());
  for (const auto& line : lines) {
    for (std::size_t c = 0; c < line.size(); ++c) {
      widths[c] = std::max(widths[c], line[c].size());
    }
  }
  std::string text;
  for (const auto& line : lines) {
    std::string one;
    for (std::size_t c = 0; c < line.size(); ++c) {
      one += fmt::format("{:<{}}  ", line[c], widths[c]);
    }
    one.erase(one.find_last_not_of(' ') + 1);
    text += one + "\n";
  }
  return text;
}

std::string published_text(const SweepResults& results) {
  std::string text;
  for (const SweepRow& row : results.rows) {
    for (const SweepPublished& other : row.published) {
      text += fmt::format("  {}/{} {}: {} here, {:g} in {}\n", row.scene, row.gaze, row.label, ratio_text(row.speed_up),
                          other.speed_up, other.source);
    }
  }
  return text.empty() ? text : "\nspeed-up beside what was published\n" + text;
}

std::string fixed_quality_text(const SweepResults& results) {
  std::string text;
  for (const SweepFixedQuality& one : results.fixed_quality) {
    const FixedQuality& r = one.result;
    text += fmt::format("  {}/{} {} {:g}: {}{}\n", one.scene, one.gaze, one.metric, one.at,
                        r.speed_up ? fmt::format("{}{}{:.3g}", r.bound, r.bound.empty() ? "" : " ", *r.speed_up) : "-",
                        r.why.empty() ? "" : " (" + r.why + ")");
  }
  return text.empty() ? text : "\nspeed-up at fixed quality, t_uniform / t_foveated\n" + text;
}

std::string controls_text(const SweepResults& results) {
  std::string text;
  for (const SweepControl& control : results.controls) {
    text += fmt::format("  {}/{} {} {}, gaze {}: {:.4g}, with the right one {:.4g}: {}{}\n", control.scene,
                        control.gaze, control.of, control.metric, control.wrong, control.wrong_score.mean,
                        control.right.mean, control.sensitive ? "sensitive" : "not sensitive",
                        control.why.empty() ? "" : " (" + control.why + ")");
  }
  return text.empty() ? text : "\ncontrols with a wrong gaze\n" + text;
}

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

// Of the tests, each once.
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

}  // namespace

std::string sweep_table(const SweepPlan& plan, const SweepResults& results) {
  std::vector<std::string> header{"id", "role", "setting", "s a frame", "spp", "speed-up", "efficiency"};
  const std::vector<std::string>& metrics = plan.measure.comparison.metrics;
  header.insert(header.end(), metrics.begin(), metrics.end());
  std::string text = plan.title + "\n";
  std::vector<std::string> places;
  for (const SweepRow& row : results.rows) {
    const std::string place = place_heading(row);
    if (std::find(places.begin(), places.end(), place) == places.end()) {
      places.push_back(place);
    }
  }
  for (const std::string& place : places) {
    std::vector<std::vector<std::string>> lines{header};
    for (const SweepRow& row : results.rows) {
      if (place_heading(row) != place) {
        continue;
      }
      std::string role = to_string(row.role);
      if (row.role == SweepRole::equal_time) {
        role += fmt::format(", reached {}", ratio_text(row.reached));
      }
      lines.push_back({row.id, role, row.label, with_spread(row.time_s),
                       fmt::format("{:.4g}", row.runs.front().samples / row.compared_pixels),
                       row.speed_up.mean > 0 ? ratio_text(row.speed_up) : "-",
                       row.efficiency ? fmt::format("{:.0f} %", 100 * *row.efficiency) : "-"});
      for (const std::string& metric : metrics) {
        lines.back().push_back(score_text(row, metric));
      }
    }
    text += place + aligned(lines);
  }
  text += published_text(results) + fixed_quality_text(results) + controls_text(results);
  for (const std::string& note : results.notes) {
    text += "\nnote: " + note;
  }
  return text + (results.notes.empty() ? "" : "\n");
}

std::string sweep_methods(const SweepPlan& plan, const SweepResults& results) {
  const SweepMeasure& m = plan.measure;
  const FrameRequest& request = plan.tests.front().plan.frames.front();
  const SweepReference& reference = plan.references.front();
  const DisplayPhotometry& p = m.comparison.photometry;
  std::string text = fmt::format(
      "Images were rendered with gazetrace {} ({}, {}; build {}) on {}, using {} threads, at {}x{} pixels and {:.4g} "
      "pixels per degree in the middle of the view. Scenes: {}. Gaze: {}. Settings that did not vary: {}; options that "
      "are "
      "not named were at the defaults of this version (results.json lists them). Measured settings: {}. ",
      kVersion, build_description(), instruction_set(), results.build.substr(0, 12), results.machine, results.threads,
      request.width_px, request.height_px, 1 / (request.view.step_x * kDegPerRad), scenes_of(plan), list_of(plan.gazes),
      list_of(plan.stated_settings), settings_of(plan));
  text += fmt::format(
      "The reference of each scene is the mean of {} renderings of {} samples per pixel with independent scramblings "
      "(seeds {}); no test shares a seed with it. Its own error was measured as the score of the mean of the first "
      "half "
      "of these against that of the second; scores better than it are reported as unresolved, and a quarter of the "
      "halves' mean squared difference, the variance of the reference, was subtracted from squared errors. ",
      reference.seeds.size(), reference.pipeline.foveation.uniform_spp, fmt::join(reference.seeds, ", "));
  text += fmt::format(
      "Every row was rendered {} times with different seeds, in rounds over all rows of a scene whose order "
      "alternates, "
      "after {} unmeasured frame(s) of each row; intervals are 95 % by Student's t over the repeats, those of "
      "speed-ups "
      "over the logarithms of pairwise ratios. Times are of the sampling map, path tracing, reconstruction and "
      "temporal "
      "accumulation (and upscaling, for the low-resolution baseline), without exposure, colour and files; speed-up is "
      "t_uniform / t_foveated at {} samples per pixel, through the same filter and temporal stage. ",
      m.repeats, m.warm_up, m.baselines.reference_spp);
  text += fmt::format(
      "Efficiency is the expected over the measured time of tracing and reconstruction, the expected one from what a "
      "sample costs in each region of a frame with {} samples in every pixel. Equal-sample baselines have the test's "
      "mean number of samples per pixel; rates of equal-time baselines were found by measurement and then measured "
      "like "
      "all others. ",
      m.efficiency_spp);
  text += fmt::format(
      "Metrics: {}; display {:g} cd/m2 at a contrast of {:g}:1 under {:g} lux. Eccentricity is the angle between the "
      "rays to the recorded gaze and to a pixel. Scores are means over frames in which the eye fixates or, where no "
      "frame is known to be of a fixation, over all with gaze",
      fmt::join(m.comparison.metrics, ", "), p.peak_cd_m2, p.contrast, p.ambient_lux);
  if (const auto& wanted = m.comparison.metrics;
      std::find(wanted.begin(), wanted.end(), "fovvideovdp") != wanted.end()) {
    text += fmt::format(" ({})", kFovVideoVdpParameters);
  }
  text += m.leave_out_s > 0 ? fmt::format(", the first {:g} s of each clip left out.", m.leave_out_s) : ".";
  return text + "\n";
}

}  // namespace gazetrace
