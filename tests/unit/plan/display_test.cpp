// SPDX-License-Identifier: Apache-2.0
#include "gazetrace/display.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "gazetrace/error.hpp"

namespace gazetrace::display_test {
namespace {

using ::testing::HasSubstr;

DisplayGeometry paper() {
  return display_by_name("paper");
}

template <class Call>
std::string message_of(const Call& call, ErrorKind kind = ErrorKind::usage) {
  try {
    call();
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), kind);
    return error.what();
  }
  return "no error";
}

TEST(Display, PaperGeometryInAngles) {
  const DisplayGeometry display = paper();
  EXPECT_NEAR(pixels_per_degree(display), 60.0 * kPi / 180.0 * 3840 / 70.848, 1e-12);
  EXPECT_NEAR(pixels_per_degree(display), 56.76, 0.005);
  const PlanarView view = view_of_display(display, {}, 3840, 2160);
  const Vec3d ahead{0, 0, -1};
  const double half_diagonal_cm = std::hypot(70.848, 39.852) / 2;
  EXPECT_NEAR(eccentricity_deg(view, ahead, 0, 0), std::atan2(half_diagonal_cm, 60.0) * kDegPerRad, 1e-12);
  EXPECT_NEAR(eccentricity_deg(view, ahead, 3840, 2160), 34.1, 0.05);
  EXPECT_NEAR(eccentricity_deg(view, view.direction(0, 0), 3840, 2160), 68.2, 0.05);
  EXPECT_NEAR(2 * std::atan2(35.424, 60.0) * kDegPerRad, eccentricity_deg(view, view.direction(0, 1080), 3840, 1080),
              1e-12);
  EXPECT_NEAR(eccentricity_deg(view, ahead, 1920, 1080), 0.0, 1e-12);
}

TEST(Display, EccentricityKeepsDigitsNextToTheGaze) {
  const PlanarView view = view_of_display(paper(), {}, 3840, 2160);
  const double step_deg = 1e-6 * 70.848 / 3840 / 60.0 * kDegPerRad;
  EXPECT_NEAR(eccentricity_deg(view, {0, 0, -1}, 1920 + 1e-6, 1080), step_deg, step_deg * 1e-6);
}

TEST(Display, PixelInvertsDirection) {
  DisplayGeometry display = paper();
  display.eye_x_cm = 7.5;
  display.eye_y_cm = -3.25;
  const PlanarView view = view_of_display(display, {480, 270, 1920, 1080}, 960, 540);
  for (const Vec2d p : {Vec2d{0, 0}, Vec2d{0.5, 0.5}, Vec2d{960, 540}, Vec2d{-100, 2000}}) {
    const Vec2d back = view.pixel(view.direction(p.x, p.y) * 3.0);
    EXPECT_NEAR(back.x, p.x, 1e-9);
    EXPECT_NEAR(back.y, p.y, 1e-9);
  }
  EXPECT_TRUE(std::isnan(view.pixel({0, 0, 1}).x));
  EXPECT_TRUE(std::isnan(view.pixel({1, 0, 0}).y));
}

TEST(Display, EyeOffsetMovesTheFootOfThePerpendicular) {
  DisplayGeometry display = paper();
  display.eye_x_cm = 70.848 / 4;  // right
  display.eye_y_cm = 39.852 / 8;  // up
  const Vec2d foot = view_of_display(display, {}, 3840, 2160).pixel({0, 0, -1});
  EXPECT_NEAR(foot.x, 3840 * 0.75, 1e-9);
  EXPECT_NEAR(foot.y, 2160 * 0.375, 1e-9);
}

TEST(Display, FrameRectIsAWindowIntoTheDisplay) {
  const PlanarView whole = view_of_display(paper(), {}, 3840, 2160);
  const PlanarView part = view_of_display(paper(), {960, 540, 1920, 1080}, 960, 540);
  // Pixel (100, 40) of the half-size frame lies at (960 + 200, 540 + 80) of the display.
  const Vec3d a = part.direction(100, 40);
  const Vec3d b = whole.direction(1160, 620);
  EXPECT_NEAR(a.x, b.x, 1e-15);
  EXPECT_NEAR(a.y, b.y, 1e-15);
}

TEST(Display, PerspectiveViewSpansItsFieldWithSquarePixels) {
  const PlanarView view = view_of_perspective(90 * kRadPerDeg, 200, 100);
  EXPECT_NEAR(view.direction(0, 0).y, 1.0, 1e-15);
  EXPECT_NEAR(view.direction(0, 100).y, -1.0, 1e-15);
  EXPECT_NEAR(view.direction(0, 0).x, -2.0, 1e-15);
  EXPECT_NEAR(view.direction(200, 0).x, 2.0, 1e-15);
  EXPECT_DOUBLE_EQ(view.step_x, view.step_y);
}

TEST(Display, AspectMayDifferByTheRoundingOfAPixelOnly) {
  EXPECT_NO_THROW(view_of_display(paper(), {}, 1366, 768));  // 768.375 rows would be exact
  EXPECT_NO_THROW(view_of_display(paper(), {}, 1, 1));
  EXPECT_EQ(
      message_of([] { view_of_display(paper(), {}, 1280, 800); }),
      "a frame of 1280x800 px does not have the shape of the 3840x2160 px of the display that it fills; give `size` "
      "1422x800, or say with `frame-rect` where on the display the frame lies");
  EXPECT_EQ(message_of([] {
              view_of_display(paper(), {3000, 0, 1000, 1000}, 10, 10);
            }),
            "the frame's rectangle 1000x1000 at (3000, 0) px does not lie on the display of 3840x2160 px");
}

TEST(Display, ErrorsNameTheField) {
  const auto with = [](auto change) {
    DisplayGeometry display = paper();
    change(display);
    return message_of([&] { check_display(display); });
  };
  EXPECT_EQ(with([](auto& d) { d.width_px = 0; }),
            "the display's width in pixels is not stated; give `screen-px`, or `screen` with a name");
  EXPECT_EQ(with([](auto& d) { d.height_px = -1; }),
            "the display's height in pixels is -1, not a positive number; give `screen-px`, or `screen` with a name");
  EXPECT_EQ(with([](auto& d) { d.width_cm = std::nan(""); }),
            "the display's width in cm is nan, not a positive number; give `screen-cm`, the size of its active area");
  EXPECT_EQ(with([](auto& d) { d.height_cm = 0; }),
            "the display's height in cm is not stated; give `screen-cm`, the size of its active area");
  EXPECT_EQ(with([](auto& d) { d.distance_cm = std::numeric_limits<double>::infinity(); }),
            "the display's distance from the eye in cm is inf, not a positive number; give `screen-distance-cm`");
  EXPECT_EQ(with([](auto& d) { d.distance_cm = 0; }),
            "the display's distance from the eye in cm is not stated; give `screen-distance-cm`");
  EXPECT_EQ(message_of([] { display_by_name("papper"); }).substr(0, 55),
            "unknown display 'papper'; did you mean 'paper'? Known: ");
  EXPECT_THAT(message_of([] { view_of_perspective(kPi, 4, 4); }), HasSubstr("is not between 0 and 180"));
  EXPECT_THAT(message_of([] { view_of_perspective(1, 0, 4); }), HasSubstr("0x4 px has no pixels"));
}

TEST(NamedDisplays, AreCompleteAndMatchTheirDiagonals) {
  for (const NamedDisplay& display : named_displays()) {
    EXPECT_NO_THROW(check_display(display.geometry)) << display.name;
    EXPECT_EQ(display_by_name(display.name).width_px, display.geometry.width_px);
    const double square = display.geometry.width_cm / display.geometry.width_px * display.geometry.height_px;
    EXPECT_NEAR(square / display.geometry.height_cm, 1.0, 1e-4) << display.name;
  }
  // FovVideoVDP reports 75.402 pixels per degree for its standard_4k, by the tangent of one degree.
  const DisplayGeometry d = display_by_name("standard-4k");
  const double one_px_deg = 2 * std::atan2(0.5 * d.width_cm / d.width_px, d.distance_cm) * kDegPerRad;
  EXPECT_NEAR(1.0 / one_px_deg, 75.402, 0.0005);
}

}  // namespace
}  // namespace gazetrace::display_test
