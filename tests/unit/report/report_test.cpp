// SPDX-License-Identifier: Apache-2.0
// Results in, texts out: what is missing stays missing, what is markup is shown as text, sentences follow the numbers.
#include "gazetrace/report.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <set>

#include "report/fill.hpp"
#include "report/plot.hpp"
#include "report/tables.hpp"
#include "report/words.hpp"
#include "support/report_results.hpp"

namespace gazetrace {
namespace {

using testing::Contains;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

TEST(ReportWords, BandsAndLists) {
  EXPECT_THAT(band_names(read(results({})).bands_deg), testing::ElementsAre("0-2.6", "2.6-60", "60+"));
  EXPECT_EQ(list_text({}), "");
  EXPECT_EQ(list_text({"a"}), "a");
  EXPECT_EQ(list_text({"a", "b", "c"}), "a, b and c");
  EXPECT_EQ(count_text(1234567.0), "1.235 M");
  EXPECT_EQ(count_text(std::nullopt), "–");
  EXPECT_EQ(with_interval(Interval{0.5, 0.25, 0.75}), "0.5 (0.25 to 0.75)");
  EXPECT_EQ(with_interval(Interval{0.5, std::nullopt, std::nullopt}), "0.5");
}

TEST(ReportWords, EveryRoleIsCalledAndDrawnInItsOwnWay) {
  std::set<std::string> words;
  std::set<std::string> looks;
  for (const RowRole role :
       {RowRole::test, RowRole::uniform_reference_rate, RowRole::equal_samples, RowRole::equal_time,
        RowRole::low_resolution, RowRole::uniform_rate, RowRole::wrong_gaze}) {
    const ReportRole& shown = report_role(role);
    EXPECT_EQ(shown.name, to_string(role));
    EXPECT_TRUE(words.insert(shown.words).second) << shown.words;
    EXPECT_TRUE(looks.insert(shown.color).second) << shown.words;
  }
  EXPECT_EQ(words.size(), report_roles().size());
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
  const Results data = read(results({}));
  EXPECT_THAT(report_plots(data), IsEmpty());
  const std::string page = page_of(data);
  EXPECT_THAT(page, HasSubstr("Nothing has been measured yet"));
  EXPECT_THAT(page, HasSubstr("No foveated run has been measured"));
}

TEST(ReportPage, TablesAboveTheLimitAreSaid) {
  const Results data = read(results({row("t", "test", score(0.1, 0.09, 0.11))}));
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
  const Results data = read(results({blank, once}));
  EXPECT_FALSE(data.rows[0].time_s);
  EXPECT_FALSE(data.rows[0].speed_up);
  EXPECT_FALSE(find_score(data.rows[0], "flip", "whole")->value);
  const std::string text = tables_html(data) + results_csv(data) + results_methods(data);
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

TEST(ReportPlots, ALineSetsBandsApartFromRegions) {
  // Of three bands two have no pixels, so that the line stands behind the first of three groups of bars: at a third of
  // the way from 84 to 614.
  ordered_json one = row("t", "test", score(0.1, 0.09, 0.11));
  for (const char* const part : {"0-2.6", "fovea", "intermediate"}) {
    one["scores"]["flip"][part] = one["scores"]["flip"]["whole"];
  }
  const std::vector<ReportPlot> plots = report_plots(read(results({one})));
  const auto bands =
      std::find_if(plots.begin(), plots.end(), [](const ReportPlot& plot) { return plot.kind == "bands"; });
  ASSERT_NE(bands, plots.end());
  EXPECT_THAT(bands->svg, HasSubstr("stroke=\"#8a8a8a\" fill=\"none\" d=\"M260.7 "));
}

TEST(ReportPlots, LongTitlesTakeTwoLinesAndKeepTheirWords) {
  PlotSvg svg(100, "");
  svg.title("flip by eccentricity and region, courtyard, gaze reader: region-samples 32,16,8");
  EXPECT_THAT(svg.str(), HasSubstr(">flip by eccentricity and region, courtyard, gaze reader:<"));
  EXPECT_THAT(svg.str(), HasSubstr(">region-samples 32,16,8<"));
  PlotSvg words(100, "");
  words.title(std::string(40, 'a') + " " + std::string(40, 'b'));
  EXPECT_THAT(words.str(), HasSubstr(">" + std::string(40, 'b') + "<"));
  PlotSvg one(100, "");
  one.title(std::string(80, 'a'));
  EXPECT_THAT(one.str(), Not(HasSubstr("></text>")));
  EXPECT_THAT(one.str(), HasSubstr("aaa…<"));
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
    const Results data = read(json);
    return control_verdict(data, data.controls[0]);
  };
  EXPECT_EQ(verdict("flip", 0.1, 0.13), ControlVerdict::undecided);
  EXPECT_EQ(verdict("flip", 0.1, 0.09), ControlVerdict::insensitive);
  EXPECT_EQ(verdict("flip weighted", 0.1, 0.13), ControlVerdict::undecided);
  EXPECT_EQ(verdict("psnr", 30, 29), ControlVerdict::undecided);
  EXPECT_EQ(verdict("psnr", 30, 31), ControlVerdict::insensitive);
  json["rows"][0]["scores"]["psnr"]["whole"] = {{"mean", 30}, {"low", nullptr}, {"high", nullptr}, {"resolved", true}};
  EXPECT_EQ(verdict("psnr", 30, 31), ControlVerdict::undecided);
  const Results data = read(json);
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

// Two repeats give intervals such as 5e-6 to 7e7, which say nothing but that there were too few.
TEST(ReportFindings, TooFewRepeatsAreASentence) {
  ordered_json fast = row("t", "test", score(0.1, 0.09, 0.11));
  fast["speed_up"] = estimate(20, 5e-6, 7e7);
  const ReportFindings findings = report_findings(read(results({fast})));
  EXPECT_THAT(findings.headline, HasSubstr("20 times as fast"));
  EXPECT_THAT(findings.headline, HasSubstr("Too few repeats"));
  EXPECT_THAT(findings.summary, Contains(HasSubstr("too few repeats for an interval")));
  EXPECT_THAT(findings.summary, Not(Contains(HasSubstr("7e+07"))));
  EXPECT_THAT(tables_html(read(results({fast}))), Not(HasSubstr("7e+07")));
}

TEST(ReportFindings, ManyControlsAreCounted) {
  ordered_json json = results({row("t", "test", score(0.1, 0.09, 0.11))});
  json["controls"] = ordered_json::array();
  for (int i = 0; i < 45; ++i) {
    json["controls"].push_back(control("flip", 0.1, i < 40 ? 0.09 : 0.13));
  }
  const std::vector<std::string> caveats = report_findings(read(json)).caveats;
  EXPECT_THAT(caveats,
              Contains(HasSubstr("flip: of 45 controls with a wrong gaze it notices 0, is insensitive to 40, and 5 "
                                 "are undecided")));
  EXPECT_LT(caveats.size(), 5U);
}

// Runs that a reader would take for one another have names that tell them apart.
TEST(ReportPage, RunsHaveNamesThatTellThemApart) {
  ordered_json first = row("a", "test", score(0.1, 0.09, 0.11));
  ordered_json second = row("b", "test", score(0.2, 0.19, 0.21));
  ordered_json other = row("c", "equal-time", score(0.3, 0.29, 0.31));
  for (ordered_json* one : {&first, &second, &other}) {
    (*one)["label"] = "32 / 16 / 8";
  }
  first["settings"] = {{"filter", "guided"}};
  second["settings"] = {{"filter", "linear"}};
  const Results data = read(results({first, second, other}));
  const std::map<std::string, std::string> names = run_names(data);
  std::set<std::string> different;
  for (const auto& [id, name] : names) {
    different.insert(name);
  }
  EXPECT_EQ(different.size(), 3U);
  EXPECT_THAT(names.at("a"), HasSubstr("filter guided"));
  EXPECT_THAT(names.at("b"), HasSubstr("filter linear"));
}

TEST(ReportFindings, ARunThatSavesNothingIsNamed) {
  ordered_json test = row("t", "test", score(0.1, 0.09, 0.11));
  ordered_json uniform = row("u", "uniform-reference-rate", score(0.1, 0.09, 0.11));
  test["spp_mean"] = 31.4;
  uniform["spp_mean"] = 32.0;
  uniform["of"] = "t";
  const auto caveats = [&] { return report_findings(read(results({test, uniform}))).caveats; };
  EXPECT_THAT(caveats(), Contains(HasSubstr("it traces 31.4 samples a pixel where uniform has 32")));
  test["spp_mean"] = 3.0;
  EXPECT_THAT(caveats(), Not(Contains(HasSubstr("samples a pixel where uniform"))));
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
  const std::string methods = results_methods(read(json));
  EXPECT_THAT(methods, HasSubstr("run {x} {} (box, gaze glide): spp 4."));
  EXPECT_THAT(methods, HasSubstr("Reference of a {0:d} scene: spp 64."));
}

TEST(ReportFamilies, BaselinesThatSeveralTestsShare) {
  ordered_json first = row("t", "test", score(0.1, 0.09, 0.11));
  ordered_json second = row("t2", "test", score(0.1, 0.09, 0.11));
  first["baselines"] = second["baselines"] = {{"uniform-reference-rate", "u"}};
  const Results data = read(results({first, second, row("u", "uniform-reference-rate", score(0.1, 0.09, 0.11)),
                                     row("w", "wrong-gaze", score(0.1, 0.09, 0.11))}));
  const auto ids = [&](const ResultRow& test) {
    std::vector<std::string> found;
    for (const ResultRow* const one : family_of(data, test)) {
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
  json["rows"][0]["role"] = "spare";
  EXPECT_THAT(complaint(json), HasSubstr("rows[0].role: is no role of a row: 'spare'"));
  json["rows"][0].erase("role");
  EXPECT_THAT(complaint(json), HasSubstr("rows[0]: has no 'role'"));
  json["rows"] = "none";
  EXPECT_THAT(complaint(json), HasSubstr("rows: is no list"));
  json["format"] = "gazetrace-sweep-2";
  EXPECT_THAT(complaint(json), HasSubstr("is of the format 'gazetrace-sweep-2', and this version reads "
                                         "gazetrace-sweep-1 only"));
  json.erase("format");
  EXPECT_THAT(complaint(json), HasSubstr("is no gazetrace-sweep-1 file"));
}

}  // namespace
}  // namespace gazetrace
