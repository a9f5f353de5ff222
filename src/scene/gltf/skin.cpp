// SPDX-License-Identifier: Apache-2.0
#include "scene/gltf/skin.hpp"

#include <algorithm>
#include <map>
#include <memory>
#include <utility>

#include "gazetrace/error.hpp"
#include "scene/gltf/accessor.hpp"
#include "scene/gltf/animation.hpp"

namespace gazetrace {
namespace {

// The joints of a skin and all their parents, each after its own parent.
struct Skeleton {
  std::vector<AnimatedNode> nodes;
  std::vector<std::ptrdiff_t> parent;  // index into nodes; -1: a root
  std::vector<std::size_t> joint;      // index into nodes
  std::vector<Affine> inverse_bind;    // one per joint
};

std::vector<Affine> joints_at(const Skeleton& skeleton, std::int64_t t_ns) {
  std::vector<Affine> world(skeleton.nodes.size());
  for (std::size_t i = 0; i < world.size(); ++i) {
    const Affine local = transform_of_node(skeleton.nodes[i], t_ns);
    world[i] = skeleton.parent[i] < 0 ? local : world[static_cast<std::size_t>(skeleton.parent[i])] * local;
  }
  std::vector<Affine> joints(skeleton.joint.size());
  for (std::size_t j = 0; j < joints.size(); ++j) {
    joints[j] = world[skeleton.joint[j]] * skeleton.inverse_bind[j];
  }
  return joints;
}

std::vector<Affine> read_inverse_bind(const GltfDocument& document, const GltfSkin& skin, const std::string& place) {
  std::vector<Affine> matrices(skin.joints.size());
  if (skin.inverse_bind_matrices < 0) {
    return matrices;
  }
  const std::vector<float> m = read_floats(document, skin.inverse_bind_matrices, 16, place + ".inverseBindMatrices");
  if (m.size() < 16 * matrices.size()) {
    throw Error(ErrorKind::input, place + ".inverseBindMatrices",
                std::to_string(m.size() / 16) + " matrices for " + std::to_string(matrices.size()) + " joints",
                "export the file again");
  }
  for (std::size_t j = 0; j < matrices.size(); ++j) {
    const float* c = &m[16 * j];  // columns first; the last row is 0 0 0 1
    matrices[j] = {{c[0], c[1], c[2]}, {c[4], c[5], c[6]}, {c[8], c[9], c[10]}, {c[12], c[13], c[14]}};
  }
  return matrices;
}

Skeleton make_skeleton(const GltfDocument& document, int skin_index, const std::vector<int>& parents,
                       const std::string& label, Warnings& warnings) {
  const GltfSkin& skin = document.skins[static_cast<std::size_t>(skin_index)];
  std::vector<int> order;
  std::map<int, std::ptrdiff_t> place_of;  // not an entry for every node: there may be as many skins
  Skeleton skeleton;
  for (const int joint : skin.joints) {
    for (const int node : chain_to(joint, parents)) {
      if (place_of.try_emplace(node, static_cast<std::ptrdiff_t>(order.size())).second) {
        const int parent = parents[static_cast<std::size_t>(node)];
        skeleton.parent.push_back(parent < 0 ? -1 : place_of.at(parent));
        order.push_back(node);
      }
    }
    skeleton.joint.push_back(static_cast<std::size_t>(place_of.at(joint)));
  }
  skeleton.nodes = animated_chain(document, order, "the skin of " + label, warnings);
  skeleton.inverse_bind =
      read_inverse_bind(document, skin, document.path + ": skins[" + std::to_string(skin_index) + "]");
  return skeleton;
}

// Checks that the joints of every vertex are among those of the skin.
void check_influences(const GltfDocument& document, int node, const Mesh& mesh, std::size_t joints) {
  const int mesh_index = document.nodes[static_cast<std::size_t>(node)].mesh;
  for (const Geometry& geometry : mesh.geometries) {
    const JointInfluences& influences = geometry.influences;
    const std::string place = document.path + ": meshes[" + std::to_string(mesh_index) + "]";
    if (influences.per_vertex == 0) {
      throw Error(ErrorKind::input, place,
                  "a primitive has no JOINTS_0 and WEIGHTS_0, and nodes[" + std::to_string(node) + "] gives it a skin",
                  "bind it to the skin, or take the skin from the node, and export again");
    }
    for (std::size_t k = 0; k < influences.joints.size(); ++k) {
      if (influences.joints[k] >= joints) {
        throw Error(ErrorKind::input, place,
                    "vertex " + std::to_string(k / influences.per_vertex) + " follows joint " +
                        std::to_string(influences.joints[k]) + "; the skin of nodes[" + std::to_string(node) +
                        "] has " + std::to_string(joints),
                    "export the file again");
      }
    }
  }
}

std::size_t target_count(const Mesh& mesh) {
  std::size_t count = 0;
  for (const Geometry& geometry : mesh.geometries) {
    count = std::max(count, geometry.morph_targets.size());
  }
  return count;
}

std::vector<double> resting_weights(const GltfDocument& document, int node_index, std::size_t targets) {
  const GltfNode& node = document.nodes[static_cast<std::size_t>(node_index)];
  const GltfMesh& mesh = document.meshes[static_cast<std::size_t>(node.mesh)];
  std::vector<double> weights = node.weights.empty() ? mesh.weights : node.weights;
  if (!weights.empty() && weights.size() != targets) {
    throw Error(ErrorKind::input, document.path + ": nodes[" + std::to_string(node_index) + "].weights",
                std::to_string(weights.size()) + " weights for " + std::to_string(targets) + " morph targets",
                "export the file again");
  }
  weights.resize(targets, 0.0);
  return weights;
}

bool any_moves(const Skeleton& skeleton) {
  return std::any_of(skeleton.nodes.begin(), skeleton.nodes.end(), [](const AnimatedNode& node) {
    return node.translation_track || node.rotation_track || node.scale_track;
  });
}

// Vertices are floats, which are coarse far from the world's origin. There they count from where a joint puts the
// middle of the mesh; elsewhere from the origin.
Vec3d point_to_count_from(const Mesh& mesh, const Affine& joint) {
  constexpr double kFar_m = 100;
  Vec3d sum;
  double count = 0;
  for (const Geometry& geometry : mesh.geometries) {
    for (const Vec3f& position : geometry.positions) {
      sum += to_double(position);
    }
    count += static_cast<double>(geometry.positions.size());
  }
  const Vec3d middle = transform_point(joint, sum / std::max(count, 1.0));
  return length(middle) > kFar_m && is_finite(middle) ? middle : Vec3d{};
}

std::vector<Affine> counted_from(const Vec3d& point_m, std::vector<Affine> joints) {
  for (Affine& joint : joints) {
    joint.t = joint.t - point_m;
  }
  return joints;
}

}  // namespace

NodeDeformation deformation_of_node(const GltfDocument& document, int node, const std::vector<int>& parents,
                                    const Mesh& mesh, const std::string& label, Warnings& warnings) {
  const int skin = document.nodes[static_cast<std::size_t>(node)].skin;
  const std::size_t targets = target_count(mesh);
  if (skin < 0 && targets == 0) {
    return {};
  }
  std::shared_ptr<const Skeleton> skeleton;
  if (skin >= 0) {
    check_influences(document, node, mesh, document.skins[static_cast<std::size_t>(skin)].joints.size());
    skeleton = std::make_shared<const Skeleton>(make_skeleton(document, skin, parents, label, warnings));
  }
  MeshPose rest;
  rest.morph_weights = resting_weights(document, node, targets);
  std::optional<WeightTrack> track;
  if (targets > 0) {
    track = animated_weights(document, node, targets, label, warnings);
  }
  const bool moves = skeleton && any_moves(*skeleton);
  if (skeleton) {
    // At rest there is no animation, only the nodes' own transforms.
    Skeleton still = *skeleton;
    for (AnimatedNode& of_skeleton : still.nodes) {
      of_skeleton.translation_track.reset();
      of_skeleton.rotation_track.reset();
      of_skeleton.scale_track.reset();
    }
    rest.joints = joints_at(still, 0);
  }

  NodeDeformation result;
  if (!rest.joints.empty()) {
    result.about_m = point_to_count_from(mesh, rest.joints.front());
    rest.joints = counted_from(result.about_m, std::move(rest.joints));
  }
  if (!moves && !track) {
    const bool is_plain = !skeleton && std::all_of(rest.morph_weights.begin(), rest.morph_weights.end(),
                                                   [](double weight) { return weight == 0; });
    if (!is_plain) {
      result.fixed = std::move(rest);
    }
    return result;
  }
  const std::int64_t end_ns =
      std::max(skeleton ? last_key_ns(skeleton->nodes) : 0, track ? track->times_ns.back() : std::int64_t{0});
  result.animated = Deformation{[skeleton, track, rest, about_m = result.about_m](std::int64_t t_ns) {
                                  MeshPose pose;
                                  pose.morph_weights = track ? weights_at(*track, t_ns) : rest.morph_weights;
                                  if (skeleton) {
                                    pose.joints = counted_from(about_m, joints_at(*skeleton, t_ns));
                                  }
                                  return pose;
                                },
                                rest, end_ns};
  return result;
}

}  // namespace gazetrace
