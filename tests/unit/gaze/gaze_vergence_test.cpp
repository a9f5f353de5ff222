// SPDX-License-Identifier: Apache-2.0
// Vergence against the geometry of two eyes that look at one point.
#include "gazetrace/gaze_vergence.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "gazetrace/error.hpp"

namespace gazetrace::gaze_vergence_test {
namespace {

constexpr double kPupilsMm = 63;
constexpr double kScreenMm[] = {520, 300}, kDistanceMm = 650;

EyeGaze eye_at(const Vec3d& at) {
  EyeGaze eye;
  eye.at = at;
  eye.validity = GazeValidity::ok;
  return eye;
}

GazeLog log_of(GazeKind kind, const EyeGaze& left, const EyeGaze& right) {
  GazeLog log;
  log.kind = kind;
  log.samples.resize(1);
  log.samples[0].validity = GazeValidity::ok;
  log.eyes = {{left, right}};
  if (kind == GazeKind::screen) {
    DisplayGeometry screen;
    screen.width_px = 1920;
    screen.height_px = 1080;
    screen.width_cm = kScreenMm[0] / 10;
    screen.height_cm = kScreenMm[1] / 10;
    screen.distance_cm = kDistanceMm / 10;
    log.recording_geometry = screen;
  }
  return log;
}

// Where the line from an eye (x millimetres to the right) to a point crosses the screen, as a share of it.
Vec3d on_screen(double eye_x_mm, const Vec3d& point_mm) {
  const double share = kDistanceMm / -point_mm.z;
  const double x = eye_x_mm + (point_mm.x - eye_x_mm) * share;
  return {0.5 + x / kScreenMm[0], 0.5 - point_mm.y * share / kScreenMm[1], 0};
}

TEST(GazeVergence, EyesThatLookAtOnePointOfTheScreenConvergeThere) {
  // Seen from the eyes, the middle of the screen lies at atan(31.5 / 650) to each side.
  const EyeGaze middle = eye_at({0.5, 0.5, 0});
  const VergenceOverTime result = measure_vergence(log_of(GazeKind::screen, middle, middle), {kPupilsMm});
  ASSERT_EQ(result.samples.size(), 1U);
  EXPECT_TRUE(result.is_distance_stated);
  EXPECT_NEAR(result.samples[0].horizontal_deg, 2 * std::atan(31.5 / 650) * kDegPerRad, 1e-12);
  EXPECT_NEAR(result.samples[0].vertical_deg, 0, 1e-12);
  EXPECT_NEAR(result.samples[0].distance_mm, kDistanceMm, 1e-9);
}

TEST(GazeVergence, APointBeforeOrBehindTheScreenIsFoundWhereItIs) {
  for (const Vec3d& point : {Vec3d{0, 0, -300}, Vec3d{80, -50, -420}, Vec3d{-120, 60, -2000}}) {
    const GazeLog log =
        log_of(GazeKind::screen, eye_at(on_screen(-kPupilsMm / 2, point)), eye_at(on_screen(kPupilsMm / 2, point)));
    const Vergence at = measure_vergence(log, {kPupilsMm}).samples.at(0);
    EXPECT_NEAR(at.distance_mm, length(point), 1e-6);
    const Vec3d left = point - Vec3d{-kPupilsMm / 2, 0, 0};
    const Vec3d right = point - Vec3d{kPupilsMm / 2, 0, 0};
    EXPECT_NEAR(at.horizontal_deg, std::atan2(length(cross(left, right)), dot(left, right)) * kDegPerRad, 1e-9);
    EXPECT_NEAR(at.vertical_deg, 0, 1e-9);
  }
}

TEST(GazeVergence, EyesThatDivergeMeetNowhere) {
  const Vergence out = vergence_of({-30, 0, 0}, {30, 0, 0}, {-0.02, 0, -1}, {0.02, 0, -1});
  EXPECT_LT(out.horizontal_deg, 0);
  EXPECT_TRUE(std::isnan(out.distance_mm));
  const Vergence ahead = vergence_of({-30, 0, 0}, {30, 0, 0}, {0, 0, -1}, {0, 0, -1});
  EXPECT_EQ(ahead.horizontal_deg, 0);
  EXPECT_TRUE(std::isnan(ahead.distance_mm));
}

TEST(GazeVergence, LinesThatPassEachOtherMeetInTheMiddleOfTheShortestLineBetweenThem) {
  // One eye looks 2 mm too high at 500 mm. With 1 + a and 1 + b as the places along the two lines, the derivatives of
  // the squared distance (30 (a + b))^2 + (2 + 2 a)^2 + (500 (a - b))^2 vanish where a - b = 0.0036 (a + b) and
  // 3600 (a + b) + 8 (1 + a) = 0.
  const Vergence at = vergence_of({-30, 0, 0}, {30, 0, 0}, {30, 2, -500}, {-30, 0, -500});
  const double sum = -8 / (3600 + 4 * 1.0036);
  const double a = 0.5 * 1.0036 * sum;
  EXPECT_NEAR(at.distance_mm, std::hypot(15 * 0.0036 * sum, 1 + a, 500 * (1 + sum / 2)), 1e-9);
  EXPECT_NEAR(at.vertical_deg, std::atan2(2, 500) * kDegPerRad, 1e-9);
}

TEST(GazeVergence, DirectionsNeedNoPupilDistanceForTheAngle) {
  const GazeLog log =
      log_of(GazeKind::direction, eye_at(normalize(Vec3d{0.03, 0, -1})), eye_at(normalize(Vec3d{-0.03, 0, -1})));
  const VergenceOverTime alone = measure_vergence(log, {});
  EXPECT_NEAR(alone.samples.at(0).horizontal_deg, 2 * std::atan(0.03) * kDegPerRad, 1e-12);
  EXPECT_TRUE(std::isnan(alone.samples.at(0).distance_mm));
  EXPECT_NEAR(measure_vergence(log, {60}).samples.at(0).distance_mm, 30 / 0.03, 1e-9);
}

TEST(GazeVergence, TakesThePupilsOfALogThatStatesThem) {
  GazeLog log = log_of(GazeKind::screen, eye_at({0.5, 0.5, 0}), eye_at({0.5, 0.5, 0}));
  EXPECT_FALSE(measure_vergence(log, {}).missing.empty());
  log.origins = {{{-30, 4, 600}, {32, 4, 600}, 0}};
  const VergenceOverTime result = measure_vergence(log, {});
  EXPECT_TRUE(result.missing.empty());
  EXPECT_NEAR(result.pupil_distance_mm, 62, 1e-5);
  EXPECT_FALSE(result.is_distance_stated);
}

TEST(GazeVergence, SaysWhatIsMissing) {
  GazeLog one = log_of(GazeKind::screen, eye_at({0.5, 0.5, 0}), eye_at({0.5, 0.5, 0}));
  one.eyes.clear();
  EXPECT_NE(measure_vergence(one, {kPupilsMm}).missing, "");
  GazeLog unknown = log_of(GazeKind::screen, eye_at({0.5, 0.5, 0}), eye_at({0.5, 0.5, 0}));
  unknown.recording_geometry.reset();
  EXPECT_NE(measure_vergence(unknown, {kPupilsMm}).missing, "");
  GazeLog lost = log_of(GazeKind::screen, eye_at({0.5, 0.5, 0}), EyeGaze{});
  EXPECT_TRUE(std::isnan(measure_vergence(lost, {kPupilsMm}).samples.at(0).horizontal_deg));
  for (const double wrong : {-1.0, 6.3, 630.0, std::numeric_limits<double>::quiet_NaN()}) {
    EXPECT_THROW((void)measure_vergence(lost, {wrong}), Error);
  }
}

}  // namespace
}  // namespace gazetrace::gaze_vergence_test
