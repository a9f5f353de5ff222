// SPDX-License-Identifier: Apache-2.0
// The library without the program: one foveated frame of a scene, stage by stage, and what it cost.
//   embed scene.gltf out.exr [u v]      (u, v: gaze as fractions of the frame)
#include <cstdio>
#include <cstdlib>
#include <string>

#include "gazetrace/color.hpp"
#include "gazetrace/error.hpp"
#include "gazetrace/foveation.hpp"
#include "gazetrace/output.hpp"
#include "gazetrace/reconstruct.hpp"
#include "gazetrace/scene.hpp"
#include "gazetrace/trace.hpp"

namespace {

int render(const std::string& scene_path, const std::string& exr_path, double u, double v) {
  using namespace gazetrace;
  Scene scene = load_scene(scene_path);
  if (!scene.environment.present()) {
    scene.environment = builtin_sky();
  }
  Camera camera;
  if (scene.cameras.empty()) {
    camera.pose = look_at({3, 2, 4}, {0, 0, 0}, {0, 1, 0});
  } else {
    const CameraPath& path = scene.cameras.front().path;
    camera.pose = path.pose_at(path.begin_ns);
    camera.projection = path.projection;
  }

  constexpr int kWidth = 320;
  constexpr int kHeight = 180;
  const DisplayGeometry display = display_by_name("paper");
  const PlanarView view = view_of_display(display, {}, kWidth, kHeight);
  const Vec3d gaze = view.direction(u * kWidth, v * kHeight);

  const SamplingMap map = make_sampling_map({}, view, gaze);
  PathTracer tracer(scene, {});
  const SparseFrame sparse = tracer.at_rest().trace(camera, 1, map, {});
  const Frame frame = Reconstruction({"linear", {}}).frame(sparse, map);

  FrameHeader header;
  header.frame = 1;
  header.camera = camera;
  write_frame_exr(exr_path, frame, nullptr, header, {});

  std::printf(
      "%llu samples for %d pixels, %llu rays, kernel %s\n", static_cast<unsigned long long>(sparse.stats.samples),
      kWidth * kHeight,
      static_cast<unsigned long long>(sparse.stats.rays_primary + sparse.stats.rays_bounce + sparse.stats.rays_shadow),
      sparse.stats.kernel.c_str());
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3 && argc != 5) {
    std::fprintf(stderr, "usage: embed scene.gltf out.exr [u v]\n");
    return 2;
  }
  try {
    return render(argv[1], argv[2], argc == 5 ? std::atof(argv[3]) : 0.5, argc == 5 ? std::atof(argv[4]) : 0.5);
  } catch (const gazetrace::Error& error) {
    std::fprintf(stderr, "embed: %s\n", error.what());
    return error.kind() == gazetrace::ErrorKind::runtime ? 3 : 2;
  }
}
