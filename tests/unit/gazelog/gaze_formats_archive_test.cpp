// SPDX-License-Identifier: Apache-2.0
// Formats on files of our own, made after their documentation: BIDS, XDF, and tables that the user describes.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstring>
#include <filesystem>

#include "support/gaze_format_files.hpp"

namespace gazetrace::gaze_formats_archive_test {
namespace {

using ::testing::HasSubstr;

TEST_F(GazeFormats, BidsInheritsAndForgivesDrafts) {
  namespace fs = std::filesystem;
  fs::create_directories(files_.path("sub-1/eyetrack"));
  put("dataset_description.json", "{}");
  put("task-x_physio.json",
      R"({"Columns": ["time", "x_coordinate", "y_coordinate"], "SamplingFrequency": 500,
                   "SampleCoordinateSystem": "gaze-on-screen", "x_coordinate": {"Units": "pixel"}})");
  put("sub-1/eyetrack/sub-1_task-x_recording-eye1_physio.json", R"({"RecordedEye": "right"})");
  put("task-x_events.json", R"({"StimulusPresentation": {"ScreenDistance": 1.2, "ScreenOrigin": ["bottom",
               "left"], "ScreenSize": [0.773, 0.445], "ScreenResolution": [1919, 1079]}})");
  const std::string path = files_.write("sub-1/eyetrack/sub-1_task-x_recording-eye1_physio.tsv",
                                        "\xEF\xBB\xBF"
                                        "2\t960\t270\n4\tn/a\tn/a\n6\t0\t0\n");
  const GazeLog log = load_gaze_log(path, {});
  EXPECT_EQ(log.format, "bids");
  ASSERT_EQ(log.samples.size(), 3U);
  EXPECT_EQ(log.samples[0].t_ns, 2'000'000);  // no unit is stated, but 500 Hz is: milliseconds
  EXPECT_EQ(log.samples[0].eye, Eye::right);
  EXPECT_EQ(log.samples[0].u, 0.5);  // 1919 x 1079 are EyeLink's inclusive corners
  EXPECT_EQ(log.samples[0].v, 0.75);
  EXPECT_EQ(log.samples[1].validity, GazeValidity::lost);
  EXPECT_EQ(log.samples[2].validity, GazeValidity::ok);  // n/a is BIDS' missing, zeros are places
  EXPECT_EQ(log.recording_geometry->distance_cm, 120);
  EXPECT_THAT(log.warnings.at(0), HasSubstr("1919x1079 looks like inclusive corners"));
}

// The bytes of an XDF file; what pyxdf 1.17 makes of the same is in the test.
class XdfBytes {
 public:
  template <class... Values>
  static std::string pack(Values... values) {
    std::string bytes;
    (bytes.append(reinterpret_cast<const char*>(&values), sizeof values), ...);
    return bytes;
  }
  static std::string length(std::size_t n) {
    return n < 256 ? pack(std::uint8_t{1}, static_cast<std::uint8_t>(n))
                   : pack(std::uint8_t{4}, static_cast<std::uint32_t>(n));
  }
  void chunk(std::uint16_t tag, const std::string& content) {
    bytes += length(content.size() + 2) + pack(tag) + content;
  }
  std::string bytes = "XDF:";
};

XdfBytes xdf_with_header(const std::string& unit = "<unit>normalized</unit>") {
  XdfBytes xdf;
  xdf.chunk(1, "<?xml version=\"1.0\"?><info><version>1.0</version></info>");
  xdf.chunk(2, XdfBytes::pack(std::uint32_t{7}) +
                   "<?xml version=\"1.0\"?><info><name>t</name><type>Gaze</type><channel_count>3</channel_count>"
                   "<nominal_srate>100</nominal_srate><channel_format>float32</channel_format><desc><channels>"
                   "<channel><label>Screen_X</label><eye>both</eye><type>ScreenX</type>" +
                   unit +
                   "</channel>"
                   "<channel><label>Screen_Y</label><eye>both</eye><type>ScreenY</type>" +
                   unit +
                   "</channel>"
                   "<channel><label>Confidence</label></channel></channels></desc></info>");
  return xdf;
}

std::string gaze_xdf() {
  XdfBytes xdf = xdf_with_header();
  for (int k = 0; k < 4; ++k) {
    xdf.chunk(4, XdfBytes::pack(std::uint32_t{7}, 1000 + k * 0.1, 5.5 + 0.001 * k));
  }
  std::string samples = XdfBytes::pack(std::uint32_t{7}) + XdfBytes::length(40);
  for (int i = 0; i < 40; ++i) {
    const double jitter = 0.001 * ((i * 7) % 5 - 2);
    samples +=
        i % 10 == 3 ? XdfBytes::pack(std::uint8_t{0}) : XdfBytes::pack(std::uint8_t{8}, 1000 + i * 0.01 + jitter);
    samples += XdfBytes::pack(0.25F + static_cast<float>(i) / 256, 0.5F, i == 5 ? 0.0F : 1.0F);
  }
  xdf.chunk(3, samples);
  return xdf.bytes;
}

// Two stretches of 40 samples. The sender's clock stands at `begin_s` at each, and is `offset_s` behind the recorder's
// where it was asked, twelve times a second apart; NaN: not asked again.
struct Stretch {
  double begin_s, offset_s;
};
std::string xdf_of_two(const Stretch& first, const Stretch& second) {
  XdfBytes xdf = xdf_with_header();
  for (const Stretch& part : {first, second}) {
    for (int k = 0; k < 12 && !std::isnan(part.offset_s); ++k) {
      xdf.chunk(4, XdfBytes::pack(std::uint32_t{7}, part.begin_s + k, part.offset_s + 0.001 * k));
    }
    std::string samples = XdfBytes::pack(std::uint32_t{7}) + XdfBytes::length(40);
    for (int i = 0; i < 40; ++i) {
      const double jitter = 0.001 * ((i * 7) % 5 - 2);
      samples += XdfBytes::pack(std::uint8_t{8}, part.begin_s + i * 0.01 + jitter);
      samples += XdfBytes::pack(0.25F + static_cast<float>(i) / 1024, 0.5F, 1.0F);
    }
    xdf.chunk(3, samples);
  }
  return xdf.bytes;
}

TEST_F(GazeFormats, XdfOnTheRecordersClock) {
  const GazeLog log = read("t.xdf", gaze_xdf());
  EXPECT_EQ(log.format, "xdf");
  ASSERT_EQ(log.samples.size(), 40U);
  EXPECT_EQ(log.nominal_rate_hz, 100);
  // pyxdf.load_xdf of the same bytes, with its default clock synchronisation and dejittering, in seconds to 1 ns.
  EXPECT_NEAR(static_cast<double>(log.samples[0].t_ns), 1005'500'221'707.0, 1.5);
  EXPECT_NEAR(static_cast<double>(log.samples[3].t_ns), 1005'530'534'214.0, 1.5);
  EXPECT_NEAR(static_cast<double>(log.samples[39].t_ns), 1005'894'284'293.0, 1.5);
  EXPECT_EQ(log.samples[4].u, 0.25 + 4.0 / 256);
  EXPECT_EQ(log.samples[5].validity, GazeValidity::lost);
}

// A second header of the same stream, which promises more and wider channels than its samples have.
TEST_F(GazeFormats, XdfHasOneHeaderAStream) {
  const GazeLog log = read("t.xdf", gaze_xdf());
  XdfBytes again;
  again.bytes = gaze_xdf();
  again.chunk(2, XdfBytes::pack(std::uint32_t{7}) +
                     "<?xml version=\"1.0\"?><info><type>Gaze</type><channel_count>4000</channel_count>"
                     "<nominal_srate>100</nominal_srate><channel_format>double64</channel_format><desc><channels>"
                     "<channel><label>Screen_X</label></channel><channel><label>Screen_Y</label></channel>"
                     "</channels></desc></info>");
  const GazeLog mended = read("again.xdf", again.bytes);
  EXPECT_THAT(mended.warnings.at(0), HasSubstr("1 damaged or cut off chunk; the readable part is used"));
  ASSERT_EQ(mended.samples.size(), 40U);
  EXPECT_EQ(mended.samples[39].u, 0.25 + 39.0 / 256);
  EXPECT_EQ(mended.samples[39].t_ns, log.samples[39].t_ns);
  // The same header twice contradicts nothing.
  XdfBytes twice = xdf_with_header();
  const std::string header_and_samples = gaze_xdf().substr(4);
  twice.bytes += header_and_samples;
  const GazeLog same = read("twice.xdf", twice.bytes);
  EXPECT_TRUE(same.warnings.empty());
  EXPECT_EQ(same.samples[39].t_ns, log.samples[39].t_ns);
}

// Twenty samples a hundredth of a second apart, without a word on their unit; every tenth is (x, y) of `tenth`.
std::string xdf_without_unit(const Vec2f& most, const Vec2f& tenth) {
  XdfBytes xdf = xdf_with_header("");
  std::string samples = XdfBytes::pack(std::uint32_t{7}) + XdfBytes::length(20);
  for (int i = 0; i < 20; ++i) {
    const Vec2f& at = i % 10 == 9 ? tenth : most;
    samples += XdfBytes::pack(std::uint8_t{8}, 1000 + i * 0.01) + XdfBytes::pack(at.x, at.y, 1.0F);
  }
  xdf.chunk(3, samples);
  return xdf.bytes;
}

TEST_F(GazeFormats, XdfWithoutAUnit) {
  const std::string quarter = xdf_without_unit({0.25F, 0.5F}, {0.75F, 0.5F});
  EXPECT_THAT(refusal("a.xdf", quarter, {}), HasSubstr("`unit` fraction"));
  GazeReadOptions importing;
  importing.accepts_inferred = true;
  const GazeLog fractions = read("a.xdf", quarter, importing);
  EXPECT_EQ(fractions.samples[0].u, 0.25);
  EXPECT_EQ(fractions.conventions.unit.evidence, Evidence::statistics);
  EXPECT_EQ(fractions.conventions.origin.value, PositionOrigin::top_left);
  GazeReadOptions options;
  options.display =
      DisplayGeometry{.width_px = 1000, .height_px = 500, .width_cm = 50, .height_cm = 25, .distance_cm = 50};
  options.columns.position_unit = PositionUnit::px;
  const GazeLog marks = read("b.xdf", xdf_without_unit({0.25F, 0.5F}, {-32768, -32768}), options);
  EXPECT_EQ(marks.samples[0].v, 0.5 / 500);
  EXPECT_EQ(marks.samples[9].validity, GazeValidity::lost);
  // Degrees count from the center.
  const std::string degrees = xdf_without_unit({-10, 5}, {10, 0});
  options.columns.position_unit = PositionUnit::automatic;
  EXPECT_THAT(refusal("c.xdf", degrees, options), HasSubstr("degrees or centimetres?"));
  options.columns.position_unit = PositionUnit::deg;
  EXPECT_NEAR(read("c.xdf", degrees, options).samples[9].u, 0.5 + std::tan(10 * kRadPerDeg), 1e-12);
}

// Expected times are pyxdf 1.17.5's of the same bytes, to 1 ns.
void expect_times(const GazeLog& log, const std::array<double, 4>& expected_s) {
  ASSERT_EQ(log.samples.size(), 80U);
  const std::array<std::size_t, 4> at{0, 39, 40, 79};
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_NEAR(static_cast<double>(log.samples[at[i]].t_ns), expected_s[i] * 1e9, 1.5) << at[i];
  }
}

// The sender was started anew: its clock is back at 2 s while the recorder's goes on.
TEST_F(GazeFormats, XdfWhoseSenderStartedAnew) {
  expect_times(read("reset.xdf", xdf_of_two({1000, 5.5}, {2, 1010.5})),
               {1005.499853512, 1005.890536488, 1012.499853512, 1012.890536488});
}

// Ten seconds without samples are no jitter: each stretch is evened out by itself.
TEST_F(GazeFormats, XdfWithAGap) {
  expect_times(read("gap.xdf", xdf_of_two({1000, 5.5}, {1010, std::nan("")})),
               {1005.499853512, 1005.890536488, 1015.509853512, 1015.900536488});
}

TEST_F(GazeFormats, ADamagedXdfGoesOnAtTheNextBoundary) {
  const std::string good = gaze_xdf();
  const std::size_t header_end = good.find("</desc></info>") + 14;
  XdfBytes boundary;
  boundary.bytes = std::string("\x63\x00garbage", 9);
  boundary.chunk(5, "\x43\xA5\x46\xDC\xCB\xF5\x41\x0F\xB3\x0E\xD5\x46\x73\x83\xCB\xE4");
  const GazeLog log = read("t.xdf", good.substr(0, header_end) + boundary.bytes + good.substr(header_end));
  EXPECT_EQ(log.samples.size(), 40U);
  EXPECT_THAT(log.warnings.at(0), HasSubstr("damaged"));
}

TEST_F(GazeFormats, ColumnMapsAreSavedAndReused) {
  GazeColumns columns;
  columns.time = "Zeit";
  columns.time_unit = TimeUnit::ms;
  columns.left = {.x = "a",
                  .y = "b",
                  .z = "c",
                  .validity = "ok",
                  .confidence = "",
                  .pupil = "",
                  .openness = "o",
                  .origin_x = "",
                  .origin_y = "",
                  .origin_z = ""};
  columns.axes = GazeAxes::unity;
  columns.head_x = "hx";
  columns.valid_values = {"good", "1"};
  columns.valid_mask = 6;
  columns.head_m_per_unit = 0.01;
  const std::string path = files_.path("map.json");
  save_gaze_columns(columns, path);
  EXPECT_EQ(load_gaze_columns(path), columns);
  GazeColumns over;
  over.time = "t";
  const GazeColumns merged = merge_gaze_columns(columns, over);
  EXPECT_EQ(merged.time, "t");
  EXPECT_EQ(merged.left.x, "a");
  try {
    load_gaze_columns(files_.write("bad.json", R"({"tiem": "x"})"));
    ADD_FAILURE();
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), HasSubstr("unknown key 'tiem'; did you mean 'time'?"));
  }
  EXPECT_THROW(load_gaze_columns(files_.write("worse.json", R"({"axes": "left"})")), Error);
}

TEST_F(GazeFormats, FlagsMendWhatALogGotWrong) {
  const std::string text = "# display_px 1000 1000\nt[ms],x[px],y[px]\n0,0,0\n1,250,100\n";
  GazeReadOptions options;
  options.missing_value = 0;
  options.swap_xy = true;
  const GazeLog log = read("log.csv", text, options);
  EXPECT_EQ(log.samples[0].validity, GazeValidity::lost);
  EXPECT_EQ(log.samples[1].u, 0.1);
  EXPECT_EQ(log.samples[1].v, 0.25);
  // The right one of two monitors.
  GazeReadOptions beside;
  beside.corner = Vec2d{1000, 0};
  const GazeLog right = read("log.csv", "# display_px 1000 1000\nt[ms],x[px],y[px]\n0,1100,200\n1,1250,100\n", beside);
  EXPECT_EQ(right.samples[0].u, 0.1);
  EXPECT_EQ(right.samples[1].v, 0.1);
  // Also of formats that state their origin themselves.
  GazeReadOptions flipped;
  flipped.columns.origin = PositionOrigin::bottom_left;
  const GazeLog asc_log = read("a.asc", asc("SAMPLES\tGAZE\tLEFT\tRATE\t500", "100\t0\t270\t9\t...\n"), flipped);
  EXPECT_EQ(asc_log.samples[0].v, 0.75);
  EXPECT_THAT(asc_log.warnings.at(0), HasSubstr("`origin` bottom-left was given and is used"));
}

}  // namespace
}  // namespace gazetrace::gaze_formats_archive_test
