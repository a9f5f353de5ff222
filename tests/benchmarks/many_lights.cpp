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

#include "core/hash.hpp"
#include "gazetrace/scene.hpp"
#include "gazetrace/trace.hpp"
#include "pixel_statistics.hpp"

namespace {

using namespace gazetrace;
using namespace gazetrace::benchmark;

class Random {
 public:
  float operator()(float low, float high) {
    state_ += 0x9e3779b97f4a7c15ULL;
    return low + (high - low) * static_cast<float>(hash64(state_) >> 40U) * 0x1p-24F;
  }

 private:
  std::uint64_t state_ = 1;
};

void add_box(Geometry& geometry, const Vec3f& low, const Vec3f& high) {
  const auto first = static_cast<std::uint32_t>(geometry.positions.size());
  for (unsigned corner = 0; corner < 8; ++corner) {
    geometry.positions.push_back({(corner & 1U) != 0 ? high.x : low.x, (corner & 2U) != 0 ? high.y : low.y,
                                  (corner & 4U) != 0 ? high.z : low.z});
  }
  constexpr std::uint32_t kFaces[6][4] = {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4},
                                          {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}};
  for (const auto& face : kFaces) {
    geometry.triangles.push_back({first + face[0], first + face[1], first + face[2]});
    geometry.triangles.push_back({first + face[0], first + face[2], first + face[3]});
  }
}

// 40 x 40 m with 60 blocks; the lights hang between 0.3 and 6 m, all of them together of the same power whatever their
// number.
Scene city(int lights, bool punctual) {
  Scene scene;
  Material gray;
  gray.base_color = {0.6F, 0.6F, 0.6F, 1};
  gray.metallic = 0;
  gray.roughness = 0.7F;
  scene.materials.push_back(gray);
  Geometry blocks;
  add_box(blocks, {-20, -0.1F, -20}, {20, 0, 20});
  Random random;
  for (int i = 0; i < 60; ++i) {
    const Vec3f at{random(-19, 19), 0, random(-19, 19)};
    add_box(blocks, at, at + Vec3f{random(0.5F, 2), random(0.5F, 4), random(0.5F, 2)});
  }
  scene.meshes.push_back({"", {blocks}});
  for (int i = 0; i < lights; ++i) {
    const Vec3f at{random(-20, 20), random(0.3F, 6), random(-20, 20)};
    const float strength = 3000.0F / static_cast<float>(lights) * std::pow(100.0F, random(-0.5F, 0.5F));
    const Vec3f color{strength * random(0.5F, 1), strength * random(0.5F, 1), strength * random(0.5F, 1)};
    if (punctual) {
      PunctualLight light;
      light.kind = i % 2 == 0 ? LightKind::point : LightKind::spot;
      light.position_m = at;
      light.intensity = color * 0.02F;
      light.direction = {random(-1, 1), -1, random(-1, 1)};
      scene.lights.push_back(light);
      continue;
    }
    // One of 16 materials, so that a light is a triangle and not a mesh with a material of its own.
    if (i < 16) {
      Material shining = gray;
      shining.emission = color * 40.0F;
      scene.materials.push_back(shining);
      scene.meshes[0].geometries.emplace_back().material = i + 1;
    }
    Geometry& geometry = scene.meshes[0].geometries[1 + static_cast<std::size_t>(i % 16)];
    const auto first = static_cast<std::uint32_t>(geometry.positions.size());
    const auto side = [&] { return Vec3f{random(-0.1F, 0.1F), random(-0.1F, 0.1F), random(-0.1F, 0.1F)}; };
    geometry.positions.insert(geometry.positions.end(), {at, at + side(), at + side()});
    geometry.triangles.push_back({first, first + 1, first + 2});
  }
  scene.instances = {{0, {}}};
  return scene;
}

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
