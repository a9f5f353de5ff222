// SPDX-License-Identifier: Apache-2.0
// Results are written and read by one schema: what was written is read again, to the bit, and files of other versions
// are refused.
#include "gazetrace/results.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "gazetrace/error.hpp"
#include "gazetrace/output.hpp"
#include "results/lookup.hpp"
#include "support/temporary_folder.hpp"

namespace gazetrace::results_test {
namespace {

using nlohmann::ordered_json;
using testing::ElementsAre;
using testing::HasSubstr;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr std::array kAllRoles{RowRole::test,       RowRole::uniform_reference_rate, RowRole::equal_samples,
                               RowRole::equal_time, RowRole::low_resolution,         RowRole::uniform_rate,
                               RowRole::wrong_gaze};

Results read_text(const std::string& text) {
  const TemporaryFolder folder;
  write_text_atomically(folder / "results.json", text);
  return read_results(folder / "results.json");
}

ResultRow row_with_everything() {
  ResultRow row;
  row.id = "box-left-1-time";
  row.scene = "box";
  row.gaze = "left";
  row.label = "uniform, \"equal\" time, 3.1 spp";
  row.role = RowRole::equal_time;
  row.of = "box-left-1";
  row.curve = "0123abcd";
  row.wrong = "mirrored";
  row.baselines = {{"equal-samples", "box-left-1-samples"}};
  row.settings = {{"sampling", "uniform"}, {"spp", "3.1"}};
  row.resolution_scale = 0.5;
  row.reference = "box-a";
  row.time_s = Interval{0.1, 0.09, 0.11};
  row.times_s = {0.1 / 3, 0.2 / 3};
  row.output_s = 0.7 / 3;
  row.samples = 1e15 + 1;
  row.spp_mean = 3.1;
  row.rays = 1e6;
  row.peak_mib = 12.5;
  row.speed_up = Interval{4, 3.8, 4.2};
  row.end_to_end = 2.125;
  row.efficiency = 0.75;
  row.published = {{57.25, "Table 2"}};
  row.reached = Interval{1.01, std::nullopt, std::nullopt};
  row.scores["flip"]["whole"] = {Interval{0.1, 0.09, 0.11}, true};
  row.scores["flip"]["0-2.6"] = {std::nullopt, false};
  ResultFrame frame;
  frame.index = 7;
  frame.t_s = 6.5 / 24;
  frame.event = "fixation";
  frame.gaze_px = Vec2d{12.5, 1.0 / 3};
  frame.rings_px = {10.0 / 3, 20};
  frame.time_s = 0.1;
  frame.png = "frames/a/frame.0007.png";
  frame.flip_png = "frames/a/flip.0007.png";
  frame.scores = {{"flip", 0.1}, {"psnr", std::nullopt}};
  row.frames = {frame};
  return row;
}

Results results_with_everything() {
  Results results;
  results.title = "a <sweep>";
  results.plan_file = "plan.toml";
  results.build = {"0.1.0", "0123", "gcc", "avx2"};
  results.machine = {"a processor", 8};
  results.viewing.size_px = {64, 36};
  results.viewing.pixels_per_degree = 64.0 / 3;
  results.viewing.width_deg = 61;
  results.viewing.peak_cd_m2 = 200;
  results.viewing.contrast = 1000;
  results.viewing.ambient_lux = 250;
  results.viewing.model_gain = 1.5;
  results.viewing.model_gain_cut_4_cpd = 1.875;
  results.view = "ACES SDR";
  results.common_settings = {{"filter", "linear"}, {"bounces", "3"}};
  results.varied = {"sampling", "spp"};
  results.repeats = 2;
  results.bands_deg = {0, 2.6, 60};
  results.regions_deg = {2.6, 8.5};
  results.band_pixel_share = {{"left", {0.25, 0.5, 0.25}}};
  results.event_shares = {{"left", {{"fixation", 0.75}, {"blink", 0.25}}}};
  results.metrics = {{"flip", "", "a note", true}, {"psnr", "dB", "", false}};
  ResultReference reference;
  reference.scene = "box";
  reference.key = "box-a";
  reference.directory = "references/a";
  reference.png = "references/a/reference.####.png";
  reference.spp = 64;
  reference.pictures = 1;
  reference.seeds = {1, std::numeric_limits<std::uint64_t>::max()};  // more than a double can hold
  reference.floors = {{"right", {{"flip", {{"whole", 0.02}}}}, {}, {{"fixation", 1}}},
                      {"left", {{"flip", {{"whole", 0.01}}}}, {0.25, 0.5, 0.25}, {{"fixation", 0.75}}}};
  results.references = {reference};
  results.rows = {row_with_everything()};
  results.pareto = {{"flip", {{"box/left", {"a", "b"}}}}};
  results.fixed_quality = {{"flip", "box", "left", "region-blocks 1;1", 0.05, {3.5, ">", "never"}, 1.25}};
  results.controls = {{"box", "left", "box-left-1", "flip weighted", "mirrored", "why", 0.1, 0.2, true}};
  results.notes = {"a note"};
  results.methods = "Everything was measured.\n";
  return results;
}

TEST(Results, WhatIsWrittenIsReadAgainToTheBit) {
  const Results written = results_with_everything();
  const std::string text = results_json(written);
  const Results read = read_text(text);
  EXPECT_EQ(results_json(read), text);
  EXPECT_EQ(results_csv(read), results_csv(written));
  EXPECT_EQ(results_table(read), results_table(written));
  const ResultRow& row = read.rows.at(0);
  EXPECT_EQ(row.role, RowRole::equal_time);
  EXPECT_EQ(row.times_s, written.rows[0].times_s);
  EXPECT_EQ(row.output_s, written.rows[0].output_s);
  EXPECT_EQ(row.settings, written.rows[0].settings);
  EXPECT_FALSE(row.scores.at("flip").at("0-2.6").value);
  EXPECT_FALSE(row.scores.at("flip").at("0-2.6").is_resolved);
  EXPECT_EQ(row.frames.at(0).gaze_px->y, 1.0 / 3);
  EXPECT_EQ(read.references.at(0).seeds, written.references[0].seeds);
  EXPECT_EQ(read.references.at(0).floors.at(0).gaze, "right");  // as they were, not by name
  EXPECT_EQ(read.machine.threads, 8);
  EXPECT_EQ(read.view, "ACES SDR");
  EXPECT_EQ(read.controls.at(0).wrong_score, 0.2);
  EXPECT_EQ(read.fixed_quality.at(0).result.bound, ">");
  EXPECT_EQ(read.fixed_quality.at(0).model_gain, 1.25);
}

std::vector<std::string> keys_of(const ordered_json& json) {
  std::vector<std::string> keys;
  for (const auto& [key, value] : json.items()) {
    keys.push_back(key);
  }
  return keys;
}

// What scripts rely on: where one of these changes, the version of the file changes.
TEST(Results, TheKeysOfVersionOne) {
  const ordered_json json = ordered_json::parse(results_json(results_with_everything()));
  EXPECT_THAT(keys_of(json),
              ElementsAre("format", "title", "plan_file", "build", "machine", "viewing", "color", "common_settings",
                          "varied", "repeats", "bands_deg", "regions_deg", "band_pixel_share", "shares", "metrics",
                          "scenes", "rows", "pareto", "fixed_quality", "controls", "notes", "methods"));
  const ordered_json& row = json.at("rows").at(0);
  EXPECT_THAT(keys_of(row), ElementsAre("id", "scene", "gaze", "role", "of", "label", "curve", "wrong", "baselines",
                                        "settings", "resolution_scale", "reference", "time_s", "output_s", "samples",
                                        "spp_mean", "rays", "peak_mib", "speed_up", "end_to_end", "efficiency",
                                        "published", "reached", "scores", "frames"));
  EXPECT_THAT(keys_of(row.at("time_s")), ElementsAre("mean", "low", "high", "values"));
  EXPECT_THAT(keys_of(row.at("scores").at("flip").at("whole")), ElementsAre("mean", "low", "high", "resolved"));
  EXPECT_THAT(keys_of(row.at("frames").at(0)),
              ElementsAre("index", "t_s", "time_s", "event", "gaze_px", "rings_px", "png", "flip_png", "scores"));
  EXPECT_THAT(keys_of(json.at("scenes").at(0).at("reference")),
              ElementsAre("key", "spp", "frames_rendered", "seeds", "scramblings", "directory", "png", "floor",
                          "floor_by_gaze", "band_pixel_share_by_gaze", "shares_by_gaze"));
  EXPECT_THAT(keys_of(json.at("viewing")), ElementsAre("size_px", "ppd", "width_deg", "peak_cd_m2", "contrast",
                                                       "ambient_lux", "model_gain", "model_gain_cut_4_cpd"));
  EXPECT_THAT(keys_of(json.at("fixed_quality").at(0)),
              ElementsAre("metric", "at", "scene", "gaze", "curve", "speed_up", "bound", "why", "model_gain"));
  EXPECT_THAT(keys_of(json.at("controls").at(0)),
              ElementsAre("scene", "gaze", "metric", "of", "wrong", "right_score", "wrong_score", "sensitive", "why"));
}

// The results that are written hold something under every key, so that a key that is not read is found by the texts.
TEST(Results, ResultsWithEverythingHoldSomethingUnderEveryKey) {
  const ordered_json json = ordered_json::parse(results_json(results_with_everything()));
  const ordered_json blank = ordered_json::parse(results_json(Results()));
  for (const auto& [key, value] : json.items()) {
    if (key != "format") {
      EXPECT_NE(value, blank.at(key)) << key;
    }
  }
  const auto is_set = [](const ordered_json& value) { return !value.is_null() && value != "" && value != 0; };
  for (const auto& [key, value] : json.at("rows").at(0).items()) {
    EXPECT_TRUE(is_set(value)) << key;
  }
  for (const auto& [key, value] : json.at("rows").at(0).at("frames").at(0).items()) {
    EXPECT_TRUE(is_set(value)) << key;
  }
}

TEST(Results, WhatIsNotFiniteIsMissing) {
  Results results = results_with_everything();
  results.rows[0].time_s = Interval{kNan, std::nullopt, std::nullopt};
  results.rows[0].times_s = {kNan, 1};
  results.rows[0].scores["flip"]["whole"].value = Interval{std::numeric_limits<double>::infinity(), {}, {}};
  const std::string text = results_json(results);
  EXPECT_EQ(text.find("nan"), std::string::npos);
  const Results read = read_text(text);
  EXPECT_FALSE(read.rows[0].time_s);
  EXPECT_EQ(read.rows[0].times_s.size(), 2U);  // it was measured twice all the same
  EXPECT_TRUE(std::isnan(read.rows[0].times_s[0]));
  EXPECT_FALSE(read.rows[0].scores.at("flip").at("whole").value);
}

TEST(Results, FilesOfAnotherVersionAreRefused) {
  ordered_json json = ordered_json::parse(results_json(results_with_everything()));
  const auto complaint = [&]() -> std::string {
    try {
      read_text(json.dump());
    } catch (const Error& e) {
      EXPECT_EQ(e.kind(), ErrorKind::input);
      return e.what();
    }
    return {};
  };
  EXPECT_EQ(complaint(), "");
  json["format"] = "gazetrace-sweep-9";
  EXPECT_THAT(complaint(), HasSubstr("is of the format 'gazetrace-sweep-9', and this version reads "
                                     "gazetrace-sweep-1 only; write it again with gazetrace sweep"));
  json["format"] = 2;
  EXPECT_THAT(complaint(), HasSubstr("format: is no text"));
  json.erase("format");
  EXPECT_THAT(complaint(), HasSubstr("is no gazetrace-sweep-1 file: it has no 'format'"));
}

TEST(Results, WholeNumbersMustBeWhole) {
  ordered_json json = ordered_json::parse(results_json(results_with_everything()));
  const auto expect_refused = [&](const ordered_json::json_pointer& at, const ordered_json& value, const char* place) {
    ordered_json other = json;
    other[at] = value;
    try {
      read_text(other.dump());
      ADD_FAILURE() << place;
    } catch (const Error& e) {
      EXPECT_THAT(e.what(), HasSubstr(std::string(place) + ": is no such whole number"));
    }
  };
  expect_refused(ordered_json::json_pointer("/rows/0/frames/0/index"), 1.5, "rows[0].frames[0].index");
  expect_refused(ordered_json::json_pointer("/rows/0/frames/0/index"), 1e12, "rows[0].frames[0].index");
  expect_refused(ordered_json::json_pointer("/scenes/0/reference/seeds/0"), -1, "scenes[0].reference.seeds[0]");
}

TEST(Results, RolesHaveNames) {
  for (const RowRole role : kAllRoles) {
    EXPECT_EQ(row_role(to_string(role)), role) << to_string(role);
  }
  EXPECT_EQ(row_role("spare"), std::nullopt);
}

TEST(Results, FloorsAreThoseOfTheGaze) {
  const Results results = results_with_everything();
  const ResultReference& reference = results.references[0];
  EXPECT_EQ(find_floor(&reference, "right", "flip", "whole"), 0.02);
  EXPECT_EQ(find_floor(&reference, "up", "flip", "whole"), std::nullopt);
  EXPECT_EQ(find_floor(&reference, "left", "flip", "weighted"), std::nullopt);
  EXPECT_EQ(find_floor(nullptr, "left", "flip", "whole"), std::nullopt);
}

TEST(Results, ATableOfRowsWithoutScoresHasALineForEach) {
  Results results = results_with_everything();
  results.rows[0].scores.clear();
  const std::string csv = results_csv(results);
  EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), 2);
  // As many cells as there are columns: the two commas of the quoted label are none between cells.
  const std::size_t line = csv.find('\n') + 1;
  EXPECT_EQ(std::count(csv.begin(), csv.begin() + static_cast<std::ptrdiff_t>(line), ','),
            std::count(csv.begin() + static_cast<std::ptrdiff_t>(line), csv.end(), ',') - 2);
}

// Names that the system does not even look up: as one error of the library, not one of the language's.
TEST(Results, ANameThatCannotBeLookedUpIsAnErrorOfTheInput) {
  const std::string name(5000, 'a');
  try {
    (void)read_results(name);
    FAIL() << "was read";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::input);
    EXPECT_THAT(error.what(), HasSubstr("cannot be opened"));
  }
}

}  // namespace
}  // namespace gazetrace::results_test
