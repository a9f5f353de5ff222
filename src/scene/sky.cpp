// SPDX-License-Identifier: Apache-2.0
#include "gazetrace/sky.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "gazetrace/error.hpp"

namespace gazetrace {
namespace {

constexpr int kWidthPx = 1024, kHeightPx = 512;
constexpr double kSunRadius_deg = 0.2665;                // seen from the Earth at its mean distance
constexpr double kSunIlluminance_lx = 128000;            // outside of the atmosphere
constexpr std::array kWavelengths_um{0.65, 0.55, 0.45};  // for red, green and blue

// Perez's function of the angle from the zenith and the angle from the sun.
struct Perez {
  double a, b, c, d, e;
  [[nodiscard]] double at(double cos_zenith, double sun_angle) const {
    const double cos_sun = std::cos(sun_angle);
    return (1 + a * std::exp(b / std::max(cos_zenith, 1e-4))) *
           (1 + c * std::exp(d * sun_angle) + e * cos_sun * cos_sun);
  }
};

// Each coefficient is linear in turbidity.
Perez luminance_terms(double t) {
  return {0.1787 * t - 1.4630, -0.3554 * t + 0.4275, -0.0227 * t + 5.3251, 0.1206 * t - 2.5771, -0.0670 * t + 0.3703};
}
Perez x_terms(double t) {
  return {-0.0193 * t - 0.2592, -0.0665 * t + 0.0008, -0.0004 * t + 0.2125, -0.0641 * t - 0.8989, -0.0033 * t + 0.0452};
}
Perez y_terms(double t) {
  return {-0.0167 * t - 0.2608, -0.0950 * t + 0.0092, -0.0079 * t + 0.2102, -0.0441 * t - 1.6537, -0.0109 * t + 0.0529};
}

double zenith_luminance_cd_m2(double t, double sun_zenith) {
  const double chi = (4.0 / 9.0 - t / 120) * (kPi - 2 * sun_zenith);
  return 1000 * ((4.0453 * t - 4.9710) * std::tan(chi) - 0.2155 * t + 2.4192);
}

// A row for T^2, T and 1; in it the factors of the sun's angle from the zenith to the powers 3, 2, 1 and 0.
using ZenithTable = std::array<std::array<double, 4>, 3>;
constexpr ZenithTable kZenithX{
    {{0.00166, -0.00375, 0.00209, 0}, {-0.02903, 0.06377, -0.03202, 0.00394}, {0.11693, -0.21196, 0.06052, 0.25886}}};
constexpr ZenithTable kZenithY{
    {{0.00275, -0.00610, 0.00317, 0}, {-0.04214, 0.08970, -0.04153, 0.00516}, {0.15346, -0.26756, 0.06670, 0.26688}}};

double zenith_chromaticity(const ZenithTable& table, double t, double angle) {
  double sum = 0;
  for (const std::array<double, 4>& row : table) {
    sum = sum * t + ((row[0] * angle + row[1]) * angle + row[2]) * angle + row[3];
  }
  return sum;
}

// Linear Rec.709 of a luminance and a chromaticity; IEC 61966-2-1, white D65.
Vec3d rec709(const SkyColor& color) {
  const double y = color.luminance_cd_m2;
  const double x = color.x / color.y * y;
  const double z = (1 - color.x - color.y) / color.y * y;
  return {3.2406 * x - 1.5372 * y - 0.4986 * z, -0.9689 * x + 1.8758 * y + 0.0415 * z,
          0.0557 * x - 0.2040 * y + 1.0570 * z};
}

double sun_zenith(const ClearSky& sky) {
  return (90 - sky.sun_elevation_deg) * kRadPerDeg;
}

// The share of a square of pixels that the sun's disc covers, by points within it.
double sun_share(const Vec3d& sun, int x, int y) {
  constexpr int kPoints = 8;
  int inside = 0;
  const double cos_radius = std::cos(kSunRadius_deg * kRadPerDeg);
  for (int j = 0; j < kPoints; ++j) {
    for (int i = 0; i < kPoints; ++i) {
      const double theta = (y + (j + 0.5) / kPoints) / kHeightPx * kPi;
      const double azimuth = ((x + (i + 0.5) / kPoints) / kWidthPx - 0.5) * 2 * kPi;
      const Vec3d direction{std::sin(theta) * std::sin(azimuth), std::cos(theta), -std::sin(theta) * std::cos(azimuth)};
      inside += dot(direction, sun) >= cos_radius ? 1 : 0;
    }
  }
  return static_cast<double>(inside) / (kPoints * kPoints);
}

void check(const ClearSky& sky) {
  const auto refuse = [](const char* what) { throw Error(ErrorKind::usage, "sky", what); };
  if (!(sky.turbidity >= 1.7 && sky.turbidity <= 10)) {
    refuse("a turbidity is between 1.7 and 10");
  }
  if (!(sky.sun_elevation_deg >= 0 && sky.sun_elevation_deg <= 90)) {
    refuse("the sun's elevation is between 0 and 90 degrees");
  }
  if (!(sky.ground_albedo >= 0 && sky.ground_albedo <= 1)) {
    refuse("the ground's albedo is between 0 and 1");
  }
}

}  // namespace

SkyColor clear_sky_color(const ClearSky& sky, const Vec3d& direction) {
  const double t = sky.turbidity;
  const double at_sun = sun_zenith(sky);
  const double cos_angle = std::clamp(dot(direction, sun_direction(sky)), -1.0, 1.0);
  const double angle = std::acos(cos_angle);
  const auto relative = [&](const Perez& terms) { return terms.at(direction.y, angle) / terms.at(1, at_sun); };
  return {zenith_luminance_cd_m2(t, at_sun) * relative(luminance_terms(t)),
          zenith_chromaticity(kZenithX, t, at_sun) * relative(x_terms(t)),
          zenith_chromaticity(kZenithY, t, at_sun) * relative(y_terms(t))};
}

Vec3d sun_direction(const ClearSky& sky) {
  const double up = sky.sun_elevation_deg * kRadPerDeg;
  const double around = sky.sun_azimuth_deg * kRadPerDeg;
  return {std::cos(up) * std::sin(around), std::sin(up), std::cos(up) * std::cos(around)};
}

Vec3d sun_illuminance(const ClearSky& sky) {
  const double angle = sun_zenith(sky);
  // Relative optical mass, and Angstrom's turbidity coefficient of haze.
  const double mass = 1 / (std::cos(angle) + 0.15 * std::pow(93.885 - angle * kDegPerRad, -1.253));
  const double haze = 0.04608 * sky.turbidity - 0.04586;
  const auto left = [&](double wavelength_um) {
    return kSunIlluminance_lx * std::exp(-0.008735 * std::pow(wavelength_um, -4.08) * mass) *
           std::exp(-haze * std::pow(wavelength_um, -1.3) * mass);
  };
  return {left(kWavelengths_um[0]), left(kWavelengths_um[1]), left(kWavelengths_um[2])};
}

Environment clear_sky(const ClearSky& sky, double rotation_deg, double exposure_ev) {
  check(sky);
  Environment environment;
  environment.radiance = ImageRgb(kWidthPx, kHeightPx);
  environment.rotation_rad = rotation_deg * kRadPerDeg;
  environment.source = "built-in sky";
  const Vec3d sun = sun_direction(sky);
  const double scale = std::exp2(exposure_ev) / kSkyUnit_cd_m2;
  std::vector<Vec3d> light(static_cast<std::size_t>(kWidthPx) * kHeightPx);
  std::vector<double> sun_shares(light.size(), 0);
  double sun_solid_angle = 0;
  Vec3d on_ground{0, 0, 0};  // illuminance by the sky, later also by the sun
  for (int y = 0; y < kHeightPx / 2; ++y) {
    const double theta = (y + 0.5) / kHeightPx * kPi;
    const double solid_angle =
        2 * kPi / kWidthPx * (std::cos(theta - kPi / kHeightPx / 2) - std::cos(theta + kPi / kHeightPx / 2));
    for (int x = 0; x < kWidthPx; ++x) {
      const double azimuth = ((x + 0.5) / kWidthPx - 0.5) * 2 * kPi;  // from -z towards +x
      const Vec3d direction{std::sin(theta) * std::sin(azimuth), std::cos(theta), -std::sin(theta) * std::cos(azimuth)};
      const std::size_t i = static_cast<std::size_t>(y) * kWidthPx + static_cast<std::size_t>(x);
      const Vec3d color = rec709(clear_sky_color(sky, direction));
      light[i] = {std::max(color.x, 0.0), std::max(color.y, 0.0), std::max(color.z, 0.0)};
      on_ground = on_ground + light[i] * (solid_angle * direction.y);
      if (dot(direction, sun) > std::cos(3 * kSunRadius_deg * kRadPerDeg)) {
        sun_shares[i] = sun_share(sun, x, y);
        sun_solid_angle += sun_shares[i] * solid_angle;
      }
    }
  }
  const Vec3d direct = sun_illuminance(sky);
  on_ground = on_ground + direct * sun.y;
  const Vec3d ground = on_ground * (sky.ground_albedo / kPi);
  for (int y = 0; y < kHeightPx; ++y) {
    for (int x = 0; x < kWidthPx; ++x) {
      const std::size_t i = static_cast<std::size_t>(y) * kWidthPx + static_cast<std::size_t>(x);
      Vec3d seen = y < kHeightPx / 2 ? light[i] : ground;
      if (sun_shares[i] > 0) {
        seen = seen + direct * (sun_shares[i] / sun_solid_angle);
      }
      environment.radiance(x, y) = to_float(seen * scale);
    }
  }
  return environment;
}

}  // namespace gazetrace
