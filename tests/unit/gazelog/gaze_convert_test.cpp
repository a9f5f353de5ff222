// SPDX-License-Identifier: Apache-2.0
// A log written as gazetrace CSV or as BIDS and read again is the same log: times to the nanosecond, everything else
// bit by bit. Over real recordings and synthetic ones.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>

#include "gazetrace/gaze.hpp"
#include "gazetrace/gaze_events.hpp"
#include "gazetrace/gaze_synth.hpp"
#include "gazetrace/gaze_write.hpp"
#include "support/text_file.hpp"

namespace gazetrace::gaze_convert_test {
namespace {

// Equal bits, or both missing.
template <class Number>
void expect_same(Number a, Number b, const std::string& what) {
  EXPECT_TRUE((std::isnan(a) && std::isnan(b)) || a == b) << what << ": " << a << " and " << b;
}

void expect_same_place(const Vec3d& a, const Vec3d& b, const std::string& what) {
  expect_same(a.x, b.x, what + " x");
  expect_same(a.y, b.y, what + " y");
  expect_same(a.z, b.z, what + " z");
}

void expect_same_eye(const EyeGaze& a, const EyeGaze& b, const std::string& what) {
  EXPECT_EQ(a.validity, b.validity) << what;
  expect_same(a.confidence, b.confidence, what + " confidence");
  expect_same(a.pupil, b.pupil, what + " pupil");
  if (!std::isnan(a.at.x) || !std::isnan(b.at.x)) {
    expect_same_place(a.at, b.at, what);
  }
}

void expect_same_log(const GazeLog& a, const GazeLog& b) {
  EXPECT_EQ(a.kind, b.kind);
  EXPECT_EQ(a.pupil_unit, b.pupil_unit);
  ASSERT_EQ(a.samples.size(), b.samples.size());
  ASSERT_EQ(a.eyes.size(), b.eyes.size());
  ASSERT_EQ(a.origins.size(), b.origins.size());
  for (std::size_t i = 0; i < a.samples.size() && !::testing::Test::HasFailure(); ++i) {
    const GazeSample& s = a.samples[i];
    const GazeSample& r = b.samples[i];
    const std::string at = "sample " + std::to_string(i);
    EXPECT_EQ(s.t_ns, r.t_ns) << at;
    EXPECT_EQ(s.eye, r.eye) << at;
    const auto place = [&](const GazeSample& g) {
      return a.kind == GazeKind::direction ? g.direction : Vec3d{g.u, g.v, 0};
    };
    expect_same_eye({place(s), s.confidence, s.pupil, s.validity}, {place(r), r.confidence, r.pupil, r.validity}, at);
    if (!a.eyes.empty()) {
      expect_same_eye(a.eyes[i].left, b.eyes[i].left, at + " left");
      expect_same_eye(a.eyes[i].right, b.eyes[i].right, at + " right");
    }
    if (!a.origins.empty()) {
      expect_same_place(to_double(a.origins[i].left_mm), to_double(b.origins[i].left_mm), at + " left origin");
      expect_same_place(to_double(a.origins[i].right_mm), to_double(b.origins[i].right_mm), at + " right origin");
    }
  }
  ASSERT_EQ(a.recording_geometry.has_value(), b.recording_geometry.has_value());
  if (a.recording_geometry) {
    EXPECT_EQ(a.recording_geometry->width_px, b.recording_geometry->width_px);
    EXPECT_EQ(a.recording_geometry->height_px, b.recording_geometry->height_px);
    EXPECT_EQ(a.recording_geometry->width_cm, b.recording_geometry->width_cm);
    EXPECT_EQ(a.recording_geometry->height_cm, b.recording_geometry->height_cm);
    EXPECT_EQ(a.recording_geometry->distance_cm, b.recording_geometry->distance_cm);
    EXPECT_EQ(a.recording_geometry->eye_x_cm, b.recording_geometry->eye_x_cm);
  }
  EXPECT_EQ(a.pixels_per_degree, b.pixels_per_degree);
}

void expect_same_head(const GazeLog& a, const GazeLog& b) {
  ASSERT_EQ(a.head.size(), b.head.size());
  for (std::size_t i = 0; i < a.head.size() && !::testing::Test::HasFailure(); ++i) {
    EXPECT_EQ(a.head[i].t_ns, b.head[i].t_ns) << i;
    EXPECT_TRUE(a.head[i].position_m == b.head[i].position_m && a.head[i].orientation == b.head[i].orientation) << i;
  }
}

void expect_same_events(const GazeLog& a, const GazeLog& b) {
  ASSERT_EQ(a.events.size(), b.events.size());
  for (std::size_t i = 0; i < a.events.size() && !::testing::Test::HasFailure(); ++i) {
    const GazeEvent& e = a.events[i];
    const GazeEvent& r = b.events[i];
    EXPECT_TRUE(e.type == r.type && e.eye == r.eye && e.begin_ns == r.begin_ns && e.end_ns == r.end_ns) << i;
    EXPECT_EQ(e.text, r.text) << i;
  }
}

void expect_same_calibrations(const GazeLog& a, const GazeLog& b) {
  ASSERT_EQ(a.calibrations.size(), b.calibrations.size());
  for (std::size_t i = 0; i < a.calibrations.size(); ++i) {
    EXPECT_TRUE(a.calibrations[i].eye == b.calibrations[i].eye && a.calibrations[i].t_ns == b.calibrations[i].t_ns);
    expect_same(a.calibrations[i].mean_error_deg, b.calibrations[i].mean_error_deg, "mean error");
    expect_same(a.calibrations[i].max_error_deg, b.calibrations[i].max_error_deg, "greatest error");
  }
}

class Conversion : public ::testing::TestWithParam<const char*> {
 protected:
  // Empty where there is no such recording.
  static std::string sample() { return std::string(GAZETRACE_SHARED_DIR) + "/gaze-samples/" + GetParam(); }
};

#define SKIP_WITHOUT_SAMPLE()                   \
  if (!std::filesystem::exists(sample())) {     \
    GTEST_SKIP() << sample() << " is not here"; \
  }

TEST_P(Conversion, ToCsvAndBack) {
  SKIP_WITHOUT_SAMPLE();
  const GazeLog log = load_gaze_log(sample(), {});
  const TextFiles files;
  write_gaze_csv(log, files.path("log.csv"));
  const GazeLog back = load_gaze_log(files.path("log.csv"), {});
  expect_same_log(log, back);
  expect_same_head(log, back);
  expect_same_events(log, back);
  expect_same_calibrations(log, back);
  EXPECT_EQ(log.nominal_rate_hz, back.nominal_rate_hz);
  EXPECT_EQ(log.sample_age_unknown, back.sample_age_unknown);
  EXPECT_EQ(default_event_preset(log).name, default_event_preset(back).name);
}

TEST_P(Conversion, ToBidsAndBack) {
  SKIP_WITHOUT_SAMPLE();
  const GazeLog log = load_gaze_log(sample(), {});
  const TextFiles files;
  write_gaze_bids(log, files.path("sub-01_task-look_physio.tsv.gz"));
  const std::vector<std::string> names = bids_file_names(log, files.path("sub-01_task-look_physio.tsv.gz"));
  for (const std::string& name : names) {
    EXPECT_TRUE(std::filesystem::exists(name)) << name;
  }
  for (const std::string& name : names) {  // whichever is opened, its neighbours come along
    if (is_bids_file_name(name)) {
      expect_same_log(log, load_gaze_log(name, {}));
    }
  }
  const GazeLog back = load_gaze_log(names.front(), {});
  EXPECT_EQ(back.format, "bids");
  expect_same_calibrations(log, back);
  EXPECT_EQ(log.sample_age_unknown, back.sample_age_unknown);
  const auto count = [](const GazeLog& l, GazeEventType type) {
    return std::count_if(l.events.begin(), l.events.end(), [&](const GazeEvent& e) { return e.type == type; });
  };
  for (const GazeEventType type : {GazeEventType::fixation, GazeEventType::saccade, GazeEventType::blink,
                                   GazeEventType::message, GazeEventType::segment}) {
    EXPECT_EQ(count(back, type), count(log, type)) << to_string(type);
  }
}

INSTANTIATE_TEST_SUITE_P(RealRecordings, Conversion,
                         ::testing::Values("eyelink-asc/bino1000_blinks.asc", "eyelink-asc/bino1000.asc",
                                           "eyelink-asc/mono500.asc", "tobii-studio-tsv/data.tsv", "arff/gaze.arff",
                                           "vive-pro-eye/TESTNA01_360VR_Fist3.csv", "pico-neo3-pro/boxing_VR.csv",
                                           "bids/derived-tx300/sub-01_task-view_recording-eye1_physio.tsv.gz",
                                           "gazebase-vr/gazebase_vr_example.csv"));

TEST(GazeConvert, SyntheticLogsSurviveBids) {
  for (const GazeKind kind : {GazeKind::screen, GazeKind::direction}) {
    SynthSettings settings;
    settings.kind = kind;
    settings.noise_deg = 0.3;
    settings.lost_share = 0.1;
    settings.blinks_per_min = 30;
    // No number of pixels that divides without a rest.
    settings.display = {1366, 769, 34.4, 19.35, 57.3, 1.1, -2.2};
    GazeLog log = synthesize_gaze(settings).log;
    for (GazeSample& sample : log.samples) {
      sample.t_ns += 1'700'000'000'123'456'789;  // beyond 2^53
    }
    const TextFiles files;
    write_gaze_bids(log, files.path("sub-02_recording-eye1_physio.tsv.gz"));
    EXPECT_TRUE(std::filesystem::exists(files.path("sub-02_recording-cyclopean_physio.tsv.gz")));
    expect_same_log(log, load_gaze_log(files.path("sub-02_recording-cyclopean_physio.tsv.gz"), {}));
  }
}

// Eyes that differ vertically by a degree: automatic takes one of them, and says so.
GazeLog log_of_two_eyes(const TextFiles& files, bool loses_the_better) {
  std::string text =
      "# gazetrace-gaze 1\n# display_px 1000 1000\n# display_cm 50 50\n# distance_cm 60\nt[ns],u[1],v[1],valid,eye\n";
  for (int i = 0; i < 300; ++i) {
    const double u = 0.5 + 0.1 * std::sin(0.05 * i);
    text += std::to_string(4'000'000LL * i) + "," + std::to_string(u) + ",0.50," +
            (i % 50 == 7 && loses_the_better ? "lost" : "ok") + ",left\n";
    text += std::to_string(4'000'000LL * i) + "," + std::to_string(u + 0.02 * (i % 2)) + ",0.53," +
            (i % 20 == 3 && loses_the_better ? "lost" : "ok") + ",right\n";
  }
  GazeLog log = load_gaze_log(files.write("eyes.csv", text), {});
  log.events = {{GazeEventType::fixation, Eye::left, 0, 8'000'000, "L", 0},
                {GazeEventType::fixation, Eye::right, 4'000'000, 16'000'000, "R", 0},
                {GazeEventType::segment, Eye::cyclopean, 0, 1'196'000'000, "", 0}};
  for (const GazeSample& sample : log.samples) {
    log.head.push_back({sample.t_ns, {0.25, 1.5, 1e-9 * static_cast<double>(sample.t_ns)}, {0, 0, 0, 1}});
  }
  return log;
}

TEST(GazeConvert, TheChosenEyeStaysChosen) {
  for (const bool stands_in : {false, true}) {
    const TextFiles files;
    const GazeLog log = log_of_two_eyes(files, stands_in);
    ASSERT_EQ(log.samples.front().eye, Eye::left);  // the steadier one, or the one that is seen more often
    write_gaze_csv(log, files.path("log.csv"));
    expect_same_head(log, load_gaze_log(files.path("log.csv"), {}));
    EXPECT_EQ(read_file(files.path("log.csv")).find("ok,cyclopean") != std::string::npos, stands_in);
    write_gaze_bids(log, files.path("sub-1_physio.tsv.gz"));
    EXPECT_EQ(std::filesystem::exists(files.path("sub-1_recording-cyclopean_physio.tsv.gz")), stands_in);
    for (const char* const name :
         {"log.csv", "sub-1_recording-eye1_physio.tsv.gz", "sub-1_recording-eye2_physio.tsv.gz"}) {
      const GazeLog back = load_gaze_log(files.path(name), {});
      expect_same_log(log, back);
      EXPECT_EQ(events_of_log(back).events.front().end_ns, events_of_log(log).events.front().end_ns) << name;
      EXPECT_EQ(std::count_if(back.events.begin(), back.events.end(),
                              [](const GazeEvent& e) { return e.type == GazeEventType::segment; }),
                1);
      const bool warned = std::any_of(back.warnings.begin(), back.warnings.end(), [](const std::string& w) {
        return w.find("differ vertically") != std::string::npos;
      });
      EXPECT_TRUE(warned) << name;
    }
    // Asking for the mean still gives it.
    GazeReadOptions mean;
    mean.eye = EyeChoice::mean;
    EXPECT_EQ(load_gaze_log(files.path("log.csv"), mean).samples.front().eye, Eye::cyclopean);
  }
}

// BIDS has no recording of both there.
TEST(GazeConvert, EventsOfBothEyesGoWithTheOneThatWasTaken) {
  const TextFiles files;
  log_of_two_eyes(files, false);
  GazeReadOptions options;
  options.eye = EyeChoice::right;
  GazeLog log = load_gaze_log(files.path("eyes.csv"), options);
  log.events = {{GazeEventType::blink, Eye::cyclopean, 0, 8'000'000, "", 0}};
  write_gaze_bids(log, files.path("sub-1_physio.tsv.gz"));
  const GazeLog back = load_gaze_log(files.path("sub-1_recording-eye2_physio.tsv.gz"), {});
  ASSERT_EQ(back.events.size(), 1U);
  EXPECT_EQ(back.events.front().eye, Eye::right);
}

TEST(GazeConvert, ThePupilsUnitIsThatOfAnyRecording) {
  const TextFiles files;
  std::string text = "# gazetrace-gaze 1\nt[ns],u[1],v[1],valid,eye,pupil[mm]\n";
  for (int i = 0; i < 10; ++i) {
    for (const char* const eye : {"cyclopean,", "left,3.5", "right,3.25"}) {
      text += std::to_string(i * 8'000'000) + ",0.5,0.5,ok," + eye + "\n";
    }
  }
  const GazeLog log = load_gaze_log(files.write("log.csv", text), {});
  ASSERT_EQ(log.pupil_unit, "mm");
  write_gaze_bids(log, files.path("sub-1_physio.tsv.gz"));
  EXPECT_EQ(load_gaze_log(files.path("sub-1_recording-cyclopean_physio.tsv.gz"), {}).pupil_unit, "mm");
}

TEST(GazeConvert, TheRateOfAFrameLogIsItsMean) {
  GazeLog log;
  log.source = "frames";
  std::int64_t t_ns = 0;
  for (int i = 0; i < 300; ++i) {  // 8, 8 and 9 ms: 120 Hz
    log.samples.push_back({t_ns, 0.5, 0.5, {}, GazeValidity::ok, Eye::cyclopean, 1, 0, i});
    t_ns += i % 3 == 2 ? 9'000'000 : 8'000'000;
  }
  const TextFiles files;
  write_gaze_bids(log, files.path("sub-1_physio.tsv.gz"));
  EXPECT_NEAR(load_gaze_log(files.path("sub-1_recording-cyclopean_physio.tsv.gz"), {}).nominal_rate_hz, 120, 0.1);
  log.nominal_rate_hz = 125;  // stated
  write_gaze_bids(log, files.path("sub-2_physio.tsv.gz"));
  EXPECT_EQ(load_gaze_log(files.path("sub-2_recording-cyclopean_physio.tsv.gz"), {}).nominal_rate_hz, 125);
}

TEST(GazeConvert, PosesBetweenSamplesAndTextsOfManyKindsSurviveCsv) {
  GazeLog log = synthesize_gaze({}).log;
  log.sample_age_unknown = true;
  log.nominal_rate_hz = 120.03;
  std::int64_t k = 0;
  for (std::size_t i = 0; i < 400; ++i, ++k) {
    const double a = 0.1 * static_cast<double>(k);
    const Vec3d p{std::sin(a), 1.0 / 3.0, 1e-17 * a};
    const Quatd q = normalize(Quatd{std::sin(a), std::cos(3 * a), 0.3, 1.1});
    log.head.push_back({log.samples[i].t_ns, p, q});
    if (i % 3 == 0) {
      log.head.push_back({log.samples[i].t_ns + 1, p, q});
    }
  }
  for (const GazeEventType type : {GazeEventType::fixation, GazeEventType::saccade, GazeEventType::blink,
                                   GazeEventType::message, GazeEventType::segment}) {
    for (const std::string text : {"", "TRIALID 7, \"a;b\"  # c", "23"}) {
      log.events.push_back({type, Eye::right, -5, 1'700'000'000'123'456'789, text, 0});
    }
  }
  log.events.push_back({GazeEventType::message, Eye::cyclopean, 3, 3, "two\nlines", 0});
  log.calibrations.push_back({77, Eye::left, 0.1, std::numeric_limits<double>::quiet_NaN(), 0});
  const TextFiles files;
  write_gaze_csv(log, files.path("log.csv"));
  const GazeLog back = load_gaze_log(files.path("log.csv"), {});
  expect_same_log(log, back);
  expect_same_head(log, back);
  log.events.back().text = "two lines";
  expect_same_events(log, back);
  expect_same_calibrations(log, back);
  EXPECT_TRUE(back.sample_age_unknown);
  EXPECT_EQ(back.nominal_rate_hz, 120.03);
}

TEST(GazeConvert, RecordsOfThePreambleThatAreWrongAreNamed) {
  const TextFiles files;
  for (const std::string line : {"event blunk left 1 2", "event blink left 1.5 2", "event blink", "head 1 2 3",
                                 "calibration left x 1 1", "rate_hz fast"}) {
    const std::string path = files.write("log.csv", "# gazetrace-gaze 1\n# " + line + "\nt[ns],u[1],v[1]\n1,0.5,0.5\n");
    try {
      load_gaze_log(path, {});
      ADD_FAILURE() << line;
    } catch (const Error& error) {
      EXPECT_NE(std::string(error.what()).find("log.csv:2"), std::string::npos) << error.what();
    }
    // A comment of somebody else's table is no record.
    EXPECT_NO_THROW(load_gaze_log(files.write("other.csv", "# " + line + "\nt[ns],u[1],v[1]\n1,0.5,0.5\n"), {}))
        << line;
  }
}

TEST(GazeConvert, OtherNamesAreNoBids) {
  EXPECT_TRUE(is_bids_file_name("a/sub-01_task-view_physio.tsv.gz"));
  EXPECT_FALSE(is_bids_file_name("log.csv"));
  EXPECT_FALSE(is_bids_file_name("physio.tsv.gz"));
  EXPECT_FALSE(is_bids_file_name("sub-01_physio.tsv"));
  EXPECT_THROW(write_gaze_bids(synthesize_gaze({}).log, "log.csv"), Error);
}

}  // namespace
}  // namespace gazetrace::gaze_convert_test
