// SPDX-License-Identifier: Apache-2.0
// FovVideoVDP against the numbers of its authors' program: single steps and a map. The limits are those that the
// reference set's README suggests; every entry of it is fovvideovdp_reference_test's.
#include "gazetrace/fovvideovdp.hpp"

#include <algorithm>
#include <cmath>
#include <random>

#include "gazetrace/error.hpp"
#include "gazetrace/output.hpp"
#include "metrics/contrast_sensitivity.hpp"
#include "metrics/masking.hpp"
#include "metrics/pyramid.hpp"
#include "metrics/temporal_channels.hpp"
#include "support/metrics_reference.hpp"

namespace gazetrace::fovvideovdp_test {
namespace {

using Json = nlohmann::json;

constexpr double kDegreeLimit = 1e-4;  // of single-precision degrees

void expect_frequencies(const std::vector<double>& bands, const std::vector<double>& expected,
                        const std::string& what) {
  ASSERT_EQ(bands.size(), expected.size()) << what;
  for (std::size_t b = 0; b < bands.size(); ++b) {
    EXPECT_NEAR(bands[b], expected[b], 1e-6 * expected[b]) << what;
  }
}

TEST(FovVideoVdpSteps, Geometry) {
  GAZETRACE_SKIP_WITHOUT_METRICS_REFERENCE();
  const Json all = read_reference_json("intermediates.json")["geometry"];
  EXPECT_GE(all.size(), 5U);
  for (const auto& [name, expected] : all.items()) {
    const FovVideoVdpGeometry geometry = geometry_of(expected);
    const int width = geometry.width_px;
    const int height = geometry.height_px;
    EXPECT_NEAR(geometry.pixels_per_degree(), expected["pix_per_deg_centre"].get<double>(),
                1e-6 * geometry.pixels_per_degree())
        << name;
    EXPECT_NEAR(geometry.width_m, expected["display_size_m"][0].get<double>(), 1e-6) << name;
    EXPECT_NEAR(geometry.height_m, expected["display_size_m"][1].get<double>(), 1e-6) << name;
    const Vec2d gaze = geometry.view_direction_deg(expected["gaze_pixel"][0].get<double>() + 0.5,
                                                   expected["gaze_pixel"][1].get<double>() + 0.5, width, height);
    for (const Json& point : expected["points"]) {
      const Vec2d d = geometry.view_direction_deg(point["pixel"][0].get<double>() + 0.5,
                                                  point["pixel"][1].get<double>() + 0.5, width, height);
      EXPECT_NEAR(d.x, point["view_direction_deg"][0].get<double>(), kDegreeLimit) << name;
      EXPECT_NEAR(d.y, point["view_direction_deg"][1].get<double>(), kDegreeLimit) << name;
      EXPECT_NEAR(std::hypot(d.x - gaze.x, d.y - gaze.y), point["eccentricity_deg"].get<double>(), kDegreeLimit)
          << name;
      // The original subtracts two tangents in single precision.
      EXPECT_NEAR(geometry.magnification(d), point["resolution_magnification"].get<double>(), 2e-3) << name;
    }
    expect_frequencies(fovvideovdp_bands_cpd(geometry.pixels_per_degree(), width, height),
                       expected["band_cpd_full_frame"], name);
  }
}

TEST(FovVideoVdpSteps, BandsForSizes) {
  GAZETRACE_SKIP_WITHOUT_METRICS_REFERENCE();
  const Json all = read_reference_json("intermediates.json")["bands_for_size"];
  EXPECT_EQ(all.size(), 5U);
  for (const Json& expected : all) {
    expect_frequencies(fovvideovdp_bands_cpd(expected["ppd"], expected["width"], expected["height"]), expected["cpd"],
                       expected.dump());
  }
}

TEST(FovVideoVdpSteps, TemporalFilters) {
  GAZETRACE_SKIP_WITHOUT_METRICS_REFERENCE();
  const Json all = read_reference_json("intermediates.json")["temporal_filters"];
  for (const auto& [rate, expected] : all.items()) {
    const TemporalFilters filters = temporal_filters(std::stod(rate));
    ASSERT_EQ(filters.sustained.size(), expected["taps"].get<std::size_t>()) << rate;
    for (std::size_t i = 0; i < filters.sustained.size(); ++i) {
      EXPECT_NEAR(filters.sustained[i], expected["sustained"][i].get<double>(), 1e-6) << rate << " tap " << i;
      EXPECT_NEAR(filters.transient[i], expected["transient"][i].get<double>(), 1e-6) << rate << " tap " << i;
    }
  }
  EXPECT_THROW(temporal_filters(3), Error);
}

TEST(FovVideoVdpSteps, Photometry) {
  GAZETRACE_SKIP_WITHOUT_METRICS_REFERENCE();
  const Json expected = read_reference_json("intermediates.json")["photometry_standard_sdr"];
  EXPECT_NEAR(black_level_cd_m2({}), expected["black_level"].get<double>(), 1e-6);
  for (const auto& [code, luminance] : expected["grey_luminance"].items()) {
    const float v = static_cast<float>(std::stoi(code)) / 255.0F;
    EXPECT_NEAR(display_luminance(ImageRgb(1, 1, {v, v, v}), {})(0, 0), luminance.get<double>(),
                1e-6 * luminance.get<double>() + 1e-6)
        << code;
  }
}

TEST(FovVideoVdpSteps, ContrastSensitivity) {
  GAZETRACE_SKIP_WITHOUT_METRICS_REFERENCE();
  const SensitivityTable& table = SensitivityTable::get();
  const Json samples = read_reference_json("intermediates.json")["csf_samples"]["rows"];
  EXPECT_EQ(samples.size(), 50U);
  for (const Json& row : samples) {
    const auto log2_of = [&](std::size_t i) { return std::log2(row[i].get<float>()); };
    const std::array<float, 2> log2_s =
        table.log2_sensitivity({log2_of(1), log2_of(2), std::sqrt(row[3].get<float>())});
    const double s = std::exp2(static_cast<double>(log2_s[row[0].get<double>() > 0 ? 1 : 0]));
    EXPECT_NEAR(s, row[4].get<double>(), 1e-3 * row[4].get<double>()) << row;
  }
}

TEST(FovVideoVdpSteps, Pyramid) {
  GAZETRACE_SKIP_WITHOUT_METRICS_REFERENCE();
  const Json cases = read_reference_json("intermediates.json")["pyramid"];
  EXPECT_EQ(cases.size(), 3U);
  for (const Json& expected : cases) {
    ImageGray image(expected["width"], expected["height"]);
    image.pixels = expected["input"].get<std::vector<float>>();
    const ImageGray half = halved(image, true, 1);
    ASSERT_EQ(half.height_px, expected["reduced_shape_hw"][0].get<int>());
    ASSERT_EQ(half.width_px, expected["reduced_shape_hw"][1].get<int>());
    const ImageGray back = doubled(half, image.width_px, image.height_px, 1);
    for (std::size_t i = 0; i < half.pixels.size(); ++i) {
      EXPECT_NEAR(half.pixels[i], expected["reduced"][i].get<double>(), 1e-5) << image.width_px << " " << i;
    }
    for (std::size_t i = 0; i < back.pixels.size(); ++i) {
      EXPECT_NEAR(back.pixels[i], expected["expanded_back"][i].get<double>(), 1e-5) << image.width_px << " " << i;
    }
  }
}

// The correct border keeps a uniform picture uniform and does to columns what it does to rows; the original's does not.
TEST(FovVideoVdpSteps, CorrectBorder) {
  for (const auto& [width, height] : {std::pair{7, 6}, {6, 7}, {5, 5}, {9, 1}}) {
    const ImageGray flat(width, height, 3);
    for (const float value : halved(flat, false, 1).pixels) {
      EXPECT_NEAR(value, 3, 1e-6);
    }
  }
  ImageGray image(7, 6);
  ImageGray turned(6, 7);
  for (int y = 0; y < 6; ++y) {
    for (int x = 0; x < 7; ++x) {
      image(x, y) = turned(y, x) = static_cast<float>((x * 5 + y * 11) % 13);
    }
  }
  const ImageGray half = halved(image, false, 1);
  const ImageGray half_turned = halved(turned, false, 1);
  for (int y = 0; y < 3; ++y) {
    for (int x = 0; x < 4; ++x) {
      EXPECT_NEAR(half(x, y), half_turned(y, x), 1e-5);
    }
  }
  EXPECT_NE(halved(image, true, 1), half);
}

TEST(FovVideoVdpSteps, MaskingAndJod) {
  GAZETRACE_SKIP_WITHOUT_METRICS_REFERENCE();
  const Json all = read_reference_json("intermediates.json");
  for (const Json& row : all["masking_samples"]["rows"]) {
    const float d = masked_difference(row[1], row[2], row[0] == 0 ? kMaskSustained : kMaskTransient);
    EXPECT_NEAR(d, row[3].get<double>(), 1e-5 * row[3].get<double>()) << row;
  }
  for (const Json& row : all["jod_samples"]) {
    EXPECT_NEAR(fovvideovdp_jod(row[0]), row[1].get<double>(), 2e-6) << row;
  }
}

TEST(FovVideoVdp, FindsTheDifferenceOfAScore) {
  for (const double jod : {9.9, 9.5, 9.0, 3.0, -2.0}) {
    EXPECT_NEAR(fovvideovdp_jod(fovvideovdp_q(jod)), jod, 1e-12);
  }
  EXPECT_EQ(fovvideovdp_q(10), 0);
}

TEST(FovVideoVdpReference, DifferenceMap) {
  GAZETRACE_SKIP_WITHOUT_METRICS_REFERENCE();
  const Json maps = read_reference_json("intermediates.json")["raw_heatmap"];
  for (const Json& expected : maps) {
    const ImageGray reference = display_luminance(reference_code(expected["reference"]), {});
    const ImageGray test = display_luminance(reference_code(expected["test"]), {});
    FovVideoVdpSettings settings;
    settings.geometry = geometry_from_horizontal_fov(reference.width_px, reference.height_px, 60);
    settings.foveated = expected["foveated"];
    const ImageGray map =
        FovVideoVdp(settings, reference.width_px, reference.height_px).add(reference, test, {}, true).map;
    // The original keeps three significant digits.
    const auto near = [](double value, double wanted) { return std::fabs(value - wanted) <= 2e-3 * wanted + 1e-4; };
    EXPECT_PRED2(near, map_statistics(map).mean, expected["mean"].get<double>());
    EXPECT_PRED2(near, map_statistics(map).max, expected["max"].get<double>());
    for (const Json& probe : expected["probes_xy_value"]) {
      EXPECT_PRED2(near, map(probe[0].get<int>(), probe[1].get<int>()), probe[2].get<double>()) << probe;
    }
  }
}

// A picture in a corner of a display is one that fills it, where nothing differs elsewhere: the same differences in
// each band, over 16 times the pixels.
TEST(FovVideoVdp, PicturesOffTheMiddleAreSeenWhereTheyLie) {
  constexpr int kSide = 128;
  constexpr int kDisplay = 4 * kSide;
  constexpr double kMetresPerPixel = 0.002;
  constexpr double kPoolSpace = 1.52134;
  const auto differing = [](int side, int left, int top) {
    ImageGray image(side, side);
    for (int y = 0; y < side; ++y) {
      for (int x = 0; x < side; ++x) {
        const int dx = x - left;
        const int dy = y - top;
        const bool inside = dx >= 48 && dx < 80 && dy >= 48 && dy < 80;
        image(x, y) = inside && (dx / 2 + dy / 3) % 2 == 0 ? 44.0F : 40.0F;
      }
    }
    return image;
  };
  FovVideoVdpSettings settings;
  settings.geometry = {kDisplay, kDisplay, kDisplay * kMetresPerPixel, kDisplay * kMetresPerPixel, 1};
  FovVideoVdpSettings part = settings;
  for (const auto& [left, top] : {std::pair(0, 0), std::pair(kDisplay - kSide, 0), std::pair(0, kDisplay - kSide)}) {
    part.geometry = {kSide, kSide, kSide * kMetresPerPixel, kSide * kMetresPerPixel, 1};
    const Vec2d unmoved = part.geometry.view_direction_deg(20, 30, kSide, kSide);
    part.geometry.right_m = (left + kSide / 2.0 - kDisplay / 2.0) * kMetresPerPixel;
    part.geometry.up_m = (kDisplay / 2.0 - top - kSide / 2.0) * kMetresPerPixel;
    const Vec2d of_part = part.geometry.view_direction_deg(20, 30, kSide, kSide);
    const Vec2d of_whole = settings.geometry.view_direction_deg(left + 20, top + 30, kDisplay, kDisplay);
    EXPECT_NEAR(of_part.x, of_whole.x, 1e-9);
    EXPECT_NEAR(of_part.y, of_whole.y, 1e-9);
    EXPECT_GT(std::fabs(of_part.x - unmoved.x), 10);
    EXPECT_NEAR(part.geometry.magnification(of_part), settings.geometry.magnification(of_whole), 1e-9);
    const Vec2d gaze{30, 90};
    const FovVideoVdpFrame whole =
        FovVideoVdp(settings, kDisplay, kDisplay)
            .add(ImageGray(kDisplay, kDisplay, 40), differing(kDisplay, left, top), Vec2d{gaze.x + left, gaze.y + top});
    const FovVideoVdpFrame alone =
        FovVideoVdp(part, kSide, kSide).add(ImageGray(kSide, kSide, 40), differing(kSide, 0, 0), gaze);
    ASSERT_EQ(whole.sustained.size(), alone.sustained.size());
    for (std::size_t b = 0; b < whole.sustained.size(); ++b) {
      EXPECT_NEAR(alone.sustained[b], whole.sustained[b] * std::pow(16, 1 / kPoolSpace), 1e-3 * alone.sustained[b])
          << b;
    }
  }
}

// Noise that is three times as strong on the right; windows there are half as dense as on the left.
TEST(FovVideoVdp, WindowsStandForTheWholeByTheirWeights) {
  constexpr int kWidth = 768;
  constexpr int kHeight = 384;
  constexpr int kSide = 96;
  const ImageGray reference(kWidth, kHeight, 40);
  ImageGray whole = reference;
  ImageGray windows = reference;
  ImageGray weights(kWidth, kHeight, 0);
  std::mt19937 random(17);
  std::normal_distribution<float> normal;
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      const bool right = x >= kWidth / 2;
      whole(x, y) += (right ? 6.0F : 2.0F) * normal(random);
      const int column = x / kSide;
      const int row = y / kSide;
      if ((column + row) % 2 == 0 && (!right || row % 2 == 0)) {
        windows(x, y) = whole(x, y);
        weights(x, y) = right ? 4.0F : 2.0F;
      }
    }
  }
  FovVideoVdpSettings settings;
  settings.geometry = geometry_from_horizontal_fov(kWidth, kHeight, 768.0 / 28);
  const auto jod_of = [&](const ImageGray& test, const ImageGray& pooling) {
    settings.pooling_weights = pooling;
    return fovvideovdp_jod(FovVideoVdp(settings, kWidth, kHeight).add(reference, test, Vec2d{200, 100}).q);
  };
  const double expected = jod_of(whole, {});
  EXPECT_LT(expected, 9.8);
  EXPECT_NEAR(jod_of(windows, weights), expected, 0.05);
  EXPECT_GT(jod_of(windows, {}), expected + 0.2);
  EXPECT_EQ(jod_of(whole, ImageGray(kWidth, kHeight, 2)), expected);

  EXPECT_THROW(jod_of(whole, ImageGray(kWidth, kHeight, 0)), Error);
  EXPECT_THROW(jod_of(whole, ImageGray(kWidth / 2, kHeight, 1)), Error);
  weights(3, 4) = -1;
  EXPECT_THROW(jod_of(whole, weights), Error);
}

TEST(FovVideoVdp, SameBitsForAnyNumberOfThreadsAndPlaces) {
  ImageGray reference(131, 77);
  ImageGray test(131, 77);
  for (std::size_t i = 0; i < reference.pixels.size(); ++i) {
    reference.pixels[i] = static_cast<float>(1 + i * 37 % 101);
    test.pixels[i] = static_cast<float>(1 + i * 41 % 97);
  }
  FovVideoVdpSettings settings;
  settings.frames_per_second = 30;
  const auto q_of = [&](int threads) {
    settings.threads = threads;
    FovVideoVdp metric(settings, 131, 77);
    metric.add(test, reference, Vec2d{3, 4});
    return metric.add(reference, test, Vec2d{100, 20}).q;
  };
  EXPECT_EQ(q_of(1), q_of(5));
  EXPECT_THROW(FovVideoVdp(settings, 7, 100), Error);
  FovVideoVdp other(settings, 100, 77);
  EXPECT_THROW(other.add(reference, test, {}), Error);
}

}  // namespace
}  // namespace gazetrace::fovvideovdp_test
