// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

#include "gazetrace/scene.hpp"
#include "gazetrace/sky.hpp"
#include "support/gltf_builder.hpp"

namespace gazetrace::environment_test {
namespace {

using ::testing::HasSubstr;

std::string error_of(const std::string& path) {
  try {
    static_cast<void>(load_environment(path));
  } catch (const Error& error) {
    return error.what();
  }
  return "no error";
}

// A Radiance picture of one scanline without run lengths: mantissas and a shared exponent, value = m / 256 * 2^(e -
// 128).
std::string radiance_file(int width, const std::vector<std::uint8_t>& rgbe) {
  std::string file = "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X " + std::to_string(width) + "\n";
  file.append(reinterpret_cast<const char*>(rgbe.data()), rgbe.size());
  return file;
}

TEST(Environment, RadianceValuesAndExposure) {
  const test::TempFolder folder;
  const std::string path = folder.write("two.hdr", radiance_file(2, {128, 64, 32, 129, 128, 128, 128, 138}));
  const Environment environment = load_environment(path, 90, 1);
  ASSERT_EQ(environment.radiance.width_px, 2);
  ASSERT_EQ(environment.radiance.height_px, 1);
  EXPECT_EQ(environment.radiance(0, 0), (Vec3f{2, 1, 0.5F}));
  EXPECT_EQ(environment.radiance(1, 0).x, 1024);
  EXPECT_DOUBLE_EQ(environment.rotation_rad, kPi / 2);
  EXPECT_EQ(environment.source, path);
}

TEST(Environment, BadFilesAreRefused) {
  const test::TempFolder folder;
  EXPECT_THAT(error_of(folder.file("gone.hdr")), HasSubstr("there is no such file"));
  EXPECT_THAT(error_of(folder.write("text.hdr", "hello")), HasSubstr("text.hdr: cannot be read"));
  EXPECT_THAT(error_of(folder.write("cut.hdr", radiance_file(64, {1, 2, 3, 4}))), HasSubstr("damaged"));
}

// Whatever the name says: OpenImageIO would try films, raw photographs and medical volumes.
TEST(Environment, OnlyPicturesOfKnownKindsAreTried) {
  const test::TempFolder folder;
  const std::string pixmap = "P6\n2 1\n255\nabcdef";
  for (const char* name : {"sky.hdr", "sky.exr", "sky.ppm"}) {
    EXPECT_THAT(error_of(folder.write(name, pixmap)), HasSubstr("no picture of a known kind")) << name;
  }
  // OpenImageIO makes room for as many pixels as a film's header claims before anybody can ask, or ends the program.
  const std::string film = std::string("GIF89a\xff\xff\xff\xff\xf7\0\0", 13) + std::string(60, '\x2c');
  EXPECT_THAT(error_of(folder.write("sky.gif", film)), HasSubstr("no picture of a known kind"));
}

TEST(Environment, ExposureThatOverflowsIsRefused) {
  const test::TempFolder folder;
  const std::string path = folder.write("one.hdr", radiance_file(1, {128, 128, 128, 138}));
  EXPECT_THROW(static_cast<void>(load_environment(path, 0, 200)), Error);
}

TEST(Environment, CubeMapsAreRefusedAndOtherShapesDoubted) {
  const test::TempFolder folder;
  const auto size = [&](int width, int height) {
    return folder.write("flat.hdr", "#?RADIANCE\n\n-Y " + std::to_string(height) + " +X " + std::to_string(width) +
                                        "\n" + std::string(4 * static_cast<std::size_t>(width) * height, 'x'));
  };
  EXPECT_THAT(error_of(size(48, 8)), HasSubstr("cube map"));
  EXPECT_THAT(error_of(size(8, 48)), HasSubstr("cube map"));
  EXPECT_THAT(load_environment(size(32, 32)).warnings, testing::ElementsAre(HasSubstr("32 x 32")));
  EXPECT_THAT(load_environment(size(32, 16)).warnings, testing::IsEmpty());
}

TEST(Environment, TakesNoMoreMemoryThanItMay) {
  const test::TempFolder folder;
  const std::string path = folder.write("black.hdr", "#?RADIANCE\n\n-Y 128 +X 256\n" + std::string(4 * 128 * 256, 'x'));
  EXPECT_TRUE(load_environment(path, 0, 0, 2U << 20U).present());
  EXPECT_THAT([&] { static_cast<void>(load_environment(path, 0, 0, 1U << 19U)); },
              testing::ThrowsMessage<Error>(HasSubstr("max-memory")));
}

TEST(Environment, ConstantIsOnePixel) {
  const Environment environment = constant_environment({1, 2, 3});
  EXPECT_TRUE(environment.present());
  EXPECT_EQ(environment.radiance, ImageRgb(1, 1, Vec3f{1, 2, 3}));
  EXPECT_FALSE(Environment{}.present());
  EXPECT_THROW(static_cast<void>(constant_environment({-1, 0, 0})), Error);
  EXPECT_THROW(static_cast<void>(constant_environment({std::nanf(""), 0, 0})), Error);
}

TEST(Sky, IsPositiveSmoothAndWrapsAround) {
  const Environment sky = builtin_sky(30, 2);
  const ImageRgb& image = sky.radiance;
  ASSERT_EQ(image.width_px, 512);
  ASSERT_EQ(image.height_px, 256);
  EXPECT_DOUBLE_EQ(sky.rotation_rad, kPi / 6);
  double largest_step = 0;
  float largest = 0;
  for (int y = 0; y < image.height_px; ++y) {
    for (int x = 0; x < image.width_px; ++x) {
      const Vec3f pixel = image(x, y);
      ASSERT_GT(std::min({pixel.x, pixel.y, pixel.z}), 0);
      largest = std::max({largest, pixel.x, pixel.y, pixel.z});
      const Vec3f right = image((x + 1) % image.width_px, y);
      const Vec3f below = image(x, std::min(y + 1, image.height_px - 1));
      largest_step = std::max({largest_step, std::abs(1.0 * pixel.x - right.x), std::abs(1.0 * pixel.x - below.x)});
    }
  }
  EXPECT_LT(largest_step, 0.1 * largest);
  // Brightest where the sun would be: above the horizon, right of the picture's centre (towards +x).
  const auto brightest = std::max_element(image.pixels.begin(), image.pixels.end(),
                                          [](const Vec3f& a, const Vec3f& b) { return a.x + a.y < b.x + b.y; });
  const auto index = static_cast<int>(brightest - image.pixels.begin());
  EXPECT_LT(index / image.width_px, 128);
  EXPECT_GT(index % image.width_px, 256);
  const Environment plain = builtin_sky();
  EXPECT_FLOAT_EQ(image(100, 50).y, 4 * plain.radiance(100, 50).y);
}

// Figures from the data's own description: 0.2126 R + 0.7152 G + 0.0722 B.
TEST(Environment, SharedPicturesHaveTheirDescribedLuminance) {
  const std::string folder = std::string(GAZETRACE_SHARED_DIR) + "/hdri/";
  if (!std::filesystem::exists(folder)) {
    GTEST_SKIP() << folder << " is not here";
  }
  const Environment park = load_environment(folder + "rooitou_park_1k.hdr");
  ASSERT_EQ(park.radiance.width_px, 1024);
  ASSERT_EQ(park.radiance.height_px, 512);
  const auto luminance = [](const Vec3f& p) { return 0.2126 * p.x + 0.7152 * p.y + 0.0722 * p.z; };
  double sum = 0;
  double weight = 0;
  double largest = 0;
  std::pair<int, int> place;
  for (int y = 0; y < 512; ++y) {
    const double solid_angle = std::sin((y + 0.5) / 512 * kPi);
    for (int x = 0; x < 1024; ++x) {
      const double value = luminance(park.radiance(x, y));
      sum += solid_angle * value;
      weight += solid_angle;
      if (value > largest) {
        largest = value;
        place = {y, x};
      }
    }
  }
  EXPECT_NEAR(sum / weight, 0.756, 0.005);
  EXPECT_NEAR(largest, 64890, 0.005 * 64890);
  EXPECT_EQ(place, (std::pair{226, 614}));
  EXPECT_TRUE(park.warnings.empty());
  EXPECT_TRUE(load_environment(folder + "kiara_1_dawn_1k.hdr").present());
  EXPECT_TRUE(load_environment(folder + "dikhololo_night_1k.hdr").present());
}

// Lossy compression left small negative values in this one.
TEST(Environment, NegativePixelsBecomeBlackWithAWarning) {
  const std::string folder = std::string(GAZETRACE_SHARED_DIR) + "/hdri/";
  if (!std::filesystem::exists(folder)) {
    GTEST_SKIP() << folder << " is not here";
  }
  for (const char* name : {"city_512_zip.exr", "city_512.exr"}) {
    const Environment city = load_environment(folder + name);
    ASSERT_EQ(city.warnings.size(), 1U);
    EXPECT_THAT(city.warnings[0], HasSubstr("negative"));
    float least = 1;
    float most = 0;
    for (const Vec3f& pixel : city.radiance.pixels) {
      least = std::min({least, pixel.x, pixel.y, pixel.z});
      most = std::max({most, pixel.x, pixel.y, pixel.z});
    }
    EXPECT_EQ(least, 0);
    EXPECT_NEAR(most, 11, 1);
  }
}

// Judd, MacAdam and Wyszecki 1964, from which the CIE's daylight is made: the locus of daylights.
double daylight_y(double x) {
  return -3.000 * x * x + 2.870 * x - 0.275;
}

TEST(ClearSky, ItsColoursLieAlongTheLocusOfDaylight) {
  for (const double turbidity : {2.0, 3.0, 4.0, 6.0}) {
    for (const double elevation : {20.0, 40.0, 60.0}) {
      ClearSky sky;
      sky.turbidity = turbidity;
      sky.sun_elevation_deg = elevation;
      for (const Vec3d& direction : {Vec3d{0, 1, 0}, normalize(Vec3d{1, 1, 0}), normalize(Vec3d{0, 1, -1})}) {
        const SkyColor color = clear_sky_color(sky, direction);
        EXPECT_NEAR(color.y, daylight_y(color.x), 0.02) << turbidity << " " << elevation;
        EXPECT_GT(color.x, 0.22);
        EXPECT_LT(color.x, 0.36);
      }
    }
  }
}

// The Illuminating Engineering Society's formulas for a clear day (Lighting Handbook, 9th edition, chapter 8), made
// from other measurements: 127.5 klx exp(-0.21 m) from the sun, 0.8 + 15.5 sqrt(sin h) klx from the sky on the ground.
TEST(ClearSky, ItsLightIsThatOfAClearDay) {
  for (const double elevation : {25.0, 40.0, 60.0}) {
    ClearSky sky;
    sky.turbidity = 2.5;
    sky.sun_elevation_deg = elevation;
    sky.ground_albedo = 0;
    const double height = std::sin(elevation * kRadPerDeg);
    EXPECT_NEAR(sun_illuminance(sky).y / (127500 * std::exp(-0.21 / height)), 1, 0.15) << elevation;
    double on_ground = 0;
    constexpr int kSteps = 200;
    for (int i = 0; i < kSteps; ++i) {
      for (int j = 0; j < kSteps; ++j) {  // in equal shares of the illuminance
        const double sine = std::sqrt((i + 0.5) / kSteps);
        const double around = (j + 0.5) / kSteps * 2 * kPi;
        const Vec3d direction{sine * std::cos(around), std::sqrt(1 - sine * sine), sine * std::sin(around)};
        on_ground += clear_sky_color(sky, direction).luminance_cd_m2 * kPi / (kSteps * kSteps);
      }
    }
    // The model is known to be brighter than measured skies (Zotti, Wilkie and Purgathofer 2007).
    EXPECT_GT(on_ground, 1000 * (0.8 + 15.5 * std::sqrt(height))) << elevation;
    EXPECT_LT(on_ground, 2000 * (0.8 + 15.5 * std::sqrt(height))) << elevation;
  }
}

// Where clear skies are bright and dark: about the sun and toward the horizon; a right angle away from the sun.
TEST(ClearSky, IsBrightestAboutTheSunAndDarkestARightAngleAway) {
  const ClearSky sky;
  const auto luminance = [&](double towards_sun_deg) {  // from the zenith, in the plane of the sun
    const double angle = towards_sun_deg * kRadPerDeg;
    const double around = sky.sun_azimuth_deg * kRadPerDeg;
    return clear_sky_color(sky,
                           {std::sin(angle) * std::sin(around), std::cos(angle), std::sin(angle) * std::cos(around)})
        .luminance_cd_m2;
  };
  const double at_sun = luminance(90 - sky.sun_elevation_deg);
  EXPECT_GT(at_sun, 3 * luminance(0));
  const double opposite = luminance(-sky.sun_elevation_deg);
  EXPECT_LT(opposite, luminance(0));
  EXPECT_LT(opposite, luminance(-85));
}

// The picture holds the model: the sun where it is said to be, with its whole light, and half of all directions sky.
TEST(ClearSky, ThePictureHoldsSunSkyAndGround) {
  const ClearSky sky;
  const Environment environment = clear_sky(sky, 0, 1);
  const ImageRgb& picture = environment.radiance;
  double brightest = 0;
  Vec3d at{0, 0, 0};
  double sun_lx = 0;
  for (int y = 0; y < picture.height_px; ++y) {
    for (int x = 0; x < picture.width_px; ++x) {
      const Vec3f& pixel = picture(x, y);
      ASSERT_TRUE(std::isfinite(pixel.x) && pixel.x >= 0 && pixel.y >= 0 && pixel.z >= 0);
      const double theta = (y + 0.5) / picture.height_px * kPi;
      const double azimuth = ((x + 0.5) / picture.width_px - 0.5) * 2 * kPi;
      const Vec3d direction{std::sin(theta) * std::sin(azimuth), std::cos(theta), -std::sin(theta) * std::cos(azimuth)};
      if (pixel.y > brightest) {
        brightest = pixel.y;
        at = direction;
      }
      if (dot(direction, sun_direction(sky)) > std::cos(1.5 * kRadPerDeg)) {
        const double solid_angle = 2 * kPi / picture.width_px * kPi / picture.height_px * std::sin(theta);
        sun_lx += pixel.y * solid_angle * kSkyUnit_cd_m2 / 2;  // one stop brighter, as asked
      }
    }
  }
  EXPECT_GT(dot(at, sun_direction(sky)), std::cos(0.5 * kRadPerDeg));
  EXPECT_NEAR(sun_lx / sun_illuminance(sky).y, 1, 0.02);
  EXPECT_GT(picture(10, picture.height_px - 10).y, 0);
  ClearSky wrong;
  wrong.turbidity = 100;
  EXPECT_THROW((void)clear_sky(wrong), Error);
}

}  // namespace
}  // namespace gazetrace::environment_test
