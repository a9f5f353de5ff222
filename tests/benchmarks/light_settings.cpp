// SPDX-License-Identifier: Apache-2.0
// Settings of light transport that trade noise for something else, on a scene under a sky: time per sample (one
// thread), relative mean squared error of a pixel's noise at one sample, and the bias, which is the change of the
// frame's mean with its standard error over the seeds. First MIS compensation of the environment, then clamping of
// indirect light.
//   gazetrace_light_settings scene.gltf sky.hdr [--eye X,Y,Z] [--target X,Y,Z] [--fov DEG] [--seeds N] [--spp N]
//       [--bounces N] [--clamp RADIANCE,...]
#include <fmt/core.h>

#include <cmath>
#include <cstdlib>
#include <exception>
#include <string>
#include <string_view>

#include "gazetrace/error.hpp"
#include "gazetrace/scene.hpp"
#include "pixel_statistics.hpp"

namespace {

using namespace gazetrace;
using namespace gazetrace::benchmark;

struct Options {
  std::string scene, sky;
  View view{{8, 2, -0.3}, {-8, 3, -0.3}};
  int seeds = 32;
  std::uint32_t spp = 4;
  std::vector<double> limits{100, 10, 3, 1};
  TraceSettings settings;
};

Options parse(int argc, char** argv) {
  Options options;
  for (int i = 1; i < argc; ++i) {
    const std::string_view name = argv[i];
    if (name.substr(0, 2) != "--") {
      (options.scene.empty() ? options.scene : options.sky) = name;
      continue;
    }
    const char* value = i + 1 < argc ? argv[++i] : "";
    if (name == "--eye") {
      options.view.eye = parse_point(value);
    } else if (name == "--target") {
      options.view.target = parse_point(value);
    } else if (name == "--fov") {
      options.view.yfov_rad = std::strtod(value, nullptr) * kRadPerDeg;
    } else if (name == "--seeds") {
      options.seeds = static_cast<int>(std::strtol(value, nullptr, 10));
    } else if (name == "--spp") {
      options.spp = static_cast<std::uint32_t>(std::strtoul(value, nullptr, 10));
    } else if (name == "--bounces") {
      options.settings.max_bounces = static_cast<int>(std::strtol(value, nullptr, 10));
    } else if (name == "--clamp") {
      options.limits = parse_numbers(value);
    } else {
      throw Error(ErrorKind::usage, name, "is not known");
    }
  }
  return options;
}

void print(const std::string& name, const PixelStatistics& measured, const PixelStatistics& plain) {
  // The same seeds: both runs' noise is largely the same, so the difference of the means is known better than either.
  const auto n = static_cast<double>(measured.frame_means.size());
  double mean = 0;
  double square = 0;
  for (std::size_t i = 0; i < measured.frame_means.size(); ++i) {
    const double change = measured.frame_means[i] - plain.frame_means[i];
    mean += change / n;
    square += change * change / n;
  }
  const double error = std::sqrt((square - mean * mean) / (n - 1));
  const double whole = average(plain.frame_means);
  const double noise = relative_mse(measured, plain.mean, 1);
  const double before = relative_mse(plain, plain.mean, 1);
  fmt::print("{:<22} {:10.3f} {:12.4f} {:11.3f} {:9.3f} +- {:.3f} %\n", name, measured.us_per_sample, noise,
             plain.us_per_sample * before / (measured.us_per_sample * noise), 100 * mean / whole, 100 * error / whole);
}

int run(int argc, char** argv) {
  const Options options = parse(argc, argv);
  Scene scene = load_scene(options.scene);
  scene.environment = options.sky.empty() ? builtin_sky() : load_environment(options.sky);
  TracerOptions one_thread;
  one_thread.threads = 1;
  const PathTracer tracer(scene, one_thread);
  const auto with = [&](bool compensate, double limit) {
    TraceSettings settings = options.settings;
    settings.compensate_environment = compensate;
    settings.clamp_indirect = limit;
    return measure(tracer, settings, options.view, options.seeds, options.spp);
  };
  fmt::print("{:<22} {:>10} {:>12} {:>11} {:>9}\n", "setting", "us/sample", "rel. MSE", "efficiency", "mean");
  const PixelStatistics plain = with(false, 0);
  print("none", plain, plain);
  print("compensated sky", with(true, 0), plain);
  for (const double limit : options.limits) {
    print(fmt::format("indirect at most {}", limit), with(false, limit), plain);
  }
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
