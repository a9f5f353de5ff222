// SPDX-License-Identifier: Apache-2.0
#include "report/tables.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <map>

#include "core/svg.hpp"
#include "report/words.hpp"

namespace gazetrace {
namespace {

class Html {
 public:
  template <class... Values>
  void add(fmt::format_string<Values...> pattern, Values&&... values) {
    fmt::format_to(std::back_inserter(text_), pattern, std::forward<Values>(values)...);
  }
  void begin_table(const std::string& caption) {
    add("<div class=\"scroll\" tabindex=\"0\" role=\"region\" aria-label=\"{0}\"><table><caption>{0}</caption>\n",
        escaped(caption));
  }
  void head(const std::vector<std::string>& names) {
    add("<thead><tr>");
    for (const std::string& name : names) {
      add("<th scope=\"col\">{}</th>", name);
    }
    add("</tr></thead>\n<tbody>\n");
  }
  void end_table() { add("</tbody></table></div>\n"); }
  void cell(const std::string& text) { add("<td>{}</td>", text); }
  void estimate(const std::optional<Interval>& value) {
    const std::string interval = interval_text(value);
    add("<td>{}{}</td>", mean_text(value), interval.empty() ? "" : "<small>" + interval + "</small>");
  }
  void score(const ResultScore* score) {
    if (score == nullptr || !score->value) {
      add("<td>–</td>");
    } else if (score->is_resolved) {
      estimate(score->value);
    } else {
      add("<td class=\"unresolved\">{}<small>unresolved</small></td>", mean_text(score->value));
    }
  }
  [[nodiscard]] const std::string& str() const { return text_; }

 private:
  std::string text_;
};

std::string metric_head(const ResultMetric& metric) {
  return fmt::format("{}<small>{} is better</small>", escaped(metric_text(metric)),
                     metric.is_lower_better ? "lower" : "higher");
}

std::string row_head(const ResultRow& row, const std::string& name) {
  std::string role = report_role(row.role).words;
  if (row.reached) {
    role += fmt::format(": {} of its time", with_interval(row.reached));
  }
  return fmt::format("<tr class=\"role-{}\"><th scope=\"row\">{}<small>{}</small></th>", to_string(row.role),
                     escaped(name), escaped(role));
}

// "Frames: fixation 80 %, in-flight 20 %."
std::string shares_text(const Results& data, const std::string& gaze) {
  const auto found = data.event_shares.find(gaze);
  std::vector<std::string> shares;
  if (found != data.event_shares.end()) {
    for (const auto& [event, share] : found->second) {
      if (share > 0) {
        shares.push_back(fmt::format("{} {:.3g} %", event, 100 * share));
      }
    }
  }
  return shares.empty() ? std::string() : "Frames: " + list_text(shares) + ".";
}

// The rows of a scene and gaze: first those that belong to no single test, then every test with its own baselines.
std::vector<const ResultRow*> rows_of(const Results& data, const SceneGaze& both) {
  std::map<std::string, int> tests_of;  // baseline -> how many tests stand beside it
  for (const ResultRow* const test : test_rows(data)) {
    for (const ResultRow* const row : family_of(data, *test)) {
      ++tests_of[row->id];
    }
  }
  std::vector<const ResultRow*> rows;
  for (const ResultRow& row : data.rows) {
    if (SceneGaze{row.scene, row.gaze} == both && row.role != RowRole::test && tests_of[row.id] != 1) {
      rows.push_back(&row);
    }
  }
  for (const ResultRow* const test : test_rows(data)) {
    if (SceneGaze{test->scene, test->gaze} == both) {
      for (const ResultRow* const row : family_of(data, *test)) {
        if (tests_of[row->id] == 1) {
          rows.push_back(row);
        }
      }
    }
  }
  return rows;
}

using RunNames = std::map<std::string, std::string>;

void add_runs(Html& html, const Results& data, const SceneGaze& both, const std::vector<const ResultRow*>& rows,
              const RunNames& names) {
  if (const std::string shares = shares_text(data, both.gaze); !shares.empty()) {
    html.add("<p class=\"small\">{}: {}</p>\n", escaped(scene_gaze_text(both)), escaped(shares));
  }
  html.begin_table(scene_gaze_text(both));
  std::vector<std::string> heads{"run", "time<small>s a frame</small>", "speed-up",
                                 "end-to-end<small>with output</small>", "efficiency"};
  for (const ResultMetric& metric : data.metrics) {
    heads.push_back(metric_head(metric));
  }
  for (const char* const cost : {"samples a pixel", "samples", "rays", "peak<small>MiB</small>"}) {
    heads.emplace_back(cost);
  }
  html.head(heads);
  for (const ResultRow* const row : rows) {
    html.add("{}", row_head(*row, names.at(row->id)));
    html.estimate(row->time_s);
    html.estimate(row->speed_up);
    html.cell(value_text(row->end_to_end));
    html.cell(value_text(row->efficiency));
    for (const ResultMetric& metric : data.metrics) {
      html.score(find_score(*row, metric.name, "whole"));
    }
    html.cell(value_text(row->spp_mean));
    html.cell(count_text(row->samples));
    html.cell(count_text(row->rays));
    html.cell(value_text(row->peak_mib));
    html.add("</tr>\n");
  }
  const std::vector<const ResultReference*> scenes = find_references(data, both);
  for (const ResultReference* const scene : scenes) {
    html.add(
        "<tr class=\"role-floor\"><th scope=\"row\">{} from itself<small>floor</small></th>"
        "<td></td><td></td><td></td><td></td>",
        escaped(reference_text(*scene, scenes.size())));
    for (const ResultMetric& metric : data.metrics) {
      html.cell(value_text(find_floor(scene, both.gaze, metric.name, "whole")));
    }
    html.add("<td></td><td></td><td></td><td></td></tr>\n");
  }
  html.end_table();
}

void add_bands(Html& html, const Results& data, const SceneGaze& both, const std::vector<const ResultRow*>& rows,
               const RunNames& names) {
  const std::vector<std::string> parts = scored_parts(data);
  if (parts.empty()) {
    return;
  }
  html.add("<details><summary>By eccentricity, {}</summary>\n", escaped(scene_gaze_text(both)));
  const auto shares = data.band_pixel_share.find(both.gaze);
  const std::vector<std::string> bands = band_names(data.bands_deg);
  for (const ResultMetric& metric : data.metrics) {
    html.begin_table(metric_text(metric) + (metric.is_lower_better ? ", lower is better" : ", higher is better"));
    std::vector<std::string> heads{"run"};
    for (const std::string& part : parts) {
      const auto band = std::find(bands.begin(), bands.end(), part);
      const auto b = static_cast<std::size_t>(band - bands.begin());
      const bool known = band != bands.end() && shares != data.band_pixel_share.end() && b < shares->second.size();
      heads.push_back(
          fmt::format("{}{}{}", escaped(part), band != bands.end() ? " deg" : "",
                      known ? fmt::format("<small>{:.3g} % of pixels</small>", 100 * shares->second[b]) : ""));
    }
    html.head(heads);
    for (const ResultRow* const row : rows) {
      html.add("{}", row_head(*row, names.at(row->id)));
      for (const std::string& part : parts) {
        html.score(find_score(*row, metric.name, part));
      }
      html.add("</tr>\n");
    }
    html.end_table();
  }
  html.add("</details>\n");
}

void add_published(Html& html, const Results& data) {
  const auto has = [](const ResultRow& row) { return !row.published.empty(); };
  if (std::none_of(data.rows.begin(), data.rows.end(), has)) {
    return;
  }
  html.begin_table("Speed-up beside what was published");
  html.head({"scene and gaze", "run", "here", "published", "where"});
  for (const ResultRow& row : data.rows) {
    for (const PublishedSpeedUp& other : row.published) {
      html.add("<tr><th scope=\"row\">{}</th>", escaped(scene_gaze_text({row.scene, row.gaze})));
      html.cell(escaped(row.label));
      html.estimate(row.speed_up);
      html.cell(value_text(other.speed_up));
      html.add("<td class=\"words\">{}</td></tr>\n", escaped(other.source));
    }
  }
  html.end_table();
}

void add_fixed_quality(Html& html, const Results& data) {
  if (data.fixed_quality.empty()) {
    return;
  }
  html.begin_table("Speed-up at fixed quality");
  html.head({"scene and gaze", "metric", "at", "speed-up", "by the model", "why not"});
  for (const ResultFixedQuality& fixed : data.fixed_quality) {
    html.add("<tr><th scope=\"row\">{}</th>",
             escaped(scene_gaze_text({fixed.scene, fixed.gaze}) + (fixed.curve.empty() ? "" : ", " + fixed.curve)));
    html.cell(escaped(fixed.metric));
    html.cell(value_text(fixed.at));
    html.cell(fixed.result.speed_up ? escaped(fixed.result.bound.empty() ? "" : fixed.result.bound + " ") +
                                          value_text(fixed.result.speed_up)
                                    : std::string("not known"));
    html.cell(value_text(fixed.model_gain));
    html.add("<td class=\"words\">{}</td></tr>\n", escaped(fixed.result.why));
  }
  html.end_table();
}

void add_controls(Html& html, const Results& data) {
  if (data.controls.empty()) {
    return;
  }
  html.add("<h3 id=\"controls\">Controls</h3>\n");
  html.begin_table("Controls: the same settings rendered with a wrong gaze and scored with the right one");
  html.head({"scene and gaze", "metric", "gaze", "right", "wrong", "does the metric notice", "why"});
  for (const ResultControl& control : data.controls) {
    html.add("<tr><th scope=\"row\">{}</th>", escaped(scene_gaze_text({control.scene, control.gaze})));
    html.cell(escaped(control.metric));
    html.cell(escaped(control.wrong));
    html.cell(value_text(control.right_score));
    html.cell(value_text(control.wrong_score));
    const ControlVerdict verdict = control_verdict(data, control);
    html.cell(verdict == ControlVerdict::sensitive     ? "yes"
              : verdict == ControlVerdict::insensitive ? "no: insensitive here"
                                                       : "undecided");
    html.add("<td class=\"words\">{}</td></tr>\n", escaped(control.why));
  }
  html.end_table();
}

}  // namespace

std::string tables_html(const Results& data) {
  Html html;
  const RunNames names = run_names(data);
  if (data.rows.empty()) {
    html.add("<p>Nothing has been measured yet.</p>\n");
  }
  for (const SceneGaze& both : scene_gazes(data)) {
    const std::vector<const ResultRow*> rows = rows_of(data, both);
    add_runs(html, data, both, rows, names);
    add_bands(html, data, both, rows, names);
  }
  add_published(html, data);
  add_fixed_quality(html, data);
  add_controls(html, data);
  return html.str();
}

std::string list_html(const std::vector<std::string>& items) {
  constexpr std::size_t kShown = 10;  // further items are folded away
  const auto list = [&](std::size_t begin, std::size_t end) {
    std::string text = "<ul>\n";
    for (std::size_t i = begin; i < end; ++i) {
      text += "<li>" + escaped(items[i]) + "</li>\n";
    }
    return text + "</ul>\n";
  };
  if (items.size() <= kShown + 1) {
    return list(0, items.size());
  }
  return list(0, kShown) + fmt::format("<details><summary>{} more</summary>\n", items.size() - kShown) +
         list(kShown, items.size()) + "</details>\n";
}

std::string findings_html(const ReportFindings& findings) {
  std::string text =
      findings.summary.empty() ? "<p>No foveated run has been measured.</p>\n" : list_html(findings.summary);
  if (!findings.summary.empty()) {
    text += "<div class=\"losses\"><h3>Where foveation loses</h3>\n";
    text += "<p>" + escaped(findings.tally) + "</p>\n";
    text += findings.losses.empty() ? std::string("<p>The intervals show no loss.</p>\n") : list_html(findings.losses);
    text += "</div>\n";
  }
  if (!findings.caveats.empty()) {
    text += "<h3>What these measurements do not say</h3>\n" + list_html(findings.caveats);
  }
  return text;
}

}  // namespace gazetrace
