// SPDX-License-Identifier: Apache-2.0
// Real recordings beside the project, each read without its format being named. Expected numbers were counted in the
// files by other means: a few lines of Python (pandas for tables, json for JSON lines, numpy for binary records).
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

#include "gazetrace/gaze.hpp"

namespace gazetrace::gaze_samples_test {
namespace {

using ::testing::HasSubstr;

std::string sample(const std::string& name) {
  return std::string(GAZETRACE_SHARED_DIR) + "/gaze-samples/" + name;
}

#define SKIP_WITHOUT(name)                          \
  if (!std::filesystem::exists(sample(name))) {     \
    GTEST_SKIP() << sample(name) << " is not here"; \
  }

GazeReadOptions in_frame(GazeFrame frame) {
  GazeReadOptions options;
  options.frame = frame;
  return options;
}
GazeReadOptions of_eye(EyeChoice eye) {
  GazeReadOptions options;
  options.eye = eye;
  return options;
}

std::size_t count(const GazeLog& log, GazeValidity validity) {
  return static_cast<std::size_t>(std::count_if(log.samples.begin(), log.samples.end(),
                                                [&](const GazeSample& s) { return s.validity == validity; }));
}
std::size_t events(const GazeLog& log, GazeEventType type) {
  return static_cast<std::size_t>(
      std::count_if(log.events.begin(), log.events.end(), [&](const GazeEvent& e) { return e.type == type; }));
}
std::string fact(const GazeLog& log, const std::string& what) {
  for (const GazeFact& f : log.facts) {
    if (f.what == what) {
      return f.value + " (" + std::string(to_string(f.evidence)) + ")";
    }
  }
  return "";
}

void expect_span(const GazeLog& log, const std::string& format, std::size_t samples, std::int64_t first_ns,
                 std::int64_t last_ns) {
  EXPECT_EQ(log.format, format);
  EXPECT_GE(log.format_confidence, 0.9);
  ASSERT_EQ(log.samples.size(), samples);
  EXPECT_EQ(log.samples.front().t_ns, first_ns);
  EXPECT_EQ(log.samples.back().t_ns, last_ns);
}

std::string refusal(const std::string& path, const GazeReadOptions& options = {}) {
  try {
    load_gaze_log(path, options);
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::input);
    return error.what();
  }
  return "";
}

TEST(GazeSamples, EyeLinkBinocular) {
  SKIP_WITHOUT("eyelink-asc/bino1000.asc");
  const GazeLog log = load_gaze_log(sample("eyelink-asc/bino1000.asc"), {});
  // Lines of the calibration's coefficients begin with digits too; samples stand only between START and END.
  expect_span(log, "eyelink-asc", 3467, 7'427'362'000'000, 7'436'443'000'000);
  EXPECT_EQ(log.eyes.size(), 3467U);
  EXPECT_EQ(log.nominal_rate_hz, 1000);
  // Corners are inclusive: 0 0 1023 767 is 1024 x 768.
  EXPECT_EQ(log.eyes[0].left.at, (Vec3d{502.3 / 1024, 411.1 / 768, 0}));
  EXPECT_EQ(log.eyes[0].right.at, (Vec3d{512.8 / 1024, 395.9 / 768, 0}));
  EXPECT_EQ(log.eyes[0].left.pupil, 1103.0F);
  EXPECT_EQ(log.pupil_unit, "area");
  EXPECT_EQ(log.samples[0].row, 138);
  EXPECT_EQ(log.eyes[3466].left.at, (Vec3d{776.1 / 1024, 383.3 / 768, 0}));
  EXPECT_EQ(log.samples[3466].row, 3802);
  EXPECT_EQ(log.samples[1733].t_ns, 7'432'712'000'000);
  EXPECT_EQ(log.eyes[1733].right.at, (Vec3d{515.1 / 1024, 390.6 / 768, 0}));
  // Four blocks with seconds between them; 24 fixations, 16 saccades, two validations.
  EXPECT_EQ(events(log, GazeEventType::segment), 4U);
  EXPECT_EQ(events(log, GazeEventType::fixation), 24U);
  EXPECT_EQ(events(log, GazeEventType::saccade), 16U);
  EXPECT_EQ(events(log, GazeEventType::message), 196U);
  ASSERT_EQ(log.calibrations.size(), 2U);
  EXPECT_EQ(log.calibrations[0].eye, Eye::left);
  EXPECT_EQ(log.calibrations[0].mean_error_deg, 0.35);
  EXPECT_EQ(log.calibrations[1].max_error_deg, 0.91);
  ASSERT_TRUE(log.pixels_per_degree.has_value());
  EXPECT_NEAR(log.pixels_per_degree->x, (35.19 + 35.18 * 3) / 4, 1e-12);
}

TEST(GazeSamples, EyeLinkBlinks) {
  SKIP_WITHOUT("eyelink-asc/bino1000_blinks.asc");
  const GazeLog log = load_gaze_log(sample("eyelink-asc/bino1000_blinks.asc"), {});
  expect_span(log, "eyelink-asc", 10294, 1'835'009'000'000, 1'845'302'000'000);
  EXPECT_EQ(log.recording_geometry->width_px, 1680);
  EXPECT_EQ(log.recording_geometry->height_px, 1050);
  std::size_t left = 0;
  std::size_t right = 0;
  for (const BothEyes& eyes : log.eyes) {
    left += std::isnan(eyes.left.at.x) ? 1 : 0;
    right += std::isnan(eyes.right.at.x) ? 1 : 0;
  }
  EXPECT_EQ(left, 313U);  // 297 and 16 of EBLINK L
  EXPECT_EQ(right, 66U);
  // Line 7074: the left eye alone is lost, `1841860  . . 0.0  326.9 562.2 885.0  .C...`.
  const std::size_t at = 1841860 - 1835009;
  EXPECT_EQ(log.samples[at].row, 7074);
  EXPECT_EQ(log.eyes[at].left.validity, GazeValidity::blink);
  EXPECT_TRUE(std::isnan(log.eyes[at].left.pupil));
  EXPECT_EQ(log.eyes[at].right.at, (Vec3d{326.9 / 1680, 562.2 / 1050, 0}));
  // The tracker's saccade around a blink is part of it.
  const auto saccade = std::find_if(log.events.begin(), log.events.end(), [](const GazeEvent& e) {
    return e.type == GazeEventType::saccade && e.eye == Eye::left && e.begin_ns < 1'841'860'000'000 &&
           e.end_ns > 1'842'156'000'000;
  });
  ASSERT_NE(saccade, log.events.end());
  const auto index = static_cast<std::size_t>((saccade->begin_ns - 1'835'009'000'000) / 1'000'000);
  EXPECT_EQ(log.eyes[index].left.validity, GazeValidity::blink);
  EXPECT_FALSE(std::isnan(log.eyes[index].left.at.x));
  EXPECT_NE(log.eyes[index - 1].left.validity, GazeValidity::blink);
  // Durations in the file are garbage of 64 bits; ends are believed.
  EXPECT_EQ(log.events[0].type, GazeEventType::message);
  for (const GazeEvent& event : log.events) {
    EXPECT_LE(event.end_ns - event.begin_ns, 11'000'000'000);
  }
  // RES of END, 41.00 x 45.48 px/deg; 45 px of vertical difference: the mean only when told.
  EXPECT_NEAR(log.pixels_per_degree->y, 45.48, 1e-12);
  EXPECT_THAT(log.warnings.at(0), HasSubstr("the eyes differ vertically by 0.99 deg"));
  EXPECT_EQ(load_gaze_log(sample("eyelink-asc/bino1000_blinks.asc"), of_eye(EyeChoice::mean)).samples[0].eye,
            Eye::cyclopean);
}

TEST(GazeSamples, EyeLinkMonocular) {
  SKIP_WITHOUT("eyelink-asc/mono500.asc");
  const GazeLog log = load_gaze_log(sample("eyelink-asc/mono500.asc"), {});
  expect_span(log, "eyelink-asc", 1834, 7'196'720'000'000, 7'205'384'000'000);
  EXPECT_TRUE(log.eyes.empty());
  EXPECT_EQ(log.samples[0].eye, Eye::left);
  EXPECT_EQ(log.samples[0].u, 512.8 / 1024);
  EXPECT_EQ(log.samples[917].t_ns, 7'200'052'000'000);
  EXPECT_EQ(log.samples[917].v, 387.5 / 768);
  EXPECT_EQ(log.samples.back().u, 251.3 / 1024);
  EXPECT_EQ(log.calibrations.at(0).mean_error_deg, 0.31);
  EXPECT_EQ(events(log, GazeEventType::fixation), 12U);
}

TEST(GazeSamples, TobiiStudio) {
  SKIP_WITHOUT("tobii-studio-tsv/data.tsv");
  const GazeLog log = load_gaze_log(sample("tobii-studio-tsv/data.tsv"), {});
  // 2,920 rows, 10 of them events without gaze.
  expect_span(log, "tobii-studio", 2910, 5'000'000, 24'244'000'000);
  EXPECT_EQ(count(log, GazeValidity::lost), 193U);
  EXPECT_EQ(events(log, GazeEventType::message), 10U);
  EXPECT_EQ(log.samples[0].u, 985.0 / 1920);
  EXPECT_EQ(log.samples[0].v, 580.0 / 1080);
  EXPECT_EQ(log.eyes[0].left.at, (Vec3d{962.0 / 1920, 578.0 / 1080, 0}));
  EXPECT_TRUE(std::isnan(log.eyes[0].left.pupil));  // -1.00
  EXPECT_EQ(log.samples[1000].t_ns, 8'338'000'000);
  EXPECT_EQ(log.samples[1000].u, 1228.0 / 1920);
  EXPECT_EQ(log.samples[1000].row, 1007);
  EXPECT_EQ(log.samples[2909].v, 542.0 / 1080);
  // 513 x 353 mm, as its README derives from (ADCSmm); medians of the middle between the eyes in 2,483 rows: 245.675 mm
  // from the left edge, 50.375 mm above the lower one and 553.605 mm before the display.
  EXPECT_NEAR(log.recording_geometry->width_cm, 51.3, 0.05);
  EXPECT_NEAR(log.recording_geometry->height_cm, 35.3, 0.05);
  EXPECT_NEAR(log.recording_geometry->distance_cm, 55.3605, 1e-9);
  EXPECT_NEAR(log.recording_geometry->eye_x_cm, 24.5675 - 51.3 / 2, 0.03);
  EXPECT_NEAR(log.recording_geometry->eye_y_cm, 5.0375 - 35.3 / 2, 0.03);
  GazeReadOptions options;
  options.columns.time = "EyeTrackerTimestamp";
  EXPECT_EQ(load_gaze_log(sample("tobii-studio-tsv/data.tsv"), options).samples[0].t_ns, 123'210'798'000);
}

TEST(GazeSamples, TobiiProLabOfFixationsOnly) {
  SKIP_WITHOUT("tobii-pro-lab-tsv/mobile_mapped_excerpt.tsv");
  const std::string path = sample("tobii-pro-lab-tsv/mobile_mapped_excerpt.tsv");
  EXPECT_THAT(refusal(path), HasSubstr("no gaze points (Gaze point X), only fixations"));
  GazeReadOptions options;
  options.columns.x = "Fixation point X";
  options.columns.y = "Fixation point Y";
  options.display = DisplayGeometry{.width_px = 1920, .height_px = 1080};
  const GazeLog log = load_gaze_log(path, options);
  // 27 of 164 rows are the eye tracker's; two rows are a column short, behind what is needed.
  expect_span(log, "tobii-pro-lab", 27, 1'051'996'474'000, 1'052'517'416'000);
  for (const std::size_t i : {0U, 13U, 26U}) {
    EXPECT_EQ(log.samples[i].u, 962.0 / 1920);
    EXPECT_EQ(log.samples[i].v, 647.0 / 1080);
  }
}

TEST(GazeSamples, TobiiGlasses2) {
  SKIP_WITHOUT("tobii-glasses2/livedata.json.gz");
  const std::string path = sample("tobii-glasses2/livedata.json.gz");
  EXPECT_THAT(refusal(path), HasSubstr("scene camera"));
  EXPECT_THAT(refusal(path), HasSubstr("`frame` head"));
  const GazeLog scene = load_gaze_log(path, in_frame(GazeFrame::scene_camera));
  EXPECT_EQ(scene.kind, GazeKind::scene_camera);
  expect_span(scene, "tobii-glasses-2", 965, 84'415'010'000, 104'203'559'000);
  EXPECT_EQ(count(scene, GazeValidity::lost), 5U);
  EXPECT_EQ(scene.samples[0].u, 0.4404);
  EXPECT_EQ(scene.samples[500].t_ns, 94'928'949'000);
  EXPECT_EQ(scene.samples[500].v, 0.4262);
  EXPECT_EQ(scene.samples[964].u, 0.4063);
  const GazeLog head = load_gaze_log(path, in_frame(GazeFrame::head));
  expect_span(head, "tobii-glasses-2", 966, 84'415'010'000, 104'223'566'000);
  // gd [0.0425, 0.1162, 0.9923] looks to the wearer's left.
  EXPECT_NEAR(head.eyes[0].left.at.x, -0.0425, 1e-4);
  EXPECT_NEAR(head.eyes[0].left.at.y, 0.1162, 1e-4);
  EXPECT_NEAR(head.eyes[0].left.at.z, -0.9923, 1e-4);
  EXPECT_EQ(head.origins[0].left_mm, (Vec3f{-31.82F, -23.28F, 29.18F}));
  EXPECT_LT(head.origins[0].left_mm.x, head.origins[0].right_mm.x);
  EXPECT_EQ(head.eyes[0].right.pupil, 3.52F);
  // The scene video starts at ts 85374512.
  const auto start = std::find_if(head.events.begin(), head.events.end(),
                                  [](const GazeEvent& e) { return e.text == "scene video starts"; });
  ASSERT_NE(start, head.events.end());
  EXPECT_EQ(start->begin_ns, 85'374'512'000);
}

TEST(GazeSamples, TobiiGlasses3) {
  SKIP_WITHOUT("tobii-glasses3/gazedata.gz");
  const std::string path = sample("tobii-glasses3/gazedata.gz");
  EXPECT_THAT(refusal(path), HasSubstr("`frame` head"));
  const GazeLog scene = load_gaze_log(path, in_frame(GazeFrame::scene_camera));
  expect_span(scene, "tobii-glasses-3", 6547, 6'684'000, 65'585'314'000);
  EXPECT_EQ(count(scene, GazeValidity::lost), 412U);
  EXPECT_EQ(scene.samples[0].u, 0.57220000000000015);  // float noise is the file's
  EXPECT_EQ(scene.samples[3000].t_ns, 30'061'058'000);
  EXPECT_EQ(scene.samples[3000].u, 0.89460000000000028);
  EXPECT_EQ(scene.samples[6546].v, 0.39800000000000013);
  const GazeLog head = load_gaze_log(sample("tobii-glasses3"), in_frame(GazeFrame::head));
  expect_span(head, "tobii-glasses-3", 6547, 6'684'000, 65'585'314'000);
  std::size_t one = 0;
  for (const BothEyes& eyes : head.eyes) {
    one += is_usable(eyes.left.validity) != is_usable(eyes.right.validity) ? 1 : 0;
  }
  EXPECT_EQ(one, 788U);
  EXPECT_NEAR(head.eyes[0].left.at.x, 0.1463, 1e-4);
  EXPECT_NEAR(head.eyes[0].left.at.z, -0.9872, 1e-4);
  EXPECT_LT(head.origins[0].left_mm.x, head.origins[0].right_mm.x);
}

TEST(GazeSamples, PupilCore) {
  SKIP_WITHOUT("pupil-core/gaze_positions.csv");
  const std::string path = sample("pupil-core/gaze_positions.csv");
  EXPECT_THAT(refusal(path), HasSubstr("export gaze on a surface"));
  const GazeLog scene = load_gaze_log(path, in_frame(GazeFrame::scene_camera));
  expect_span(scene, "pupil-core", 5000, 1'216'218'711'000, 1'237'308'648'000);
  EXPECT_EQ(count(scene, GazeValidity::ok), 4477U);
  EXPECT_EQ(count(scene, GazeValidity::lost), 25U);
  EXPECT_EQ(scene.samples[0].u, 0.46200690434431324);
  EXPECT_EQ(scene.samples[0].v, 1 - 0.285159265953997);  // from the bottom
  EXPECT_EQ(scene.samples[2500].t_ns, 1'226'761'735'500);
  EXPECT_EQ(scene.samples[4999].v, 1 - 0.19903600094890106);
  EXPECT_EQ(fact(scene, "origin"), "bottom-left (format)");
  const GazeLog head = load_gaze_log(path, in_frame(GazeFrame::head));
  // Eye 0 is the right one, by its center; +x right, +y down, +z forward.
  EXPECT_EQ(fact(head, "eye 0"), "right (statistics)");
  EXPECT_NEAR(head.eyes[0].right.at.x, -0.1079293731751228, 1e-12);
  EXPECT_NEAR(head.eyes[0].right.at.y, -0.14599866449787485, 1e-12);
  EXPECT_NEAR(head.eyes[0].right.at.z, -0.9833797030500793, 1e-12);
  const GazeLog mono = load_gaze_log(sample("pupil-core/gaze_positions_with_monocular.csv"), in_frame(GazeFrame::head));
  expect_span(mono, "pupil-core", 2054, 329'367'897'894'000, 329'374'830'006'000);
  std::size_t left = 0;
  std::size_t right = 0;
  for (const BothEyes& eyes : mono.eyes) {
    left += std::isnan(eyes.left.at.x) ? 1 : 0;
    right += std::isnan(eyes.right.at.x) ? 1 : 0;
  }
  EXPECT_EQ(right, 171U + 31U);  // empty gaze_normal0, and (0, 0, 0)
  EXPECT_EQ(left, 294U + 30U);
}

TEST(GazeSamples, PupilInvisible) {
  SKIP_WITHOUT("pupil-invisible-cloud/gaze.csv");
  const std::string path = sample("pupil-invisible-cloud/gaze.csv");
  EXPECT_THAT(refusal(path), HasSubstr("Pupil Cloud"));
  const GazeLog scene = load_gaze_log(path, in_frame(GazeFrame::scene_camera));
  expect_span(scene, "pupil-cloud", 3385, 1'685'088'813'175'076'015, 1'685'088'830'119'004'015);
  EXPECT_EQ(count(scene, GazeValidity::blink), 110U);
  EXPECT_EQ(scene.samples[0].u, 629.146 / 1088);
  EXPECT_EQ(scene.samples[1692].t_ns, 1'685'088'821'647'126'015);
  EXPECT_EQ(scene.samples[1692].v, 564.426 / 1080);
  EXPECT_EQ(scene.samples[3384].u, 476.827 / 1088);
  const GazeLog head = load_gaze_log(path, in_frame(GazeFrame::head));
  const double az = 7.700536268254241 * kRadPerDeg;
  const double el = -8.617572141588298 * kRadPerDeg;
  EXPECT_NEAR(head.samples[0].direction.x, std::cos(el) * std::sin(az), 1e-12);
  EXPECT_NEAR(head.samples[0].direction.y, std::sin(el), 1e-12);
  const GazeLog jumps =
      load_gaze_log(sample("pupil-invisible-cloud/trampoline_02_gaze.csv"), in_frame(GazeFrame::head));
  expect_span(jumps, "pupil-cloud", 5338, 1'629'390'345'036'471'431, 1'629'390'371'788'463'431);
  EXPECT_EQ(count(jumps, GazeValidity::blink), 2103U);
}

TEST(GazeSamples, NeonNative) {
  SKIP_WITHOUT("pupil-neon-native/gaze ps1.raw");
  EXPECT_THAT(refusal(sample("pupil-neon-native")), HasSubstr("put its scene_camera.json beside it"));
  for (const std::string name : {"pupil-neon-native", "pupil-neon-native/gaze ps1.time"}) {
    const GazeLog log = load_gaze_log(sample(name), in_frame(GazeFrame::scene_camera));
    expect_span(log, "neon-native", 1788, 1'760'676'790'465'965'534, 1'760'676'799'429'223'534);
    EXPECT_EQ(log.nominal_rate_hz, 200);
    EXPECT_EQ(log.samples[0].u, static_cast<double>(719.7832F) / 1600);
    EXPECT_EQ(log.samples[900].v, static_cast<double>(599.6922F) / 1200);
    EXPECT_EQ(log.samples[1787].u, static_cast<double>(1081.4131F) / 1600);
    EXPECT_EQ(count(log, GazeValidity::ok), 1788U);
  }
}

TEST(GazeSamples, Smi) {
  SKIP_WITHOUT("smi-iview-txt/recording1_Samples.txt");
  const GazeLog log = load_gaze_log(sample("smi-iview-txt/recording1_Samples.txt"), {});
  expect_span(log, "smi", 27370, 2'152'092'084'000, 2'942'150'823'000);
  EXPECT_EQ(count(log, GazeValidity::lost), 13294U);
  EXPECT_EQ(count(log, GazeValidity::off_screen), 611U);
  EXPECT_EQ(events(log, GazeEventType::message), 28U);
  EXPECT_EQ(events(log, GazeEventType::segment), 5U);  // trials
  EXPECT_EQ(log.nominal_rate_hz, 50);
  EXPECT_EQ(log.recording_geometry->width_px, 1024);
  EXPECT_EQ(log.recording_geometry->width_cm, 30);
  EXPECT_EQ(log.recording_geometry->distance_cm, 80);
  const auto at = [&](std::int64_t t_us) {
    return *std::find_if(log.samples.begin(), log.samples.end(),
                         [&](const GazeSample& s) { return s.t_ns == t_us * 1000; });
  };
  EXPECT_EQ(at(2255986057).u, 512.0 / 1024);
  EXPECT_EQ(at(2735703160).u, 678.82 / 1024);
  EXPECT_EQ(at(2735703160).v, 443.69 / 768);
  EXPECT_EQ(log.samples.back().v, 261.86 / 768);
}

TEST(GazeSamples, Arff) {
  SKIP_WITHOUT("arff/gaze.arff");
  const GazeLog log = load_gaze_log(sample("arff/gaze.arff"), {});
  expect_span(log, "arff", 5002, 1'000'000, 20'116'000'000);
  EXPECT_EQ(count(log, GazeValidity::lost), 49U);
  EXPECT_EQ(count(log, GazeValidity::off_screen), 61U);
  EXPECT_EQ(log.samples[0].u, 416.9 / 1280);
  EXPECT_EQ(log.samples[2500].t_ns, 10'112'000'000);
  EXPECT_EQ(log.samples[2500].v, 502.6 / 720);
  EXPECT_EQ(log.samples[5001].u, 809.5 / 1280);
  EXPECT_EQ(log.recording_geometry->distance_cm, 45);
}

TEST(GazeSamples, BidsWithBothEyes) {
  const std::string name = "bids/derived-tx300/sub-01_task-view_recording-eye1_physio.tsv.gz";
  SKIP_WITHOUT(name);
  const GazeLog log = load_gaze_log(sample(name), {});
  expect_span(log, "bids", 1206, 2'640'808'332'000, 2'644'824'448'000);
  EXPECT_EQ(log.nominal_rate_hz, 300);
  EXPECT_EQ(count(log, GazeValidity::lost), 39U);  // n/a of both; once of the right eye alone
  ASSERT_EQ(log.eyes.size(), 1206U);
  EXPECT_EQ(log.eyes[0].left.at, (Vec3d{909.12 / 1920, 530.50 / 1080, 0}));
  EXPECT_EQ(log.eyes[500].right.at, (Vec3d{1310.98 / 1920, 875.77 / 1080, 0}));
  EXPECT_EQ(log.eyes[1205].left.at, (Vec3d{671.23 / 1920, 875.77 / 1080, 0}));
  EXPECT_EQ(log.eyes[0].left.pupil, 3.6442F);
  EXPECT_EQ(log.pupil_unit, "mm");
  EXPECT_NEAR(log.recording_geometry->width_cm, 50.9174, 1e-12);
  EXPECT_NEAR(log.recording_geometry->distance_cm, 65, 1e-12);
  EXPECT_EQ(fact(log, "time unit"), "us (sidecar)");
}

TEST(GazeSamples, BidsOfNoBytes) {
  const std::string name = "bids/rest_eye/sub-01_ses-01_task-rest_run-01_recording-eye1_physio.tsv.gz";
  SKIP_WITHOUT(name);
  EXPECT_THAT(refusal(sample(name)), HasSubstr("is empty"));
}

TEST(GazeSamples, ViveWithHeadPose) {
  SKIP_WITHOUT("vive-pro-eye/TESTNA01_360VR_Fist3.csv");
  const GazeLog log = load_gaze_log(sample("vive-pro-eye/TESTNA01_360VR_Fist3.csv"), {});
  // .NET ticks counted from 1970: (638342802882596202 - 621355968000000000) * 100 ns.
  expect_span(log, "vive-sranipal", 1665, 1'698'683'488'259'620'200, 1'698'683'502'123'268'900);
  EXPECT_EQ(log.kind, GazeKind::direction);
  // The direction's bit unset in 32 rows of the left eye, 33 of the right; openness <= 0.1 is a blink.
  std::size_t lost = 0;
  std::size_t unusable = 0;
  for (const BothEyes& eyes : log.eyes) {
    lost += std::isnan(eyes.left.at.x) ? 1 : 0;
    unusable += is_usable(eyes.left.validity) || is_usable(eyes.right.validity) ? 0 : 1;
  }
  EXPECT_EQ(lost, 32U);
  EXPECT_EQ(unusable, 43U);
  // SRanipal's +x is the wearer's left, its +z forward; written to seven digits, so not of unit length to the last.
  const Vec3d first = normalize(Vec3d{-0.05995178, -0.09603882, -0.9935608});
  EXPECT_LT(length(log.eyes[0].left.at - first), 1e-15);
  EXPECT_EQ(log.origins[0].left_mm.x, -38.03552F);
  EXPECT_EQ(log.origins[0].right_mm.x, 32.1974F);
  ASSERT_EQ(log.head.size(), 1665U);
  EXPECT_EQ(log.head[0].position_m, (Vec3d{0.7961, 1.2287, -0.7097}));
  // Unity's Euler angles (0.2186, 332.7692, 359.7081): yaw of -27.23 deg is to the left, so -z turns towards -x.
  const Vec3d view = rotate(log.head[0].orientation, {0, 0, -1});
  EXPECT_NEAR(std::atan2(view.x, -view.z) * kDegPerRad, 332.7692 - 360, 1e-9);
  EXPECT_NEAR(std::asin(view.y) * kDegPerRad, -0.2186, 1e-9);  // positive about x is nose down
  EXPECT_EQ(load_gaze_log(sample("vive-pro-eye/TESTNA01_2D_Fist3.csv"), {}).samples.size(), 1518U);
  EXPECT_THAT(refusal(sample("vive-pro-eye/TESTVA03_2D_Spread9_header_only.csv")), HasSubstr("holds no sample"));
}

TEST(GazeSamples, HeadAnglesThatWrapStayContinuous) {
  SKIP_WITHOUT("vive-pro-eye/TESTNA01_360VR_Fist3.csv");
  const GazeLog log = load_gaze_log(sample("vive-pro-eye/TESTNA01_360VR_Fist3.csv"), {});
  double fastest_deg = 0;
  for (std::size_t i = 1; i < log.head.size(); ++i) {
    const Vec3d a = rotate(log.head[i - 1].orientation, {0, 0, -1});
    const Vec3d b = rotate(log.head[i].orientation, {0, 0, -1});
    fastest_deg = std::max(fastest_deg, angle_between_rad(a, b) * kDegPerRad);
  }
  EXPECT_GT(fastest_deg, 0.01);
  EXPECT_LT(fastest_deg, 10);  // of one row to the next; a wrap taken for a turn would be 360
}

TEST(GazeSamples, PicoIsALogOfFrames) {
  SKIP_WITHOUT("pico-neo3-pro/boxing_VR.csv");
  const GazeLog log = load_gaze_log(sample("pico-neo3-pro/boxing_VR.csv"), {});
  expect_span(log, "pico", 492, 11'111'110, 5'466'674'000);
  EXPECT_EQ(count(log, GazeValidity::lost), 6U);
  EXPECT_TRUE(log.sample_age_unknown);
  EXPECT_NEAR(log.samples[0].direction.x, 0.0133, 1e-4);
  EXPECT_NEAR(log.samples[0].direction.y, 0.2678, 1e-4);
  EXPECT_NEAR(log.samples[0].direction.z, -0.9634, 1e-4);
  EXPECT_NEAR(log.samples[200].direction.x, 0.0638, 1e-4);
  EXPECT_NEAR(log.samples[491].direction.y, 0.1127, 1e-4);
  ASSERT_EQ(log.head.size(), 492U);
  EXPECT_EQ(log.head[0].position_m, (Vec3d{0.0067, 1.6033, 0.366}));
}

TEST(GazeSamples, GazeBaseVrInDegrees) {
  SKIP_WITHOUT("gazebase-vr/gazebase_vr_example.csv");
  const GazeLog log = load_gaze_log(sample("gazebase-vr/gazebase_vr_example.csv"), {});
  expect_span(log, "gazebase", 10, 0, 35'943'000);
  EXPECT_EQ(log.kind, GazeKind::direction);
  EXPECT_EQ(log.samples[1].t_ns, 3'969'900);
  const auto azimuth = [](const Vec3d& d) { return std::atan2(d.x, -d.z) * kDegPerRad; };
  const auto elevation = [](const Vec3d& d) { return std::atan2(d.y, -d.z) * kDegPerRad; };
  EXPECT_NEAR(azimuth(log.samples[0].direction), 0.7334, 1e-9);
  EXPECT_NEAR(elevation(log.samples[0].direction), -4.9397, 1e-9);
  EXPECT_NEAR(azimuth(log.eyes[0].left.at), 3.5087, 1e-9);
  EXPECT_NEAR(elevation(log.eyes[9].right.at), -5.4664, 1e-9);
}

TEST(GazeSamples, PlainCsvCanBeLookedAtWithoutItsDisplay) {
  SKIP_WITHOUT("plain-csv/gaze-toy-example.csv");
  EXPECT_THAT(refusal(sample("plain-csv/gaze-toy-example.csv")), HasSubstr("`unit` px `screen-px` W,H"));
  GazeReadOptions options;
  options.guess_display = true;
  const GazeLog log = load_gaze_log(sample("plain-csv/gaze-toy-example.csv"), options);
  EXPECT_EQ(fact(log, "position unit"), "px (statistics)");
  EXPECT_THAT(fact(log, "display size"), HasSubstr("(statistics)"));
}

}  // namespace
}  // namespace gazetrace::gaze_samples_test
