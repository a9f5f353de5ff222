// SPDX-License-Identifier: Apache-2.0
#include "scene/gltf/keyframes.hpp"

#include <algorithm>
#include <cstddef>

#include "scene/gltf/node.hpp"

namespace gazetrace {
namespace {

struct Span {
  std::size_t first = 0, second = 0;  // equal where the time is outside the keyframes
  double fraction = 0;                // 0..1 from first to second
  double length_s = 0;
};

Span span_at(const std::vector<std::int64_t>& times, std::int64_t t_ns) {
  const auto second = static_cast<std::size_t>(std::upper_bound(times.begin(), times.end(), t_ns) - times.begin());
  if (second == 0) {
    return {0, 0, 0, 0};
  }
  if (second == times.size() || times[second - 1] == t_ns) {  // of two keys at this time, the later one
    return {second - 1, second - 1, 0, 0};
  }
  const auto length_ns = static_cast<double>(times[second] - times[second - 1]);
  return {second - 1, second, static_cast<double>(t_ns - times[second - 1]) / length_ns, length_ns * 1e-9};
}

Vec4d combine(double a, const Vec4d& p, double b, const Vec4d& q) {
  return {a * p.x + b * q.x, a * p.y + b * q.y, a * p.z + b * q.z, a * p.w + b * q.w};
}

// The value at a keyframe, without its tangents.
const Vec4d& key_value(const KeyTrack& track, std::size_t key) {
  return track.interpolation == KeyInterpolation::cubic_spline ? track.values[3 * key + 1] : track.values[key];
}

// The Hermite basis; tangents are scaled by the length of the interval (glTF 2.0 appendix C.4).
struct Hermite {
  double p0, out0, in1, p1;
};
Hermite hermite(const Span& span) {
  const double u = span.fraction;
  const double u2 = u * u;
  const double u3 = u2 * u;
  return {2 * u3 - 3 * u2 + 1, span.length_s * (u3 - 2 * u2 + u), span.length_s * (u3 - u2), -2 * u3 + 3 * u2};
}

Vec4d cubic(const KeyTrack& track, const Span& span) {
  const Hermite basis = hermite(span);
  const Vec4d& p0 = track.values[3 * span.first + 1];
  const Vec4d& out0 = track.values[3 * span.first + 2];
  const Vec4d& in1 = track.values[3 * span.second];
  const Vec4d& p1 = track.values[3 * span.second + 1];
  return combine(1, combine(basis.p0, p0, basis.p1, p1), 1, combine(basis.out0, out0, basis.in1, in1));
}

Quatd as_quaternion(const Vec4d& v) {
  return normalize(Quatd{v.x, v.y, v.z, v.w});
}

}  // namespace

Vec3d vector_at(const KeyTrack& track, std::int64_t t_ns) {
  const Span span = span_at(track.times_ns, t_ns);
  Vec4d value = key_value(track, span.first);
  if (span.first != span.second && track.interpolation == KeyInterpolation::linear) {
    value = combine(1 - span.fraction, value, span.fraction, key_value(track, span.second));
  } else if (span.first != span.second && track.interpolation == KeyInterpolation::cubic_spline) {
    value = cubic(track, span);
  }
  return {value.x, value.y, value.z};
}

Quatd rotation_at(const KeyTrack& track, std::int64_t t_ns) {
  const Span span = span_at(track.times_ns, t_ns);
  const Quatd first = as_quaternion(key_value(track, span.first));
  if (span.first == span.second || track.interpolation == KeyInterpolation::step) {
    return first;
  }
  if (track.interpolation == KeyInterpolation::linear) {
    return slerp(first, as_quaternion(key_value(track, span.second)), span.fraction);
  }
  return as_quaternion(cubic(track, span));
}

std::vector<double> weights_at(const WeightTrack& track, std::int64_t t_ns) {
  const Span span = span_at(track.times_ns, t_ns);
  const bool is_cubic = track.interpolation == KeyInterpolation::cubic_spline;
  // Parts 0, 1 and 2 of a keyframe are its in-tangents, values and out-tangents.
  const auto value = [&](std::size_t key, std::size_t part, std::size_t i) {
    return track.values[(is_cubic ? 3 * key + part : key) * track.width + i];
  };
  std::vector<double> weights(track.width);
  const Hermite basis = hermite(span);
  for (std::size_t i = 0; i < weights.size(); ++i) {
    const double first = value(span.first, 1, i);
    weights[i] = first;
    if (span.first != span.second && track.interpolation == KeyInterpolation::linear) {
      weights[i] = (1 - span.fraction) * first + span.fraction * value(span.second, 1, i);
    } else if (span.first != span.second && is_cubic) {
      weights[i] = basis.p0 * first + basis.out0 * value(span.first, 2, i) + basis.in1 * value(span.second, 0, i) +
                   basis.p1 * value(span.second, 1, i);
    }
  }
  return weights;
}

namespace {

Quatd own_rotation_at(const AnimatedNode& node, std::int64_t t_ns) {
  return node.rotation_track ? rotation_at(*node.rotation_track, t_ns) : node.rotation;
}

}  // namespace

Affine transform_of_node(const AnimatedNode& node, std::int64_t t_ns) {
  if (node.has_matrix) {
    return node.matrix;
  }
  const Vec3d translation = node.translation_track ? vector_at(*node.translation_track, t_ns) : node.translation;
  const Vec3d scale = node.scale_track ? vector_at(*node.scale_track, t_ns) : node.scale;
  return make_affine(translation, own_rotation_at(node, t_ns), scale);
}

Affine transform_of_chain(const std::vector<AnimatedNode>& chain, std::int64_t t_ns) {
  Affine world;
  for (const AnimatedNode& node : chain) {
    world = world * transform_of_node(node, t_ns);
  }
  return world;
}

CameraPose pose_of_chain(const std::vector<AnimatedNode>& chain, std::int64_t t_ns) {
  Affine world;
  Quatd turned;
  for (const AnimatedNode& node : chain) {
    world = world * transform_of_node(node, t_ns);
    turned = turned * (node.has_matrix ? rotation_or(node.matrix, Quatd{}) : own_rotation_at(node, t_ns));
  }
  return {world.t, rotation_or(world, normalize(turned))};
}

}  // namespace gazetrace
