// SPDX-License-Identifier: Apache-2.0
// Makes cameras, static or moved by animations.
#include <algorithm>
#include <cmath>
#include <memory>
#include <set>
#include <utility>

#include "gazetrace/error.hpp"
#include "scene/gltf/animation.hpp"
#include "scene/gltf/node.hpp"

namespace gazetrace {
namespace {

constexpr double kFarthestMiddle_m = 1e6;  // beyond it, rays have no precision
constexpr double kMostAspect = 1e4;        // beyond it, the height of the view leaves no precision for directions

Projection projection_of(const GltfDocument& document, int camera_index, Warnings& warnings) {
  const GltfCamera& from = document.cameras[static_cast<std::size_t>(camera_index)];
  const std::string place = document.path + ": cameras[" + std::to_string(camera_index) + "]";
  Projection projection;
  projection.near_m = std::max(from.znear, 0.0);
  projection.far_m = std::max(from.zfar, 0.0);
  if (from.perspective) {
    if (!(from.yfov_rad > 0 && from.yfov_rad < kPi)) {
      throw Error(ErrorKind::input, place, "yfov " + std::to_string(from.yfov_rad) + " is not between 0 and pi");
    }
    projection.yfov_rad = from.yfov_rad;
    projection.aspect = from.aspect;
  } else {
    projection.kind = ProjectionKind::orthographic;
    projection.ymag_m = std::abs(from.ymag);
    if (!(projection.ymag_m > 0)) {
      throw Error(ErrorKind::input, place, "ymag must not be zero");
    }
    projection.aspect = std::abs(from.xmag) / projection.ymag_m;
    if (projection.aspect == 0) {
      warnings.push_back(place + ": xmag must not be zero; the width follows the frame's shape");
    }
  }
  if (!(projection.aspect >= 0 && projection.aspect <= kMostAspect)) {
    throw Error(ErrorKind::input, place, "a width of " + std::to_string(projection.aspect) + " heights is no view",
                "correct aspectRatio, or xmag and ymag");
  }
  projection.middle_m = from.middle_m;
  if (!(std::hypot(projection.middle_m.x, projection.middle_m.y) <= kFarthestMiddle_m)) {
    throw Error(ErrorKind::input, place + ".extras.gazetrace.middle_m", "is no place before a camera",
                "give two numbers in metres");
  }
  if (projection.far_m != 0 && projection.far_m <= projection.near_m) {
    throw Error(ErrorKind::input, place, "zfar is not beyond znear");
  }
  return projection;
}

CameraPath make_path(const GltfDocument& document, const std::string& name, int camera, const std::vector<int>& chain,
                     Warnings& warnings) {
  const auto nodes = std::make_shared<const std::vector<AnimatedNode>>(
      animated_chain(document, chain, "camera '" + name + "'", warnings));
  CameraPath path;
  path.source = document.path + ": camera '" + name + "'";
  path.projection = projection_of(document, camera, warnings);
  for (const AnimatedNode& node : *nodes) {
    for (const auto* track : {&node.translation_track, &node.rotation_track, &node.scale_track}) {
      if (*track) {
        const auto& times = (*track)->times_ns;
        path.begin_ns = path.is_static ? times.front() : std::min(path.begin_ns, times.front());
        path.end_ns = path.is_static ? times.back() : std::max(path.end_ns, times.back());
        path.is_static = false;
      }
    }
  }
  path.pose_at = [nodes](std::int64_t t_ns) { return pose_of_chain(*nodes, t_ns); };
  return path;
}

}  // namespace

std::vector<SceneCamera> make_cameras(const GltfDocument& document, const std::vector<WorldNode>& nodes,
                                      const std::vector<int>& parents, Warnings& warnings) {
  std::vector<SceneCamera> cameras;
  std::set<std::string> names;
  for (const WorldNode& world : nodes) {
    const GltfNode& node = document.nodes[static_cast<std::size_t>(world.node)];
    if (node.camera < 0) {
      continue;
    }
    const std::vector<int> chain = chain_to(world.node, parents);
    std::string name = node.name.empty() ? document.cameras[static_cast<std::size_t>(node.camera)].name : node.name;
    if (name.empty() || !names.insert(name).second) {
      name += "#" + std::to_string(cameras.size());
      names.insert(name);
    }
    cameras.push_back({name, make_path(document, name, node.camera, chain, warnings)});
  }
  return cameras;
}

}  // namespace gazetrace
