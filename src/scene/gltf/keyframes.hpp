// SPDX-License-Identifier: Apache-2.0
// Keyframe tracks of glTF 2.0 (section 3.11 and appendix C), evaluated in double.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "gazetrace/camera.hpp"

namespace gazetrace {

enum class KeyInterpolation : std::uint8_t { step, linear, cubic_spline };

// Vectors (w unused) or quaternions over time. Times do not decrease; of two equal
// ones, the later holds from that time on. With cubic_spline there are three values per
// keyframe: in-tangent, value, out-tangent (tangents per second).
struct KeyTrack {
  KeyInterpolation interpolation = KeyInterpolation::linear;
  std::vector<std::int64_t> times_ns;
  std::vector<Vec4d> values;
};

// Before the first and after the last keyframe its value is held.
Vec3d vector_at(const KeyTrack& track, std::int64_t t_ns);
Quatd rotation_at(const KeyTrack& track, std::int64_t t_ns);  // linear: slerp; always of unit length

// Several numbers per keyframe, as the weights of morph targets: `width` of them, or with cubic_spline three times as
// many (all in-tangents, then all values, then all out-tangents).
struct WeightTrack {
  KeyInterpolation interpolation = KeyInterpolation::linear;
  std::size_t width = 0;
  std::vector<std::int64_t> times_ns;
  std::vector<double> values;
};
std::vector<double> weights_at(const WeightTrack& track, std::int64_t t_ns);

// A node on the chain from the root to something that moves.
struct AnimatedNode {
  bool has_matrix = false;
  Affine matrix;
  Vec3d translation{0, 0, 0}, scale{1, 1, 1};
  Quatd rotation;
  std::optional<KeyTrack> translation_track, rotation_track, scale_track;
};

Affine transform_of_node(const AnimatedNode& node, std::int64_t t_ns);  // into its parent's space
Affine transform_of_chain(const std::vector<AnimatedNode>& chain, std::int64_t t_ns);
// The pose of the last node of the chain, which looks along its -z.
CameraPose pose_of_chain(const std::vector<AnimatedNode>& chain, std::int64_t t_ns);

}  // namespace gazetrace
