// SPDX-License-Identifier: Apache-2.0
// Each kind of file that could be read wrong in silence: it is refused with the option that answers the question, and
// with it the true gaze results. The eye is made here: fixations of 400 ms and saccades of 40 ms along a minimum-jerk
// path.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <functional>

#include "gazetrace/gaze_events.hpp"
#include "gazetrace/gaze_inspect.hpp"
#include "gazetrace/gaze_read.hpp"
#include "support/text_file.hpp"

namespace gazetrace::gaze_judge_test {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::ThrowsMessage;

constexpr std::array<Vec2d, 7> kPlaces{
    {{.20, .30}, {.75, .25}, {.60, .80}, {.15, .70}, {.50, .50}, {.85, .55}, {.35, .15}}};
constexpr int kRateHz = 120;

Vec2d place_at(int i) {
  constexpr int kRest = 48;    // samples of a fixation
  constexpr int kSaccade = 5;  // and of a saccade
  const int n = i / (kRest + kSaccade);
  const int k = std::max(0, i % (kRest + kSaccade) - kRest);
  const Vec2d& from = kPlaces[static_cast<std::size_t>(n) % kPlaces.size()];
  const Vec2d& to = kPlaces[static_cast<std::size_t>(n + 1) % kPlaces.size()];
  const double s = static_cast<double>(k) / kSaccade;
  const double share = s * s * s * (10 - 15 * s + 6 * s * s);
  const double wobble = 2e-4 * std::sin(2.1 * i);  // noise that no row repeats
  return {from.x + share * (to.x - from.x) + wobble, from.y + share * (to.y - from.y) - wobble};
}

using Write = std::function<std::string(const Vec2d&)>;
std::string table(const std::string& header, const Write& write, int rows = 480) {
  std::string text = header + "\n";
  for (int i = 0; i < rows; ++i) {
    text += fmt::format("{:.4f},{}\n", static_cast<double>(i) / kRateHz, write(place_at(i)));
  }
  return text;
}

class GazeJudge : public ::testing::Test {
 protected:
  GazeLog read(const std::string& text) {
    options_.display = DisplayGeometry{.width_px = 1920, .height_px = 1080};
    return load_gaze_log(files_.write("log.csv", text), options_);
  }
  void expect_refused(const std::string& text, const std::string& words) {
    EXPECT_THAT([&] { read(text); }, ThrowsMessage<Error>(HasSubstr(words))) << text.substr(0, 200);
  }
  GazeInspection inspect(const std::string& text, const std::string& name = "seen.csv") {
    return inspect_gaze(load_for_inspection(files_.write(name, text), options_), {});
  }
  void expect_true(const GazeLog& log) {
    for (const int i : {10, 100, 300}) {
      EXPECT_NEAR(log.samples[static_cast<std::size_t>(i)].u, place_at(i).x, 1e-3);
      EXPECT_NEAR(log.samples[static_cast<std::size_t>(i)].v, place_at(i).y, 1e-3);
    }
  }
  TextFiles files_;
  GazeReadOptions options_;
};

TEST_F(GazeJudge, UnitsOfPsychoPyAreNeverDegreesByGuess) {
  const std::string height = table("time[s],gaze_x,gaze_y", [](const Vec2d& p) {
    return fmt::format("{:.5f},{:.5f}", (p.x - 0.5) * 16 / 9, 0.5 - p.y);
  });
  const std::string norm = table("time[s],gaze_x,gaze_y",
                                 [](const Vec2d& p) { return fmt::format("{:.5f},{:.5f}", 2 * p.x - 1, 1 - 2 * p.y); });
  expect_refused(height, "`unit` height, norm, deg or rad");
  expect_refused(norm, "`unit` norm, deg or rad");
  options_.columns.position_unit = PositionUnit::height;
  expect_true(read(height));
  options_.columns.position_unit = PositionUnit::norm;
  expect_true(read(norm));
  // Called degrees, its saccades last too long for their size.
  options_.columns.position_unit = PositionUnit::deg;
  options_.frame = GazeFrame::head;
  EXPECT_THAT(inspect(norm).verdict, Not(HasSubstr("nothing suspicious")));
}

TEST_F(GazeJudge, CentredPixels) {
  const std::string text = table(
      "t[s],x,y", [](const Vec2d& p) { return fmt::format("{:.1f},{:.1f}", 1920 * (p.x - 0.5), 1080 * (0.5 - p.y)); });
  expect_refused(text, "`origin` center");
  options_.columns.origin = PositionOrigin::center;
  expect_true(read(text));
}

// Two monitors beside each other, and the eye on the one that is not at the origin.
TEST_F(GazeJudge, TheOtherMonitor) {
  for (const int left : {1920, -1920}) {
    const std::string text = table("t[s],x[px],y[px]", [&](const Vec2d& p) {
      return fmt::format("{:.1f},{:.1f}", 1920 * p.x + left, 1080 * p.y);
    });
    options_.corner.reset();
    expect_refused(text, fmt::format("`corner` {},0", left));
    options_.corner = Vec2d{static_cast<double>(left), 0};
    expect_true(read(text));
  }
}

TEST_F(GazeJudge, VectorsByTheColumnBesideThem) {
  const auto vector = [](const Vec2d& p, const char* pattern) {
    const Vec3d d = normalize(Vec3d{p.x - 0.5, 0.5 - p.y, 1});
    return fmt::format(fmt::runtime(pattern), d.x, d.y, d.z);
  };
  const std::string fine =
      table("t[s],gaze_x,gaze_y,gaze_z", [&](const Vec2d& p) { return vector(p, "{:.6f},{:.6f},{:.6f}"); });
  expect_refused(fine, "`axes` unity, sranipal or cv");
  options_.columns.axes = GazeAxes::unity;
  const GazeLog log = read(fine);
  EXPECT_EQ(log.kind, GazeKind::direction);
  EXPECT_NEAR(log.samples[10].direction.x / -log.samples[10].direction.z, place_at(10).x - 0.5, 1e-4);
  EXPECT_THAT(
      inspect(table("t[s],gaze_x,gaze_y,gaze_z", [&](const Vec2d& p) { return vector(p, "{:.1f},{:.1f},{:.1f}"); }))
          .findings.front()
          .code,
      "coarse");
  // In one cell, quoted or not.
  EXPECT_EQ(read(table("t[s],gaze_direction,note",
                       [&](const Vec2d& p) { return vector(p, "\"({:.6f}, {:.6f}, {:.6f})\",x"); }))
                .samples[10]
                .direction,
            log.samples[10].direction);
}

TEST_F(GazeJudge, RadiansAreAUnit) {
  const GazeLog log = [&] {
    options_.frame = GazeFrame::head;
    return read(table("t[s],yaw[rad],pitch[rad]", [](const Vec2d& p) {
      return fmt::format("{:.6f},{:.6f}", 0.5 * (p.x - 0.5), 0.5 * (0.5 - p.y));
    }));
  }();
  EXPECT_NEAR(log.samples[10].direction.x / -log.samples[10].direction.z, std::tan(0.5 * (place_at(10).x - 0.5)), 1e-5);
}

TEST_F(GazeJudge, ValidityThatIsReadTheWrongWayRound) {
  std::string text = "t[ms],x[px],y[px],validity\n";
  for (int i = 0; i < 200; ++i) {
    const bool is_lost = i % 10 == 9;
    const Vec2d p = is_lost ? Vec2d{} : place_at(i);
    text += fmt::format("{},{:.1f},{:.1f},{}\n", 8 * i, 1920 * p.x, 1080 * p.y, is_lost ? 1 : 0);
  }
  expect_refused(text, "`valid-values` 0");
  options_.columns.valid_values = {"0"};
  EXPECT_NEAR(read(text).samples[5].u, place_at(5).x, 1e-3);
}

TEST_F(GazeJudge, ACombinedGazeThatIsTheSumOfTheEyes) {
  const std::string text = table("t[s],GazeXLeft,GazeYLeft,GazeXRight,GazeYRight,GazeX,GazeY", [](const Vec2d& p) {
    return fmt::format("{0:.4f},{1:.4f},{0:.4f},{1:.4f},{2:.4f},{3:.4f}", p.x, p.y, 2 * p.x, 2 * p.y);
  });
  expect_refused(text, "`x-column` GazeXLeft `y-column` GazeYLeft");
}

TEST_F(GazeJudge, DisplaySizesOfBlocks) {
  const auto block = [](int begin, int width, int height) {
    std::string text = fmt::format(
        "MSG\t{} GAZE_COORDS 0 0 {} {}\nSTART\t{} \tLEFT\tSAMPLES\tEVENTS\n"
        "SAMPLES\tGAZE\tLEFT\tRATE\t250.00\tTRACKING\tCR\n",
        begin - 10, width - 1, height - 1, begin);
    for (int i = 0; i < 50; ++i) {
      text += fmt::format("{}\t{:.1f}\t{:.1f}\t800.0\t...\n", begin + 4 * i, 0.25 * width, 0.5 * height);
    }
    return text + fmt::format("END\t{} \tSAMPLES\tEVENTS\tRES\t 40.00\t 40.00\n", begin + 200);
  };
  options_ = {};
  const std::string head = "** CONVERTED FROM a.edf\n** EYELINK II\n";
  const std::string path = files_.write("two.asc", head + block(1000, 1920, 1080) + block(5000, 1024, 768));
  EXPECT_THAT([&] { load_gaze_log(path, options_); },
              ThrowsMessage<Error>(AllOf(HasSubstr("from 1920x1080 to 1024x768"), HasSubstr("`gaze-recording` 1"))));
  options_.recording = "2";
  EXPECT_EQ(load_gaze_log(path, options_).samples[0].u, 0.25);
  // A size in place of the last pixel, as some programs write it.
  options_ = {};
  const GazeLog log = load_gaze_log(files_.write("size.asc", head + block(1000, 1281, 1025)), options_);
  EXPECT_EQ(log.recording_geometry->width_px, 1280);
  EXPECT_EQ(log.recording_geometry->height_px, 1024);
}

TEST_F(GazeJudge, ClocksThatStartAgainOverflowOrStandTwice) {
  const auto rows = [](const std::function<double(int)>& ms) {
    std::string text = "t[ms],u,v\n";
    for (int i = 0; i < 1200; ++i) {
      const Vec2d p = place_at(i);
      text += fmt::format("{:.0f},{:.5f},{:.5f}\n", ms(i), p.x, p.y);
    }
    return text;
  };
  const std::string again = rows([](int i) { return i < 600 ? 90'000 + 8 * i : 8 * (i - 600); });
  EXPECT_THAT([&] { read(again); }, ThrowsMessage<Error>(AllOf(HasSubstr("starts again in line 602"),
                                                               HasSubstr("2 recordings"), Not(HasSubstr("sort")))));
  options_.recording = "2";
  EXPECT_EQ(read(again).samples.size(), 600U);
  options_.recording = "";
  const std::string overflow = rows([](int i) { return std::fmod(60'000 + 8.0 * i, 65'536); });
  expect_refused(overflow, "`order` unwrap");
  options_.unordered = UnorderedPolicy::unwrap;
  const GazeLog unwrapped = read(overflow);
  EXPECT_EQ(unwrapped.samples.back().t_ns - unwrapped.samples.front().t_ns, 1199LL * 8'000'000);
  options_.unordered = UnorderedPolicy::error;
  const std::string pairs = rows([](int i) { return 5000.0 + i / 2; });
  expect_refused(pairs, "`order` pairs");
  options_.unordered = UnorderedPolicy::pairs;
  EXPECT_EQ(read(pairs).samples[1].t_ns - read(pairs).samples[0].t_ns, 500'000);
}

// A direction 12 degrees to the right and 5 up, in the axes of Unreal: ahead, right, up.
TEST_F(GazeJudge, DirectionsOfUnreal) {
  const auto vector = [](const Vec2d& p, const char* pattern) {
    const double right = (p.x - 0.5) * 0.6;
    const double up = (0.5 - p.y) * 0.4;
    return fmt::format(fmt::runtime(pattern), std::sqrt(1 - right * right - up * up), right, up);
  };
  const auto expect_ahead = [&](const GazeLog& log) {
    EXPECT_NEAR(log.samples[10].direction.x, (place_at(10).x - 0.5) * 0.6, 1e-4);
    EXPECT_NEAR(log.samples[10].direction.y, (0.5 - place_at(10).y) * 0.4, 1e-4);
    EXPECT_LT(log.samples[10].direction.z, -0.8);
  };
  const std::string columns = table("time[s],gaze_dir_x,gaze_dir_y,gaze_dir_z",
                                    [&](const Vec2d& p) { return vector(p, "{:.5f},{:.5f},{:.5f}"); });
  const std::string cells =
      table("time[s],gaze_dir", [&](const Vec2d& p) { return vector(p, "X={:.5f} Y={:.5f} Z={:.5f}"); });
  expect_refused(columns, "`axes` unreal");
  expect_refused(cells, "`axes` unreal");
  options_.columns.axes = GazeAxes::unreal;
  expect_ahead(read(columns));
  expect_ahead(read(cells));
}

TEST_F(GazeJudge, ColumnsThatOnlyLookLikeGaze) {
  const auto three = [](const Vec2d& p) { return fmt::format("{:.4f},{:.4f},{:.4f}", 30 * p.x, 20 * p.y, p.x * p.y); };
  expect_refused(table("time[s],yaw,pitch,roll", three), "an eye does not roll");
  expect_refused(table("time[s],pos_x,pos_y,pos_z", three), "a place in space or a direction");
  expect_refused(table("time[s],target_x,target_y,mouse_x", three), "`x-column` and `y-column`");
}

TEST_F(GazeJudge, WordsBesideTheGazeSayWhereItCountsFrom) {
  const auto from_bottom = [](const Vec2d& p) {
    return fmt::format("{:.1f},{:.1f},bottom_left", 1920 * p.x, 1080 * (1 - p.y));
  };
  expect_true(read(table("time[s],gaze_x_px,gaze_y_px,coordinate_system", from_bottom)));
}

// Project Aria's frame has +x to the left, each eye its own yaw, and one pitch.
TEST_F(GazeJudge, RadiansInAFrameOfTheHead) {
  const GazeLog log = read(table("t[s],left_yaw_rads_cpf,right_yaw_rads_cpf,pitch_rads_cpf", [](const Vec2d&) {
    return fmt::format("{:.6f},{:.6f},{:.6f}", -10 * kRadPerDeg, -12 * kRadPerDeg, 4 * kRadPerDeg);
  }));
  EXPECT_EQ(log.kind, GazeKind::direction);
  ASSERT_EQ(log.eyes.size(), log.samples.size());
  const Vec3d left = log.eyes[5].left.at;
  EXPECT_NEAR(std::atan2(left.x, -left.z) * kDegPerRad, 10, 1e-3);
  const Vec3d right = log.eyes[5].right.at;
  EXPECT_NEAR(std::atan2(right.x, -right.z) * kDegPerRad, 12, 1e-3);
  EXPECT_GT(right.y, 0);
}

// Directions beside the head's rotation stand in the world where they are at rest in it while the head turns.
TEST_F(GazeJudge, DirectionsInTheWorldOfTheHead) {
  std::string text =
      "time[s],gazeDirection_x,gazeDirection_y,gazeDirection_z,headRotation_x,headRotation_y,"
      "headRotation_z,headRotation_w\n";
  const double at = 80 * kRadPerDeg;  // to the right, in Unity's axes
  for (int i = 0; i < 400; ++i) {
    const double half = 0.5 * (at + 0.3 * std::sin(0.05 * i));
    text += fmt::format("{:.4f},{:.5f},0,{:.5f},0,{:.5f},0,{:.5f}\n", i / 60.0, std::sin(at), std::cos(at),
                        std::sin(half), std::cos(half));
  }
  expect_refused(text, "`axes` unity, sranipal or cv");
  options_.columns.axes = GazeAxes::unity;
  const GazeLog log = read(text);
  const Vec3d& d = log.samples[31].direction;  // the head has turned by 0.3 sin(1.55) beyond it
  EXPECT_NEAR(std::atan2(d.x, -d.z), -0.3 * std::sin(0.05 * 31), 1e-3);
}

TEST_F(GazeJudge, StampsThatWereRoundedOrSetBack) {
  const auto rows = [](const std::function<std::string(int)>& time) {
    std::string text = "t[ms],u,v\n";
    for (int i = 0; i < 400; ++i) {
      text += fmt::format("{},{:.5f},{:.5f}\n", time(i), place_at(i).x, place_at(i).y);
    }
    return text;
  };
  const std::string rounded = rows([](int i) { return fmt::format("{:.5E}", 1'701'123'456'789.0 + 8 * i); });
  EXPECT_THAT([&] { read(rounded); },
              ThrowsMessage<Error>(AllOf(HasSubstr("as a spreadsheet shows"), Not(HasSubstr("`order`")))));
  const std::string back = rows([](int i) { return std::to_string(10'000 + 8 * i - (i < 200 ? 0 : 240)); });
  EXPECT_THAT([&] { read(back); }, ThrowsMessage<Error>(AllOf(HasSubstr("or was set back"), HasSubstr("in line 202"),
                                                              Not(HasSubstr("sort")))));
  // A row that was written too late is out of order, and its clock is good.
  const std::string late = rows([](int i) {
    return std::to_string(8 * (i == 100 ? 103 : i > 100 && i < 104 ? i - 1 : i));
  });
  expect_refused(late, "`order` sort");
}

TEST_F(GazeJudge, ZerosForMissingPlaces) {
  std::string text = "t[ms],x[px],y[px]\n";
  for (int i = 0; i < 200; ++i) {
    const Vec2d p = i % 20 < 2 ? Vec2d{} : place_at(i);
    text += fmt::format("{},{:.1f},{:.1f}\n", 8 * i, 1920 * p.x, 1080 * p.y);
  }
  expect_refused(text, "`missing-value` 0");
  options_.missing_value = 0;
  EXPECT_EQ(read(text).samples[20].validity, GazeValidity::lost);
}

TEST_F(GazeJudge, BlocksOfOneEyeAndThenTheOther) {
  const auto block = [](int begin, const char* eye, const char* end) {
    std::string text =
        fmt::format("START\t{0} \t{1}\tSAMPLES\tEVENTS\nSAMPLES\tGAZE\t{1}\tRATE\t250.00\tTRACKING\tCR\n", begin, eye);
    for (int i = 0; i < 50; ++i) {
      text += fmt::format("{}\t480.0\t540.0\t800.0\t...\n", begin + 4 * i);
    }
    return text + fmt::format(fmt::runtime(end), begin + 200);
  };
  options_ = {};
  const std::string head = "** CONVERTED FROM a.edf\n** EYELINK II\nMSG\t1 GAZE_COORDS 0 0 1919 1079\n";
  const GazeLog log = load_gaze_log(
      files_.write("turns.asc", head + block(1000, "LEFT", "") + block(5000, "RIGHT", "END\t{} \tSAMPLES\n")),
      options_);
  ASSERT_EQ(log.samples.size(), 100U);
  EXPECT_EQ(log.samples[99].u, 0.25);
  EXPECT_THAT(log.warnings, ::testing::Contains(HasSubstr("the recorded eye changes")));
  EXPECT_THAT(log.warnings, Not(::testing::Contains(HasSubstr("merged to their mean"))));
}

TEST_F(GazeJudge, RowsThatAreNoGaze) {
  std::string text = "t[ms],EventSource,u,v,heart\n";
  for (int i = 0; i < 100; ++i) {
    const Vec2d p = place_at(i);
    text += fmt::format("{},1,{:.4f},{:.4f},\n{},2,,,71\n", 8 * i, p.x, p.y, 8 * i + 3);
    text += i == 50 ? "402,trial starts\n" : i == 60 ? "MSG,482,trial ends\nt[ms],EventSource,u,v,heart\n" : "";
  }
  const GazeLog log = read(text);
  EXPECT_EQ(log.samples.size(), 100U);
  ASSERT_EQ(log.events.size(), 2U);
  EXPECT_EQ(log.events[1].text, "trial ends");
  EXPECT_EQ(log.events[1].begin_ns, 482'000'000);
  EXPECT_EQ(log.events[0].text, "trial starts");
  EXPECT_EQ(log.events[0].begin_ns, 402'000'000);
}

TEST_F(GazeJudge, FilesOfOtherKindsAreNamedWithTheWayOut) {
  for (const auto& [content, words] : std::vector<std::pair<std::string, std::string>>{
           {"SR_RESEARCH_COMBINED_FILE\n\x01", "edf2asc"},
           {"\x89HDF\r\n\x1a\n....", "HDF5"},
           {std::string("PK\x03\x04....", 8), "xlsx"},
           {"PAR1....", "Parquet"},
           {"MATLAB 5.0 MAT-file, Platform", "MATLAB"},
           {std::string("\x80\x02]q\0X", 6), "pickle"},
           {std::string("\x11\x22\0\0\x33\0\0\0 and more", 17), "is not a gaze log of a known format"},
           {"trial,gaze_x,gaze_y\n1,\"[1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13]\",\"[1, 2, 3, 4, 5, 6, 7, 8, 9, 10, "
            "11, 12, 13]\"\n",
            "a row for each sample"},
           {"{\"time\": 1, \"x\": 2}\n{\"time\": 2, \"x\": 3}\n", "JSON"},
           {"# Title\n\nSome words, and more\nof them.\nAnd more,\nand more\n", "a text without rows of numbers"}}) {
    EXPECT_THAT([&] { load_gaze_log(files_.write("file.bin", content), {}); }, ThrowsMessage<Error>(HasSubstr(words)));
  }
}

TEST_F(GazeJudge, PlainFilesStayPlain) {
  const std::string px =
      table("time,x,y", [](const Vec2d& p) { return fmt::format("{:.1f},{:.1f}", 1920 * p.x, 1080 * p.y); });
  expect_true(read(px));
  const std::string fractions =
      table("time,x,y", [](const Vec2d& p) { return fmt::format("{:.5f},{:.5f}", p.x, p.y); });
  expect_refused(fractions, "`unit` fraction");
  options_.accepts_inferred = true;  // the importer takes what only one reading fits
  expect_true(read(fractions));
}

}  // namespace
}  // namespace gazetrace::gaze_judge_test
