// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "gazetrace/output.hpp"
#include "support/temporary_folder.hpp"

namespace gazetrace::timing_test {
namespace {

TimingRow example(std::int32_t frame) {
  TimingRow row;
  row.frame = frame;
  row.plan_ms = 0.125;
  row.trace_ms = 1234.5;
  row.guides_ms = 3;
  row.reconstruct_ms = 8;
  row.temporal_ms = 0.0625;
  row.exposure_ms = 1.5;
  row.color_ms = 42.0625;
  row.write_ms = 77.75;
  row.total_ms = 1364;
  row.trace_cpu_ms = 2469;
  row.pixels = 8'294'400;
  row.samples = 18'446'744'073'709'551'615U;
  row.training_paths = 65'536;
  row.rays_primary = 3;
  row.rays_bounce = 4;
  row.rays_shadow = 5;
  row.rejected_rays = 6;
  row.non_finite_samples = 7;
  row.region_pixels = {68'488, 673'600, 7'552'312};
  row.region_samples = {8, 9, 10};
  row.region_cpu_ms = {0.5, 0.25, 11};
  row.exposure_ev = -0.1;
  row.gaze = {0.25, 0.987654321, 1};
  row.gaze_state = "measured";
  row.gaze_event = "fixation";
  row.gaze_age_ms = "unknown";
  row.no_gaze = 1;
  row.peak_memory_mib = 512.5;
  return row;
}

TEST(Timing, ColumnsNameTheirUnits) {
  EXPECT_THAT(
      timing_columns(),
      testing::ElementsAre(
          "frame", "plan_ms", "guiding_ms", "pilot_ms", "trace_ms", "guides_ms", "reconstruct_ms", "temporal_ms",
          "exposure_ms", "layers_ms", "color_ms", "write_ms", "total_ms", "trace_cpu_ms", "pixels", "samples",
          "pilot_samples", "other_samples", "training_paths", "rays_primary", "rays_bounce", "rays_shadow",
          "rejected_rays", "non_finite_samples", "fovea_pixels", "fovea_samples", "fovea_cpu_ms", "intermediate_pixels",
          "intermediate_samples", "intermediate_cpu_ms", "periphery_pixels", "periphery_samples", "periphery_cpu_ms",
          "uniform_pixels", "uniform_samples", "uniform_cpu_ms", "block_1_pixels", "block_1_samples", "block_1_cpu_ms",
          "block_2_pixels", "block_2_samples", "block_2_cpu_ms", "block_4_pixels", "block_4_samples", "block_4_cpu_ms",
          "block_8_pixels", "block_8_samples", "block_8_cpu_ms", "block_16_pixels", "block_16_samples",
          "block_16_cpu_ms", "block_32_pixels", "block_32_samples", "block_32_cpu_ms", "block_64_pixels",
          "block_64_samples", "block_64_cpu_ms", "exposure_ev", "predicted_relmse", "predicted_jod", "gaze.u", "gaze.v",
          "gaze.valid", "gaze_state", "gaze_event", "gaze_age_ms", "gaze_effective_age_ms", "no_gaze",
          "peak_memory_mib"));
}

TEST(Timing, RoundTrip) {
  const TemporaryFolder folder;
  const std::string path = folder / "timing.csv";
  write_text_atomically(path, timing_csv_text({example(1), example(2)}));
  const std::vector<TimingRow> rows = read_timing_csv(path);
  ASSERT_EQ(rows.size(), 2U);
  EXPECT_EQ(timing_row_text(rows[1]), timing_row_text(example(2)));
  const TimingRow& row = rows[0];
  EXPECT_EQ(row.frame, 1);
  EXPECT_EQ(row.samples, 18'446'744'073'709'551'615U);
  EXPECT_EQ(row.color_ms, 42.0625);
  EXPECT_EQ(row.region_samples[2], 10U);
  EXPECT_EQ(row.region_cpu_ms[1], 0.25);
  EXPECT_EQ(row.exposure_ev, -0.1);
  EXPECT_EQ(row.gaze.u, 0.25);
  EXPECT_NEAR(row.gaze.v, 0.987654321, 5e-7);
  EXPECT_EQ(row.gaze.valid, 1);
  EXPECT_EQ(row.gaze_state, "measured");
  EXPECT_EQ(row.gaze_event, "fixation");
  EXPECT_EQ(row.gaze_age_ms, "unknown");
  EXPECT_EQ(row.no_gaze, 1);
  EXPECT_EQ(row.peak_memory_mib, 512.5);
}

TEST(Timing, ALineCutOffByTheEndOfARunIsPassedOver) {
  const TemporaryFolder folder;
  const std::string path = folder / "timing.csv";
  const std::string whole = timing_csv_text({example(1), example(2)});
  const std::size_t second_row = timing_csv_text({example(1)}).size();
  for (std::size_t size = second_row; size < whole.size(); ++size) {
    write_text_atomically(path, whole.substr(0, size));
    EXPECT_EQ(read_timing_csv(path).size(), 1U) << size;
  }
}

void expect_error(const std::string& path, const std::string& text, const std::string& part) {
  write_text_atomically(path, text);
  try {
    read_timing_csv(path);
    FAIL() << text;
  } catch (const Error& e) {
    EXPECT_EQ(e.kind(), ErrorKind::input);
    EXPECT_THAT(e.what(), testing::HasSubstr(part));
  }
}

TEST(Timing, BrokenTables) {
  const TemporaryFolder folder;
  const std::string path = folder / "timing.csv";
  const std::string header = timing_csv_text({});
  expect_error(path, "", "first line");
  expect_error(path, "frame,ms\n", "timing.csv:1: the columns");
  expect_error(path, header + "1,2,3\n", "timing.csv:2: 3 columns instead of 69");
  std::string letters = timing_csv_text({example(1)});
  letters.replace(letters.find("1234.5000"), 9, "fast");
  expect_error(path, letters, "timing.csv:2: 'fast' is not a number for column trace_ms");
  EXPECT_THROW(read_timing_csv(folder / "none.csv"), Error);
}

}  // namespace
}  // namespace gazetrace::timing_test
