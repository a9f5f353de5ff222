// SPDX-License-Identifier: Apache-2.0
// Every file of the recordings beside the project, by one table: how many samples, the first and the last time to the
// nanosecond, how many have no place, and four rows in canonical form, worked by hand from the text of that line (its
// number stands beside them). Files that are no gaze log must say so.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <functional>

#include "gazetrace/gaze.hpp"

namespace gazetrace::gaze_samples_table_test {
namespace {

using ::testing::HasSubstr;

std::string sample_path(const std::string& name) {
  return std::string(GAZETRACE_SHARED_DIR) + "/gaze-samples/" + name;
}

struct Row {
  std::size_t index;  // among the samples
  std::int64_t row;   // line of the file, or record
  std::int64_t t_ns;
  Vec3d at;  // (u, v, 0) or the direction
};

struct Span {
  std::size_t samples;
  std::int64_t first_ns, last_ns;
  std::size_t without_place;  // NaN
};

struct Case {
  std::string name, file, format;
  GazeReadOptions options;
  GazeKind kind;
  Span span;
  std::vector<Row> rows;
};

GazeReadOptions of_eye(EyeChoice eye) {
  GazeReadOptions options;
  options.eye = eye;
  return options;
}
GazeReadOptions of_frame(GazeFrame frame) {
  GazeReadOptions options;
  options.frame = frame;
  return options;
}
GazeReadOptions of_display(int width_px, int height_px) {
  GazeReadOptions options;
  options.display = DisplayGeometry{.width_px = width_px, .height_px = height_px};
  return options;
}
GazeReadOptions of_fixations() {
  GazeReadOptions options = of_display(1920, 1080);
  options.columns.x = "Fixation point X";
  options.columns.y = "Fixation point Y";
  return options;
}

// Pixels from the top left: GAZE_COORDS 0 0 1023 767 are corners, so 1024 x 768.
Vec3d px(double x, double y, double width, double height) {
  return {x / width, y / height, 0};
}
Vec3d lost() {
  return {std::nan(""), std::nan(""), std::nan("")};
}
// +x to the wearer's left and +z forward, as SRanipal has it; seven digits are not quite of length 1.
Vec3d sranipal(double x, double y, double z) {
  return normalize(Vec3d{-x, y, -z});
}
Vec3d unity(double x, double y, double z) {
  return normalize(Vec3d{x, y, -z});
}
// Azimuth and elevation as two independent angles.
Vec3d degrees(double x, double y) {
  return normalize(Vec3d{std::tan(x * kRadPerDeg), std::tan(y * kRadPerDeg), -1});
}
// .NET ticks of 100 ns from the year 1, of which 1970 is 621355968000000000.
constexpr std::int64_t ticks(std::int64_t t) {
  return (t - 621'355'968'000'000'000) * 100;
}

std::vector<Case> cases() {
  const auto screen = GazeKind::screen;
  const auto scene = GazeKind::scene_camera;
  const auto direction = GazeKind::direction;
  return {
      // `t xL yL pL xR yR pR flags`, t in ms.
      {"EyeLinkBinocularLeft",
       "eyelink-asc/bino1000.asc",
       "eyelink-asc",
       of_eye(EyeChoice::left),
       screen,
       {3467, 7'427'362'000'000, 7'436'443'000'000, 0},
       {{0, 138, 7'427'362'000'000, px(502.3, 411.1, 1024, 768)},
        {1155, 1346, 7'430'237'000'000, px(505.0, 406.5, 1024, 768)},
        {2311, 2570, 7'433'290'000'000, px(499.3, 388.6, 1024, 768)},
        {3466, 3802, 7'436'443'000'000, px(776.1, 383.3, 1024, 768)}}},
      {"EyeLinkBinocularRight",
       "eyelink-asc/bino1000.asc",
       "eyelink-asc",
       of_eye(EyeChoice::right),
       screen,
       {3467, 7'427'362'000'000, 7'436'443'000'000, 0},
       {{0, 138, 7'427'362'000'000, px(512.8, 395.9, 1024, 768)},
        {1155, 1346, 7'430'237'000'000, px(522.7, 403.5, 1024, 768)},
        {2311, 2570, 7'433'290'000'000, px(517.9, 397.9, 1024, 768)},
        {3466, 3802, 7'436'443'000'000, px(779.4, 391.4, 1024, 768)}}},
      {"EyeLinkMonocular",
       "eyelink-asc/mono500.asc",
       "eyelink-asc",
       {},
       screen,
       {1834, 7'196'720'000'000, 7'205'384'000'000, 0},
       {{0, 91, 7'196'720'000'000, px(512.8, 394.5, 1024, 768)},
        {611, 759, 7'199'440'000'000, px(489.1, 381.8, 1024, 768)},
        {1222, 1416, 7'202'430'000'000, px(508.4, 381.4, 1024, 768)},
        {1833, 2079, 7'205'384'000'000, px(251.3, 364.9, 1024, 768)}}},
      // GAZE_COORDS 0 0 1679 1049; `.` in 313 rows of the left eye and 66 of the right.
      {"EyeLinkBlinksLeft",
       "eyelink-asc/bino1000_blinks.asc",
       "eyelink-asc",
       of_eye(EyeChoice::left),
       screen,
       {10294, 1'835'009'000'000, 1'845'302'000'000, 313},
       {{0, 26, 1'835'009'000'000, px(1682.1, 993.5, 1680, 1050)},
        {3431, 3555, 1'838'440'000'000, px(1049.7, 300.2, 1680, 1050)},
        {6862, 7087, 1'841'871'000'000, lost()},
        {10293, 10627, 1'845'302'000'000, lost()}}},
      {"EyeLinkBlinksRight",
       "eyelink-asc/bino1000_blinks.asc",
       "eyelink-asc",
       of_eye(EyeChoice::right),
       screen,
       {10294, 1'835'009'000'000, 1'845'302'000'000, 66},
       {{0, 26, 1'835'009'000'000, px(1723.1, 1059.1, 1680, 1050)},
        {3431, 3555, 1'838'440'000'000, px(1110.7, 359.8, 1680, 1050)},
        {6862, 7087, 1'841'871'000'000, px(347.3, 596.6, 1680, 1050)},
        {10293, 10627, 1'845'302'000'000, px(944.2, 623.4, 1680, 1050)}}},
      // RecordingTimestamp in ms; 193 empty cells of GazePointX (ADCSpx) beside a validity.
      {"TobiiStudio",
       "tobii-studio-tsv/data.tsv",
       "tobii-studio",
       {},
       screen,
       {2910, 5'000'000, 24'244'000'000, 193},
       {{0, 2, 5'000'000, px(985, 580, 1920, 1080)},
        {970, 977, 8'088'000'000, px(1231, 395, 1920, 1080)},
        {1940, 1949, 16'170'000'000, px(39, 999, 1920, 1080)},
        {2909, 2921, 24'244'000'000, px(930, 542, 1920, 1080)}}},
      // Only fixations, read as places because the columns are named; timestamps in us.
      {"TobiiProLab",
       "tobii-pro-lab-tsv/mobile_mapped_excerpt.tsv",
       "tobii-pro-lab",
       of_fixations(),
       screen,
       {27, 1'051'996'474'000, 1'052'517'416'000, 0},
       {{0, 6, 1'051'996'474'000, px(962, 647, 1920, 1080)},
        {9, 62, 1'052'176'850'000, px(962, 647, 1920, 1080)},
        {18, 114, 1'052'357'127'000, px(962, 647, 1920, 1080)},
        {26, 162, 1'052'517'416'000, px(962, 647, 1920, 1080)}}},
      // "gp" of the scene video, ts in us; s is not 0 in 5 lines.
      {"TobiiGlasses2",
       "tobii-glasses2/livedata.json.gz",
       "tobii-glasses-2",
       of_frame(GazeFrame::scene_camera),
       scene,
       {965, 84'415'010'000, 104'203'559'000, 5},
       {{0, 7, 84'415'010'000, {0.4404, 0.4077, 0}},
        {321, 3890, 91'351'019'000, {0.4088, 0.2998, 0}},
        {643, 7727, 97'787'294'000, {0.2984, 0.5466, 0}},
        {964, 11549, 104'203'559'000, {0.4063, 0.4078, 0}}}},
      // "gaze2d", timestamps in s: "timestamp":21.866214 in line 2183; "data":{} in 412 lines.
      {"TobiiGlasses3",
       "tobii-glasses3/gazedata.gz",
       "tobii-glasses-3",
       of_frame(GazeFrame::scene_camera),
       scene,
       {6547, 6'684'000, 65'585'314'000, 412},
       {{0, 1, 6'684'000, {0.5722000000000002, 0.5182000000000002, 0}},
        {2182, 2183, 21'866'214'000, {0.4812000000000001, 1.0701000000000003, 0}},
        {4364, 4365, 43'725'781'000, {0.5069000000000001, 0.4395000000000001, 0}},
        {6546, 6547, 65'585'314'000, {0.46480000000000016, 0.39800000000000013, 0}}}},
      // Origin bottom left: v = 1 - norm_pos_y. Rows without confidence have places, too; see below.
      {"PupilCore",
       "pupil-core/gaze_positions.csv",
       "pupil-core",
       of_frame(GazeFrame::scene_camera),
       scene,
       {5000, 1'216'218'711'000, 1'237'308'648'000, 0},
       {{0, 2, 1'216'218'711'000, {0.46200690434431324, 1 - 0.285159265953997, 0}},
        {1666, 1668, 1'223'245'369'000, {0.6718575246656117, 1 - 0.5491795153064634, 0}},
        {3333, 3335, 1'230'279'595'000, {0.6012994975558991, 1 - 0.46602094399977523, 0}},
        {4999, 5001, 1'237'308'648'000, {0.6250537357982502, 1 - 0.19903600094890106, 0}}}},
      {"PupilCoreMonocular",
       "pupil-core/gaze_positions_with_monocular.csv",
       "pupil-core",
       of_frame(GazeFrame::scene_camera),
       scene,
       {2054, 329'367'897'894'000, 329'374'830'006'000, 0},
       {{0, 2, 329'367'897'894'000, {0.501013401785833, 1 - 0.48943624382641693, 0}},
        {684, 686, 329'370'233'437'500, {0.5634485839558041, 1 - 0.12881931962800808, 0}},
        {1369, 1371, 329'372'538'942'500, {0.5026690164225328, 1 - 0.5267103584957271, 0}},
        {2053, 2055, 329'374'830'006'000, {0.4090454068426605, 1 - 0.3300383896764536, 0}}}},
      // Pixels of 1088 x 1080, ns from 1970. Blinks have places too, which mean nothing.
      {"PupilInvisible",
       "pupil-invisible-cloud/gaze.csv",
       "pupil-cloud",
       of_frame(GazeFrame::scene_camera),
       scene,
       {3385, 1'685'088'813'175'076'015, 1'685'088'830'119'004'015, 0},
       {{0, 2, 1'685'088'813'175'076'015, px(629.146, 647.936, 1088, 1080)},
        {1128, 1130, 1'685'088'818'823'056'015, px(514.664, 468.132, 1088, 1080)},
        {2256, 2258, 1'685'088'824'471'186'015, px(601.388, 547.485, 1088, 1080)},
        {3384, 3386, 1'685'088'830'119'004'015, px(476.827, 558.565, 1088, 1080)}}},
      {"PupilInvisibleTrampoline",
       "pupil-invisible-cloud/trampoline_02_gaze.csv",
       "pupil-cloud",
       of_frame(GazeFrame::scene_camera),
       scene,
       {5338, 1'629'390'345'036'471'431, 1'629'390'371'788'463'431, 0},
       {{0, 2, 1'629'390'345'036'471'431, px(484.345, 525.118, 1088, 1080)},
        {1779, 1781, 1'629'390'353'956'450'431, px(535.532, 1017.331, 1088, 1080)},
        {3558, 3560, 1'629'390'362'868'470'431, px(254.899, 700.714, 1088, 1080)},
        {5337, 5339, 1'629'390'371'788'463'431, px(570.313, 1000.641, 1088, 1080)}}},
      // float32 pairs in pixels of 1600 x 1200.
      {"NeonNative",
       "pupil-neon-native/gaze ps1.raw",
       "neon-native",
       of_frame(GazeFrame::scene_camera),
       scene,
       {1788, 1'760'676'790'465'965'534, 1'760'676'799'429'223'534, 0},
       {{0, 1, 1'760'676'790'465'965'534, px(719.783203125, 749.7763061523438, 1600, 1200)},
        {596, 597, 1'760'676'793'463'747'534, px(830.5039672851562, 551.3410034179688, 1600, 1200)},
        {1192, 1193, 1'760'676'796'446'546'534, px(812.1463623046875, 578.8074340820312, 1600, 1200)},
        {1787, 1788, 1'760'676'799'429'223'534, px(1081.4130859375, 841.5453491210938, 1600, 1200)}}},
      // us; `0.00 0.00` in 13294 rows.
      {"Smi",
       "smi-iview-txt/recording1_Samples.txt",
       "smi",
       {},
       screen,
       {27370, 2'152'092'084'000, 2'942'150'823'000, 13294},
       {{0, 21, 2'152'092'084'000, lost()},
        {9123, 9147, 2'445'628'180'000, lost()},
        {18246, 18279, 2'759'630'998'000, px(474.05, 60.22, 1024, 768)},
        {27369, 27417, 2'942'150'823'000, px(538.52, 261.86, 1024, 768)}}},
      // us; confidence 0.0 in 49 rows.
      {"Arff",
       "arff/gaze.arff",
       "arff",
       {},
       screen,
       {5002, 1'000'000, 20'116'000'000, 49},
       {{0, 14, 1'000'000, px(416.9, 188.0, 1280, 720)},
        {1667, 1681, 6'780'000'000, px(1035.5, 363.7, 1280, 720)},
        {3334, 3348, 13'448'000'000, px(244.2, 492.1, 1280, 720)},
        {5001, 5015, 20'116'000'000, px(809.5, 504.4, 1280, 720)}}},
      // us; n/a in 39 rows of the left eye's file and 40 of the right one's.
      {"BidsLeft",
       "bids/derived-tx300/sub-01_task-view_recording-eye1_physio.tsv.gz",
       "bids",
       of_eye(EyeChoice::left),
       screen,
       {1206, 2'640'808'332'000, 2'644'824'448'000, 39},
       {{0, 1, 2'640'808'332'000, px(909.12, 530.50, 1920, 1080)},
        {402, 403, 2'642'148'132'000, px(1132.22, 816.37, 1920, 1080)},
        {804, 805, 2'643'487'932'000, px(1583.23, 773.28, 1920, 1080)},
        {1205, 1206, 2'644'824'448'000, px(671.23, 875.77, 1920, 1080)}}},
      {"BidsRight",
       "bids/derived-tx300/sub-01_task-view_recording-eye2_physio.tsv.gz",
       "bids",
       of_eye(EyeChoice::right),
       screen,
       {1206, 2'640'808'332'000, 2'644'824'448'000, 40},
       {{0, 1, 2'640'808'332'000, px(902.21, 499.93, 1920, 1080)},
        {402, 403, 2'642'148'132'000, px(1134.14, 840.35, 1920, 1080)},
        {804, 805, 2'643'487'932'000, px(1587.46, 812.38, 1920, 1080)},
        {1205, 1206, 2'644'824'448'000, px(638.02, 880.52, 1920, 1080)}}},
      // The left eye; (0, 0, 0) in 32 and 213 rows.
      {"Vive360",
       "vive-pro-eye/TESTNA01_360VR_Fist3.csv",
       "vive-sranipal",
       of_eye(EyeChoice::left),
       direction,
       {1665, ticks(638'342'802'882'596'202), 1'698'683'502'123'268'900, 32},
       {{0, 2, 1'698'683'488'259'620'200, sranipal(0.05995178, -0.09603882, 0.9935608)},
        {555, 557, 1'698'683'492'883'551'400, sranipal(0.2864075, 0.04646301, 0.9569702)},
        {1110, 1112, 1'698'683'497'507'555'300, sranipal(0.03791809, 0.0001068115, 0.9992676)},
        {1664, 1666, 1'698'683'502'123'268'900, sranipal(0.1963348, -0.008590698, 0.980484)}}},
      {"Vive2D",
       "vive-pro-eye/TESTNA01_2D_Fist3.csv",
       "vive-sranipal",
       of_eye(EyeChoice::left),
       direction,
       {1518, 1'698'682'600'011'534'600, 1'698'682'612'650'076'400, 213},
       {{0, 2, 1'698'682'600'011'534'600, sranipal(0.1235046, -0.1205444, 0.9849854)},
        {506, 508, 1'698'682'604'227'153'100, sranipal(0.1075439, -0.09783936, 0.9893646)},
        {1012, 1014, 1'698'682'608'443'347'100, sranipal(0.01005554, -0.1984558, 0.9800415)},
        {1517, 1519, 1'698'682'612'650'076'400, lost()}}},
      // Seconds; (0, 0, 0) in 6 rows.
      {"Pico",
       "pico-neo3-pro/boxing_VR.csv",
       "pico",
       {},
       direction,
       {492, 11'111'110, 5'466'674'000, 6},
       {{0, 2, 11'111'110, unity(0.0133, 0.2678, 0.9634)},
        {164, 166, 1'833'337'000, unity(0.038, 0.3005, 0.953)},
        {328, 330, 3'655'546'000, unity(0.0464, 0.2745, 0.9605)},
        {491, 493, 5'466'674'000, unity(-0.0485, 0.1127, 0.9924)}}},
      // ms with four decimals; degrees.
      {"GazeBaseVr",
       "gazebase-vr/gazebase_vr_example.csv",
       "gazebase",
       {},
       direction,
       {10, 0, 35'943'000, 0},
       {{0, 2, 0, degrees(0.7334, -4.9397)},
        {3, 5, 11'941'300, degrees(0.7506, -4.9511)},
        {6, 8, 23'957'300, degrees(0.7678, -4.9283)},
        {9, 11, 35'943'000, degrees(0.7621, -4.9397)}}},
      // ms, by its steps; the display is nowhere stated, so given.
      {"PlainCsv",
       "plain-csv/gaze-toy-example.csv",
       "generic",
       of_display(1280, 1024),
       screen,
       {4306, 0, 17'220'000'000, 0},
       {{0, 2, 0, px(206.8, 152.4, 1280, 1024)},
        {1435, 1437, 5'740'000'000, px(156.9, 267.5, 1280, 1024)},
        {2870, 2872, 11'480'000'000, px(951.9, 351.8, 1280, 1024)},
        {4305, 4307, 17'220'000'000, px(355.8, 413.8, 1280, 1024)}}},
  };
}

[[maybe_unused]] void PrintTo(const Case& c, std::ostream* out) {
  *out << c.name;
}

class EveryRecording : public ::testing::TestWithParam<Case> {};

TEST_P(EveryRecording, IsReadAsCountedByHand) {
  const Case& c = GetParam();
  const std::string path = sample_path(c.file);
  if (!std::filesystem::exists(path)) {
    GTEST_SKIP() << path << " is not here";
  }
  const GazeLog log = load_gaze_log(path, c.options);
  EXPECT_EQ(log.format, c.format);
  EXPECT_EQ(log.kind, c.kind);
  ASSERT_EQ(log.samples.size(), c.span.samples);
  EXPECT_EQ(log.samples.front().t_ns, c.span.first_ns);
  EXPECT_EQ(log.samples.back().t_ns, c.span.last_ns);
  const auto place = [&](const GazeSample& s) {
    return log.kind == GazeKind::direction ? s.direction : Vec3d{s.u, s.v, 0};
  };
  const auto is_lost = [&](const GazeSample& s) { return !is_finite(place(s)); };
  EXPECT_EQ(static_cast<std::size_t>(std::count_if(log.samples.begin(), log.samples.end(), is_lost)),
            c.span.without_place);
  for (const Row& row : c.rows) {
    const GazeSample& s = log.samples.at(row.index);
    EXPECT_EQ(s.row, row.row);
    EXPECT_EQ(s.t_ns, row.t_ns) << row.row;
    if (!is_finite(row.at)) {
      EXPECT_TRUE(is_lost(s) && !is_usable(s.validity)) << row.row;
    } else {
      EXPECT_LT(length(place(s) - row.at), 1e-15) << row.row;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Samples, EveryRecording, ::testing::ValuesIn(cases()),
                         [](const auto& instance) { return instance.param.name; });

// Trackers that go on writing places while they do not know them: confidence below 0.6 in 523 and 441 rows, a blink id
// in 110 and 2103.
TEST(EveryRecordingWithPlaces, KnowsWhichMeanNothing) {
  const std::vector<std::pair<std::string, std::size_t>> files{
      {"pupil-core/gaze_positions.csv", 523},
      {"pupil-core/gaze_positions_with_monocular.csv", 441},
      {"pupil-invisible-cloud/gaze.csv", 110},
      {"pupil-invisible-cloud/trampoline_02_gaze.csv", 2103},
  };
  for (const auto& [file, unusable] : files) {
    if (!std::filesystem::exists(sample_path(file))) {
      GTEST_SKIP() << sample_path(file) << " is not here";
    }
    const GazeLog log = load_gaze_log(sample_path(file), of_frame(GazeFrame::scene_camera));
    EXPECT_EQ(static_cast<std::size_t>(std::count_if(log.samples.begin(), log.samples.end(),
                                                     [](const GazeSample& s) { return !is_usable(s.validity); })),
              unusable)
        << file;
  }
}

// Side files of recordings, and a recording of nothing. Each says why it is no log.
TEST(EveryFileBeside, IsRefusedForTheRightReason) {
  const std::vector<std::pair<std::string, std::string>> files{
      {"README.md", "is not a table of time and position"},
      {"bids/derived-tx300/sub-01_task-view_events.json", "is JSON"},
      {"bids/derived-tx300/sub-01_task-view_recording-eye1_physio.json", "is JSON"},
      {"bids/derived-tx300/sub-01_task-view_recording-eye2_physio.json", "is JSON"},
      {"bids/rest_eye/sub-01_ses-01_task-rest_run-01_recording-eye1_physio.json", "is JSON"},
      {"bids/rest_eye/sub-01_ses-01_task-rest_run-01_recording-eye1_physio.tsv.gz", "is empty"},
      {"bids/rest_eye/task-rest_events.json", "is JSON"},
      {"bids/rest_eye/task-rest_physio.json", "is JSON"},
      {"bids/rest_eye/task-rest_physioevents.json", "is JSON"},
      {"pupil-core/blinks_with_monocular.csv", "is a table of blinks"},
      {"pupil-core/fixations_with_monocular.csv", "is a table of fixations"},
      {"pupil-invisible-cloud/blinks.csv", "is a table of blinks"},
      {"pupil-invisible-cloud/imu.csv", "holds movements of the head"},
      {"pupil-invisible-cloud/info.json", "is JSON"},
      {"pupil-invisible-cloud/scene_camera.json", "is JSON"},
      {"pupil-invisible-cloud/trampoline_02_imu.csv", "holds movements of the head"},
      {"pupil-invisible-cloud/world_timestamps.csv",
       "no columns for the horizontal position and the vertical position are found"},
      {"pupil-neon-native/Neon Scene Camera v1 ps1.time", "is not a gaze log of a known format"},
      {"pupil-neon-native/eye_state.dtype", "is JSON"},
      {"pupil-neon-native/gaze.dtype", "is JSON"},
      {"pupil-neon-native/info.json", "is JSON"},
      {"pupil-neon-native/worn ps1.raw", "is not a gaze log of a known format"},
      {"pupil-neon-native/worn.dtype", "is JSON"},
      {"tobii-glasses2/segment.json", "is JSON"},
      {"tobii-glasses3/eventdata.gz", "is JSON"},
      {"tobii-glasses3/imudata.gz", "is JSON"},
      {"vive-pro-eye/TESTVA03_2D_Spread9_header_only.csv", "holds no sample"},
  };
  if (!std::filesystem::exists(sample_path("README.md"))) {
    GTEST_SKIP() << sample_path("") << " is not here";
  }
  std::vector<std::string> known;
  for (const auto& [file, reason] : files) {
    known.push_back(file);
    try {
      load_gaze_log(sample_path(file), {});
      ADD_FAILURE() << file << " was read";
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::input);
      EXPECT_THAT(error.what(), HasSubstr(reason)) << file;
      EXPECT_THAT(error.what(), HasSubstr(file));
    }
  }
  // Nothing is left out: every file there is in one of the two tables, or is the second half of a recording in it.
  for (const Case& c : cases()) {
    known.push_back(c.file);
  }
  known.emplace_back("pupil-neon-native/gaze ps1.time");
  const std::string root = sample_path("");
  for (const auto& entry : std::filesystem::recursive_directory_iterator(root)) {
    if (entry.is_regular_file()) {
      const std::string name = entry.path().string().substr(root.size());
      EXPECT_NE(std::find(known.begin(), known.end(), name), known.end()) << name << " is in no table";
    }
  }
}

}  // namespace
}  // namespace gazetrace::gaze_samples_table_test
