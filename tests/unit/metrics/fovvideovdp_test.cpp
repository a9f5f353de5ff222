// SPDX-License-Identifier: Apache-2.0
// FovVideoVDP against the numbers of its authors' program: single steps, then every entry of the reference set. The
// limits are those that the set's README suggests.
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

FovVideoVdpGeometry geometry_of(const Json& values) {
  const int width = values["resolution"][0];
  const int height = values["resolution"][1];
  const double distance_m = values["distance_m"];
  if (values.contains("diagonal_size_inches")) {
    return geometry_from_diagonal(width, height, values["diagonal_size_inches"], distance_m);
  }
  if (values.contains("fov_horizontal")) {
    return geometry_from_horizontal_fov(width, height, values["fov_horizontal"], distance_m);
  }
  return geometry_from_diagonal_fov(width, height, values["fov_diagonal"], distance_m);
}

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

ImageGray luminance_of(const std::string& path, const Json& entry, const Json& pair) {
  const std::string photometry = entry["photometry"];
  if (photometry == "standard_sdr") {
    return display_luminance(reference_code(path), {});
  }
  const ImageRgb light = read_exr_rgb((metrics_reference_folder() / path).string());
  const double scale = pair["fovvideovdp_input_scale"];
  return photometry == "absolute" ? linear_luminance(light, scale)
                                  : linear_luminance(light, scale, 1500, 10 / kPi * 0.005 + 1500 / 1e6);
}

FovVideoVdpSettings settings_of(const Json& entry) {
  FovVideoVdpSettings settings;
  settings.geometry = geometry_of(entry["geometry_values"]);
  settings.foveated = entry["foveated"];
  settings.frames_per_second = entry.value("frames_per_second", 0.0);
  return settings;
}

// Pixels count from the centre of the first one.
std::optional<Vec2d> gaze_of(const Json& entry, std::size_t frame) {
  const Json& fixation = entry["fixation"];
  if (!fixation.is_array()) {
    return std::nullopt;
  }
  const Json& at = fixation[0].is_array() ? fixation[frame] : fixation;
  return Vec2d{at[0].get<double>() + 0.5, at[1].get<double>() + 0.5};
}

// On uniform pictures the original's numbers are single-precision noise of 1e-10; this is 5e-6 JOD.
constexpr double kRoundingQ = 1e-6;

void expect_bands(const std::vector<double>& q, const std::vector<double>& expected, const std::string& what) {
  ASSERT_EQ(q.size(), expected.size()) << what;
  const double largest = expected.empty() ? 0 : *std::max_element(expected.begin(), expected.end());
  for (std::size_t b = 0; b < q.size(); ++b) {
    EXPECT_NEAR(q[b], expected[b], 0.01 * expected[b] + 1e-3 * largest + kRoundingQ) << what << " band " << b;
  }
}

void expect_still(const Json& pair, const std::string& id) {
  for (const Json& entry : pair["fovvideovdp"]) {
    const ImageGray reference = luminance_of(pair["reference"], entry, pair);
    const ImageGray test = luminance_of(pair["test"], entry, pair);
    FovVideoVdp metric(settings_of(entry), reference.width_px, reference.height_px);
    const FovVideoVdpFrame frame = metric.add(reference, test, gaze_of(entry, 0));
    const std::string what = id + " " + entry["geometry"].get<std::string>() + " " + entry["fixation"].dump();
    EXPECT_NEAR(fovvideovdp_jod(frame.q), entry["jod"].get<double>(), 0.002) << what;
    expect_bands(frame.sustained, entry["Q_per_band"]["sustained"], what);
    EXPECT_NEAR(metric.band_frequencies_cpd().back(), entry["rho_band_cpd"].back().get<double>(), 1e-5) << what;
  }
}

TEST(FovVideoVdp, FindsTheDifferenceOfAScore) {
  for (const double jod : {9.9, 9.5, 9.0, 3.0, -2.0}) {
    EXPECT_NEAR(fovvideovdp_jod(fovvideovdp_q(jod)), jod, 1e-12);
  }
  EXPECT_EQ(fovvideovdp_q(10), 0);
}

TEST(FovVideoVdpReference, Stills) {
  GAZETRACE_SKIP_WITHOUT_METRICS_REFERENCE();
  const Json expected = read_reference_json("expected.json");
  std::size_t entries = 0;
  for (const char* const kind : {"ldr", "hdr"}) {
    for (const auto& [id, pair] : expected[kind].items()) {
      expect_still(pair, id);
      entries += pair["fovvideovdp"].size();
    }
  }
  EXPECT_GT(entries, 80U);
}

// The indices of the frames that the original puts before the first one.
std::vector<std::size_t> frames_before(const std::string& padding, std::size_t taps, std::size_t count) {
  std::vector<std::size_t> before;
  for (std::size_t k = 0; k + 1 < taps; ++k) {
    if (padding == "pingpong") {
      before.push_back(taps - 1 - k);
    } else if (padding == "circular") {
      before.push_back((2 * count - 1 - taps + k) % count);
    }
  }
  return before;
}

TEST(FovVideoVdpReference, Videos) {
  GAZETRACE_SKIP_WITHOUT_METRICS_REFERENCE();
  const Json expected = read_reference_json("expected.json")["video"];
  EXPECT_EQ(expected.size(), 5U);
  for (const auto& [id, video] : expected.items()) {
    for (const Json& entry : video["fovvideovdp"]) {
      const std::size_t count = video["reference"].size();
      const std::string padding = entry["temp_padding"];
      const std::string what = id + " " + entry["geometry"].get<std::string>() + " " + padding + " " +
                               entry["frames_per_second"].dump() + " fps " + entry["fixation"].dump().substr(0, 20);
      std::vector<ImageGray> references;
      std::vector<ImageGray> tests;
      for (std::size_t f = 0; f < count; ++f) {
        references.push_back(luminance_of(video["reference"][f], entry, video));
        tests.push_back(luminance_of(video["test"][f], entry, video));
      }
      FovVideoVdp metric(settings_of(entry), references[0].width_px, references[0].height_px);
      for (const std::size_t f : frames_before(padding, static_cast<std::size_t>(metric.taps()), count)) {
        metric.prime(references[f], tests[f]);
      }
      double q = 0;
      for (std::size_t f = 0; f < count; ++f) {
        // Circular padding ends the first window one frame early.
        const std::size_t shown = padding == "circular" && f == 0 ? count - 2 : f;
        const FovVideoVdpFrame frame = metric.add(references[shown], tests[shown], gaze_of(entry, f));
        q += frame.q / static_cast<double>(count);
        std::vector<double> sustained;
        std::vector<double> transient;
        for (std::size_t b = 0; b < frame.sustained.size(); ++b) {
          sustained.push_back(entry["Q_per_band"]["sustained"][b][f]);
          transient.push_back(entry["Q_per_band"]["transient"][b][f]);
        }
        expect_bands(frame.sustained, sustained, what + " sustained, frame " + std::to_string(f));
        expect_bands(frame.transient, transient, what + " transient, frame " + std::to_string(f));
      }
      EXPECT_NEAR(fovvideovdp_jod(q), entry["jod"].get<double>(), 0.002) << what;
    }
  }
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
