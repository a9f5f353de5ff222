// SPDX-License-Identifier: Apache-2.0
// Each density against published or independently computed values: cut-off frequencies, what it leaves of a
// full-rate frame, Jacobians by finite differences of the mappings, and the extremes that must not break one.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "foveation/density_curve.hpp"
#include "foveation/density_field.hpp"
#include "gazetrace/error.hpp"
#include "gazetrace/foveation.hpp"
#include "support/sampling_models.hpp"

namespace gazetrace::density_models_test {
namespace {

std::optional<double> cutoff_of(const FoveationSettings& settings, double e, double meridian_deg = 0) {
  return cutoff_cpd(std::get<DensitySampling>(settings.sampling), e, meridian_deg);
}

struct CutoffCase {
  const char* name;
  double scale;  // of the printed values: "mar" is given for two slopes
  std::array<double, 10> cpd;
};
constexpr std::array<double, 10> kAngles{0, 2.6, 5.2, 8.5, 10, 17, 20, 30, 40, 60};
constexpr CutoffCase kCutoffs[] = {
    {"mar", 0.022, {48.00, 12.82, 7.39, 4.81, 4.15, 2.53, 2.17, 1.47, 1.11, 0.75}},
    {"mar", 0.0275, {48.00, 10.83, 6.10, 3.93, 3.38, 2.05, 1.75, 1.18, 0.89, 0.60}},
    {"geisler-perry", 0, {39.23, 18.42, 12.03, 8.36, 7.34, 4.68, 4.05, 2.79, 2.13, 1.45}},
    {"acuity", 0, {60.00, 60.00, 60.00, 35.66, 28.09, 12.08, 9.17, 4.49, 2.66, 1.24}},
    {"cortical", 0, {60.00, 35.12, 24.83, 18.09, 16.11, 10.65, 9.30, 6.54, 5.04, 3.46}},
    {"retina", 0, {65.37, 19.61, 12.31, 8.87, 7.97, 5.58, 4.95, 3.51, 2.59, 1.49}},
};

TEST(DensityCutoff, AsPublished) {
  for (const CutoffCase& c : kCutoffs) {
    SCOPED_TRACE(c.name);
    const FoveationSettings settings = model(c.scale > 0 ? fmt::format("{}:slope={}", c.name, c.scale) : c.name);
    for (std::size_t i = 0; i < kAngles.size(); ++i) {
      // Printed with two digits; the meridian 0 of either eye together is temporal.
      EXPECT_NEAR(*cutoff_of(settings, kAngles[i]), c.cpd[i], 0.00501) << kAngles[i];
    }
  }
}

// The share of full-rate samples on the source paper's display and on a head-mounted display of 110 x 110 degrees, gaze
// at the centre, in per cent, from a separate computation with the solid angle of each pixel.
TEST(Density, SharesOfAFullRateFrame) {
  struct Share {
    const char* name;
    double display, head_mounted;
  };
  constexpr Share kShares[] = {{"mar", 1.44, 1.47},
                               {"geisler-perry", 3.80, 4.18},
                               {"retina", 4.70, 5.54},
                               {"cortical", 16.1, 15.8},
                               {"acuity", 25.4, 9.7}};
  const PlanarView display = view_of_display(display_by_name("paper"), {}, 3840, 2160);
  const PlanarView head_mounted = view_of_perspective(110 * kRadPerDeg, 3000, 3000);
  for (const Share& share : kShares) {
    for (const PlanarView* view : {&display, &head_mounted}) {
      FoveationSettings settings = model(share.name);
      density_of(settings).least_density = 1e-12;
      // The published figure is of the temporal meridian in every direction.
      const bool isotropic = std::string(share.name) == "retina";
      DensityModel curve;
      if (isotropic) {
        curve.value = [settings](const DensityPlace& place) { return *cutoff_of(settings, place.eccentricity_deg); };
        curve.floor = 1e-12;
      } else {
        curve = std::get<DensityModel>(sampling_model(settings, *view, {0, 0, -1}));
      }
      const DensityField field(*view, {0, 0, -1}, {}, curve);
      double sum = 0;
      int count = 0;
      const int stride = isotropic ? 12 : 4;
      for (int y = stride / 2; y < view->height_px; y += stride) {
        for (int x = stride / 2; x < view->width_px; x += stride) {
          sum += field.at(x, y);
          ++count;
        }
      }
      const double expected = view == &display ? share.display : share.head_mounted;
      const double last_digit = expected >= 9 ? 0.06 : 0.006;
      EXPECT_NEAR(100 * sum / count, expected, last_digit) << share.name << (view == &display ? "" : ", head-mounted");
    }
  }
}

TEST(Density, RelativeIsTheSquareOfTheCutoffs) {
  const PlanarView view = view_of_perspective(1.2, 96, 64);
  const Vec3d gaze = view.direction(30, 20);
  for (const std::string& name : density_models()) {
    if (!cutoff_of(model(name), 0)) {
      continue;
    }
    FoveationSettings settings = model(name + ":relative-to=fovea");
    density_of(settings).least_density = 1e-9;
    const ImageGray density = *density_image(settings, view, gaze);
    for (const int x : {31, 50, 90}) {
      const Vec3d direction = view.direction(x + 0.5, 20.5);
      const double e = eccentricity_deg(view, gaze, x + 0.5, 20.5);
      const Vec3d right = cross(gaze, Vec3d{0, 1, 0});
      const Vec3d up = cross(right, gaze) / length(gaze);
      const double meridian = std::atan2(dot(direction, up), dot(direction, right)) * kDegPerRad;
      const double ratio = *cutoff_of(settings, e, meridian) / *cutoff_of(settings, 0);
      EXPECT_NEAR(density(x, 20), ratio * ratio, 1e-6) << name;
    }
  }
}

// Meng's mapping, written down plainly, and the area that a small square of the frame has in the buffer.
TEST(Density, LogPolarIsTheJacobianOfItsMapping) {
  const PlanarView view = view_of_perspective(1.0, 400, 300);
  const Vec2d gaze{131.3, 96.7};
  for (const auto& [sigma, alpha] : {std::pair{1.8, 4.0}, {2.5, 1.0}, {1.2, 2.0}}) {
    FoveationSettings settings = model(fmt::format("log-polar:sigma={},alpha={}", sigma, alpha));
    density_of(settings).least_density = 1e-12;
    const ImageGray density = *density_image(settings, view, view.direction(gaze.x, gaze.y));
    const double log_farthest = std::log(std::hypot(400 - gaze.x, 300 - gaze.y));
    const auto buffer = [&, a = alpha, s = sigma](double x, double y) {
      const double radius = std::hypot(x - gaze.x, y - gaze.y);
      return Vec2d{400 / s * std::pow(std::log(radius) / log_farthest, 1 / a),
                   300 / s * std::atan2(y - gaze.y, x - gaze.x) / (2 * kPi)};
    };
    for (const auto& [px, py] : {std::pair{140, 96}, {160, 120}, {300, 200}, {10, 290}, {131, 200}}) {
      const double x = px + 0.5;
      const double y = py + 0.5;
      const double h = 1e-4;
      const auto slope = [h](const Vec2d& a, const Vec2d& b) {
        return Vec2d{(a.x - b.x) / (2 * h), (a.y - b.y) / (2 * h)};
      };
      const Vec2d dx = slope(buffer(x + h, y), buffer(x - h, y));
      const Vec2d dy = slope(buffer(x, y + h), buffer(x, y - h));
      const double area = std::min(1.0, std::abs(dx.x * dy.y - dx.y * dy.x));
      EXPECT_NEAR(density(px, py) / area, 1, 1e-5) << sigma << " " << alpha << " at " << px << "," << py;
    }
  }
}

// The radial axis is the integral of M, the turn in steps whose number falls with sin e inside the plateau: samples per
// solid angle are the grid cells in a small patch of the sphere.
TEST(Density, VisualPolarIsTheJacobianOfItsMapping) {
  const FoveationSettings settings = model("visual-polar");
  // Reddy's acuity, whose plateau the turn keeps to.
  constexpr double kAcuityPlateauDeg = 5.79;
  const auto relative_acuity = [](double e) { return e <= kAcuityPlateauDeg ? 1.0 : 7.49 / std::pow(0.3 * e + 1, 2); };
  const auto integral_of_acuity = [&](double from_deg, double to_deg) {
    constexpr int kSteps = 100;
    double sum = 0;
    for (int i = 0; i < kSteps; ++i) {
      sum += relative_acuity(from_deg + (i + 0.5) * (to_deg - from_deg) / kSteps);
    }
    return sum * (to_deg - from_deg) / kSteps;
  };
  const auto cells_per_area = [&](double e_deg) {
    const double h = 0.01;
    const double du = integral_of_acuity(e_deg - h, e_deg + h);
    const double turn_steps = std::min(1.0, std::sin(e_deg * kRadPerDeg) / std::sin(kAcuityPlateauDeg * kRadPerDeg));
    const double ring_area = std::cos((e_deg - h) * kRadPerDeg) - std::cos((e_deg + h) * kRadPerDeg);
    return du * turn_steps / ring_area;
  };
  const double foveal = cells_per_area(1);
  for (const double e : {0.5, 3.0, 7.0, 12.0, 25.0, 50.0, 80.0}) {
    const double cutoff = *cutoff_of(settings, e) / *cutoff_of(settings, 0);
    EXPECT_NEAR(cutoff * cutoff / (cells_per_area(e) / foveal), 1, 2e-4) << e;
  }
}

// The cut-off is where sensitivity times contrast passes 1, found here by bisection of Barten's formula.
TEST(DensityCutoff, CsfIsWhereContrastIsJustSeen) {
  const auto log_sensitivity = [](double u, double luminance, double e, double k1, double k2) {
    const double numerator = 5200 * std::exp(-0.0016 * u * u * std::pow(1 + 100 / luminance, 0.08));
    const double a = 1 + 144.0 / 100 + 0.64 * u * u;
    const double b = 63 / std::pow(luminance, 0.83) + 1 / (1 - std::exp(-0.02 * u * u));
    return std::log(numerator / std::sqrt(a * b)) - std::log(10.0) * (k1 + k2 * u) * e;
  };
  for (const double luminance : {1.0, 100.0, 500.0}) {
    for (const double contrast : {1.0, 0.1}) {
      const FoveationSettings settings =
          model(fmt::format("csf:luminance={},contrast={},eye=right", luminance, contrast));
      for (const auto& [meridian, k1, k2] : {std::tuple{0.0, 0.0277526, 0.0175072},
                                             {90.0, 0.0277526, 0.0175072},
                                             {180.0, 0.0275591, 0.00987064},
                                             {135.0, 0.5 * (0.0277526 + 0.0275591), 0.5 * (0.0175072 + 0.00987064)}}) {
        for (const double e : {0.0, 5.0, 20.0, 60.0}) {
          double low = 2;
          double high = 64;
          for (int i = 0; i < 60; ++i) {
            const double middle = 0.5 * (low + high);
            (log_sensitivity(middle, luminance, e, k1, k2) + std::log(contrast) > 0 ? low : high) = middle;
          }
          if (low < 2.001) {
            continue;  // below the peak of the curve it has a second crossing
          }
          EXPECT_NEAR(*cutoff_of(settings, e, meridian) / low, 1, 1e-3)
              << luminance << " cd/m2, contrast " << contrast << ", " << e << " degrees towards " << meridian;
        }
      }
    }
  }
  // Dimmer frames need fewer samples.
  EXPECT_LT(*cutoff_of(model("csf:luminance=1"), 10), 0.9 * *cutoff_of(model("csf"), 10));
}

TEST(DensityCutoff, RetinaDiffersByDirectionAndEye) {
  const auto cutoff = [](const std::string& eye, double meridian_deg) {
    return *cutoff_of(model("retina:eye=" + eye), 20, meridian_deg);
  };
  // Temporal, in the right eye's field on the right, is the best meridian of all, nasal better than the vertical ones.
  EXPECT_GT(cutoff("right", 0), cutoff("right", 180));
  EXPECT_GT(cutoff("right", 180), 0.5 * cutoff("right", 90));
  for (const double meridian : {0.0, 30.0, 90.0, 200.0, 330.0}) {
    EXPECT_NEAR(cutoff("left", meridian), cutoff("right", 180 - meridian), 1e-12);
    EXPECT_NEAR(cutoff("both", meridian), std::max(cutoff("left", meridian), cutoff("right", meridian)), 1e-12);
  }
  // An ellipse between the meridians.
  const double x = cutoff("right", 0);
  const double y = cutoff("right", 90);
  const double expected = 1 / std::sqrt(0.75 / (x * x) + 0.25 / (y * y));
  EXPECT_NEAR(cutoff("right", 30), expected, 1e-9);
}

TEST(DensityCurve, IsMonotoneAndGoesThroughItsPoints) {
  const std::vector<Vec2d> points{{0, 1}, {4, 0.9}, {5, 0.2}, {10, 0.2}, {40, 0.01}};
  const MonotoneCubic curve(points);
  for (const Vec2d& point : points) {
    EXPECT_NEAR(curve(point.x), point.y, 1e-15);
  }
  EXPECT_EQ(curve(-1), 1);
  EXPECT_EQ(curve(180), 0.01);
  double last = 1;
  for (double x = 0; x <= 41; x += 0.01) {
    EXPECT_LE(curve(x), last + 1e-15) << x;
    last = curve(x);
  }
  // Continuous slope at a knot.
  const double h = 1e-6;
  EXPECT_NEAR((curve(4) - curve(4 - h)) / h, (curve(4 + h) - curve(4)) / h, 1e-4);
  EXPECT_EQ(MonotoneCubic({{7, 0.3}})(100), 0.3);
}

struct Extreme {
  std::string what;
  PlanarView view;
  Vec3d gaze;
};

std::vector<Extreme> extremes() {
  const PlanarView plain = view_of_perspective(1.0, 64, 40);
  const PlanarView narrow = view_of_perspective(0.1 * kRadPerDeg, 64, 40);
  const PlanarView wide = view_of_perspective(179 * kRadPerDeg, 64, 40);
  return {{"gaze on a pixel's centre", plain, plain.direction(20.5, 10.5)},
          {"gaze straight behind", plain, {0, 0, 1}},
          {"gaze exactly opposite to a pixel", plain, -plain.direction(20.5, 10.5)},
          {"gaze to the side", plain, {1, 0, 0}},
          {"gaze straight up", plain, {0, 1, 0}},
          {"gaze ten frames away", plain, plain.direction(64 * 10, -40 * 10)},
          {"gaze very short", plain, {0, 1e-150, -1e-150}},
          {"0.1 degrees", narrow, narrow.direction(3, 30)},
          {"179 degrees", wide, wide.direction(3, 30)},
          {"one pixel", view_of_perspective(1.0, 1, 1), {0, 0, -1}},
          {"one row", view_of_perspective(0.01, 50, 1), {0.1, 0.2, -1}}};
}

TEST(DensityExtremes, DensityIsFiniteAndWithinItsLimits) {
  for (const std::string& name : density_models()) {
    for (const Extreme& extreme : extremes()) {
      const auto density = density_image(model(name), extreme.view, extreme.gaze);
      ASSERT_TRUE(density) << name;
      for (const float p : density->pixels) {
        ASSERT_GE(p, static_cast<float>(kLeastDensity)) << name << ", " << extreme.what;
        ASSERT_LE(p, 1.0F) << name << ", " << extreme.what;
      }
    }
  }
}

TEST(DensityExtremes, ConstantsAtTheirLimits) {
  const PlanarView view = view_of_perspective(1.0, 64, 40);
  const Vec3d gaze = view.direction(20.5, 10.5);
  FoveationSettings settings = model("mar:foveal=0");  // sees everything at the gaze itself
  EXPECT_EQ(*cutoff_of(settings, 0), std::numeric_limits<double>::infinity());
  EXPECT_EQ((*density_image(settings, view, gaze))(20, 10), 1.0F);
  EXPECT_THROW((void)density_image(model("mar:foveal=0,relative-to=fovea"), view, gaze), Error);
  EXPECT_DOUBLE_EQ(*cutoff_of(model("mar:slope=0"), 90), 48);
  const ImageGray full = *density_image(model("mar:slope=0,foveal=0"), view, gaze);
  for (const float p : full.pixels) {
    EXPECT_EQ(p, 1.0F);
  }
  const ImageGray crowded = *density_image(model("log-polar:sigma=0.2,alpha=0.5"), view, gaze);
  for (const float p : crowded.pixels) {
    EXPECT_TRUE(p > 0 && p <= 1);
  }
  settings = model("csf:contrast=0.000001");  // seen by nobody
  EXPECT_EQ(*cutoff_of(settings, 0), 0);
  EXPECT_EQ((*density_image(settings, view, gaze))(20, 10), static_cast<float>(kLeastDensity));
  settings = model("linear:inner=8,outer=8.0001,least=0");  // all but a step
  EXPECT_EQ((*density_image(settings, view, gaze))(20, 10), 1.0F);
  EXPECT_EQ((*density_image(settings, view, gaze))(60, 30), static_cast<float>(kLeastDensity));
}

std::string refusal(const std::string& text) {
  try {
    parse_density(text);
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::usage);
    return error.what();
  }
  return {};
}

TEST(DensityText, IsReadBackAsItWas) {
  for (const DensityInfo& info : densities()) {
    EXPECT_EQ(to_string(parse_density(info.name)), info.name);
    for (const NamedParameter& parameter : info.parameters) {
      const std::string highest = parameter.words.empty() ? fmt::format("{}", parameter.high) : parameter.words.back();
      const std::string text = fmt::format("{}:{}={}", info.name, parameter.name, highest);
      if (refusal(text).empty()) {
        EXPECT_EQ(to_string(parse_density(text)), parameter.value == parameter.high ? info.name : text);
      }
    }
  }
  EXPECT_EQ(to_string(parse_density("mar: foveal=0.05 , slope=0.03")), "mar:slope=0.03,foveal=0.05");
  EXPECT_EQ(to_string(parse_density("rates/d.####.exr")), "rates/d.####.exr");
}

TEST(DensityText, SaysWhatIsWrong) {
  using testing::HasSubstr;
  EXPECT_THAT(refusal("acuty"), HasSubstr("did you mean 'acuity'"));
  EXPECT_THAT(refusal("mar:slop=1"), HasSubstr("did you mean 'slope'"));
  EXPECT_THAT(refusal("mar:slope"), HasSubstr("write slope=..."));
  EXPECT_THAT(refusal("mar:slope=181"), HasSubstr("give 0 to 180"));
  EXPECT_THAT(refusal("mar:slope=steep"), HasSubstr("'steep' is not possible for slope"));
  EXPECT_THAT(refusal("csf:contrast=0"), HasSubstr("more than 0, up to 1"));
  EXPECT_THAT(refusal("geisler-perry:contrast=0.015625"), HasSubstr("more than 0.015625"));  // sees no contrast of 1/64
  EXPECT_THAT(refusal("retina:eye=third"), HasSubstr("both, left, right"));
  for (const char* const model : {"linear", "quadric"}) {  // a fall needs room: 5 to 5 degrees is none
    EXPECT_THAT(refusal(fmt::format("{}:inner=5,outer=5", model)), HasSubstr("inner=5 is not less than outer=5"));
    EXPECT_THAT(refusal(fmt::format("{}:outer=4", model)), HasSubstr("inner=5 is not less than outer=4"));
  }
}

// A tenth of a degree across 16384 pixels: the angle to the next pixel is 1e-7 radians, of which acos would keep seven
// digits.
TEST(DensityExtremes, SmallAnglesKeepTheirDigits) {
  const PlanarView view = view_of_perspective(0.1 * 4 / 16384 * kRadPerDeg, 16384, 4);
  FoveationSettings settings;
  settings.sampling = a_curve({{0, 1}, {0.05, 0.5}});  // a straight line
  const Vec3d gaze = view.direction(8192, 2);
  const DensityField field(view, gaze, {}, std::get<DensityModel>(sampling_model(settings, view, gaze)));
  for (const int steps : {1, 2, 10, 100, 1000}) {
    const double e = std::atan(steps * view.step_x) * kDegPerRad;
    EXPECT_NEAR((1 - field.at(8192 + steps, 2)) / (10 * e), 1, 1e-8) << steps;
  }
}

}  // namespace
}  // namespace gazetrace::density_models_test
