// SPDX-License-Identifier: Apache-2.0
// FovVideoVDP against the numbers of its authors' program: every entry of the reference set. The limits are those that
// the set's README suggests. Its single steps are fovvideovdp_test's, under the sanitizers.
#include <algorithm>
#include <cmath>

#include "gazetrace/fovvideovdp.hpp"
#include "gazetrace/output.hpp"
#include "support/metrics_reference.hpp"

namespace gazetrace::fovvideovdp_reference_test {
namespace {

using Json = nlohmann::json;

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

}  // namespace
}  // namespace gazetrace::fovvideovdp_reference_test
