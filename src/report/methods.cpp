// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include "report/words.hpp"

namespace gazetrace {
namespace {

std::string settings_text(const ReportSettingsList& settings) {
  std::vector<std::string> texts;
  for (const auto& [name, value] : settings) {
    texts.push_back(value == "true" ? name : fmt::format("{} {}", name, value));
  }
  std::string text;
  for (const std::string& one : texts) {
    text += (text.empty() ? "" : ", ") + one;
  }
  return text;
}

void add(std::string& text, const std::string& before, const std::string& value, const char* after = ".") {
  if (!value.empty()) {
    text += (text.empty() ? "" : " ") + before + value + after;
  }
}

}  // namespace

std::string report_methods(const ReportData& data) {
  if (!data.methods.empty()) {
    return data.methods;
  }
  std::string text;
  add(text, "Frames were rendered with gazetrace (", settings_text(data.build), ").");
  add(text, "Machine: ", settings_text(data.machine));
  add(text, "Viewing: ", settings_text(data.viewing));
  add(text, "Color: ", settings_text(data.color));
  for (const ReportScene& scene : data.scenes) {
    add(text, "Reference of " + scene.name + ": ", scene.reference_text);
  }
  add(text, "Common settings: ", settings_text(data.common_settings));
  add(text, "Varied: ", list_text(data.varied));
  for (const ReportRow* const test : test_rows(data)) {
    add(text, test->label + " (" + scene_gaze_text({test->scene, test->gaze}) + "): ", settings_text(test->settings));
  }
  std::vector<std::string> metrics;
  for (const ReportMetric& metric : data.metrics) {
    metrics.push_back(metric.note.empty() ? metric.name : metric.name + " (" + metric.note + ")");
  }
  add(text, "Metrics: ", list_text(metrics));
  add(text, "Bands of eccentricity about the true gaze, in degrees: ", list_text(data.bands));
  text +=
      " Speed-up is the time of uniform sampling at the reference rate over that of the foveated run; end-to-end is "
      "the same ratio with exposure, view and writing of the pictures, without reading the scene. Intervals are at "
      "95 %; values whose intervals overlap are not told apart. Scores under the difference of the reference from "
      "itself are unresolved.";
  return text;
}

}  // namespace gazetrace
