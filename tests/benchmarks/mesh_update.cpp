// SPDX-License-Identifier: Apache-2.0
// Fitting the tree over a deforming mesh to its new vertices against building it anew, by size and by how much the
// shape changes.
//   gazetrace_mesh_update [--rounds N]
// CPU time, since others may use the machine:
//   update  milliseconds from one shape to the next: vertices, triangles, tree (median over rounds)
//   trace   milliseconds of a frame of 320x180 with 4 spp and 3 bounces in the new shape
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <ctime>
#include <string_view>
#include <utility>
#include <vector>

#include "gazetrace/foveation.hpp"
#include "gazetrace/trace.hpp"

namespace {

using namespace gazetrace;

// A ball of about 2 side^2 triangles in the middle of a floor. Shape 1 swells it in waves ("gentle"), or turns the
// upper half against the lower one and stretches it to four times its height ("wild").
Scene ball_scene(int side, bool wild) {
  Scene scene;
  Material material;
  material.metallic = 0;
  material.base_color = {0.7F, 0.6F, 0.5F, 1};
  scene.materials = {material};
  scene.environment = builtin_sky();
  Geometry ball;
  MorphTarget shape;
  for (int j = 0; j <= side; ++j) {
    for (int i = 0; i <= side; ++i) {
      const double theta = kPi * (j + 0.01) / (side + 0.02);
      const double phi = 2 * kPi * i / side;
      const Vec3d p{std::sin(theta) * std::cos(phi), std::cos(theta), std::sin(theta) * std::sin(phi)};
      Vec3d to = p * (1 + 0.1 * std::sin(7 * phi) * std::sin(5 * theta));
      if (wild) {
        const double turn = 3 * (p.y + 1);
        to = {p.x * std::cos(turn) - p.z * std::sin(turn), 4 * p.y, p.x * std::sin(turn) + p.z * std::cos(turn)};
      }
      ball.positions.push_back(to_float(p));
      ball.normals.push_back(to_float(p));
      shape.positions.push_back(to_float(to - p));
    }
  }
  const auto n = static_cast<std::uint32_t>(side);
  for (std::uint32_t j = 0; j < n; ++j) {
    for (std::uint32_t i = 0; i < n; ++i) {
      const std::uint32_t a = j * (n + 1) + i;
      ball.triangles.push_back({a, a + 1, a + n + 2});
      ball.triangles.push_back({a, a + n + 2, a + n + 1});
    }
  }
  ball.morph_targets = {shape};
  Geometry floor;
  floor.positions = {{-9, -1, -9}, {-9, -1, 9}, {9, -1, 9}, {9, -1, -9}};
  floor.normals.assign(4, {0, 1, 0});
  floor.triangles = {{0, 1, 2}, {0, 2, 3}};
  scene.meshes = {{"ball", {ball}}, {"floor", {floor}}};
  scene.instances = {{0, {}}, {1, {}}};
  scene.instances[0].deformation = 0;
  Deformation deformation;
  // Out and back within two seconds.
  deformation.pose_at = [](std::int64_t t) {
    return MeshPose{{0.5 - 0.5 * std::cos(kPi * static_cast<double>(t) * 1e-9)}, {}};
  };
  deformation.rest = deformation.pose_at(0);
  scene.deformations = {deformation};
  return scene;
}

double ms_of(const auto& work) {
  const std::clock_t begin = std::clock();
  work();
  return 1e3 * static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;
}

double median(std::vector<double> values) {
  std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2), values.end());
  return values[values.size() / 2];
}

}  // namespace

int main(int argc, char** argv) {
  const int rounds = argc > 2 && std::string_view(argv[1]) == "--rounds" ? std::atoi(argv[2]) : 7;
  FoveationSettings uniform;
  uniform.spp = 4;
  const SamplingMap map = make_sampling_map(uniform, view_of_perspective(50 * kRadPerDeg, 320, 180), {});
  Camera camera;
  camera.pose = look_at({4, 2.5, 5}, {0, 0.3, 0}, {0, 1, 0});
  fmt::print(
      "| shape | triangles | update | update, ms | trace, ms | both, ms |\n| --- | --- | --- | --- | --- | --- |\n");
  for (const bool wild : {false, true}) {
    for (const int side : {22, 71, 224, 500}) {
      const Scene scene = ball_scene(side, wild);
      constexpr std::pair<MeshUpdate, const char*> kUpdates[] = {{MeshUpdate::refit, "refit"},
                                                                 {MeshUpdate::rebuild_low, "rebuild, low"},
                                                                 {MeshUpdate::rebuild_medium, "rebuild, medium"},
                                                                 {MeshUpdate::rebuild_high, "rebuild, high"}};
      for (const auto& [update, name] : kUpdates) {
        TracerOptions options;
        options.mesh_update = update;
        options.threads = 1;
        PathTracer tracer(scene, options);
        std::vector<double> update_ms;
        std::vector<double> trace_ms;
        for (int round = 0; round < rounds; ++round) {
          const std::int64_t t = 1'000'000'000LL + round * 20'000'000LL;
          update_ms.push_back(ms_of([&] { (void)tracer.at({t, t}); }));
          trace_ms.push_back(ms_of([&] { (void)tracer.at({t, t}).trace(camera, round, map, {}); }));
        }
        fmt::print("| {} | {} | {} | {:.2f} | {:.1f} | {:.1f} |\n", wild ? "wild" : "gentle", 2 * side * side, name,
                   median(update_ms), median(trace_ms), median(update_ms) + median(trace_ms));
        std::fflush(stdout);
      }
    }
  }
  return 0;
}
