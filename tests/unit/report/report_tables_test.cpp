// SPDX-License-Identifier: Apache-2.0
// Tables of a report and their CSV: what stands in which column, and what is missing.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <sstream>

#include "report/tables.hpp"
#include "report/words.hpp"
#include "support/report_results.hpp"

namespace gazetrace {
namespace {

using testing::HasSubstr;
using testing::Not;

TEST(ReportTables, RegionsAndWeightedScores) {
  ordered_json test = row("t", "test", score(0.1, 0.09, 0.11));
  EXPECT_THAT(scored_parts(read(results({test}))), testing::IsEmpty());
  test["scores"]["flip"]["fovea"] = score(0.0123, 0.012, 0.0126);
  test["scores"]["flip"]["weighted"] = score(0.0345, 0.034, 0.035);
  test["scores"]["flip"]["2.6-60"] = score(0.0567, 0.056, 0.057);
  const Results data = read(results({test}));
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
  const Results data = read(results({test}));
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
  const std::string csv = results_csv(data);
  EXPECT_EQ(cells(csv, 1).size(), cells(csv, 0).size());
  const std::vector<std::string> names = cells(csv, 0);
  const auto at = std::find(names.begin(), names.end(), "end_to_end");
  ASSERT_NE(at, names.end());
  EXPECT_EQ(*(at - 1), "speed_up_high");
  EXPECT_EQ(cells(csv, 1).at(static_cast<std::size_t>(at - names.begin())), "2.125");
  // What it is: in the methods, and above the tables where a sweep's own methods may say nothing of it.
  const char* const words = "end-to-end is the same ratio with exposure, view and writing of the pictures";
  EXPECT_THAT(results_methods(data), HasSubstr(words));
  ordered_json told = results({test});
  told["methods"] = "As ever.";
  EXPECT_THAT(page_of(read(told)), HasSubstr(words));
}

TEST(ReportTables, EndToEndMayBeMissing) {
  for (const bool is_null : {false, true}) {
    ordered_json test = row("t", "test", score(0.1, 0.09, 0.11));
    if (is_null) {
      test["end_to_end"] = nullptr;
    }
    const Results data = read(results({test}));
    EXPECT_FALSE(data.rows[0].end_to_end);
    EXPECT_THAT(tables_html(data), HasSubstr("<td>4<small>3.8 to 4.2</small></td><td>–</td><td>–</td>"));
    EXPECT_THAT(results_csv(data), HasSubstr(",4,3.8,4.2,,,flip,whole,"));
  }
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
  const Results data = read(json);
  const std::string csv = results_csv(data);
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
  EXPECT_THAT(results_csv(read(json)), HasSubstr("flip,whole,0.1,0.09,0.11,1,\n"));
}

}  // namespace
}  // namespace gazetrace
