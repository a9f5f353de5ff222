// SPDX-License-Identifier: Apache-2.0
// Which eye is the flipped one, and what the verdict says of axes that nothing speaks of.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "gazetrace/gaze_inspect.hpp"
#include "support/gaze_format_files.hpp"

namespace gazetrace::gaze_axes_test {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

class GazeAxisFindings : public GazeFormats {
 protected:
  GazeInspection inspect(std::string_view name, std::string_view text, const GazeReadOptions& options = {}) {
    return inspect_gaze(load_for_inspection(files_.write(name, text), options), {});
  }
};

// Both eyes on 20 fixations over 1920 x 1080; the tracker's means stand behind them. `flipped` has y upside down in its
// samples.
std::string two_eyes(std::optional<Eye> flipped, bool with_means) {
  std::string rows;
  for (int fixation = 0; fixation < 20; ++fixation) {
    const double x = 200 + 70 * fixation;
    const double y = 540 + 300 * std::sin(fixation * 1.7);
    const int begin = 100 + 20 * fixation;
    const auto of = [&](Eye eye, double noise) { return eye == flipped ? 1080 - y - noise : y + noise; };
    for (int i = 0; i < 20; ++i) {
      const double noise = 0.3 * (i % 5);
      rows += fmt::format("{}\t {:.1f}\t {:.1f}\t 900.0\t {:.1f}\t {:.1f}\t 900.0\t.....\n", begin + i, x + noise,
                          of(Eye::left, noise), x + 4 - noise, of(Eye::right, noise));
    }
    for (const char eye : {'L', 'R'}) {
      rows += with_means ? fmt::format("EFIX {} {} {} 20 {:.1f} {:.1f} 900\n", eye, begin, begin + 19, x, y) : "";
    }
  }
  return asc("SAMPLES\tGAZE\tLEFT\tRIGHT\tRATE\t1000.00", rows);
}

// Gaze along a line of text: the eyes' heights hardly move, and not together, so that only the tracker's means of each
// eye tell which way up it is. Of the eyes in `with_means`.
std::string line_of_text(std::optional<Eye> flipped, std::string_view with_means) {
  std::string rows;
  for (int fixation = 0; fixation < 20; ++fixation) {
    const double x = 200 + 70 * fixation;
    const std::array<double, 2> y{500 + 4 * std::sin(fixation * 1.7), 503 + 4 * std::cos(fixation * 2.9)};
    const int begin = 100 + 20 * fixation;
    const auto of = [&](Eye eye, double noise) {
      const double at = y[eye == Eye::left ? 0 : 1] + noise;
      return eye == flipped ? 1080 - at : at;
    };
    for (int i = 0; i < 20; ++i) {
      const double noise = 0.3 * (i % 5);
      rows += fmt::format("{}\t {:.1f}\t {:.1f}\t 900.0\t {:.1f}\t {:.1f}\t 900.0\t.....\n", begin + i, x + noise,
                          of(Eye::left, noise), x + 4 - noise, of(Eye::right, noise));
    }
    for (const char eye : with_means) {
      rows +=
          fmt::format("EFIX {} {} {} 20 {:.1f} {:.1f} 900\n", eye, begin, begin + 19, x, y[eye == 'L' ? 0 : 1] + 0.6);
    }
  }
  return asc("SAMPLES\tGAZE\tLEFT\tRIGHT\tRATE\t1000.00", rows);
}

std::vector<std::string> codes(const GazeInspection& report) {
  std::vector<std::string> all;
  for (const GazeFinding& finding : report.findings) {
    if (finding.kind != FindingKind::note) {
      all.push_back(finding.code);
    }
  }
  return all;
}

TEST_F(GazeAxisFindings, WitnessesOfEachEyeTellWhichIsFlipped) {
  EXPECT_THAT(codes(inspect("whole.asc", two_eyes(std::nullopt, true))), IsEmpty());
  for (const Eye flipped : {Eye::left, Eye::right}) {
    const bool left = flipped == Eye::left;
    const std::string text = two_eyes(flipped, true);
    const GazeInspection report = inspect("a.asc", text);
    ASSERT_THAT(codes(report), ElementsAre("one-eye-flipped"));
    EXPECT_THAT(report.findings.front().what, HasSubstr(left ? "the left one has" : "the right one has"));
    EXPECT_THAT(report.settings, ElementsAre(left ? "`gaze-eye` right" : "`gaze-eye` left"));
    // The good eye alone is accused of nothing, the other of its axis.
    GazeReadOptions options;
    options.eye = left ? EyeChoice::right : EyeChoice::left;
    const GazeInspection good = inspect("a.asc", text, options);
    EXPECT_THAT(codes(good), IsEmpty());
    EXPECT_EQ(good.axes[1].verdict, AxisVerdict::confirmed);
    options.eye = left ? EyeChoice::left : EyeChoice::right;
    EXPECT_THAT(inspect("a.asc", text, options).settings, ElementsAre("`flip-y`"));
  }
}

// The eyes' positions tell nothing here, each eye's witness all.
TEST_F(GazeAxisFindings, NoEyesWitnessDecidesForTheOther) {
  const GazeInspection whole = inspect("whole.asc", line_of_text(std::nullopt, "LR"));
  ASSERT_TRUE(whole.disparity);
  EXPECT_LT(std::abs(whole.disparity->vertical_correlation), 0.5);
  EXPECT_THAT(codes(whole), IsEmpty());
  EXPECT_EQ(whole.axes[1].verdict, AxisVerdict::confirmed);
  for (const Eye flipped : {Eye::left, Eye::right}) {
    const bool left = flipped == Eye::left;
    const GazeInspection report = inspect("a.asc", line_of_text(flipped, "LR"));
    EXPECT_THAT(codes(report), ElementsAre("one-eye-flipped"));
    EXPECT_THAT(report.findings.front().what, HasSubstr(left ? "the left one has" : "the right one has"));
    EXPECT_THAT(report.settings, ElementsAre(left ? "`gaze-eye` right" : "`gaze-eye` left"));
    EXPECT_NE(report.axes[1].verdict, AxisVerdict::confirmed);
    EXPECT_EQ(report.axes[0].verdict, AxisVerdict::confirmed);
  }
}

TEST_F(GazeAxisFindings, AWitnessOfOneEyeLeavesTheOtherUntested) {
  for (const Eye flipped : {Eye::left, Eye::right}) {
    const GazeInspection report = inspect("a.asc", line_of_text(flipped, "L"));
    EXPECT_EQ(report.axes[1].verdict, AxisVerdict::undecided);
    EXPECT_THAT(report.axes[1].evidence, HasSubstr("nothing tells of the right eye"));
    if (flipped == Eye::left) {
      EXPECT_THAT(codes(report), ElementsAre("y-flip", "one-eye-untested"));
      EXPECT_THAT(report.settings, ElementsAre("`flip-y`", "`gaze-eye` left"));
    } else {
      EXPECT_THAT(codes(report), IsEmpty());
      EXPECT_THAT(report.verdict, HasSubstr("the direction of y could not be tested"));
    }
  }
}

// However often a file tells of a fixation: its samples are one account of it.
TEST_F(GazeAxisFindings, FixationsToldAgainAreOneAccount) {
  const std::string text = two_eyes(std::nullopt, true);
  std::string again;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = text.find('\n', at) + 1;
    const std::string line = text.substr(at, end - at);
    again += line.starts_with("EFIX") ? line + line + line : line;
    at = end;
  }
  for (const std::string& told : {text, again}) {
    const GazeInspection report = inspect("a.asc", told);
    EXPECT_EQ(report.axes[1].verdict, AxisVerdict::confirmed);
    EXPECT_THAT(report.axes[1].evidence, HasSubstr("40 values"));  // 20 of each eye
  }
}

TEST_F(GazeAxisFindings, WithoutAWitnessItCannotBeToldWhich) {
  const std::string text = two_eyes(Eye::left, false);
  const GazeInspection report = inspect("a.asc", text);
  ASSERT_THAT(codes(report), ElementsAre("one-eye-flipped"));
  EXPECT_THAT(report.findings.front().what, HasSubstr("left or right, it cannot be told"));
  EXPECT_THAT(report.settings, IsEmpty());
  EXPECT_THAT(report.axes[1].evidence, HasSubstr("opposite ways"));
  GazeReadOptions options;
  options.eye = EyeChoice::right;
  EXPECT_THAT(codes(inspect("a.asc", text, options)), IsEmpty());
}

TEST_F(GazeAxisFindings, TheVerdictSaysWhichAxesWereNotTested) {
  EXPECT_EQ(inspect("a.asc", two_eyes(std::nullopt, true)).verdict, "nothing suspicious was found");
  EXPECT_EQ(inspect("b.asc", two_eyes(std::nullopt, false)).verdict,
            "nothing suspicious was found; the direction of x and y could not be tested: the lines above say how to "
            "check it");
}

}  // namespace
}  // namespace gazetrace::gaze_axes_test
