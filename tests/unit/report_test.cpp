// SPDX-License-Identifier: Apache-2.0
// Results in, texts out: what is missing stays missing, what is markup is shown as text, sentences follow the numbers.
#include "gazetrace/report.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <sstream>

#include "gazetrace/output.hpp"
#include "report/fill.hpp"
#include "report/plot.hpp"
#include "report/tables.hpp"
#include "report/words.hpp"
#include "support/temporary_folder.hpp"

namespace gazetrace {
namespace {

using nlohmann::ordered_json;
using testing::Contains;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

ordered_json estimate(double mean, double low, double high) {
  return {{"mean", mean}, {"low", low}, {"high", high}};
}

ordered_json score(double mean, double low, double high, bool resolved = true) {
  ordered_json json = estimate(mean, low, high);
  json["resolved"] = resolved;
  return json;
}

ordered_json row(const std::string& id, const std::string& role, const ordered_json& flip) {
  return {{"id", id},
          {"scene", "box"},
          {"gaze", "glide"},
          {"role", role},
          {"of", role == "test" ? ordered_json() : ordered_json("t")},
          {"label", "run " + id},
          {"settings", ordered_json::object()},
          {"time_s", estimate(2, 1.9, 2.1)},
          {"samples", 1e6},
          {"spp_mean", nullptr},
          {"rays", nullptr},
          {"peak_mib", nullptr},
          {"speed_up", estimate(4, 3.8, 4.2)},
          {"efficiency", nullptr},
          {"scores", {{"flip", {{"whole", flip}}}}},
          {"frames", ordered_json::array()}};
}

ordered_json results(const std::vector<ordered_json>& rows) {
  return {{"format", "gazetrace-sweep-1"},
          {"title", "a sweep"},
          {"bands_deg", {0, 2.6, 60}},
          {"metrics", {{{"name", "flip"}, {"better", "lower"}}}},
          {"scenes", {{{"name", "box"}, {"reference", {{"spp", 64}, {"floor", {{"flip", {{"whole", 0.01}}}}}}}}}},
          {"rows", rows}};
}

ReportData read(const ordered_json& json) {
  const TemporaryFolder folder;
  const std::string path = folder / "results.json";
  write_text_atomically(path, json.dump());
  return read_results(path);
}

std::string page_of(const ReportData& data) {
  return report_page(data, {}).html;
}

TEST(ReportWords, BandsAndLists) {
  EXPECT_THAT(read(results({})).bands, testing::ElementsAre("0-2.6", "2.6-60", "60+"));
  EXPECT_EQ(list_text({}), "");
  EXPECT_EQ(list_text({"a"}), "a");
  EXPECT_EQ(list_text({"a", "b", "c"}), "a, b and c");
  EXPECT_EQ(count_text(1234567.0), "1.235 M");
  EXPECT_EQ(count_text(std::nullopt), "–");
  EXPECT_EQ(with_interval(Estimate{0.5, 0.25, 0.75}), "0.5 (0.25 to 0.75)");
  EXPECT_EQ(with_interval(Estimate{0.5, std::nullopt, std::nullopt}), "0.5");
}

// Regions and weighted scores stand beside the bands, in tables and diagrams, only where some run has them.
TEST(ReportTables, RegionsAndWeightedScores) {
  ordered_json test = row("t", "test", score(0.1, 0.09, 0.11));
  EXPECT_THAT(scored_parts(read(results({test}))), testing::IsEmpty());
  test["scores"]["flip"]["fovea"] = score(0.0123, 0.012, 0.0126);
  test["scores"]["flip"]["weighted"] = score(0.0345, 0.034, 0.035);
  test["scores"]["flip"]["2.6-60"] = score(0.0567, 0.056, 0.057);
  const ReportData data = read(results({test}));
  EXPECT_THAT(scored_parts(data), testing::ElementsAre("2.6-60", "fovea", "weighted"));
  const std::string page = page_of(data);
  for (const char* const value : {"0.0123", "0.0345", "0.0567"}) {
    EXPECT_THAT(page, HasSubstr(value));
  }
  EXPECT_THAT(page, HasSubstr(">fovea</th>"));
  EXPECT_THAT(page, HasSubstr("2.6-60 deg</th>"));
  const std::vector<ReportPlot> plots = report_plots(data);
  const auto bars = std::find_if(plots.begin(), plots.end(), [](const ReportPlot& p) { return p.kind == "bands"; });
  ASSERT_NE(bars, plots.end());
  EXPECT_THAT(bars->csv, HasSubstr(",fovea,0.0123,"));
  EXPECT_EQ(part_text("intermediate"), "the intermediate region");
}

TEST(ReportTables, PublishedSpeedUpsStandBesideOurs) {
  ordered_json test = row("t", "test", score(0.1, 0.09, 0.11));
  EXPECT_THAT(page_of(read(results({test}))), Not(HasSubstr("what was published")));
  test["published"] = {{{"speed_up", 57.25}, {"source", "Table <2>"}}};
  const std::string page = page_of(read(results({test})));
  EXPECT_THAT(page, HasSubstr("Speed-up beside what was published"));
  EXPECT_THAT(page, HasSubstr("57.25"));
  EXPECT_THAT(page, HasSubstr("Table &lt;2&gt;"));
}

std::size_t count(const std::string& text, const std::string& words) {
  std::size_t n = 0;
  for (std::size_t at = text.find(words); at != std::string::npos; at = text.find(words, at + 1)) {
    ++n;
  }
  return n;
}

// Cells of a line of the CSV; none of these holds a comma.
std::vector<std::string> cells(const std::string& csv, std::size_t line) {
  std::istringstream lines(csv);
  std::string text;
  for (std::size_t i = 0; i <= line; ++i) {
    std::getline(lines, text);
  }
  std::istringstream values(text + ",");
  std::vector<std::string> result;
  for (std::string value; std::getline(values, value, ',');) {
    result.push_back(value);
  }
  return result;
}

TEST(ReportTables, EndToEndStandsAfterTheSpeedUp) {
  ordered_json test = row("t", "test", score(0.1, 0.09, 0.11));
  test["end_to_end"] = 2.125;
  test["efficiency"] = 0.75;
  const ReportData data = read(results({test}));
  EXPECT_EQ(data.rows[0].end_to_end, 2.125);
  const std::string html = tables_html(data);
  EXPECT_THAT(html, HasSubstr("speed-up</th><th scope=\"col\">end-to-end<small>with output</small></th>"
                              "<th scope=\"col\">efficiency</th>"));
  EXPECT_THAT(html, HasSubstr("<td>4<small>3.8 to 4.2</small></td><td>2.125</td><td>0.75</td>"));
  // Heads, the run and the floor have as many cells each.
  const std::string runs = html.substr(0, html.find("</table>"));
  const std::size_t columns = count(runs, "<th scope=\"col\">");
  EXPECT_EQ(count(runs, "<tr "), 2U);
  EXPECT_EQ(count(runs, "<td>"), 2 * (columns - 1));  // the first is a head of its own
  const std::string csv = report_csv(data);
  EXPECT_EQ(cells(csv, 1).size(), cells(csv, 0).size());
  const std::vector<std::string> names = cells(csv, 0);
  const auto at = std::find(names.begin(), names.end(), "end_to_end");
  ASSERT_NE(at, names.end());
  EXPECT_EQ(*(at - 1), "speed_up_high");
  EXPECT_EQ(cells(csv, 1).at(static_cast<std::size_t>(at - names.begin())), "2.125");
  // What it is: in the methods, and above the tables where a sweep's own methods may say nothing of it.
  const char* const words = "end-to-end is the same ratio with exposure, view and writing of the pictures";
  EXPECT_THAT(report_methods(data), HasSubstr(words));
  ordered_json told = results({test});
  told["methods"] = "As ever.";
  EXPECT_THAT(page_of(read(told)), HasSubstr(words));
}

// Results of earlier builds do not have it; of sweeps that wrote no pictures it is null.
TEST(ReportTables, EndToEndMayBeMissing) {
  for (const bool is_null : {false, true}) {
    ordered_json test = row("t", "test", score(0.1, 0.09, 0.11));
    if (is_null) {
      test["end_to_end"] = nullptr;
    }
    const ReportData data = read(results({test}));
    EXPECT_FALSE(data.rows[0].end_to_end);
    EXPECT_THAT(tables_html(data), HasSubstr("<td>4<small>3.8 to 4.2</small></td><td>–</td><td>–</td>"));
    EXPECT_THAT(report_csv(data), HasSubstr(",4,3.8,4.2,,,flip,whole,"));
  }
}

TEST(ReportFill, OnlyTheTemplateIsLookedAt) {
  EXPECT_EQ(fill_template("a {{x}} b {{y}}{{x}}", {{"x", "{{y}}"}, {"y", "2"}}), "a {{y}} b 2{{y}}");
  EXPECT_EQ(fill_template("no place", {}), "no place");
  EXPECT_THROW(fill_template("{{x}}", {}), std::out_of_range);
}

TEST(ReportFill, NoTagCanEndAScript) {
  const std::string json = ordered_json{{"a", "</script><!--<script>"}}.dump();
  const std::string safe = script_safe(json);
  EXPECT_EQ(safe.find('<'), std::string::npos);
  EXPECT_EQ(ordered_json::parse(safe), ordered_json::parse(json));
}

TEST(ReportPage, MarkupInResultsIsShownAsText) {
  ordered_json evil = row("t", "test", score(0.1, 0.09, 0.11));
  const std::string tag = "</script><img src=x onerror=alert(1)>\"'";
  evil["label"] = tag;
  evil["scene"] = tag;
  ordered_json json = results({evil});
  json["title"] = tag;
  json["notes"] = {tag};
  json["scenes"][0]["name"] = tag;
  const std::string page = page_of(read(json));
  EXPECT_THAT(page, Not(HasSubstr("<img")));
  EXPECT_THAT(page, HasSubstr("&lt;img src=x"));
}

TEST(ReportPage, NoRows) {
  const ReportData data = read(results({}));
  EXPECT_THAT(report_plots(data), IsEmpty());
  const std::string page = page_of(data);
  EXPECT_THAT(page, HasSubstr("Nothing has been measured yet"));
  EXPECT_THAT(page, HasSubstr("No foveated run has been measured"));
}

TEST(ReportPage, TablesAboveTheLimitAreSaid) {
  const ReportData data = read(results({row("t", "test", score(0.1, 0.09, 0.11))}));
  EXPECT_THAT(report_page(data, {0.001, 0}).warnings, Contains(HasSubstr("more than the limit of 0.001 MiB")));
  EXPECT_THAT(report_page(data, {1, 0}).warnings, IsEmpty());
}

TEST(ReportPage, NullsAreMissingAndNeverNan) {
  ordered_json blank = row("t", "test", {{"mean", nullptr}, {"low", nullptr}, {"high", nullptr}, {"resolved", true}});
  blank["time_s"] = nullptr;
  blank["speed_up"] = {{"mean", nullptr}, {"low", nullptr}, {"high", nullptr}};
  blank["frames"] = {{{"index", 1},
                      {"t_s", 0},
                      {"time_s", nullptr},
                      {"gaze_px", nullptr},
                      {"png", nullptr},
                      {"scores", {{"flip", nullptr}}}}};
  ordered_json once = row("u", "equal-time", score(0.1, 0, 0));
  once["scores"]["flip"]["whole"] = {{"mean", 0.1}, {"low", nullptr}, {"high", nullptr}, {"resolved", true}};
  once["time_s"] = {{"mean", 2}, {"low", nullptr}, {"high", nullptr}};
  const ReportData data = read(results({blank, once}));
  EXPECT_FALSE(data.rows[0].time_s);
  EXPECT_FALSE(data.rows[0].speed_up);
  EXPECT_FALSE(find_score(data.rows[0], "flip", "whole")->value);
  const std::string text = tables_html(data) + report_csv(data) + report_methods(data);
  for (const ReportPlot& plot : report_plots(data)) {
    EXPECT_THAT(plot.svg + plot.csv, Not(testing::ContainsRegex("[^a-z]-?(nan|inf)[^a-z]")));
  }
  EXPECT_THAT(text, Not(testing::ContainsRegex("[^a-z]-?(nan|inf)[^a-z]")));
  EXPECT_THAT(tables_html(data), HasSubstr("<td>–</td>"));
  EXPECT_THAT(report_findings(data).losses, IsEmpty());  // nothing is known of either
}

TEST(ReportPage, OneFrameOfOneValueHasDiagrams) {
  ordered_json one = row("t", "test", score(0.1, 0.1, 0.1));
  one["frames"] = {{{"index", 7}, {"t_s", 0.25}, {"time_s", 2}, {"event", "fixation"}, {"scores", {{"flip", 0.1}}}}};
  const std::vector<ReportPlot> plots = report_plots(read(results({one})));
  ASSERT_EQ(plots.size(), 2U);  // no bands were measured
  for (const ReportPlot& plot : plots) {
    EXPECT_THAT(plot.svg, Not(testing::ContainsRegex("[^a-z]-?(nan|inf)[^a-z]")));
  }
  EXPECT_EQ(plots[1].kind, "time");
  EXPECT_THAT(plots[1].csv, HasSubstr("t,test,run t,7,0.25,fixation,2,0.1\n"));
}

TEST(ReportPlots, NamesAreDistinctFileNames) {
  ordered_json a = row("a/b", "test", score(0.1, 0.09, 0.11));
  ordered_json b = row("a b", "test", score(0.1, 0.09, 0.11));
  a["frames"] = b["frames"] = {{{"index", 1}, {"t_s", 0}, {"time_s", 2}, {"scores", {{"flip", 0.1}}}}};
  std::vector<std::string> names;
  for (const ReportPlot& plot : report_plots(read(results({a, b})))) {
    names.push_back(plot.name);
  }
  EXPECT_THAT(names, testing::UnorderedElementsAre("pareto_box_glide_flip", "time_a-b_flip", "time_a-b_flip-2"));
}

TEST(ReportTables, UnresolvedScoresSaySo) {
  const std::string html = tables_html(read(results({row("t", "test", score(0.005, 0.004, 0.006, false))})));
  EXPECT_THAT(html, HasSubstr("<td class=\"unresolved\">0.005<small>unresolved</small></td>"));
  EXPECT_THAT(html, HasSubstr("<td>0.01</td>"));  // the floor
}

TEST(ReportTables, EqualTimeSaysWhatWasReachedAndFramesWhatTheEyeDid) {
  ordered_json late = row("u", "equal-time", score(0.1, 0.09, 0.11));
  late["reached"] = estimate(1.04, 1.01, 1.07);
  ordered_json json = results({row("t", "test", score(0.1, 0.09, 0.11)), late});
  json["shares"] = {{"glide", {{"fixation", 0.75}, {"in-flight", 0.25}, {"blink", 0}}}};
  const std::string html = tables_html(read(json));
  EXPECT_THAT(html, HasSubstr("<small>uniform, equal time: 1.04 (1.01 to 1.07) of its time</small>"));
  EXPECT_THAT(html, HasSubstr("box, gaze glide: Frames: fixation 75 % and in-flight 25 %."));
}

TEST(ReportTables, LongListsAreFolded) {
  const std::string eleven = list_html(std::vector<std::string>(11, "<a>"));
  EXPECT_THAT(eleven, Not(HasSubstr("<details>")));
  EXPECT_THAT(eleven, HasSubstr("<li>&lt;a&gt;</li>"));
  EXPECT_THAT(list_html(std::vector<std::string>(15, "a")), HasSubstr("<summary>5 more</summary>"));
}

TEST(ReportFindings, LossesFollowFromIntervalsApart) {
  const auto losses = [](const ordered_json& ours, const ordered_json& theirs) {
    return report_findings(read(results({row("t", "test", ours), row("u", "equal-time", theirs)}))).losses;
  };
  EXPECT_THAT(losses(score(0.12, 0.11, 0.13), score(0.10, 0.09, 0.105)),
              Contains(HasSubstr("uniform, equal time has the lower flip: 0.12 (0.11 to 0.13) against 0.1 (0.09 to "
                                 "0.105) in the whole frame")));
  EXPECT_THAT(losses(score(0.12, 0.11, 0.13), score(0.10, 0.09, 0.111)), IsEmpty());  // they overlap
  EXPECT_THAT(losses(score(0.10, 0.09, 0.105), score(0.12, 0.11, 0.13)), IsEmpty());  // a gain
  EXPECT_THAT(losses(score(0.002, 0.0019, 0.0021, false), score(0.001, 0.0009, 0.0011, false)), IsEmpty());
}

TEST(ReportFindings, TallyCountsEveryComparison) {
  ordered_json json =
      results({row("t", "test", score(0.12, 0.11, 0.13)), row("a", "equal-time", score(0.10, 0.09, 0.105)),
               row("b", "equal-samples", score(0.2, 0.19, 0.21)), row("c", "low-resolution", score(0.12, 0.11, 0.13)),
               row("d", "uniform-reference-rate", score(0.01, 0.009, 0.011))});
  EXPECT_THAT(report_findings(read(json)).tally,
              HasSubstr("1 better, 1 worse, 1 not told apart, 0 under the reference's own noise, 0 not known"));
  json["rows"][0]["scores"]["flip"]["whole"] = {{"mean", nullptr}, {"low", nullptr}, {"high", nullptr}};
  EXPECT_THAT(report_findings(read(json)).tally, HasSubstr("3 not known"));
  EXPECT_THAT(report_findings(read(json)).caveats, Contains(HasSubstr("no metric has a score")));
}

TEST(ReportPlots, IntervalsDoNotMakeTheMeansSmall) {
  ordered_json wide = row("t", "test", score(0.1, -7, 8));
  wide["time_s"] = estimate(0.02, -40, 40);
  const std::vector<ReportPlot> plots =
      report_plots(read(results({wide, row("u", "equal-time", score(0.2, 0.19, 0.21))})));
  ASSERT_EQ(plots.size(), 1U);
  EXPECT_THAT(plots[0].svg, Not(testing::ContainsRegex("[^a-z]-?(nan|inf)[^a-z]")));
  EXPECT_THAT(plotted_range({{0.1, -7, 8}, {0.2, 0.19, 0.21}}),
              testing::Each(testing::AllOf(testing::Ge(0.05), testing::Le(0.25))));
  const PlotScale scale({1, 100}, 0, 10, true);
  EXPECT_EQ(scale.within(-5), 0);
  EXPECT_EQ(scale.within(1e9), 10);
  EXPECT_NEAR(scale.within(10), 5, 1e-9);
}

TEST(ReportFindings, HigherMayBeBetter) {
  ordered_json json = results({row("t", "test", score(9.1, 9.0, 9.2)), row("u", "equal-time", score(9.5, 9.4, 9.6))});
  json["metrics"][0]["better"] = "higher";
  EXPECT_THAT(report_findings(read(json)).losses,
              Contains(HasSubstr("has the higher flip: 9.1 (9 to 9.2) against 9.5")));
  EXPECT_THAT(report_findings(read(json)).summary, Contains(HasSubstr("Beside uniform, equal time: worse in flip.")));
}

TEST(ReportFindings, SpeedAndWhatItIsWorth) {
  ordered_json slow = row("t", "test", score(0.1, 0.09, 0.11));
  slow["speed_up"] = estimate(0.8, 0.75, 0.85);
  ReportFindings findings = report_findings(read(results({slow})));
  EXPECT_THAT(findings.losses, Contains(HasSubstr("slower than uniform sampling")));
  EXPECT_THAT(findings.caveats, Contains(HasSubstr("nothing is claimed for foveation")));
  slow["speed_up"] = estimate(1.05, 0.95, 1.15);
  findings = report_findings(read(results({slow})));
  EXPECT_THAT(findings.summary, Contains(HasSubstr("not told apart from 1")));
  EXPECT_THAT(findings.losses, IsEmpty());
  ordered_json json = results({slow});
  json["controls"] = {{{"scene", "box"},
                       {"gaze", "glide"},
                       {"metric", "flip"},
                       {"wrong", "mirrored"},
                       {"right_score", 0.1},
                       {"wrong_score", 0.09},
                       {"sensitive", false}}};
  json["fixed_quality"] = {{{"metric", "flip"},
                            {"at", 0.05},
                            {"scene", "box"},
                            {"gaze", "glide"},
                            {"speed_up", 3},
                            {"bound", ">"},
                            {"why", "uniform never reaches it"}}};
  findings = report_findings(read(json));
  EXPECT_THAT(findings.caveats, Contains(HasSubstr("insensitive to gaze there")));
  EXPECT_THAT(findings.caveats, Contains(HasSubstr("is > 3, uniform never reaches it")));
}

ordered_json control(const char* metric, double right, double wrong) {
  return {{"scene", "box"},        {"gaze", "glide"},      {"metric", metric},     {"of", "t"},
          {"wrong", "mirrored"},   {"right_score", right}, {"wrong_score", wrong}, {"sensitive", false},
          {"why", "it was <said>"}};
}

// Worse is more for some metrics and less for others; one repeat, or a loss within their spread, decides nothing.
TEST(ReportFindings, ControlsMayBeUndecided) {
  ordered_json json = results({row("t", "test", score(0.1, 0.09, 0.11))});
  json["metrics"].push_back({{"name", "psnr"}, {"better", "higher"}});
  json["rows"][0]["scores"]["psnr"]["whole"] = score(30, 29, 31);
  const auto verdict = [&](const char* metric, double right, double wrong) {
    json["controls"] = ordered_json::array({control(metric, right, wrong)});
    const ReportData data = read(json);
    return control_verdict(data, data.controls[0]);
  };
  EXPECT_EQ(verdict("flip", 0.1, 0.13), ControlVerdict::undecided);
  EXPECT_EQ(verdict("flip", 0.1, 0.09), ControlVerdict::insensitive);
  EXPECT_EQ(verdict("flip weighted", 0.1, 0.13), ControlVerdict::undecided);
  EXPECT_EQ(verdict("psnr", 30, 29), ControlVerdict::undecided);
  EXPECT_EQ(verdict("psnr", 30, 31), ControlVerdict::insensitive);
  json["rows"][0]["scores"]["psnr"]["whole"] = {{"mean", 30}, {"low", nullptr}, {"high", nullptr}, {"resolved", true}};
  EXPECT_EQ(verdict("psnr", 30, 31), ControlVerdict::undecided);
  const ReportData data = read(json);
  EXPECT_THAT(report_findings(data).caveats,
              Contains(testing::AllOf(HasSubstr("psnr is 31 when the gaze is mirrored, against 30 when it is right; "
                                                "whether it notices is undecided (it was <said>)"),
                                      Not(HasSubstr("insensitive")))));
  const std::string html = tables_html(data);
  EXPECT_THAT(html, HasSubstr("<td>undecided</td><td class=\"words\">it was &lt;said&gt;</td>"));
  EXPECT_THAT(html, HasSubstr("rendered with a wrong gaze and scored with the right one"));
  json["controls"][0]["sensitive"] = true;
  EXPECT_THAT(report_findings(read(json)).caveats, Not(Contains(HasSubstr("when the gaze is"))));
}

TEST(ReportFindings, WhichFramesAreScored) {
  ordered_json json = results({row("t", "test", {{"mean", nullptr}, {"low", nullptr}, {"high", nullptr}})});
  const auto is_said = [&](const ordered_json& shares, const char* words) {
    json["shares"] = {{"glide", shares}};
    EXPECT_THAT(report_findings(read(json)).caveats,
                Contains(testing::AllOf(HasSubstr("no metric has a score"), testing::EndsWith(words))));
  };
  is_said({{"fixation", 0.5}, {"blink", 0.5}}, "Scores are of fixations.");
  is_said({{"fixation", 0.0}, {"in-flight", 1.0}}, "No frame is a fixation: scores are of the others that are seen.");
  is_said({{"in-flight", 1.0}}, "No frame is a fixation: scores are of the others that are seen.");
}

// Two sizes of one scene and gaze are measured against a reference each.
TEST(ReportTables, FloorsAreThoseOfEachRunsReference) {
  ordered_json small = row("s", "test", score(0.1, 0.09, 0.11));
  ordered_json large = row("l", "test", score(0.2, 0.19, 0.21));
  small["reference"] = "box-1";
  large["reference"] = "box-2";
  ordered_json json = results({small, large});
  const auto scene = [](const char* key, double floor) -> ordered_json {
    return {{"name", "box"}, {"reference", {{"key", key}, {"floor", {{"flip", {{"whole", floor}}}}}}}};
  };
  json["scenes"] = {scene("box-2", 0.151), scene("box-1", 0.121)};
  const ReportData data = read(json);
  const std::string csv = report_csv(data);
  EXPECT_THAT(csv, HasSubstr("flip,whole,0.1,0.09,0.11,1,0.121\n"));
  EXPECT_THAT(csv, HasSubstr("flip,whole,0.2,0.19,0.21,1,0.151\n"));
  const std::string html = tables_html(data);
  EXPECT_THAT(html, HasSubstr("reference box-1 from itself"));
  EXPECT_THAT(html, HasSubstr("reference box-2 from itself"));
  EXPECT_THAT(html, testing::AllOf(HasSubstr("<td>0.121</td>"), HasSubstr("<td>0.151</td>")));
  const std::vector<ReportPlot> plots = report_plots(data);
  ASSERT_FALSE(plots.empty());
  EXPECT_THAT(plots[0].svg,
              testing::AllOf(HasSubstr("reference box-1 from itself"), HasSubstr("reference box-2 from itself")));
  // A key that no reference has is nobody's floor.
  json["rows"][0]["reference"] = "box-3";
  EXPECT_THAT(report_csv(read(json)), HasSubstr("flip,whole,0.1,0.09,0.11,1,\n"));
}

TEST(ReportPlots, EachReferenceHasAFront) {
  ordered_json json = results({});
  json["scenes"] = {{{"name", "box"}, {"reference", {{"key", "box-1"}}}},
                    {{"name", "box"}, {"reference", {{"key", "box-2"}}}}};
  const auto add = [&](const char* id, const char* reference, double time_s, double flip) {
    ordered_json one = row(id, "test", score(flip, flip, flip));
    one["reference"] = reference;
    one["time_s"] = estimate(time_s, time_s, time_s);
    json["rows"].push_back(one);
  };
  add("a", "box-1", 1, 0.4);
  add("b", "box-1", 2, 0.2);
  add("c", "box-2", 3, 0.8);
  add("d", "box-2", 4, 0.6);
  add("e", "box-2", 5, 0.7);
  json["pareto"] = {
      {"flip",
       {{"box/glide/box-1", {"a", "b"}}, {"box/glide/box-2", {"d", "c"}}, {"box/glider", ordered_json::array({"e"})}}}};
  const auto plot = [&] { return report_plots(read(json)).at(0); };
  const auto lines = [](const std::string& svg) {
    std::size_t count = 0;
    for (std::size_t at = svg.find("class=\"front\""); at != std::string::npos;
         at = svg.find("class=\"front\"", at + 1)) {
      ++count;
    }
    return count;
  };
  const ReportPlot two = plot();
  EXPECT_EQ(lines(two.svg), 2U);
  EXPECT_THAT(two.svg, testing::AllOf(HasSubstr(">front of reference box-1<"), HasSubstr(">front of reference box-2<"),
                                      HasSubstr("of one reference each")));
  for (const char* const cells : {"1,a,", "2,b,", "3,c,", "4,d,"}) {
    EXPECT_THAT(two.csv, testing::ContainsRegex(std::string("\n") + cells + "[^\n]*,1,1\n"));
  }
  EXPECT_THAT(two.csv, testing::ContainsRegex("\n5,e,[^\n]*,1,0\n"));
  json["pareto"] = {{"flip", {{"box/glide", {"a", "b"}}}}};
  EXPECT_EQ(lines(plot().svg), 1U);
  EXPECT_THAT(plot().svg, testing::AllOf(HasSubstr("Broad line: Pareto front"), Not(HasSubstr("front of"))));
}

TEST(ReportMethods, BracesInNamesAreText) {
  ordered_json json = results({row("t", "test", score(0.1, 0.09, 0.11))});
  json["rows"][0]["label"] = "run {x} {}";
  json["rows"][0]["settings"] = {{"spp", 4}};
  json["scenes"][0]["name"] = "a {0:d} scene";
  const std::string methods = report_methods(read(json));
  EXPECT_THAT(methods, HasSubstr("run {x} {} (box, gaze glide): spp 4."));
  EXPECT_THAT(methods, HasSubstr("Reference of a {0:d} scene: spp 64."));
}

TEST(ReportFamilies, BaselinesThatSeveralTestsShare) {
  ordered_json first = row("t", "test", score(0.1, 0.09, 0.11));
  ordered_json second = row("t2", "test", score(0.1, 0.09, 0.11));
  first["baselines"] = second["baselines"] = {{"uniform-reference-rate", "u"}};
  const ReportData data = read(results({first, second, row("u", "uniform-reference-rate", score(0.1, 0.09, 0.11)),
                                        row("w", "wrong-gaze", score(0.1, 0.09, 0.11))}));
  const auto ids = [&](const ReportRow& test) {
    std::vector<std::string> found;
    for (const ReportRow* const one : family_of(data, test)) {
      found.push_back(one->id);
    }
    return found;
  };
  EXPECT_THAT(ids(data.rows[0]), testing::ElementsAre("t", "u", "w"));
  EXPECT_THAT(ids(data.rows[1]), testing::ElementsAre("t2", "u"));
  // Each run stands in the table once.
  const std::string html = tables_html(data);
  std::size_t count = 0;
  for (std::size_t at = html.find("run u"); at != std::string::npos; at = html.find("run u", at + 1)) {
    ++count;
  }
  EXPECT_EQ(count, 1U);  // of runs: there are no bands
}

TEST(ReportResults, ComplaintsNameThePlace) {
  const auto complaint = [](const ordered_json& json) -> std::string {
    try {
      read(json);
    } catch (const Error& e) {
      return e.what();
    }
    return {};
  };
  ordered_json json = results({row("t", "test", score(0.1, 0.2, 0.1))});
  EXPECT_THAT(complaint(json), HasSubstr("rows[0].scores.flip.whole: has its low above its high"));
  json = results({row("t", "test", score(0.1, 0.1, 0.1))});
  json["rows"][0].erase("role");
  EXPECT_THAT(complaint(json), HasSubstr("rows[0]: has no 'role'"));
  json["rows"] = "none";
  EXPECT_THAT(complaint(json), HasSubstr("rows: is no list"));
  json["format"] = "gazetrace-sweep-2";
  EXPECT_THAT(complaint(json), HasSubstr("is no gazetrace-sweep-1 file"));
}

}  // namespace
}  // namespace gazetrace
