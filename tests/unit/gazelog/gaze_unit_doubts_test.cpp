// SPDX-License-Identifier: Apache-2.0
// Positions that cannot be of the unit that a log states.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "gazetrace/gaze_inspect.hpp"
#include "support/gaze_format_files.hpp"

namespace gazetrace::gaze_unit_doubts_test {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

// Gaze all over a display of 1920 x 1080 px, 530 x 300 mm, from 600 mm: x from `left` to `left + width`, y likewise.
std::string all_over(std::string_view unit, double left, double top, double width, double height) {
  std::string text =
      fmt::format("# display_px 1920 1080\n# display_mm 530 300\n# distance_mm 600\nt[ms],x[{0}],y[{0}]\n", unit);
  for (int i = 0; i < 1000; ++i) {
    const double x = 0.5 + 0.4 * std::sin(i / 25 * 2.3) + 0.01 * std::sin(i * 1.9);
    const double y = 0.5 + 0.4 * std::cos(i / 25 * 3.7) + 0.01 * std::cos(i * 1.3);
    text += fmt::format("{},{:.4f},{:.4f}\n", 2 * i, left + width * x, top + height * y);
  }
  return text;
}

class GazeUnitDoubts : public GazeFormats {
 protected:
  GazeInspection inspect(std::string_view text) {
    return inspect_gaze(load_for_inspection(files_.write("a.csv", text), {}), {});
  }
  void expect_setting(std::string_view text, const std::string& words, const std::string& setting) {
    const GazeInspection report = inspect(text);
    ASSERT_THAT(report.settings, ElementsAre(setting)) << text.substr(0, 100);
    EXPECT_EQ(report.findings.front().code, "position-unit");
    EXPECT_EQ(report.findings.front().kind, FindingKind::suspicion);
    EXPECT_THAT(report.findings.front().what, HasSubstr(words));
    EXPECT_THAT(report.axes[0].evidence, HasSubstr("not tested"));
  }
};

TEST_F(GazeUnitDoubts, PixelsAreNoOtherUnit) {
  expect_setting(all_over("deg", 0, 0, 1920, 1080), "no degrees but pixels", "`unit` px");
  expect_setting(all_over("mm", 0, 0, 1920, 1080), "no millimetres but pixels", "`unit` px");
  expect_setting(all_over("cm", 0, 0, 1920, 1080), "no centimetres but pixels", "`unit` px");
  expect_setting(all_over("deg", -960, -540, 1920, 1080), "no degrees but pixels", "`unit` px `origin` center");
}

TEST_F(GazeUnitDoubts, AFewRowsTellPixelsFromFractions) {
  expect_setting("# display_px 1920 1080\nt[ms],u,v\n0,960,540\n10,964,541\n20,955,538\n",
                 "no fractions of the display but pixels", "`unit` px");
  for (const std::string_view text :
       {// Beside the display, a mark among places, and both sides of the corner: nothing that three rows could tell.
        "t[ms],u,v\n0,1.3,0.5\n10,-0.4,2.1\n20,1.2,0.6\n", "t[ms],u,v\n0,0.5,0.5\n10,0.51,0.5\n20,-100,-100\n",
        "t[ms],u,v\n0,-0.2,-0.2\n10,0,0.01\n20,0.2,0.2\n"}) {
    for (const GazeFinding& finding : inspect(text).findings) {
      EXPECT_NE(finding.code, "position-unit") << text;
      EXPECT_NE(finding.code, "origin") << text;
    }
  }
}

TEST_F(GazeUnitDoubts, MillimetresAreNoCentimetresAndFractionsNeither) {
  expect_setting(all_over("cm", 0, 0, 530, 300), "no centimetres but millimetres", "`unit` mm");
  expect_setting(all_over("cm", 0, 0, 1, 1), "no centimetres but fractions", "`unit` fraction");
  expect_setting(all_over("mm", 0, 0, 1, 1), "no millimetres but fractions", "`unit` fraction");
}

TEST_F(GazeUnitDoubts, WhatIsStatedIsBelieved) {
  for (const std::string& text :
       {all_over("mm", 0, 0, 530, 300), all_over("cm", 0, 0, 53, 30), all_over("deg", -23, -14, 46, 28),
        all_over("deg", -0.7, -0.7, 1.4, 1.4), all_over("deg", -80, -60, 160, 120),
        // A display below the one looked at, now and then.
        all_over("mm", 0, 0, 530, 560)}) {
    EXPECT_THAT(inspect(text).settings, IsEmpty()) << text.substr(0, 200);
  }
}

TEST_F(GazeUnitDoubts, AMarkIsNoOtherUnit) {
  std::string text = all_over("deg", -20, -12, 40, 24);
  for (int i = 1000; i < 1150; ++i) {
    text += fmt::format("{},-100,-100\n", 2 * i);
  }
  for (const GazeFinding& finding : inspect(text).findings) {
    EXPECT_NE(finding.code, "position-unit");
  }
}

}  // namespace
}  // namespace gazetrace::gaze_unit_doubts_test
