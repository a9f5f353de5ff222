// SPDX-License-Identifier: Apache-2.0
// A scene under a sky as benchmarks take it from the command line, and from where it is looked at.
#pragma once

#include <algorithm>
#include <cstdlib>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "gazetrace/camera.hpp"
#include "gazetrace/error.hpp"
#include "gazetrace/scene.hpp"
#include "pixel_statistics.hpp"

namespace gazetrace::benchmark {

struct Viewpoint {
  Vec3d eye, target;
  double fov_deg = 50;  // vertical
};

inline Camera camera_at(const Viewpoint& from) {
  Camera camera;
  camera.pose = look_at(from.eye, from.target, {0, 1, 0});
  camera.projection.yfov_rad = from.fov_deg * kRadPerDeg;
  return camera;
}

struct World {
  std::string name;  // of the file, without folder and suffix
  Scene scene;
  Camera camera;
};

// "SCENE.gltf", "SCENE.gltf=SKY.hdr" or "SCENE.gltf=constant:R,G,B", seen by the scene's first camera or, where it has
// none, from the viewpoint.
inline World load_world(const std::string& text, const std::optional<Viewpoint>& from) {
  World world;
  const std::size_t equals = text.find('=');
  world.name = text.substr(0, equals);
  world.scene = load_scene(world.name);
  if (equals != std::string::npos) {
    constexpr std::string_view kConstant = "constant:";
    const std::string sky = text.substr(equals + 1);
    if (sky.starts_with(kConstant)) {
      const Vec3d radiance = parse_point(sky.c_str() + kConstant.size());
      world.scene.environment = constant_environment(
          {static_cast<float>(radiance.x), static_cast<float>(radiance.y), static_cast<float>(radiance.z)});
    } else {
      world.scene.environment = load_environment(sky);
    }
  }
  world.name = world.name.substr(world.name.find_last_of('/') + 1);
  world.name = world.name.substr(0, world.name.find_last_of('.'));
  if (!world.scene.cameras.empty()) {
    const CameraPath& path = world.scene.cameras.front().path;
    world.camera.pose = path.pose_at(path.begin_ns);
    world.camera.projection = path.projection;
  } else if (from) {
    world.camera = camera_at(*from);
  } else {
    throw Error(ErrorKind::usage, world.name, "the scene has no camera", "give --eye and --target");
  }
  return world;
}

struct FrameSize {
  int width_px = 0, height_px = 0;
};
inline FrameSize parse_size(const char* text) {  // "960x540"
  char* rest = nullptr;
  FrameSize size;
  size.width_px = static_cast<int>(std::strtol(text, &rest, 10));
  size.height_px = *rest == 'x' ? static_cast<int>(std::strtol(rest + 1, nullptr, 10)) : 0;
  if (size.width_px <= 0 || size.height_px <= 0) {
    throw Error(ErrorKind::usage, text, "is no size", "write it as 960x540");
  }
  return size;
}

inline std::vector<std::string> parse_names(std::string_view text) {  // "a,b,c"
  std::vector<std::string> names;
  while (!text.empty()) {
    const std::size_t comma = std::min(text.find(','), text.size());
    names.emplace_back(text.substr(0, comma));
    text.remove_prefix(std::min(comma + 1, text.size()));
  }
  return names;
}

}  // namespace gazetrace::benchmark
