// SPDX-License-Identifier: Apache-2.0
// What it costs to choose among many lights, and what the choice is worth: 1 to 10^5 emissive triangles over a floor
// with blocks, their powers spread over two decades, chosen by power and by the tree. Prints the time per sample (one
// thread), the relative mean squared error of a pixel at one sample (variance over independent seeds by the squared
// mean) and the efficiency 1 / (time * error) of the tree in units of the other's.
//   gazetrace_many_lights [--lights N,N,...] [--punctual] [--seeds N] [--spp N]
//   gazetrace_many_lights --scene FILE --eye X,Y,Z --target X,Y,Z [--seeds N] [--spp N]
#include <fmt/core.h>

#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <string>
#include <string_view>
#include <vector>

#include "gazetrace/scene.hpp"
#include "gazetrace/trace.hpp"
#include "lamp_city.hpp"
#include "pixel_statistics.hpp"

namespace {

using namespace gazetrace;
using namespace gazetrace::benchmark;

PixelStatistics measure_choice(const Scene& scene, const View& view, LightChoice choice, int seeds, std::uint32_t spp) {
  TracerOptions options;
  options.threads = 1;
  options.light_choice = choice;
  return measure(PathTracer(scene, options).at_rest(), TraceSettings{}, view, seeds, spp);
}

}  // namespace

int main(int argc, char** argv) {
  std::vector<double> counts{1, 2, 4, 8, 16, 32, 64, 256, 1000, 10000, 100000};
  bool punctual = false;
  int seeds = 16;
  std::uint32_t spp = 8;
  std::string file;
  View view{{14, 7, 16}, {0, 0.5, 0}};
  for (int i = 1; i < argc; ++i) {
    const std::string_view argument = argv[i];
    if (argument == "--punctual") {
      punctual = true;
    } else if (i + 1 < argc && argument == "--lights") {
      counts = parse_numbers(argv[++i]);
    } else if (i + 1 < argc && argument == "--scene") {
      file = argv[++i];
    } else if (i + 1 < argc && argument == "--eye") {
      view.eye = parse_point(argv[++i]);
    } else if (i + 1 < argc && argument == "--target") {
      view.target = parse_point(argv[++i]);
    } else if (i + 1 < argc && argument == "--seeds") {
      seeds = std::atoi(argv[++i]);
    } else if (i + 1 < argc && argument == "--spp") {
      spp = static_cast<std::uint32_t>(std::atoi(argv[++i]));
    } else {
      fmt::print(stderr, "unknown argument '{}'\n", argument);
      return 2;
    }
  }
  fmt::print("{:>8} {:>10} {:>10} {:>12} {:>12} {:>11} {:>10}\n", "lights", "power us", "tree us", "power relMSE",
             "tree relMSE", "efficiency", "mean ratio");
  const auto row = [&](double count, const Scene& scene) {
    const PixelStatistics power = measure_choice(scene, view, LightChoice::power, seeds, spp);
    const PixelStatistics tree = measure_choice(scene, view, LightChoice::tree, seeds, spp);
    const double a = relative_mse(power, tree.mean, 1);
    const double b = relative_mse(tree, tree.mean, 1);
    fmt::print("{:8} {:10.3f} {:10.3f} {:12.4g} {:12.4g} {:11.2f} {:10.4f}\n", count, power.us_per_sample,
               tree.us_per_sample, a, b, power.us_per_sample * a / (tree.us_per_sample * b),
               average(tree.mean) / average(power.mean));
  };
  if (!file.empty()) {
    const Scene scene = load_scene(file);
    row(static_cast<double>(summarize(scene).emissive_triangles + scene.lights.size()), scene);
    return 0;
  }
  for (const double count : counts) {
    row(count, city(static_cast<int>(count), punctual));
  }
  return 0;
}
