// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <utility>

#include "camera/path_format.hpp"
#include "core/text.hpp"
#include "gazetrace/camera.hpp"

namespace gazetrace {

#define CAMERA_FORMAT(name, ...)                 \
  double sniff_camera_##name(const CameraFile&); \
  std::vector<CameraKey> read_camera_##name(const CameraFile&, Warnings&);
#include "camera/formats/formats.def"
#undef CAMERA_FORMAT

namespace {

const std::vector<CameraFormat>& formats() {
  static const std::vector<CameraFormat> all{
#define CAMERA_FORMAT(name, text, description) {text, description, sniff_camera_##name, read_camera_##name},
#include "camera/formats/formats.def"
#undef CAMERA_FORMAT
  };
  return all;
}

const CameraFormat& choose_format(const CameraFile& file, const std::string& name) {
  std::vector<std::string> names;
  for (const CameraFormat& format : formats()) {
    if (format.name == name) {
      return format;
    }
    names.push_back(format.name);
  }
  if (!name.empty()) {
    throw Error(ErrorKind::usage, "", unknown_name_message("camera path format", name, names));
  }
  const auto best = std::max_element(formats().begin(), formats().end(),
                                     [&](const auto& a, const auto& b) { return a.sniff(file) < b.sniff(file); });
  if (!(best->sniff(file) > 0)) {
    throw Error(ErrorKind::input, file.path, "is not a camera path of a known format",
                "use CSV with a header `t[s],x[m],y[m],z[m],qx,qy,qz,qw`, or TUM with lines `t tx ty tz qx qy qz qw`");
  }
  return *best;
}

// To glTF's camera convention: the pose looks along its own -z, +y up.
CameraPose from_axes(const CameraPose& pose, CameraAxes axes) {
  const Vec3d& p = pose.position_m;
  const Quatd& q = pose.orientation;
  switch (axes) {
    case CameraAxes::gl:
      break;
    case CameraAxes::cv:
      // The same world, another naming of the camera's own axes: half a turn about x.
      return {p, q * Quatd{1, 0, 0, 0}};
    case CameraAxes::unity:
      // World and camera are both mirrored by diag(1, 1, -1): rotations about x and y turn the other way.
      return {{p.x, p.y, -p.z}, {-q.x, -q.y, q.z, q.w}};
  }
  return pose;
}

void prepare_keys(std::vector<CameraKey>& keys, const std::string& path, const CameraReadOptions& options) {
  if (keys.empty()) {
    throw Error(ErrorKind::input, path, "holds no pose",
                "give at least one line with a time, a position and a quaternion");
  }
  for (std::size_t i = 0; i < keys.size(); ++i) {
    CameraKey& key = keys[i];
    const std::string place = fmt::format("{}:{}", path, key.row);
    if (i > 0 && key.t_ns <= keys[i - 1].t_ns) {
      throw Error(ErrorKind::input, place,
                  fmt::format("time {} ns {} line {}", key.t_ns,
                              key.t_ns == keys[i - 1].t_ns ? "repeats that of" : "is before the previous one, at",
                              keys[i - 1].row),
                  "times of a camera path must increase");
    }
    const Quatd& q = key.pose.orientation;
    const double norm = std::sqrt(q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w);
    if (!(norm > 1e-6) || !std::isfinite(norm)) {
      throw Error(ErrorKind::input, place,
                  fmt::format("quaternion ({}, {}, {}, {}) has no direction", q.x, q.y, q.z, q.w),
                  "order is qx qy qz qw; no rotation is 0 0 0 1");
    }
    key.pose.orientation = normalize(q);
    key.pose = from_axes(key.pose, options.axes);
  }
}

void rebase_times(std::vector<CameraKey>& keys, const std::string& path) {
  const std::int64_t first = keys.front().t_ns;
  std::int64_t span = 0;
  if (__builtin_sub_overflow(keys.back().t_ns, first, &span)) {
    throw Error(ErrorKind::input, path, "spans more than 292 years", "check the unit of its times");
  }
  for (CameraKey& key : keys) {
    key.t_ns -= first;
  }
}

CameraPose pose_between(const std::vector<CameraKey>& keys, PathInterpolation interpolation, std::int64_t t_ns) {
  const auto after = std::upper_bound(keys.begin(), keys.end(), t_ns,
                                      [](std::int64_t t, const CameraKey& key) { return t < key.t_ns; });
  if (after == keys.begin()) {
    return keys.front().pose;
  }
  const CameraKey& a = *std::prev(after);
  if (after == keys.end() || interpolation == PathInterpolation::step || a.t_ns == t_ns) {
    return a.pose;
  }
  const CameraKey& b = *after;
  // Unsigned: the distance of two int64 stamps always fits.
  const auto since = static_cast<std::uint64_t>(t_ns) - static_cast<std::uint64_t>(a.t_ns);
  const auto span = static_cast<std::uint64_t>(b.t_ns) - static_cast<std::uint64_t>(a.t_ns);
  const double s = static_cast<double>(since) / static_cast<double>(span);
  return {a.pose.position_m * (1.0 - s) + b.pose.position_m * s, slerp(a.pose.orientation, b.pose.orientation, s)};
}

CameraPath path_of_keys(std::vector<CameraKey> keys, const std::string& source, const CameraReadOptions& options) {
  CameraPath result;
  result.source = source;
  result.projection = options.projection;
  result.is_static = keys.size() == 1;
  result.begin_ns = keys.front().t_ns;
  result.end_ns = keys.back().t_ns;
  const auto shared = std::make_shared<const std::vector<CameraKey>>(std::move(keys));
  result.pose_at = [shared, interpolation = options.interpolation](std::int64_t t_ns) {
    return pose_between(*shared, interpolation, t_ns);
  };
  return result;
}

}  // namespace

std::vector<CameraFormatInfo> camera_formats() {
  std::vector<CameraFormatInfo> infos;
  for (const CameraFormat& format : formats()) {
    infos.push_back({format.name, format.description});
  }
  return infos;
}

CameraPath camera_from_poses(const std::vector<TimedPose>& poses, const std::string& source,
                             const Projection& projection, PathInterpolation interpolation) {
  std::vector<CameraKey> keys;
  keys.reserve(poses.size());
  for (const TimedPose& pose : poses) {
    keys.push_back({pose.t_ns, pose.pose, static_cast<std::int64_t>(keys.size()) + 1});
  }
  CameraReadOptions options;
  options.interpolation = interpolation;
  options.projection = projection;
  prepare_keys(keys, source, options);
  return path_of_keys(std::move(keys), source, options);
}

CameraPath load_camera_path(const std::string& path, const CameraReadOptions& options) {
  const CameraFile file{path, read_text_file(path)};
  Warnings warnings;
  std::vector<CameraKey> keys = choose_format(file, options.format).read(file, warnings);
  prepare_keys(keys, path, options);
  if (!options.keep_time) {
    rebase_times(keys, path);
  }
  CameraPath result = path_of_keys(std::move(keys), path, options);
  result.warnings = std::move(warnings);
  return result;
}

}  // namespace gazetrace
