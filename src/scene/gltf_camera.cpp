// SPDX-License-Identifier: Apache-2.0
// Cameras and the animations that move them.
#include <algorithm>
#include <cmath>
#include <memory>
#include <set>
#include <utility>

#include "gazetrace/error.hpp"
#include "scene/gltf_accessor.hpp"
#include "scene/gltf_node.hpp"
#include "scene/keyframes.hpp"

namespace gazetrace {
namespace {

constexpr double kMaxTimeS = 9e9;  // int64 nanoseconds end at 9.2e9 s

std::string animation_place(const GltfDocument& document, std::size_t animation, int sampler) {
  return document.path + ": animations[" + std::to_string(animation) + "].samplers[" + std::to_string(sampler) + "]";
}

std::vector<std::int64_t> read_times(const GltfDocument& document, int accessor, const std::string& place) {
  std::vector<std::int64_t> times_ns;
  for (const float time_s : read_floats(document, accessor, 1, place)) {
    if (std::abs(static_cast<double>(time_s)) > kMaxTimeS) {
      throw Error(ErrorKind::input, place, "a key time of " + std::to_string(time_s) + " s is out of range");
    }
    times_ns.push_back(std::llround(static_cast<double>(time_s) * 1e9));
    if (times_ns.size() > 1 && times_ns.back() <= times_ns[times_ns.size() - 2]) {
      throw Error(ErrorKind::input, place,
                  "key " + std::to_string(times_ns.size() - 1) + " is not after the one before it",
                  "export the file again");
    }
  }
  return times_ns;
}

KeyTrack read_track(const GltfDocument& document, std::size_t animation, int sampler_index, int components) {
  const auto& sampler = document.animations[animation].samplers[static_cast<std::size_t>(sampler_index)];
  const std::string place = animation_place(document, animation, sampler_index);
  KeyTrack track;
  if (sampler.interpolation == "STEP") {
    track.interpolation = KeyInterpolation::step;
  } else if (sampler.interpolation == "CUBICSPLINE") {
    track.interpolation = KeyInterpolation::cubic_spline;
  } else if (sampler.interpolation != "LINEAR") {
    throw Error(ErrorKind::input, place, "interpolation '" + sampler.interpolation + "' does not exist",
                "use STEP, LINEAR or CUBICSPLINE");
  }
  track.times_ns = read_times(document, sampler.input, place + ".input");
  const std::vector<float> values = read_floats(document, sampler.output, components, place + ".output");
  const auto width = static_cast<std::size_t>(components);
  const std::size_t a_key = track.interpolation == KeyInterpolation::cubic_spline ? 3 : 1;
  if (values.size() != track.times_ns.size() * a_key * width) {
    throw Error(ErrorKind::input, place + ".output",
                std::to_string(values.size() / width) + " values for " + std::to_string(track.times_ns.size()) +
                    " keys, " + std::to_string(track.times_ns.size() * a_key) + " are needed",
                "export the file again");
  }
  for (std::size_t i = 0; i < values.size(); i += width) {
    track.values.push_back({values[i], values[i + 1], values[i + 2], components == 4 ? values[i + 3] : 0.0});
  }
  return track;
}

Projection projection_of(const GltfDocument& document, int camera_index) {
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
  } else {
    projection.kind = ProjectionKind::orthographic;
    projection.ymag_m = std::abs(from.ymag);
    if (!(projection.ymag_m > 0)) {
      throw Error(ErrorKind::input, place, "ymag must not be zero");
    }
  }
  if (projection.far_m != 0 && projection.far_m <= projection.near_m) {
    throw Error(ErrorKind::input, place, "zfar is not beyond znear");
  }
  return projection;
}

// Nodes from the root to `node`.
std::vector<int> chain_to(int node, const std::vector<int>& parents) {
  std::vector<int> chain;
  for (int at = node; at >= 0; at = parents[static_cast<std::size_t>(at)]) {
    chain.push_back(at);
  }
  std::reverse(chain.begin(), chain.end());
  return chain;
}

bool moves_nodes(const std::string& path) {
  return path == "translation" || path == "rotation" || path == "scale";
}

AnimatedNode rest_of(const GltfNode& node) {
  AnimatedNode result;
  result.has_matrix = node.has_matrix;
  result.matrix = node.matrix;
  result.translation = node.translation;
  result.rotation = node.rotation;
  result.scale = node.scale;
  return result;
}

// The first animation with a channel on the chain; a second one is another take, not more of the same.
std::optional<std::size_t> animation_of(const GltfDocument& document, const std::vector<int>& chain,
                                        const std::string& camera, Warnings& warnings) {
  std::optional<std::size_t> chosen;
  for (std::size_t a = 0; a < document.animations.size(); ++a) {
    const auto& channels = document.animations[a].channels;
    const bool moves = std::any_of(channels.begin(), channels.end(), [&](const GltfAnimation::Channel& channel) {
      return moves_nodes(channel.path) && std::find(chain.begin(), chain.end(), channel.node) != chain.end();
    });
    if (moves && chosen) {
      warnings.push_back("camera '" + camera + "' is moved by several animations; '" +
                         animation_name(document, *chosen) + "' is used, '" + animation_name(document, a) + "' is not");
    } else if (moves) {
      chosen = a;
    }
  }
  return chosen;
}

void add_tracks(const GltfDocument& document, std::size_t animation, const std::vector<int>& chain,
                std::vector<AnimatedNode>& nodes, Warnings& warnings) {
  for (const GltfAnimation::Channel& channel : document.animations[animation].channels) {
    const auto at = std::find(chain.begin(), chain.end(), channel.node);
    if (at == chain.end() || !moves_nodes(channel.path)) {
      continue;
    }
    AnimatedNode& node = nodes[static_cast<std::size_t>(at - chain.begin())];
    if (node.has_matrix) {
      warnings.push_back("nodes[" + std::to_string(channel.node) +
                         "] is animated and has a matrix, which glTF forbids; it stays at rest");
    } else if (channel.path == "translation") {
      node.translation_track = read_track(document, animation, channel.sampler, 3);
    } else if (channel.path == "rotation") {
      node.rotation_track = read_track(document, animation, channel.sampler, 4);
    } else {
      node.scale_track = read_track(document, animation, channel.sampler, 3);
    }
  }
}

CameraPath make_path(const GltfDocument& document, const std::string& name, int camera, const std::vector<int>& chain,
                     Warnings& warnings) {
  auto nodes = std::make_shared<std::vector<AnimatedNode>>();
  for (const int index : chain) {
    nodes->push_back(rest_of(document.nodes[static_cast<std::size_t>(index)]));
  }
  if (const auto animation = animation_of(document, chain, name, warnings)) {
    add_tracks(document, *animation, chain, *nodes, warnings);
  }
  CameraPath path;
  path.source = document.path + ": camera '" + name + "'";
  path.projection = projection_of(document, camera);
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

// True where something besides cameras hangs on a node. The document was checked: nodes form trees.
bool carries_more_than_cameras(const GltfDocument& document, int node) {
  const GltfNode& from = document.nodes[static_cast<std::size_t>(node)];
  return from.mesh >= 0 || from.light >= 0 || std::any_of(from.children.begin(), from.children.end(), [&](int child) {
           return carries_more_than_cameras(document, child);
         });
}

// What animations move besides cameras is shown at rest.
void list_other_motion(const GltfDocument& document, const std::set<int>& camera_nodes,
                       std::vector<std::string>& ignored, Warnings& warnings) {
  for (std::size_t a = 0; a < document.animations.size(); ++a) {
    std::size_t moved = 0;
    std::size_t morphed = 0;
    for (const GltfAnimation::Channel& channel : document.animations[a].channels) {
      morphed += channel.path == "weights" ? 1 : 0;
      moved += moves_nodes(channel.path) && channel.node >= 0 &&
                       (!camera_nodes.contains(channel.node) || carries_more_than_cameras(document, channel.node))
                   ? 1
                   : 0;
    }
    if (moved + morphed > 0) {
      ignored.push_back("animation '" + animation_name(document, a) + "': " + std::to_string(moved) +
                        " channels move more than cameras, " + std::to_string(morphed) + " change morph weights");
      warnings.push_back("animation '" + animation_name(document, a) +
                         "' moves more than cameras; everything but cameras is shown at rest");
    }
  }
}

}  // namespace

std::string animation_name(const GltfDocument& document, std::size_t index) {
  const std::string& name = document.animations[index].name;
  return name.empty() ? "#" + std::to_string(index) : name;
}

std::vector<SceneCamera> make_cameras(const GltfDocument& document, const std::vector<WorldNode>& nodes,
                                      const std::vector<int>& parents, std::vector<std::string>& ignored,
                                      Warnings& warnings) {
  std::vector<SceneCamera> cameras;
  std::set<std::string> names;
  std::set<int> camera_nodes;
  for (const WorldNode& world : nodes) {
    const GltfNode& node = document.nodes[static_cast<std::size_t>(world.node)];
    if (node.camera < 0) {
      continue;
    }
    const std::vector<int> chain = chain_to(world.node, parents);
    camera_nodes.insert(chain.begin(), chain.end());
    std::string name = node.name.empty() ? document.cameras[static_cast<std::size_t>(node.camera)].name : node.name;
    if (name.empty() || !names.insert(name).second) {
      name += "#" + std::to_string(cameras.size());
      names.insert(name);
    }
    cameras.push_back({name, make_path(document, name, node.camera, chain, warnings)});
  }
  list_other_motion(document, camera_nodes, ignored, warnings);
  return cameras;
}

}  // namespace gazetrace
