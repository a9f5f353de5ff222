// SPDX-License-Identifier: Apache-2.0
// What MIS compensation of the environment's density is worth: time per sample (one thread) and relative mean squared
// error of a pixel at one sample, without and with it, on a scene under a sky.
//   gazetrace_environment_mis scene.gltf sky.hdr [--eye X,Y,Z] [--target X,Y,Z] [--fov DEG] [--seeds N] [--spp N]
//       [--bounces N]
#include <fmt/core.h>

#include <cstdint>
#include <cstdlib>
#include <string>
#include <string_view>
#include <vector>

#include "gazetrace/error.hpp"
#include "gazetrace/foveation.hpp"
#include "gazetrace/scene.hpp"
#include "gazetrace/trace.hpp"

namespace {

using namespace gazetrace;

Vec3d parse_point(const char* text) {
  char* rest = nullptr;
  const double x = std::strtod(text, &rest);
  const double y = std::strtod(rest + 1, &rest);
  const double z = std::strtod(rest + 1, &rest);
  return {x, y, z};
}

struct Options {
  std::string scene, sky;
  Vec3d eye{8, 2, -0.3}, target{-8, 3, -0.3};
  double fov_deg = 50;
  int seeds = 32, bounces = 3;
  std::uint32_t spp = 4;
};

struct Measured {
  double us_per_sample = 0;
  std::vector<double> mean, variance;  // of each pixel: of a sample
};

Measured measure(const Scene& scene, const Options& options, bool compensate) {
  FoveationSettings uniform;
  uniform.uniform_spp = options.spp;
  const double yfov_rad = options.fov_deg * kRadPerDeg;
  Camera camera;
  camera.pose = look_at(options.eye, options.target, {0, 1, 0});
  camera.projection.yfov_rad = yfov_rad;
  const SamplingMap map = make_sampling_map(uniform, view_of_perspective(yfov_rad, 160, 90), {});
  TracerOptions tracer_options;
  tracer_options.threads = 1;
  const PathTracer tracer(scene, tracer_options);
  TraceSettings settings;
  settings.max_bounces = options.bounces;
  settings.compensate_environment = compensate;
  Measured result;
  result.mean.resize(map.sites.size());
  result.variance.resize(map.sites.size());
  std::int64_t cpu_ns = 0;
  std::uint64_t samples = 0;
  for (int seed = 0; seed < options.seeds; ++seed) {
    settings.seed = static_cast<std::uint64_t>(seed) + 1;
    const SparseFrame frame = tracer.trace(camera, 0, map, settings);
    for (const RegionTraceStats& region : frame.stats.regions) {
      cpu_ns += region.cpu_ns;
      samples += region.samples;
    }
    for (std::size_t i = 0; i < frame.sum.size(); ++i) {
      const double y = static_cast<double>(frame.sum[i].y) / frame.count[i];
      result.mean[i] += y;
      result.variance[i] += y * y;
    }
  }
  const double n = options.seeds;
  for (std::size_t i = 0; i < result.mean.size(); ++i) {
    result.mean[i] /= n;
    result.variance[i] = (result.variance[i] / n - result.mean[i] * result.mean[i]) * n / (n - 1) * options.spp;
  }
  result.us_per_sample = static_cast<double>(cpu_ns) * 1e-3 / static_cast<double>(samples);
  return result;
}

double average(const std::vector<double>& values) {
  double sum = 0;
  for (const double v : values) {
    sum += v;
  }
  return sum / static_cast<double>(values.size());
}

double relative_error(const Measured& measured, const std::vector<double>& mean) {
  const double typical = average(mean);
  double sum = 0;
  for (std::size_t i = 0; i < mean.size(); ++i) {
    // The floor keeps pixels that hardly anything reaches from deciding alone.
    sum += measured.variance[i] / (mean[i] * mean[i] + 0.01 * typical * typical);
  }
  return sum / static_cast<double>(mean.size());
}

int run(int argc, char** argv) {
  Options options;
  for (int i = 1; i < argc; ++i) {
    const std::string_view name = argv[i];
    if (name.substr(0, 2) != "--") {
      (options.scene.empty() ? options.scene : options.sky) = name;
      continue;
    }
    const char* value = i + 1 < argc ? argv[++i] : "";
    if (name == "--eye") {
      options.eye = parse_point(value);
    } else if (name == "--target") {
      options.target = parse_point(value);
    } else if (name == "--fov") {
      options.fov_deg = std::atof(value);
    } else if (name == "--seeds") {
      options.seeds = std::atoi(value);
    } else if (name == "--spp") {
      options.spp = static_cast<std::uint32_t>(std::atoi(value));
    } else if (name == "--bounces") {
      options.bounces = std::atoi(value);
    } else {
      throw Error(ErrorKind::usage, name, "is not known");
    }
  }
  Scene scene = load_scene(options.scene);
  scene.environment = options.sky.empty() ? builtin_sky() : load_environment(options.sky);
  const Measured plain = measure(scene, options, false);
  const Measured compensated = measure(scene, options, true);
  const double a = relative_error(plain, plain.mean);
  const double b = relative_error(compensated, plain.mean);
  fmt::print("plain       {:8.3f} us a sample, relative MSE {:8.4f}\n", plain.us_per_sample, a);
  fmt::print("compensated {:8.3f} us a sample, relative MSE {:8.4f}\n", compensated.us_per_sample, b);
  fmt::print("error {:.3f} of the plain one's, efficiency {:.3f}, mean {:.4f}\n", b / a,
             plain.us_per_sample * a / (compensated.us_per_sample * b),
             average(compensated.mean) / average(plain.mean));
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return run(argc, argv);
  } catch (const std::exception& error) {
    fmt::print(stderr, "{}\n", error.what());
    return 2;
  }
}
