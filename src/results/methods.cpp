// SPDX-License-Identifier: Apache-2.0
// The paragraph for a paper: that of the sweep, which knows its plan; without one, what the results themselves say.
#include <fmt/format.h>

#include "results/lookup.hpp"

namespace gazetrace {
namespace {

std::string settings_text(const NamedValues& settings) {
  std::string text;
  for (const auto& [name, value] : settings) {
    text += (text.empty() ? "" : ", ") + (value == "true" ? name : name + " " + value);
  }
  return text;
}

std::string reference_text(const ResultReference& reference) {
  std::string text = reference.spp ? fmt::format("spp {:.6g}", *reference.spp) : std::string();
  if (!reference.seeds.empty()) {
    text += fmt::format("{}seeds {}, scramblings {}", text.empty() ? "" : ", ", fmt::join(reference.seeds, ", "),
                        reference.seeds.size());
  }
  return text;
}

void add(std::string& text, const std::string& before, const std::string& value, const char* after = ".") {
  if (!value.empty()) {
    text += (text.empty() ? "" : " ") + before + value + after;
  }
}

}  // namespace

std::string results_methods(const Results& results) {
  if (!results.methods.empty()) {
    return results.methods;
  }
  std::string text;
  add(text, "Frames were rendered with gazetrace (", settings_text(facts_of(results.build)), ").");
  add(text, "Machine: ", settings_text(facts_of(results.machine)));
  add(text, "Viewing: ", settings_text(facts_of(results.viewing)));
  add(text, "Color: view ", results.view);
  for (const ResultReference& reference : results.references) {
    add(text, "Reference of " + reference.scene + ": ", reference_text(reference));
  }
  add(text, "Common settings: ", settings_text(results.common_settings));
  add(text, "Varied: ", list_text(results.varied));
  for (const ResultRow* const test : test_rows(results)) {
    add(text, test->label + " (" + scene_gaze_text({test->scene, test->gaze}) + "): ", settings_text(test->settings));
  }
  std::vector<std::string> metrics;
  for (const ResultMetric& metric : results.metrics) {
    metrics.push_back(metric.note.empty() ? metric.name : metric.name + " (" + metric.note + ")");
  }
  add(text, "Metrics: ", list_text(metrics));
  add(text, "Bands of eccentricity about the true gaze, in degrees: ", list_text(band_names(results.bands_deg)));
  text +=
      " Speed-up is the time of uniform sampling at the reference rate over that of the foveated run; end-to-end is "
      "the same ratio with exposure, view and writing of the pictures, without reading the scene. Intervals are at "
      "95 %; values whose intervals overlap are not told apart. Scores under the difference of the reference from "
      "itself are unresolved.";
  return text;
}

}  // namespace gazetrace
