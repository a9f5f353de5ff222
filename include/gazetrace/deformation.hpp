// SPDX-License-Identifier: Apache-2.0
// Meshes whose vertices move: morph targets and skins (glTF 2.0 sections 3.7.2.2 and 3.7.3).
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "gazetrace/math.hpp"

namespace gazetrace {

struct Geometry;
struct TextureRef;

// What a target of weight 1 adds to every vertex; empty where it leaves an attribute alone.
struct MorphTarget {
  std::vector<Vec3f> positions, normals, tangents;
};

// The joints that pull at each vertex: `per_vertex` of them, with weights that are not negative and sum to 1.
struct JointInfluences {
  std::uint32_t per_vertex = 0;  // 0: no skin
  std::vector<std::uint32_t> joints;
  std::vector<float> weights;
};

// What shapes a mesh at one time.
struct MeshPose {
  std::vector<double> morph_weights;  // one a target; empty: none
  // One a joint, from the mesh's space to the world: the joint's place times its inverse bind matrix. Empty: no skin.
  std::vector<Affine> joints;
  friend bool operator==(const MeshPose&, const MeshPose&) = default;
};

// The pose of an instance's mesh over time. May be called with any time; before the first and after the last key of the
// animation it holds. A skin puts vertices into the world by itself: its instance's to_world is the identity.
struct Deformation {
  std::function<MeshPose(std::int64_t t_video_ns)> pose_at;
  MeshPose rest;
  std::int64_t end_ns = 0;  // of the last key
};

// In the order of the geometry's vertices.
struct DeformedVertices {
  std::vector<Vec3f> positions, normals;
  std::vector<Vec4f> tangents;  // empty where the geometry has none
};

// Morph targets first: p + sum w_k dp_k (section 3.7.2.2), then linear blend skinning: sum w_j M_j p (3.7.3.3). Normals
// go with the cofactors of the blended matrix. Flat normals, and tangents that the file leaves out, are made anew from
// the new shape; `normal_texture` is the one of the geometry's material. Vertices are spread over `threads` (0: all).
DeformedVertices deform(const Geometry& geometry, const MeshPose& pose, const TextureRef& normal_texture,
                        int threads = 0);

// Whether the joints turn a mesh inside out: the first one of them does.
bool is_mirrored(const MeshPose& pose);

}  // namespace gazetrace
