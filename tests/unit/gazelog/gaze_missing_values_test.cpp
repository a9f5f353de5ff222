// SPDX-License-Identifier: Apache-2.0
// Marks of missing values that are numbers: what is always one, what the user names, and what only looks like one.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <tuple>
#include <utility>

#include "gazetrace/gaze_inspect.hpp"
#include "support/gaze_format_files.hpp"

namespace gazetrace::gaze_missing_values_test {
namespace {

using ::testing::HasSubstr;

class GazeMissingValues : public GazeFormats {
 protected:
  GazeInspection inspect(std::string_view name, std::string_view text, const GazeReadOptions& options = {}) {
    return inspect_gaze(load_for_inspection(files_.write(name, text), options), {});
  }
};

// 1000 rows in pixels of the middle of a display of 1920 x 1080; every 40th and the three behind it are `cells`,
// and of these every fifth time `others`.
std::string with_marks(const std::string& cells, const std::string& others = {}) {
  std::string text = "t[ms],x[px],y[px]\n";
  for (int i = 0; i < 1000; ++i) {
    const double phase = i * 0.7;
    const std::string& mark = i % 200 < 40 && !others.empty() ? others : cells;
    text += i % 40 < 4 ? fmt::format("{},{}\n", i, mark)
                       : fmt::format("{},{:.2f},{:.2f}\n", i, 900 + 90 * std::sin(phase), 500 + 80 * std::cos(phase));
  }
  return text;
}

GazeReadOptions full_hd() {
  GazeReadOptions options;
  options.display = DisplayGeometry{.width_px = 1920, .height_px = 1080};
  return options;
}

std::ptrdiff_t lost_rows(const GazeLog& log) {
  return std::count_if(log.samples.begin(), log.samples.end(),
                       [](const GazeSample& s) { return s.validity == GazeValidity::lost && std::isnan(s.u); });
}

const GazeFinding* finding(const GazeInspection& report, std::string_view code) {
  const auto found = std::find_if(report.findings.begin(), report.findings.end(),
                                  [&](const GazeFinding& f) { return f.code == code; });
  return found == report.findings.end() ? nullptr : &*found;
}

TEST_F(GazeMissingValues, NoUnitHasTheseCoordinates) {
  for (const std::string cells : {"-32768,-32768", "1e8,1e8", "100000000.0,100000000.0", "-1e7,-1e7", "900,-32768"}) {
    const GazeLog log = read("a.csv", with_marks(cells), full_hd());
    EXPECT_EQ(lost_rows(log), 100) << cells;
    EXPECT_EQ(finding(inspect("b.csv", with_marks(cells), full_hd()), "missing-value"), nullptr) << cells;
  }
  // Neither do they widen the range from which a unit is guessed.
  std::string fractions = "t[ms],x,y\n";
  for (int i = 0; i < 100; ++i) {
    fractions += i % 10 == 0 ? fmt::format("{},-32768,-32768\n", i) : fmt::format("{},0.4,0.{}\n", i, 1 + i % 8);
  }
  GazeReadOptions importing;
  importing.accepts_inferred = true;
  const GazeLog log = read("c.csv", fractions, importing);
  EXPECT_EQ(lost_rows(log), 10);
  EXPECT_EQ(log.samples[1].u, 0.4);
}

TEST_F(GazeMissingValues, DirectionsLikewise) {
  const std::string text =
      "t[ms],dx,dy,dz\n1,0,0,-1\n2,-32768,-32768,-32768\n3,1e8,1e8,1e8\n4,-9,-9,-9\n5,0,0,-1\n"
      "6,-9,0,0\n7,-9,-9,0\n8,0,0,-9\n";
  EXPECT_EQ(read("a.csv", text).samples[1].validity, GazeValidity::lost);
  EXPECT_EQ(read("a.csv", text).samples[2].validity, GazeValidity::lost);
  EXPECT_EQ(read("a.csv", text).samples[3].validity, GazeValidity::ok);
  GazeReadOptions options;
  options.missing_value = -9;
  EXPECT_EQ(read("a.csv", text, options).samples[3].validity, GazeValidity::lost);
  for (const std::size_t i : {4, 5, 6, 7}) {  // in all three
    EXPECT_EQ(read("a.csv", text, options).samples[i].validity, GazeValidity::ok) << i;
  }
}

TEST_F(GazeMissingValues, TheUserNamesOne) {
  GazeReadOptions options = full_hd();
  EXPECT_EQ(lost_rows(read("a.csv", with_marks("-1,-1"), options)), 0);
  options.missing_value = -1;
  EXPECT_EQ(lost_rows(read("a.csv", with_marks("-1,-1"), options)), 100);
  EXPECT_EQ(lost_rows(read("a.csv", with_marks("-1,5"), options)), 100);  // one axis is enough
  EXPECT_EQ(lost_rows(read("a.csv", with_marks("5,-1"), options)), 100);
  options.missing_value = 0;
  EXPECT_EQ(lost_rows(read("a.csv", with_marks("0,5"), options)), 0);  // the left edge is a place
  EXPECT_EQ(lost_rows(read("a.csv", with_marks("0,0"), options)), 100);
}

// `edf2asc -miss -1`; with corners that do not begin at zero the mark is still what the file has.
TEST_F(GazeMissingValues, EyeLinkOfAnotherMark) {
  std::string rows;
  for (int i = 0; i < 100; ++i) {
    // (9, 19) is at (-1, -1) of the second display, and is a place.
    rows += i == 55       ? fmt::format("{}\t 9.0\t 19.0\t 900.0\t...\n", 100 + i)
            : i % 10 == 0 ? fmt::format("{}\t -1\t -1\t 0.0\t...\n", 100 + i)
                          : fmt::format("{}\t {}\t 540.0\t 900.0\t...\n", 100 + i, 900 + i % 7);
  }
  std::string text = asc("SAMPLES\tGAZE\tLEFT\tRATE\t1000.00", rows);
  for (const std::string corners : {"0 0 1919 1079", "10 20 1929 1099"}) {
    text.replace(text.find("COORDS ") + 7, text.find("\nSTART") - text.find("COORDS ") - 7, corners);
    GazeReadOptions options;
    const GazeInspection report = inspect("a.asc", text);
    const GazeFinding* const found = finding(report, "missing-value");
    ASSERT_NE(found, nullptr) << corners;
    EXPECT_EQ(found->setting, "`missing-value` -1");
    options.missing_value = -1;
    EXPECT_EQ(lost_rows(read("a.asc", text, options)), 10) << corners;
    EXPECT_EQ(finding(inspect("a.asc", text, options), "missing-value"), nullptr);
  }
}

TEST_F(GazeMissingValues, TheDoctorNamesAMarkBesideTheDisplay) {
  const GazeInspection report = inspect("a.csv", with_marks("-1,-1"), full_hd());
  const GazeFinding* const found = finding(report, "missing-value");
  ASSERT_NE(found, nullptr);
  EXPECT_EQ(found->setting, "`missing-value` -1");
  EXPECT_THAT(found->what, HasSubstr("100 of 1000 rows are exactly at (-1, -1)"));
  EXPECT_THAT(report.verdict, HasSubstr("`missing-value` -1 mends it"));
  // One axis is enough, where no place on the display has this number.
  for (const auto& [cells, place, mark] :
       {std::tuple("-9999,-1", "(-9999, -1)", -9999), std::tuple("-1,500", "(-1, 500)", -1)}) {
    const std::string text = with_marks(cells);
    const GazeInspection unequal = inspect("b.csv", text, full_hd());
    ASSERT_NE(finding(unequal, "missing-value"), nullptr) << cells;
    EXPECT_EQ(finding(unequal, "missing-value")->setting, fmt::format("`missing-value` {}", mark));
    EXPECT_THAT(finding(unequal, "missing-value")->what, HasSubstr(place));
    GazeReadOptions options = full_hd();
    options.missing_value = mark;
    EXPECT_EQ(lost_rows(read("b.csv", text, options)), 100) << cells;
  }
  // Of two the one with more rows.
  const GazeInspection two = inspect("c.csv", with_marks("-1,-1", "-9,-9"), full_hd());
  ASSERT_NE(finding(two, "missing-value"), nullptr);
  EXPECT_EQ(finding(two, "missing-value")->setting, "`missing-value` -1");
}

// Whole pixels repeat in a fixation beside the display; they are come to by small steps.
TEST_F(GazeMissingValues, AFixationBesideTheDisplayIsNoMark) {
  std::string text = "t[ms],x[px],y[px]\n";
  for (int i = 0; i < 1000; ++i) {
    text += i < 500 ? fmt::format("{},{},{}\n", i, 900 + i * 7 % 5, 500 + i * 3 % 4)
                    : fmt::format("{},{},{}\n", i, 1930 + i * 7 % 5, 500 + i * 3 % 4);
  }
  EXPECT_EQ(finding(inspect("a.csv", text, full_hd()), "missing-value"), nullptr);
}

// A value held while the eye is lost, by a jump come to and left; rows of the two eyes, or of one eye written twice.
TEST_F(GazeMissingValues, AHeldValueIsNoMark) {
  for (const std::string_view eyes : {"left", "left right", "combined left"}) {
    std::string text = "t[ms],u[1],v[1],valid,eye\n";
    for (int i = 0; i < 2000; ++i) {
      const bool held = i >= 1000 && i < 1005;
      const bool lost = i == 1001 || i == 1003;
      const std::string cells = lost   ? "nan,nan,lost"
                                : held ? "-0.0302,-0.0815,ok"
                                       : fmt::format("{:.4f},{:.4f},ok", 0.5 + 0.2 * std::sin(i * 0.7), 0.4 + i * 1e-4);
      for (const std::string_view eye : {"left", "right", "combined"}) {
        text += eyes.find(eye) == std::string_view::npos ? "" : fmt::format("{},{},{}\n", i, cells, eye);
      }
    }
    EXPECT_EQ(finding(inspect("a.csv", text), "missing-value"), nullptr) << eyes;
  }
}

// Places that are come to by jumps alone, in one of 400 rows: a mark beside the display, on it and on its edges gaze.
TEST_F(GazeMissingValues, ASeldomPlaceOnTheDisplayIsNoMark) {
  const auto with_seldom_marks = [](const std::string& cells) {
    std::string text = "t[ms],x[px],y[px]\n";
    for (int i = 0; i < 8000; ++i) {
      text += i % 400 == 7 ? fmt::format("{},{}\n", i, cells)
                           : fmt::format("{},{:.2f},{:.2f}\n", i, 900 + 90 * std::sin(i * 0.7), 500 + 0.01 * i);
    }
    return text;
  };
  for (const std::string cells : {"300,200", "0,1080", "1920,0"}) {
    EXPECT_EQ(finding(inspect("a.csv", with_seldom_marks(cells), full_hd()), "missing-value"), nullptr) << cells;
  }
  EXPECT_NE(finding(inspect("a.csv", with_seldom_marks("-1,-1"), full_hd()), "missing-value"), nullptr);
}

// 4000 rows of fixations of 40 all over 40 x 24 degrees, with noise; every 10th begins with four rows of `cells`.
// `write` makes cells of degrees right and up.
template <class Write>
std::string fixations_with_marks(const std::string& header, const std::string& cells, const Write& write) {
  std::string text = header;
  for (int i = 0; i < 4000; ++i) {
    const int fixation = i / 40;
    const double x = 20 * std::sin(fixation * 2.3) + 0.05 * std::sin(i * 1.9);
    const double y = 12 * std::cos(fixation * 3.7) + 0.05 * std::cos(i * 1.3);
    text += fmt::format("{},{}\n", 2 * i, i % 40 < 4 ? cells : write(x, y));
  }
  return text;
}
std::string degrees(double x, double y) {
  return fmt::format("{:.3f},{:.3f}", x, y);
}
const char* const kDegrees = "t[ms],x[deg],y[deg]\n";

GazeReadOptions full_hd_at_60_cm() {
  GazeReadOptions options;
  options.display =
      DisplayGeometry{.width_px = 1920, .height_px = 1080, .width_cm = 53, .height_cm = 30, .distance_cm = 60};
  return options;
}

// Minus one degree is in the middle of the display: there a mark tells itself by how often gaze jumps to it.
TEST_F(GazeMissingValues, TheDoctorNamesAMarkWhereGazeIs) {
  const std::string text = fixations_with_marks(kDegrees, "-1,-1", degrees);
  for (const GazeReadOptions& options : {full_hd_at_60_cm(), GazeReadOptions{}}) {
    const GazeInspection report = inspect("a.csv", text, options);
    const GazeFinding* const found = finding(report, "missing-value");
    ASSERT_NE(found, nullptr);
    EXPECT_EQ(found->setting, "`missing-value` -1");
    EXPECT_THAT(found->what, HasSubstr("400 of 4000 rows are exactly at (-1, -1)"));
  }
}

TEST_F(GazeMissingValues, TheDoctorNamesAMarkOfDirections) {
  const auto vector = [](double x, double y) {
    const double right = std::tan(x * kRadPerDeg);
    const double up = std::tan(y * kRadPerDeg);
    const double norm = std::sqrt(right * right + up * up + 1);
    return fmt::format("{:.6f},{:.6f},{:.6f}", right / norm, up / norm, -1 / norm);
  };
  const std::string header = "t[ms],dx,dy,dz\n";
  const GazeInspection report = inspect("a.csv", fixations_with_marks(header, "-1,-1,-1", vector));
  const GazeFinding* const found = finding(report, "missing-value");
  ASSERT_NE(found, nullptr);
  EXPECT_EQ(found->setting, "`missing-value` -1");
  EXPECT_THAT(found->what, HasSubstr("at (-1, -1, -1)"));
  const GazeInspection ahead = inspect("b.csv", fixations_with_marks(header, "0,0,-1", vector));
  ASSERT_NE(finding(ahead, "missing-value"), nullptr);
  EXPECT_EQ(finding(ahead, "missing-value")->setting, "");
  GazeReadOptions options;
  options.missing_value = -1;
  EXPECT_EQ(finding(inspect("a.csv", fixations_with_marks(header, "-1,-1,-1", vector), options), "missing-value"),
            nullptr);
}

TEST_F(GazeMissingValues, WhereGazeIsAPlaceIsAPlace) {
  // Whole pixels repeat in fixations, which are come to once by a jump and then by small steps: here 25 times.
  const std::array<std::array<int, 2>, 4> targets{{{300, 200}, {1600, 250}, {900, 540}, {400, 900}}};
  std::string whole = "t[ms],x[px],y[px]\n";
  // Gaze without noise, as a model has it, only jumps.
  std::string exact = whole;
  for (int i = 0; i < 4000; ++i) {
    const auto& [x, y] = targets[static_cast<std::size_t>(i / 40 % 4)];
    whole += fmt::format("{},{},{}\n", 2 * i, x + i * 7 % 3, y + i * 3 % 2);
    exact += fmt::format("{},{},{}\n", 2 * i, x, y);
  }
  EXPECT_EQ(finding(inspect("a.csv", whole, full_hd()), "missing-value"), nullptr);
  EXPECT_EQ(finding(inspect("b.csv", exact, full_hd()), "missing-value"), nullptr);
  // A cross between trials is where gaze is most often, and in four of five rows to the pixel.
  std::string cross = "t[ms],x[px],y[px]\n";
  for (int i = 0; i < 4000; ++i) {
    const int trial = i / 40;
    const bool at_cross = trial % 2 == 0;
    cross += at_cross ? fmt::format("{},{},540\n", 2 * i, i % 5 == 2 ? 959 + i % 3 : 960)
                      : fmt::format("{},{:.2f},{:.2f}\n", 2 * i, 960 + 700 * std::sin(trial * 2.3) + std::sin(i * 1.9),
                                    540 + 400 * std::cos(trial * 3.7) + std::cos(i * 1.3));
  }
  EXPECT_EQ(finding(inspect("c.csv", cross, full_hd()), "missing-value"), nullptr);
}

}  // namespace
}  // namespace gazetrace::gaze_missing_values_test
