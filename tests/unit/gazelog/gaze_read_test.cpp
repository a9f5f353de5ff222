// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <random>

#include "gazetrace/gaze.hpp"
#include "gazetrace/gaze_write.hpp"
#include "support/text_file.hpp"

namespace gazetrace::gaze_read_test {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::ThrowsMessage;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

GazeReadOptions full_hd() {
  GazeReadOptions options;
  options.display =
      DisplayGeometry{.width_px = 1920, .height_px = 1080, .width_cm = 48, .height_cm = 27, .distance_cm = 60};
  return options;
}

class GazeRead : public ::testing::Test {
 protected:
  GazeLog read(std::string_view text, const GazeReadOptions& options = {}, std::string_view name = "log.csv") {
    return load_gaze_log(files_.write(name, text), options);
  }
  std::vector<std::string> warnings(const GazeLog& log) {
    std::vector<std::string> lines;
    for (const std::string& warning : log.warnings) {
      lines.push_back(files_.without_folder(warning));
    }
    return lines;
  }
  TextFiles files_;
};

TEST_F(GazeRead, GazetraceCsvWithPreamble) {
  const GazeLog log = read(
      "# gazetrace-gaze 1\n# display_px 3840 2160\n# display_mm 708.48 398.52\n# distance_mm 600\n# clock lab host, "
      "UTC\n"
      "t[ns],u[1],v[1],valid,eye,confidence,pupil[mm]\n"
      "1700000000000000001,0.25,0.75,ok,left,0.5,3.5\n"
      "1700000000000000257,-0.5,1.5,off_screen,left,,\n"
      "1700000000000000513,,,blink,left,0,.\n"
      "1700000000000000769,0.5,0.5,low_confidence,left,0.25,-\n");
  EXPECT_EQ(log.format, "gazetrace-csv");
  EXPECT_EQ(log.kind, GazeKind::screen);
  EXPECT_EQ(log.clock, "lab host, UTC");
  ASSERT_TRUE(log.recording_geometry.has_value());
  EXPECT_EQ(log.recording_geometry->width_px, 3840);
  EXPECT_EQ(log.recording_geometry->height_px, 2160);
  EXPECT_DOUBLE_EQ(log.recording_geometry->width_cm, 70.848);
  EXPECT_DOUBLE_EQ(log.recording_geometry->height_cm, 39.852);
  EXPECT_DOUBLE_EQ(log.recording_geometry->distance_cm, 60);
  ASSERT_EQ(log.samples.size(), 4U);
  EXPECT_EQ(log.samples[0].t_ns, 1'700'000'000'000'000'001);
  EXPECT_EQ(log.samples[1].t_ns - log.samples[0].t_ns, 256);
  EXPECT_EQ(log.samples[0].u, 0.25);
  EXPECT_EQ(log.samples[0].eye, Eye::left);
  EXPECT_EQ(log.samples[0].confidence, 0.5F);
  EXPECT_EQ(log.samples[0].pupil, 3.5F);
  EXPECT_EQ(log.samples[0].row, 7);
  EXPECT_EQ(log.samples[1].validity, GazeValidity::off_screen);
  EXPECT_TRUE(std::isnan(log.samples[1].confidence));
  EXPECT_EQ(log.samples[2].validity, GazeValidity::blink);
  EXPECT_TRUE(std::isnan(log.samples[2].u));
  EXPECT_EQ(log.samples[3].validity, GazeValidity::low_confidence);
  EXPECT_THAT(log.warnings, IsEmpty());
}

TEST_F(GazeRead, DirectionsAreNormalized) {
  const GazeLog log = read("t[s],dx,dy,dz\n0.5,0,0,-2\n1,0.6,0,-0.8\n1.5,0,0,0\n2,nan,0,-1\n");
  EXPECT_EQ(log.kind, GazeKind::direction);
  EXPECT_EQ(log.samples[0].direction, (Vec3d{0, 0, -1}));
  EXPECT_EQ(log.samples[1].direction, (Vec3d{0.6, 0, -0.8}));
  EXPECT_EQ(log.samples[2].validity, GazeValidity::lost);
  EXPECT_EQ(log.samples[3].validity, GazeValidity::lost);
  EXPECT_THAT(warnings(log), ElementsAre("log.csv: 1 of 4 directions were not of unit length; normalized"));
}

TEST_F(GazeRead, BackwardDirectionsAreRefused) {
  EXPECT_THAT([&] { read("t[s],dx,dy,dz\n0,0,0,1\n1,0.6,0,0.8\n"); },
              ThrowsMessage<Error>(AllOf(HasSubstr("2 of 2 directions point behind the head"),
                                         HasSubstr("log.csv -o gaze.csv `axes` unity"))));
  GazeReadOptions options;
  options.columns.axes = GazeAxes::unity;
  EXPECT_EQ(read("t[s],dx,dy,dz\n0,0,0,1\n1,0.6,0,0.8\n", options).samples[1].direction, (Vec3d{0.6, 0, -0.8}));
}

TEST_F(GazeRead, UnitsInHeaders) {
  // Pixels are continuous coordinates: u = x / W.
  const GazeLog px = read("timestamp [ns],gaze x [px],gaze y [px]\n5,960,270\n", full_hd());
  EXPECT_EQ(px.samples[0].t_ns, 5);
  EXPECT_EQ(px.samples[0].u, 0.5);
  EXPECT_EQ(px.samples[0].v, 0.25);
  EXPECT_THAT(px.warnings, IsEmpty());
  for (const auto& [header, t_ns] : std::vector<std::pair<std::string, std::int64_t>>{{"t[s]", 2'500'000'000},
                                                                                      {"t[ms]", 2'500'000},
                                                                                      {"t[us]", 2'500},
                                                                                      {"t[\xCE\xBCs]", 2'500},
                                                                                      {"time_ms", 2'500'000},
                                                                                      {"Time (in secs)", 2'500'000'000},
                                                                                      {"time(100ns)", 250},
                                                                                      {"t[ns]", 3}}) {
    EXPECT_EQ(read(header + ",u,v\n2.5,0,1\n").samples[0].t_ns, t_ns) << header;
  }
  const GazeLog mm = read("t[s]\tx[mm]\ty[mm]\n0\t120\t54\n", full_hd());
  EXPECT_DOUBLE_EQ(mm.samples[0].u, 0.25);
  EXPECT_DOUBLE_EQ(mm.samples[0].v, 0.2);
  const GazeLog cm = read("t[s]\tx_cm\ty_cm\n0\t12\t5.4\n", full_hd());
  EXPECT_DOUBLE_EQ(cm.samples[0].u, 0.25);
  EXPECT_DOUBLE_EQ(cm.samples[0].v, 0.2);
  // Degrees count from straight ahead, up is positive: 60 cm tan(10 deg) = 10.5796 cm.
  const GazeLog deg = read("t[s],x[deg],y[deg]\n0,10,10\n", full_hd());
  EXPECT_NEAR(deg.samples[0].u, 0.5 + 60 * std::tan(10 * kPi / 180) / 48, 1e-15);
  EXPECT_NEAR(deg.samples[0].v, 0.5 - 60 * std::tan(10 * kPi / 180) / 27, 1e-15);
}

TEST_F(GazeRead, Origins) {
  GazeReadOptions options = full_hd();
  options.columns.origin = PositionOrigin::bottom_left;
  GazeLog log = read("t[s],x[px],y[px]\n0,480,270\n", options);
  EXPECT_EQ(log.samples[0].u, 0.25);
  EXPECT_EQ(log.samples[0].v, 0.75);
  options.columns.origin = PositionOrigin::center;
  log = read("t[s],x[px],y[px]\n0,480,270\n", options);
  EXPECT_EQ(log.samples[0].u, 0.75);
  EXPECT_EQ(log.samples[0].v, 0.25);
  log = read("t[s],x[norm],y[norm]\n0,-1,1\n", options);  // -1..1, y up
  EXPECT_EQ(log.samples[0].u, 0);
  EXPECT_EQ(log.samples[0].v, 0);
}

TEST_F(GazeRead, TheFileMayStateTheDisplayOfItsPixels) {
  EXPECT_EQ(read("# display_px 1000 500\nt[s],x[px],y[px]\n0,250,250\n").samples[0].u, 0.25);
  const GazeLog log = read("# display_px 1000 500\nt[s],x[px],y[px]\n0,960,540\n", full_hd());
  EXPECT_EQ(log.samples[0].u, 0.5);
  EXPECT_THAT(warnings(log),
              ElementsAre("log.csv:2: the log states a display of 1000x500 px; the given 1920x1080 px are used"));
}

TEST_F(GazeRead, FlagsContradictingTheHeaderWarnAndWin) {
  GazeReadOptions options;
  options.columns.time_unit = TimeUnit::us;
  options.columns.position_unit = PositionUnit::fraction;
  const GazeLog log = read("t[ms],x[px],y[px]\n7,0.5,0.25\n", options);
  EXPECT_EQ(log.samples[0].t_ns, 7000);
  EXPECT_EQ(log.samples[0].u, 0.5);
  EXPECT_THAT(warnings(log),
              ElementsAre("log.csv:1: the header says that 't[ms]' is in ms; `time-unit` us was given and is used",
                          "log.csv:1: the header says that 'x[px]' is in px; `unit` fraction was given and is used"));
}

TEST_F(GazeRead, UnitsFromStatisticsAreInferredByTheImporterAlone) {
  const auto table = [](double step, double scale) {
    std::string text = "time,x,y\n";
    for (int i = 0; i < 50; ++i) {
      text += fmt::format("{},{},{}\n", 1000 * step + i * step, scale * (0.2 + 0.01 * i), scale * 0.5);
    }
    return text;
  };
  struct Case {
    double step;
    std::string unit;
    std::int64_t step_ns;
  };
  for (const Case& c : {Case{4, "ms", 4'000'000}, Case{8.33, "ms", 8'330'000}, Case{0.004, "s", 4'000'000},
                        Case{3333, "us", 3'333'000}, Case{3'333'000, "ns", 3'333'000}}) {
    EXPECT_THAT([&] { read(table(c.step, 1)); },
                ThrowsMessage<Error>(HasSubstr("log.csv -o gaze.csv `unit` fraction")));
    GazeReadOptions importing;
    importing.accepts_inferred = true;
    const GazeLog log = read(table(c.step, 1), importing);
    EXPECT_EQ(log.samples[1].t_ns - log.samples[0].t_ns, c.step_ns);
    EXPECT_THAT(warnings(log)[0], fmt::format("log.csv:1: guessed from its steps that 'time' is in {}; state it with "
                                              "`time-unit`",
                                              c.unit));
    EXPECT_EQ(log.conventions.unit.value, PositionUnit::fraction);
    EXPECT_EQ(log.conventions.unit.evidence, Evidence::statistics);
  }
  // Rows of two eyes: every other step is zero.
  EXPECT_EQ(read("time,u,v,eye\n0,0,0,l\n0,0,0,r\n4,0,0,l\n4,0,0,r\n").samples[1].t_ns, 4'000'000);
  // Pixels of a stated display are plain; without one, and numbers between, nothing is guessed.
  EXPECT_NEAR(read(table(4, 1000), full_hd()).samples[0].u, 200.0 / 1920, 1e-15);
  const std::string degrees = "t[ms],x,y\n0,-3,2\n4,5,-1\n8,-12,8\n";
  EXPECT_THAT([&] { read(degrees, full_hd()); }, ThrowsMessage<Error>(HasSubstr("degrees or centimetres?")));
}

TEST_F(GazeRead, SuspiciousValuesAreNamed) {
  GazeReadOptions options = full_hd();
  EXPECT_THAT([&] { read("t[s],x[px],y[px]\n0,-300,200\n1,200,-80\n2,10,20\n", options); },
              ThrowsMessage<Error>(AllOf(HasSubstr("67 % of them are negative"), HasSubstr("`origin` center"))));
  EXPECT_THAT(
      [&] { read("t[s],x[px],y[px]\n0,0,0\n1,200,80\n2,0,0\n3,10,20\n4,0,0\n", options); },
      ThrowsMessage<Error>(AllOf(HasSubstr("3 of 5 rows are exactly at (0, 0)"), HasSubstr("`missing-value` 0"))));
}

TEST_F(GazeRead, MissingValuesOfEveryManner) {
  std::string text = "t[s],u,v\n";
  int t = 0;
  for (const std::string_view marker : {"", ".", "n/a", "NaN", "nan", "-nan(ind)", "None", "-", "NA", "inf", "  "}) {
    text += fmt::format("{},{},0.5\n{},0.5,{}\n", t, marker, t + 1, marker);
    t += 2;
  }
  const GazeLog log = read(text);
  ASSERT_EQ(log.samples.size(), 22U);
  for (const GazeSample& sample : log.samples) {
    EXPECT_EQ(sample.validity, GazeValidity::lost) << sample.row;
    EXPECT_TRUE(std::isnan(sample.u) && std::isnan(sample.v));
  }
  EXPECT_THAT(warnings(log), ElementsAre("log.csv: none of its 22 samples is usable"));
}

TEST_F(GazeRead, ValidityColumns) {
  const GazeLog log = read(
      "t[s],u,v,valid\n0,0,0,0\n1,0,0,1\n2,0.5,0.5,TRUE\n3,0.5,0.5,1.0\n4,0.7,0.7,false\n5,2,0.5,1\n6,0.5,0.5,blink\n",
      {}, "generic.csv");
  std::vector<GazeValidity> validities;
  for (const GazeSample& sample : log.samples) {
    validities.push_back(sample.validity);
  }
  EXPECT_THAT(validities, ElementsAre(GazeValidity::lost, GazeValidity::ok, GazeValidity::ok, GazeValidity::ok,
                                      GazeValidity::lost, GazeValidity::off_screen, GazeValidity::blink));
  EXPECT_TRUE(std::isnan(log.samples[0].u));
  EXPECT_EQ(log.samples[1].u, 0.0);  // the corner, said to be valid
  EXPECT_EQ(log.samples[4].u, 0.7);  // held by the tracker, kept, not usable

  GazeReadOptions options;
  options.columns.validity = "val";
  options.columns.valid_values = {"0"};
  EXPECT_EQ(read("n_ms,val,u,v,time_ms\n0,0,.5,.5,0\n1,4,.5,.5,1\n", options).samples[0].validity, GazeValidity::ok);
  options.columns.valid_values.clear();
  EXPECT_THAT(warnings(read("val,u,v,time_ms\n0,.5,.5,0\n4,.5,.5,1\n", options))[0],
              "log.csv: no row is valid by column 'val', which holds: 0, 4; say with `valid-values` which of them are "
              "good");
}

TEST_F(GazeRead, TextOfEveryManner) {
  const std::vector<std::pair<std::string, std::string>> files{
      {"bom", "\xEF\xBB\xBFt[ms],u,v\n1.5,0.25,0.75\n"},
      {"crlf", "t[ms],u,v\r\n1.5,0.25,0.75\r\n"},
      {"no newline at the end", "t[ms],u,v\n1.5,0.25,0.75"},
      {"decimal comma, semicolons", "t[ms];u;v\n1,5;0,25;0,75\n"},
      {"decimal comma, tabs", "t[ms]\tu\tv\n1,5\t0,25\t0,75\n"},
      {"quoted", "\"t[ms]\",\"u\",\"v, from the top\"\n\"1.5\",\"0.25\",\"0.75\"\n"},
      {"trailing separators", "t[ms],u,v,\n1.5,0.25,0.75,\n"},
      {"blanks", "t[ms] ,  u , v\n 1.5 , 0.25 ,0.75 \n"},
      {"preamble", "## by hand\n#\n# display_px: 10 10\n\nt[ms],u,v\n1.5,0.25,0.75\n\n# end\n"},
      {"order", "label,v,u,t[ms]\nx,0.75,0.25,1.5\n"},
      {"no-break space",
       "t [ms],u,v\n1.5,\xC2\xA0"
       "0.25,0.75\n"},
  };
  for (const auto& [name, text] : files) {
    GazeReadOptions options;
    if (name == "quoted") {
      options.columns.y = "v, from the top";
      options.columns.position_unit = PositionUnit::fraction;
    }
    const GazeLog log = read(text, options);
    ASSERT_EQ(log.samples.size(), 1U) << name;
    EXPECT_EQ(log.samples[0].t_ns, 1'500'000) << name;
    EXPECT_EQ(log.samples[0].u, 0.25) << name;
    EXPECT_EQ(log.samples[0].v, 0.75) << name;
    EXPECT_THAT(log.warnings, IsEmpty()) << name;
  }
  std::string utf16 = "\xFF\xFE";
  for (const char c : std::string("t[\xB5s];u;v\r\n1500;0,25;0,75\r\n")) {
    utf16 += c;
    utf16 += '\0';
  }
  EXPECT_EQ(read(utf16).samples[0].t_ns, 1'500'000);
}

TEST_F(GazeRead, RepeatedHeadersAreSkipped) {
  const GazeLog log = read("t[s],u,v\n0,.1,.1\nt[s],u,v\n1,.2,.2\n");
  EXPECT_EQ(log.samples.size(), 2U);
  EXPECT_EQ(log.samples[1].row, 4);
  EXPECT_THAT(warnings(log), ElementsAre("log.csv: rows that repeat the header are skipped: 1"));
}

TEST_F(GazeRead, ColumnsByNameAndByNumber) {
  GazeReadOptions options = full_hd();
  options.columns.time = "n";
  options.columns.x = "lx";
  options.columns.y = "LY";
  options.columns.time_unit = TimeUnit::ms;
  options.columns.position_unit = PositionUnit::deg;
  EXPECT_NEAR(read("n,x,y,lx,ly\n4,1,1,0,0\n", options).samples[0].u, 0.5, 1e-15);
  options.columns.time = "3";
  options.columns.x = "1";
  options.columns.y = "2";
  options.columns.time_unit = TimeUnit::s;
  options.columns.position_unit = PositionUnit::px;
  const GazeLog log = read("960,540,1.25\n480,540,1.5\n", options);
  ASSERT_EQ(log.samples.size(), 2U);
  EXPECT_EQ(log.samples[0].t_ns, 1'250'000'000);
  EXPECT_EQ(log.samples[0].row, 1);
  EXPECT_EQ(log.samples[1].u, 0.25);
}

// tan of 100 degrees is that of -80: a gaze to the far right would land on the left.
TEST_F(GazeRead, NoScreenIsMetBeyond90Degrees) {
  GazeReadOptions options = full_hd();
  options.columns.position_unit = PositionUnit::deg;
  const GazeLog log = read("t[s],x,y\n0,100,0\n1,0,-95\n2,-90,0\n3,89,0\n4,1,1\n", options);
  ASSERT_EQ(log.samples.size(), 5U);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(log.samples[i].validity, GazeValidity::lost) << i;
  }
  EXPECT_EQ(log.samples[3].validity, GazeValidity::off_screen);
  EXPECT_GT(log.samples[3].u, 1);
  EXPECT_EQ(log.samples[4].validity, GazeValidity::ok);
}

TEST_F(GazeRead, EyesOfOneTimeAreMerged) {
  const GazeLog log = read(
      "t[s],u[1],v[1],valid,eye,pupil,confidence\n"
      "0,0.2,0.4,ok,left,3,0.5\n0,0.4,0.6,ok,right,4,1\n"
      "1,0.2,0.4,ok,left,3,1\n1,,,lost,right,,\n"
      "2,,,blink,left,,\n2,,,lost,right,,\n"
      "3,0.9,0.5,ok,L,3,1\n3,1.3,0.5,off_screen,R,3,1\n");
  ASSERT_EQ(log.samples.size(), 4U);
  EXPECT_NEAR(log.samples[0].u, 0.3, 1e-15);
  EXPECT_NEAR(log.samples[0].v, 0.5, 1e-15);
  EXPECT_EQ(log.samples[0].pupil, 3.5F);
  EXPECT_EQ(log.samples[0].confidence, 0.75F);
  EXPECT_EQ(log.samples[0].eye, Eye::cyclopean);
  // One eye alone, moved by half of what the eyes differed by: no jump from 0.3 to 0.2.
  EXPECT_NEAR(log.samples[1].u, 0.3, 1e-15);
  EXPECT_EQ(log.samples[1].validity, GazeValidity::ok);
  EXPECT_EQ(log.samples[2].validity, GazeValidity::blink);
  EXPECT_EQ(log.samples[3].validity, GazeValidity::off_screen);  // their mean is at 1.1
  EXPECT_THAT(warnings(log),
              ElementsAre("log.csv: rows of several eyes merged to their mean: 4 times, 1 of them with one "
                          "usable eye only"));
  const GazeLog directions = read("t[s],dx,dy,dz,eye\n0,0.6,0,-0.8,left\n0,-0.6,0,-0.8,right\n");
  EXPECT_NEAR(directions.samples[0].direction.z, -1, 1e-15);
}

TEST_F(GazeRead, SortingKeepsTheLastOfEqualTimes) {
  GazeReadOptions options;
  options.unordered = UnorderedPolicy::sort;
  const GazeLog log = read("t[s],u,v\n3,.3,0\n1,.1,0\n2,.2,0\n1,.15,0\n", options);
  ASSERT_EQ(log.samples.size(), 3U);
  EXPECT_EQ(log.samples[0].u, 0.15);
  EXPECT_EQ(log.samples[0].row, 5);
  EXPECT_EQ(log.samples[2].t_ns, 3'000'000'000);
  EXPECT_THAT(warnings(log), ElementsAre("log.csv: sorted by time; 2 steps went backwards",
                                         "log.csv: 1 duplicate was dropped: the last row of equal times is kept"));
  // One eye after the other, as some exporters write them.
  EXPECT_EQ(read("t[s],u,v,eye\n1,.1,0,left\n2,.1,0,left\n1,.3,0,right\n2,.3,0,right\n", options).samples.size(), 2U);
}

bool same_bits(double a, double b) {
  return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b) || (std::isnan(a) && std::isnan(b));
}
bool same_bits(float a, float b) {
  return std::bit_cast<std::uint32_t>(a) == std::bit_cast<std::uint32_t>(b) || (std::isnan(a) && std::isnan(b));
}

TEST_F(GazeRead, WritingAndReadingKeepsEveryBit) {
  std::mt19937_64 random(11);
  const auto uniform = [&] { return std::uniform_real_distribution<double>(-0.5, 1.5)(random); };
  for (const GazeKind kind : {GazeKind::screen, GazeKind::direction}) {
    GazeLog log;
    log.kind = kind;
    log.clock = "tracker; zero at power-on";
    log.recording_geometry = DisplayGeometry{
        .width_px = 1918, .height_px = 1079, .width_cm = 51.3 / 7, .height_cm = 35.3, .distance_cm = 1e2 / 3};
    log.recording_geometry->eye_x_cm = 1.0 / 3;
    std::int64_t t = std::numeric_limits<std::int64_t>::min() / 5;
    for (int i = 0; i < 3000; ++i) {
      GazeSample sample;
      sample.t_ns = i == 2999 ? std::numeric_limits<std::int64_t>::max() / 5 : t;
      t += 1 + static_cast<std::int64_t>(random() % 1'000'000'000'000'000ULL);
      sample.validity = static_cast<GazeValidity>(random() % 6);
      const bool known = is_usable(sample.validity) || random() % 2 == 0;
      sample.eye = Eye::right;
      if (kind == GazeKind::screen) {
        sample.u = known ? uniform() : kNan;
        sample.v = known ? uniform() * 1e-9 : kNan;
        sample.direction = {};
      } else {
        sample.direction = known ? normalize(Vec3d{uniform(), uniform(), -1}) : Vec3d{kNan, kNan, kNan};
      }
      sample.confidence = random() % 3 == 0 ? std::numeric_limits<float>::quiet_NaN() : static_cast<float>(uniform());
      sample.pupil = static_cast<float>(uniform() * 7);
      log.samples.push_back(sample);
    }
    const std::string path = files_.path("out.csv");
    write_gaze_csv(log, path);
    const GazeLog back = load_gaze_log(path, {});
    EXPECT_THAT(back.warnings, IsEmpty());
    EXPECT_EQ(back.clock, log.clock);
    ASSERT_TRUE(back.recording_geometry.has_value());
    EXPECT_TRUE(same_bits(back.recording_geometry->width_cm, log.recording_geometry->width_cm));
    EXPECT_TRUE(same_bits(back.recording_geometry->height_cm, log.recording_geometry->height_cm));
    EXPECT_TRUE(same_bits(back.recording_geometry->distance_cm, log.recording_geometry->distance_cm));
    EXPECT_TRUE(same_bits(back.recording_geometry->eye_x_cm, log.recording_geometry->eye_x_cm));
    EXPECT_EQ(back.recording_geometry->height_px, 1079);
    ASSERT_EQ(back.samples.size(), log.samples.size());
    for (std::size_t i = 0; i < log.samples.size(); ++i) {
      const GazeSample& a = log.samples[i];
      const GazeSample& b = back.samples[i];
      ASSERT_EQ(a.t_ns, b.t_ns);
      ASSERT_EQ(a.validity, b.validity);
      ASSERT_EQ(a.eye, b.eye);
      ASSERT_TRUE(same_bits(a.confidence, b.confidence) && same_bits(a.pupil, b.pupil)) << i;
      if (kind == GazeKind::screen) {
        ASSERT_TRUE(same_bits(a.u, b.u) && same_bits(a.v, b.v)) << i;
      } else {
        ASSERT_TRUE(same_bits(a.direction.x, b.direction.x) && same_bits(a.direction.y, b.direction.y) &&
                    same_bits(a.direction.z, b.direction.z))
            << i;
      }
    }
    // And a second time: the file is a fixed point.
    write_gaze_csv(back, files_.path("again.csv"));
    EXPECT_EQ(read_file(files_.path("again.csv")), read_file(path));
  }
  EXPECT_THROW(write_gaze_csv(GazeLog{}, files_.path("no/such/folder.csv")), Error);
}

TEST(GazeFormatList, NamesEachOnce) {
  std::vector<std::string> names;
  for (const GazeFormatInfo& format : gaze_formats()) {
    names.push_back(format.name);
    EXPECT_FALSE(format.description.empty());
  }
  EXPECT_EQ(names.front(), "gazetrace-csv");
  EXPECT_EQ(names.back(), "generic");
  std::sort(names.begin(), names.end());
  EXPECT_EQ(std::adjacent_find(names.begin(), names.end()), names.end());
}

TEST(GazeSamples, PlainCsvOfMilliseconds) {
  const std::string path = std::string(GAZETRACE_SHARED_DIR) + "/gaze-samples/plain-csv/gaze-toy-example.csv";
  if (!std::filesystem::exists(path)) {
    GTEST_SKIP() << path << " is not here";
  }
  GazeReadOptions options;
  options.display = DisplayGeometry{.width_px = 1280, .height_px = 1024};
  const GazeLog log = load_gaze_log(path, options);
  EXPECT_EQ(log.format, "generic");
  ASSERT_EQ(log.samples.size(), 4306U);
  EXPECT_EQ(log.samples.front().t_ns, 0);
  EXPECT_EQ(log.samples.back().t_ns, 17'220'000'000);
  EXPECT_EQ(log.samples[0].u, 206.8 / 1280);
  EXPECT_EQ(log.samples[0].v, 152.4 / 1024);
  EXPECT_EQ(log.samples[2].u, 207.6 / 1280);
  EXPECT_EQ(log.samples.back().v, 413.8 / 1024);
  ASSERT_EQ(log.warnings.size(), 1U);  // pixels of a stated display are plain
  EXPECT_THAT(log.warnings[0], HasSubstr("'time' is in ms"));
}

}  // namespace
}  // namespace gazetrace::gaze_read_test
