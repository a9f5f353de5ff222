// SPDX-License-Identifier: Apache-2.0
// Only what a scene requires: time per sample as features are taken out of a scene one by one, with the kernel that the
// tracer chooses and, of the same scene, with everything compiled in. Rounds of both alternate; medians are printed.
//   gazetrace_feature_removal Sponza.gltf sky.hdr [--rounds N] [--spp N]
// The scene gets what it lacks first: a clearcoat on every second material, vertex colours, a shining triangle, a
// second copy far away, so that its mesh is instanced, and turns meanwhile; the camera a lens, an open shutter and a
// slide. Lens, shutter and movement are no part of a kernel: what they cost when off shows beside the row above.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <functional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "benchmark_main.hpp"
#include "gazetrace/error.hpp"
#include "gazetrace/scene.hpp"
#include "pixel_statistics.hpp"
#include "trace/kernel/kernel.hpp"

namespace {

using namespace gazetrace;
using namespace gazetrace::benchmark;

struct Step {
  std::string name;
  std::function<void(Scene&, View&)> apply;
};

// The far copy, about a vertical axis through its middle: one turn in ten seconds.
Motion turning(const Affine& place) {
  Motion motion;
  motion.end_ns = 10'000'000'000;
  motion.to_world_at = [place](std::int64_t t_ns) {
    const double half_turn_rad = kPi * static_cast<double>(t_ns) * 1e-10;
    const Quatd turn{0, std::sin(half_turn_rad), 0, std::cos(half_turn_rad)};
    return place * make_affine({}, turn, {1, 1, 1});
  };
  return motion;
}

void add_everything(Scene& scene) {
  for (std::size_t i = 0; i < scene.materials.size(); i += 2) {
    scene.materials[i].clearcoat.factor = 0.5F;
    scene.materials[i].clearcoat.roughness = 0.1F;
  }
  for (Mesh& mesh : scene.meshes) {
    for (Geometry& geometry : mesh.geometries) {
      geometry.colors.assign(geometry.positions.size(), {1, 1, 1, 1});
    }
  }
  Instance far = scene.instances.front();
  far.to_world.t.x += 1e4;
  far.motion = static_cast<std::int32_t>(scene.motions.size());
  scene.motions.push_back(turning(far.to_world));
  scene.instances.push_back(far);

  Material glow;
  glow.base_color = {0, 0, 0, 1};
  glow.emission = {50, 50, 50};
  glow.double_sided = true;
  Geometry lamp;
  lamp.positions = {{0, 6, 0}, {0.5F, 6, 0}, {0, 6, 0.5F}};
  lamp.normals.assign(3, {0, -1, 0});
  lamp.triangles = {{0, 1, 2}};
  lamp.material = static_cast<std::int32_t>(scene.materials.size());
  scene.materials.push_back(glow);
  scene.meshes.push_back({"lamp", {lamp}});
  scene.instances.push_back({static_cast<std::int32_t>(scene.meshes.size()) - 1, {}});
}

std::vector<Step> removals() {
  const auto of_each_material = [](void (*change)(Material&)) {
    return [change](Scene& scene, View&) { std::for_each(scene.materials.begin(), scene.materials.end(), change); };
  };
  return {
      {"everything", [](Scene&, View&) {}},
      {"no lens", [](Scene&, View& view) { view.lens = {}; }},
      {"a closed shutter", [](Scene&, View& view) { view.slide_m = {}; }},
      {"nothing moves", [](Scene& scene, View&) { scene.instances[scene.instances.size() - 2].motion = -1; }},
      {"no clearcoat", of_each_material([](Material& m) { m.clearcoat.factor = 0; })},
      {"no vertex colours",
       [](Scene& scene, View&) {
         for (Mesh& mesh : scene.meshes) {
           for (Geometry& geometry : mesh.geometries) {
             geometry.colors.clear();
           }
         }
       }},
      {"no shining triangle",
       [](Scene& scene, View&) {
         scene.instances.pop_back();
         scene.meshes.pop_back();
       }},
      {"no instances", [](Scene& scene, View&) { scene.instances.pop_back(); }},
      {"no alpha mask", of_each_material([](Material& m) { m.alpha_mode = AlphaMode::opaque; })},
      {"no normal maps", of_each_material([](Material& m) { m.normal_texture = {}; })},
      {"no textures", of_each_material([](Material& m) {
         m.base_color_texture = m.metallic_roughness_texture = {};
         m.base_color = {0.5F, 0.5F, 0.5F, 1};
         m.metallic = 0;
       })},
      {"a sun for the sky",
       [](Scene& scene, View&) {
         scene.environment = {};
         PunctualLight sun;
         sun.kind = LightKind::directional;
         sun.direction = {0.2F, -0.95F, 0.1F};
         scene.lights = {sun};
       }},
  };
}

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

int run(int argc, char** argv) {
  std::string path;
  std::string sky;
  int rounds = 7;
  std::uint32_t spp = 4;
  for (int i = 1; i < argc; ++i) {
    const std::string_view name = argv[i];
    if (name.substr(0, 2) != "--") {
      (path.empty() ? path : sky) = name;
    } else if (name == "--rounds" && i + 1 < argc) {
      rounds = static_cast<int>(std::strtol(argv[++i], nullptr, 10));
    } else if (name == "--spp" && i + 1 < argc) {
      spp = static_cast<std::uint32_t>(std::strtoul(argv[++i], nullptr, 10));
    } else {
      throw Error(ErrorKind::usage, name, "is not known");
    }
  }
  Scene scene = load_scene(path);
  scene.environment = sky.empty() ? builtin_sky() : load_environment(sky);
  add_everything(scene);
  View view;
  view.eye = {8, 2, -0.3};
  view.target = {-8, 3, -0.3};
  view.width_px = 480;
  view.height_px = 270;
  view.lens = {0.02, 6};
  view.slide_m = {0.1, 0, 0};
  fmt::print("{}, {} x {}, {} spp, one thread, {} rounds\n", path, view.width_px, view.height_px, spp, rounds);
  fmt::print("{:<22} {:<22} {:>12} {:>16} {:>7}\n", "scene", "kernel", "us/sample", "everything in", "ratio");
  for (const Step& step : removals()) {
    step.apply(scene, view);
    TracerOptions options;
    options.threads = 1;
    const RenderScene render_scene(scene, options);
    PathTracer chosen(scene, options);
    options.all_features = true;
    PathTracer all(scene, options);
    // The far copy turns while the shutter is open.
    const ShutterTimes times{0, length(view.slide_m) > 0 ? 20'000'000 : 0};
    std::vector<double> small;
    std::vector<double> large;
    std::vector<double> ratio;
    for (int round = 0; round < rounds; ++round) {
      small.push_back(measure(chosen.at(times), {}, view, 1, spp, round).us_per_sample);
      large.push_back(measure(all.at(times), {}, view, 1, spp, round).us_per_sample);
      ratio.push_back(large.back() / small.back());
    }
    fmt::print("{:<22} {:<22} {:12.3f} {:16.3f} {:7.3f}\n", step.name, choose_kernel(render_scene, false).name,
               median(small), median(large), median(ratio));
    std::fflush(stdout);
  }
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  return gazetrace::benchmark::benchmark_main(run, argc, argv);
}
