// SPDX-License-Identifier: Apache-2.0
// Compares light with that of another renderer: means over windows with those that Mitsuba 3 gave for the same files
// (tests/data/mitsuba, written by tests/benchmarks/peers/write_mitsuba_reference.py, with versions and settings).
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "render/tracer_scenes.hpp"
#include "support/chi2.hpp"
#include "support/picture_evidence.hpp"

namespace gazetrace::mitsuba_reference_test {
namespace {

using namespace test;
using nlohmann::json;

constexpr int kSeeds = 12;
constexpr std::uint32_t kSpp = 128;

const std::string& folder() {
  static const std::string path = std::string(GAZETRACE_SOURCE_DIR) + "/tests/data/mitsuba/";
  return path;
}

Vec3d vector_of(const json& a) {
  return {a[0], a[1], a[2]};
}

// Means of a frame's windows, row by row, red, green, blue of each.
std::vector<double> window_means(const SparseFrame& frame, const SamplingMap& map, int window_px) {
  const int across = map.width_px / window_px;
  const int down = map.height_px / window_px;
  std::vector<double> sums(static_cast<std::size_t>(3 * across * down));
  std::vector<PixelIndex> pixels;
  for (std::size_t i = 0; i < map.sites.size(); ++i) {
    pixels_of_site(map, map.sites[i], pixels);
    const int window = pixels[0].y / window_px * across + pixels[0].x / window_px;
    const Vec3d mean = to_double(frame.sum[i]) / frame.count[i];
    double* sum = &sums[static_cast<std::size_t>(3 * window)];
    sum[0] += mean.x;
    sum[1] += mean.y;
    sum[2] += mean.z;
  }
  for (double& sum : sums) {
    sum /= window_px * window_px;
  }
  return sums;
}

// The windows as a picture of the frame's size.
ImageRgb picture_of_windows(const std::vector<double>& means, int size_px, int window_px) {
  ImageRgb picture(size_px, size_px);
  const int across = size_px / window_px;
  for (int y = 0; y < across * window_px; ++y) {
    for (int x = 0; x < across * window_px; ++x) {
      const auto first = static_cast<std::size_t>(3 * (y / window_px * across + x / window_px));
      picture(x, y) = to_float(Vec3d{means[first], means[first + 1], means[first + 2]});
    }
  }
  return picture;
}

struct Sample {
  double mean = 0, variance_of_mean = 0;
  double count = 0;
};

Sample sample_of(const std::vector<std::vector<double>>& repeats, std::size_t window) {
  Sample result;
  result.count = static_cast<double>(repeats.size());
  for (const auto& repeat : repeats) {
    result.mean += repeat[window] / result.count;
  }
  for (const auto& repeat : repeats) {
    const double off = repeat[window] - result.mean;
    result.variance_of_mean += off * off / (result.count - 1) / result.count;
  }
  return result;
}

// Two-sided p of Welch's t with the Welch-Satterthwaite degrees of freedom.
double welch_p(const Sample& a, const Sample& b) {
  const double variance = a.variance_of_mean + b.variance_of_mean;
  if (!(variance > 0)) {
    return a.mean == b.mean ? 1 : 0;
  }
  const double t2 = (a.mean - b.mean) * (a.mean - b.mean) / variance;
  const double degrees = variance * variance /
                         (a.variance_of_mean * a.variance_of_mean / (a.count - 1) +
                          b.variance_of_mean * b.variance_of_mean / (b.count - 1));
  return incomplete_beta(0.5 * degrees, 0.5, degrees / (degrees + t2));
}

TEST(MitsubaReference, NoWindowDiffers) {
  std::ifstream file(folder() + "reference.json");
  ASSERT_TRUE(file) << folder() << "reference.json";
  const json reference = json::parse(file);
  struct Window {
    std::string scene, place;
    double p, ours, theirs, spread;
  };
  std::vector<Window> windows;
  std::map<std::string, std::pair<ImageRgb, ImageRgb>> pictures;  // by scene: ours and theirs, as means of windows
  const int size_px = reference["size_px"];
  const int window_px = reference["window_px"];
  for (const json& entry : reference["scenes"]) {
    Scene scene = load_scene(folder() + entry["file"].get<std::string>());
    if (!entry["environment"].is_null()) {
      scene.environment = load_environment(folder() + entry["environment"].get<std::string>());
    }
    PathTracer tracer(scene, threads(0));
    const Camera camera = camera_at(vector_of(entry["eye"]), vector_of(entry["target"]), entry["yfov_deg"]);
    const SamplingMap map = uniform_map(size_px, size_px, kSpp);
    TraceSettings settings;
    settings.max_bounces = entry["bounces"];
    settings.russian_roulette = false;
    settings.diffuse = entry["materials"] == "matte" ? DiffuseModel::matte : DiffuseModel::burley;
    std::vector<std::vector<double>> repeats;
    for (int s = 0; s < kSeeds; ++s) {
      settings.seed = static_cast<std::uint64_t>(s + 1);
      repeats.push_back(window_means(tracer.at_rest().trace(camera, 1, map, settings), map, window_px));
    }
    const std::vector<double> means = entry["mean"];
    const std::vector<double> errors = entry["standard_error"];
    ASSERT_EQ(means.size(), repeats[0].size());
    const std::string scene_file = entry["file"];
    std::vector<double> our_means;
    for (std::size_t w = 0; w < means.size(); ++w) {
      const Sample ours = sample_of(repeats, w);
      our_means.push_back(ours.mean);
      const Sample theirs{means[w], errors[w] * errors[w], reference["seeds"]};
      windows.push_back(
          {scene_file, scene_file + " window " + std::to_string(w / 3) + " channel " + std::to_string(w % 3),
           welch_p(ours, theirs), ours.mean, theirs.mean, std::sqrt(ours.variance_of_mean + theirs.variance_of_mean)});
    }
    pictures[scene_file] = {picture_of_windows(our_means, size_px, window_px),
                            picture_of_windows(means, size_px, window_px)};
  }
  // Holm 1979: the k-th smallest of n is held against the family's level / (n - k).
  std::sort(windows.begin(), windows.end(), [](const Window& a, const Window& b) { return a.p < b.p; });
  ASSERT_GT(windows.size(), 50U);
  for (std::size_t k = 0; k < windows.size(); ++k) {
    const Window& w = windows[k];
    if (w.p * static_cast<double>(windows.size() - k) >= kFamilyLevel) {
      break;
    }
    const auto& [ours, theirs] = pictures.at(w.scene);
    ADD_FAILURE() << w.place << ": " << w.ours << ", Mitsuba " << w.theirs << ", standard error " << w.spread << ", p "
                  << w.p << keep_pictures(ours, theirs, w.scene);
  }
  // The test must be able to see something: in the median window, differences of 0.4 % (two standard errors).
  std::vector<double> relative;
  for (const Window& w : windows) {
    relative.push_back(w.spread / w.theirs);
  }
  std::nth_element(relative.begin(), relative.begin() + static_cast<std::ptrdiff_t>(relative.size() / 2),
                   relative.end());
  RecordProperty("median_relative_error", std::to_string(relative[relative.size() / 2]));
  EXPECT_LT(relative[relative.size() / 2], 0.002) << "too noisy to mean anything";
}

}  // namespace
}  // namespace gazetrace::mitsuba_reference_test
