// SPDX-License-Identifier: Apache-2.0
// Meshes whose vertices move: morph targets and skins (glTF 2.0 sections 3.7.2.2 and 3.7.3).
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <vector>

#include "gazetrace/math.hpp"

namespace gazetrace {

struct Geometry;
struct TextureRef;

// The offsets that a target of weight 1 adds to every vertex. An attribute that it leaves alone is empty.
struct MorphTarget {
  std::vector<Vec3f> positions, normals, tangents;
  std::vector<Vec2f> uv0, uv1;
  std::vector<Vec4f> colors;
};

// The joints that influence each vertex: `per_vertex` of them, with weights that are not negative and sum to 1. Vertex
// i has entries i * per_vertex and those after it.
struct JointInfluences {
  std::uint32_t per_vertex = 0;  // 0: no skin
  std::vector<std::uint32_t> joints;
  std::vector<float> weights;
};

// The state of a mesh's deformation at one time.
struct MeshPose {
  std::vector<double> morph_weights;  // one per target; empty: no morphing
  // One per joint, from the mesh's space to the world (less the instance's translation): the joint's transform times
  // its inverse bind matrix. Empty: no skin.
  std::vector<Affine> joints;
  friend bool operator==(const MeshPose&, const MeshPose&) = default;
};

// The pose of an instance's mesh over time. May be called with any time; before the first and after the last keyframe
// it stands still. A skin puts vertices into the world by itself, so its instance's to_world is no more than a
// translation.
struct Deformation {
  std::function<MeshPose(std::int64_t t_video_ns)> pose_at;
  MeshPose rest;
  std::int64_t end_ns = 0;  // time of the last keyframe
};

// One entry per vertex, in the order of the geometry.
struct DeformedVertices {
  std::vector<Vec3f> positions, normals;
  std::vector<Vec4f> tangents;  // empty where the geometry has none
  // Empty where those of the geometry stay; colours are clamped to 0..1, as glTF says.
  std::vector<Vec2f> uv0, uv1;
  std::vector<Vec4f> colors;
  // Vertices that their joints mirror, and so turn inside out; empty where there are none.
  std::vector<std::uint8_t> mirrored;
  // By the majority of its corners.
  [[nodiscard]] bool is_mirrored(const std::array<std::uint32_t, 3>& triangle) const {
    return !mirrored.empty() && mirrored[triangle[0]] + mirrored[triangle[1]] + mirrored[triangle[2]] >= 2;
  }
};

// Applies morph targets, p + sum w_k dp_k (section 3.7.2.2), then linear blend skinning, sum w_j M_j p (3.7.3.3).
// Normals are transformed by the cofactors of the blended matrix; the sign of tangents turns where it mirrors. Flat
// normals, and tangents that the file leaves out, are computed anew from the new shape; `normal_texture` is that of the
// geometry's material. `threads` 0: all cores.
DeformedVertices deform(const Geometry& geometry, const MeshPose& pose, const TextureRef& normal_texture,
                        int threads = 0);

}  // namespace gazetrace
