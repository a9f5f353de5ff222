// SPDX-License-Identifier: Apache-2.0
// What is made of results by the program itself: the table of all scores, the paragraph of methods, and complaints
// about files. The results are invented.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "gazetrace/error.hpp"
#include "gazetrace/output.hpp"
#include "gazetrace/results.hpp"
#include "support/temporary_folder.hpp"

namespace gazetrace::results_texts_test {
namespace {

using nlohmann::ordered_json;
using testing::HasSubstr;

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

Results read(const ordered_json& json) {
  const TemporaryFolder folder;
  const std::string path = folder / "results.json";
  write_text_atomically(path, json.dump());
  return read_results(path);
}

TEST(ResultsMethods, BracesInNamesAreText) {
  ordered_json json = results({row("t", "test", score(0.1, 0.09, 0.11))});
  json["rows"][0]["label"] = "run {x} {}";
  json["rows"][0]["settings"] = {{"spp", 4}};
  json["scenes"][0]["name"] = "a {0:d} scene";
  const std::string methods = results_methods(read(json));
  EXPECT_THAT(methods, HasSubstr("run {x} {} (box, gaze glide): spp 4."));
  EXPECT_THAT(methods, HasSubstr("Reference of a {0:d} scene: spp 64."));
}

TEST(Results, ComplaintsNameThePlace) {
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

TEST(ResultsCsv, FloorsAreThoseOfEachRunsReference) {
  ordered_json small = row("s", "test", score(0.1, 0.09, 0.11));
  ordered_json large = row("l", "test", score(0.2, 0.19, 0.21));
  small["reference"] = "box-1";
  large["reference"] = "box-2";
  ordered_json json = results({small, large});
  const auto scene = [](const char* key, double floor) -> ordered_json {
    return {{"name", "box"}, {"reference", {{"key", key}, {"floor", {{"flip", {{"whole", floor}}}}}}}};
  };
  json["scenes"] = {scene("box-2", 0.151), scene("box-1", 0.121)};
  const std::string csv = results_csv(read(json));
  EXPECT_THAT(csv, HasSubstr("flip,whole,0.1,0.09,0.11,1,0.121,\n"));
  EXPECT_THAT(csv, HasSubstr("flip,whole,0.2,0.19,0.21,1,0.151,\n"));
  // A key that no reference has is nobody's floor.
  json["rows"][0]["reference"] = "box-3";
  EXPECT_THAT(results_csv(read(json)), HasSubstr("flip,whole,0.1,0.09,0.11,1,,\n"));
}

TEST(ResultsCsv, EndToEndStandsAfterTheSpeedUp) {
  ordered_json test = row("t", "test", score(0.1, 0.09, 0.11));
  EXPECT_THAT(results_csv(read(results({test}))), HasSubstr(",4,3.8,4.2,,,flip,whole,"));
  test["end_to_end"] = 2.125;
  test["efficiency"] = 0.75;
  EXPECT_THAT(results_csv(read(results({test}))), HasSubstr(",4,3.8,4.2,2.125,0.75,flip,whole,"));
}

}  // namespace
}  // namespace gazetrace::results_texts_test
