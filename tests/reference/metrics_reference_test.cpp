// SPDX-License-Identifier: Apache-2.0
// Every per-picture number of the reference set: FLIP by its authors' program, SSIM by scikit-image, PSNR, MSE and
// relMSE by numpy. The limits are those that the set's README suggests. Small pictures are metrics_test's, under the
// sanitizers.
#include <cmath>

#include "gazetrace/output.hpp"
#include "support/metrics_reference.hpp"

namespace gazetrace::metrics_reference_test {
namespace {

using Json = nlohmann::json;

constexpr double kProbeLimit = 1e-4;
constexpr double kPooledLimit = 1e-4;
constexpr double kRelativeLimit = 1e-6;

void expect_probes(const Json& entry, const ImageGray& map, const std::string& what) {
  if (!entry.contains("map_probes_xy_value")) {
    return;
  }
  for (const Json& probe : entry["map_probes_xy_value"]) {
    EXPECT_NEAR(map(probe[0].get<int>(), probe[1].get<int>()), probe[2].get<double>(), kProbeLimit)
        << what << " at " << probe[0] << "," << probe[1];
  }
}

void expect_pooled(const Json& entry, const ImageGray& map, double mean_limit, const std::string& what) {
  const MapStatistics statistics = map_statistics(map);
  EXPECT_NEAR(statistics.mean, entry["mean"].get<double>(), mean_limit) << what;
  EXPECT_NEAR(statistics.min, entry["min"].get<double>(), kPooledLimit) << what;
  EXPECT_NEAR(statistics.max, entry["max"].get<double>(), kPooledLimit) << what;
  EXPECT_NEAR(statistics.weighted_quartiles[0], entry["weighted_q1"].get<double>(), kPooledLimit) << what;
  EXPECT_NEAR(statistics.weighted_quartiles[1], entry["weighted_median"].get<double>(), kPooledLimit) << what;
  EXPECT_NEAR(statistics.weighted_quartiles[2], entry["weighted_q3"].get<double>(), kPooledLimit) << what;
}

double score(const std::string& metric, const MetricPicture& reference, const MetricPicture& test) {
  return metric_value(metric, measure(metric, reference, test, {}).mean);
}

void expect_psnr(const Json& expected, double value, const std::string& what) {
  if (expected.is_null()) {
    EXPECT_EQ(value, HUGE_VAL) << what;
  } else {
    // Of decibels where they are large; 0 dB is a mean squared error of 1 to the same relative limit.
    EXPECT_NEAR(value, expected.get<double>(), kRelativeLimit * std::max(expected.get<double>(), 5.0)) << what;
  }
}

ImageRgb luma_picture(const ImageRgb& code) {
  ImageRgb luma(code.width_px, code.height_px);
  for (std::size_t i = 0; i < code.pixels.size(); ++i) {
    const Vec3f& p = code.pixels[i];
    const auto y = static_cast<float>(0.299 * static_cast<double>(p.x) + 0.587 * static_cast<double>(p.y) +
                                      0.114 * static_cast<double>(p.z));
    luma.pixels[i] = {y, y, y};
  }
  return luma;
}

TEST(MetricsReference, LdrFlip) {
  GAZETRACE_SKIP_WITHOUT_METRICS_REFERENCE();
  int entries = 0;
  const Json expected = read_reference_json("expected.json");
  for (const auto& [id, pair] : expected["ldr"].items()) {
    const MetricPicture reference{{}, reference_code(pair["reference"])};
    const MetricPicture test{{}, reference_code(pair["test"])};
    // Single-precision rounding in the original dominates on uniform pictures and steps.
    const bool card = id.starts_with("flat_") || id == "edge";
    for (const Json& entry : pair["flip"]) {
      MetricSettings settings;
      settings.pixels_per_degree = entry["ppd"];
      const MetricMap map = measure("flip", reference, test, settings);
      const std::string what = id + " at " + entry["ppd"].dump() + " ppd";
      expect_pooled(entry, map.values, card ? 1e-4 : 1e-5, what);
      expect_probes(entry, map.values, what);
      EXPECT_DOUBLE_EQ(map.mean, map_statistics(map.values).mean) << what;
      ++entries;
    }
  }
  EXPECT_GT(entries, 30);
}

TEST(MetricsReference, HdrFlip) {
  GAZETRACE_SKIP_WITHOUT_METRICS_REFERENCE();
  const Json expected = read_reference_json("expected.json");
  for (const auto& [id, pair] : expected["hdr"].items()) {
    const auto folder = metrics_reference_folder();
    const MetricPicture reference{read_exr_rgb((folder / pair["reference"].get<std::string>()).string()), {}};
    const MetricPicture test{read_exr_rgb((folder / pair["test"].get<std::string>()).string()), {}};
    for (const Json& entry : pair["hdr_flip"]) {
      MetricSettings settings;
      settings.pixels_per_degree = entry["ppd"];
      const std::string tone_mapper = entry["tone_mapper"];
      settings.hdr_flip.tone_mapper = tone_mapper == "aces"    ? FlipToneMapper::aces
                                      : tone_mapper == "hable" ? FlipToneMapper::hable
                                                               : FlipToneMapper::reinhard;
      if (entry.contains("given")) {
        settings.hdr_flip.start_ev = entry["start_exposure"].get<double>();
        settings.hdr_flip.stop_ev = entry["stop_exposure"].get<double>();
        settings.hdr_flip.count = entry["num_exposures"].get<int>();
      }
      const std::string what = id + " " + tone_mapper + " " + entry["ppd"].dump();
      const FlipExposures exposures = flip_exposures(reference.light, settings.hdr_flip);
      EXPECT_NEAR(exposures.start_ev, entry["start_exposure"].get<double>(), 1e-4) << what;
      EXPECT_NEAR(exposures.stop_ev, entry["stop_exposure"].get<double>(), 1e-4) << what;
      EXPECT_EQ(exposures.count, entry["num_exposures"].get<int>()) << what;
      const MetricMap map = measure("hdr_flip", reference, test, settings);
      expect_pooled(entry, map.values, 1e-5, what);
      expect_probes(entry, map.values, what);
    }
  }
}

TEST(MetricsReference, SquaredErrorsOfLight) {
  GAZETRACE_SKIP_WITHOUT_METRICS_REFERENCE();
  const Json expected = read_reference_json("expected.json");
  for (const auto& [id, pair] : expected["hdr"].items()) {
    const auto folder = metrics_reference_folder();
    const MetricPicture reference{read_exr_rgb((folder / pair["reference"].get<std::string>()).string()), {}};
    const MetricPicture test{read_exr_rgb((folder / pair["test"].get<std::string>()).string()), {}};
    const double mse = pair["mse"];
    const double relmse = pair["relmse_eps0.01"];
    EXPECT_NEAR(score("mse", reference, test), mse, kRelativeLimit * mse) << id;
    EXPECT_NEAR(score("rmse", reference, test), std::sqrt(mse), kRelativeLimit * std::sqrt(mse)) << id;
    EXPECT_NEAR(score("relmse", reference, test), relmse, kRelativeLimit * relmse) << id;
  }
}

TEST(MetricsReference, PsnrAndSsim) {
  GAZETRACE_SKIP_WITHOUT_METRICS_REFERENCE();
  const Json expected = read_reference_json("expected.json");
  for (const auto& [id, pair] : expected["ldr"].items()) {
    const MetricPicture reference{{}, reference_code(pair["reference"])};
    const MetricPicture test{{}, reference_code(pair["test"])};
    expect_psnr(pair["psnr_rgb8_db"], score("psnr", reference, test), id);
    const double ssim = pair["ssim_gauss_rgb8"];
    EXPECT_NEAR(score("ssim", reference, test), ssim, kRelativeLimit * ssim) << id;
    const double ssim_luma = pair["ssim_gauss_luma601"];
    EXPECT_NEAR(score("ssim", {{}, luma_picture(reference.code)}, {{}, luma_picture(test.code)}), ssim_luma,
                kRelativeLimit * ssim_luma)
        << id;
  }
}

TEST(MetricsReference, FramesOfTheVideos) {
  GAZETRACE_SKIP_WITHOUT_METRICS_REFERENCE();
  const Json expected = read_reference_json("expected.json");
  for (const auto& [id, video] : expected["video"].items()) {
    for (std::size_t i = 0; i < video["reference"].size(); ++i) {
      const MetricPicture reference{{}, reference_code(video["reference"][i])};
      const MetricPicture test{{}, reference_code(video["test"][i])};
      const std::string what = id + " frame " + std::to_string(i);
      EXPECT_NEAR(score("flip", reference, test), video["flip_mean_per_frame_ppd67"][i].get<double>(), 1e-5) << what;
      expect_psnr(video["psnr_rgb8_db_per_frame"][i], score("psnr", reference, test), what);
    }
  }
}

}  // namespace
}  // namespace gazetrace::metrics_reference_test
