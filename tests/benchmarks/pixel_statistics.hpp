// SPDX-License-Identifier: Apache-2.0
// Time, noise and bias of an estimator: mean and variance of every pixel over independent seeds, on one thread.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <numeric>
#include <vector>

#include "gazetrace/camera.hpp"
#include "gazetrace/foveation.hpp"
#include "gazetrace/trace.hpp"

namespace gazetrace::benchmark {

struct View {
  Vec3d eye, target;
  double yfov_rad = 50 * kRadPerDeg;
  int width_px = 160, height_px = 90;
  Lens lens{};
  Vec3d slide_m{};  // of the camera while the shutter is open
};

struct PixelStatistics {
  double us_per_sample = 0;
  std::uint32_t spp = 0;
  int seeds = 0;
  std::vector<double> mean, variance;  // of each pixel's G; the variance is that of one sample
  std::vector<double> frame_means;     // of each seed
};

inline double average(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

// With the seeds first_seed, first_seed + 1, ...
inline PixelStatistics measure(const PosedScene& scene, TraceSettings settings, const View& view, int seeds,
                               std::uint32_t spp, int first_seed = 1) {
  FoveationSettings uniform;
  uniform.spp = spp;
  Camera camera;
  camera.pose = look_at(view.eye, view.target, {0, 1, 0});
  camera.projection.yfov_rad = view.yfov_rad;
  camera.lens = view.lens;
  if (length(view.slide_m) > 0) {
    camera.shutter_poses = {camera.pose, camera.pose};
    camera.shutter_poses.back().position_m = view.eye + view.slide_m;
  }
  const SamplingMap map =
      make_sampling_map(uniform, view_of_perspective(view.yfov_rad, view.width_px, view.height_px), {});
  PixelStatistics result;
  result.spp = spp;
  result.seeds = seeds;
  result.mean.resize(map.sites.size());
  result.variance.resize(map.sites.size());
  std::int64_t cpu_ns = 0;
  std::uint64_t samples = 0;
  for (int seed = first_seed; seed < first_seed + seeds; ++seed) {
    settings.seed = static_cast<std::uint64_t>(seed);
    const SparseFrame frame = scene.trace(camera, 0, map, settings);
    for (const RegionTraceStats& region : frame.stats.regions) {
      cpu_ns += region.cpu_ns;
      samples += region.samples;
    }
    double sum = 0;
    for (std::size_t i = 0; i < frame.sum.size(); ++i) {
      const double y = static_cast<double>(frame.sum[i].y) / frame.count[i];
      result.mean[i] += y;
      result.variance[i] += y * y;
      sum += y;
    }
    result.frame_means.push_back(sum / static_cast<double>(frame.sum.size()));
  }
  const double n = seeds;
  for (std::size_t i = 0; i < result.mean.size(); ++i) {
    result.mean[i] /= n;
    result.variance[i] = (result.variance[i] / n - result.mean[i] * result.mean[i]) * n / (n - 1) * spp;
  }
  result.us_per_sample = static_cast<double>(cpu_ns) * 1e-3 / static_cast<double>(samples);
  return result;
}

// Mean over the pixels of their squared error at `spp` samples by the squared true mean. Pixels that hardly anything
// reaches must not decide alone: a hundredth of the frame's squared mean is added below.
inline double relative_mse(const PixelStatistics& measured, const std::vector<double>& truth, std::uint32_t spp) {
  const double typical = average(truth);
  double sum = 0;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    sum += measured.variance[i] / spp / (truth[i] * truth[i] + 0.01 * typical * typical);
  }
  return sum / static_cast<double>(truth.size());
}

// "1,2.5,-3"; stops at what is no number.
inline std::vector<double> parse_numbers(const char* text) {
  std::vector<double> list;
  for (char* rest = nullptr;; text = rest + 1) {
    const double value = std::strtod(text, &rest);
    if (rest == text) {
      return list;
    }
    list.push_back(value);
    if (*rest != ',') {
      return list;
    }
  }
}
inline Vec3d parse_point(const char* text) {
  const std::vector<double> list = parse_numbers(text);
  return list.size() == 3 ? Vec3d{list[0], list[1], list[2]} : Vec3d{};
}

}  // namespace gazetrace::benchmark
