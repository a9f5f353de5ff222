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
  CameraKeys read_camera_##name(const CameraFile&, const CameraReadOptions&);
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

// KITTI's odometry poses, the rows of a 3x4 matrix on a line, are common and have no times; others write all 16
// numbers, and some a time in front.
void refuse_matrices(const CameraFile& file) {
  LineReader lines(file.text);
  std::vector<std::string_view> cells;
  std::string_view line;
  if (!lines.next(line)) {
    return;
  }
  split_cells(line, ' ', cells);
  const bool numbers =
      std::all_of(cells.begin(), cells.end(), [](std::string_view cell) { return number_from(cell).has_value(); });
  if (cells.size() == 12 && numbers) {
    throw Error(ErrorKind::input, file.path, "is in KITTI's form, 12 numbers of a matrix on each line without a time",
                "evo's kitti_poses_and_timestamps_to_trajectory.py makes a TUM file of it and its times.txt");
  }
  if ((cells.size() == 13 || cells.size() == 16 || cells.size() == 17) && numbers) {
    throw Error(ErrorKind::input, file.path,
                fmt::format("has matrices of {} numbers on each line{}, which no reader takes", cells.size() / 4 * 4,
                            cells.size() % 2 == 1 ? ", with a time or a number in front" : ""),
                "write TUM lines `t tx ty tz qx qy qz qw`, or transforms.json with one transform_matrix a frame");
  }
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
  refuse_matrices(file);
  const auto best = std::max_element(formats().begin(), formats().end(),
                                     [&](const auto& a, const auto& b) { return a.sniff(file) < b.sniff(file); });
  if (!(best->sniff(file) > 0)) {
    const bool scene = file.text.starts_with("glTF") || file.text.find("\"asset\"") != std::string::npos;
    throw Error(ErrorKind::input, file.path, "is not a camera path of a known format",
                scene ? "the cameras of a glTF scene, animated or not, are chosen with `camera`"
                      : fmt::format("known are {}; CSV has a header `t[s],x[m],y[m],z[m],qx,qy,qz,qw`, TUM lines "
                                    "`t tx ty tz qx qy qz qw`",
                                    fmt::join(names, ", ")));
  }
  return *best;
}

// Converts a pose to glTF's camera convention: it looks along its own -z with +y up.
CameraPose from_axes(const CameraPose& pose, CameraAxes axes) {
  const Vec3d& p = pose.position_m;
  const Quatd& q = pose.orientation;
  switch (axes) {
    case CameraAxes::gl:
      break;
    case CameraAxes::cv:
      // The world is the same, only the camera's own axes have other names: half a turn about x.
      return {p, q * Quatd{1, 0, 0, 0}};
    case CameraAxes::unity:
      // World and camera are both mirrored by diag(1, 1, -1): rotations about x and y turn the other way.
      return {{p.x, p.y, -p.z}, {-q.x, -q.y, q.z, q.w}};
  }
  return pose;
}

// Generous: rounding to four digits changes the length by about 1e-4.
constexpr double kNormTolerance = 0.01;

void prepare_keys(std::vector<CameraKey>& keys, const std::string& path, CameraAxes axes) {
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
    if (!(std::abs(norm - 1) <= kNormTolerance)) {
      throw Error(ErrorKind::input, place,
                  norm > 1e-6
                      ? fmt::format("quaternion ({}, {}, {}, {}) has length {:.4g}, not 1", q.x, q.y, q.z, q.w, norm)
                      : fmt::format("quaternion ({}, {}, {}, {}) has no direction", q.x, q.y, q.z, q.w),
                  "no rotation is x 0, y 0, z 0, w 1; check the order of its columns");
    }
    key.pose.orientation = normalize(q);
    key.pose = from_axes(key.pose, axes);
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

double step_s(const CameraKey& a, const CameraKey& b) {
  // Unsigned: the distance of two int64 stamps always fits.
  return 1e-9 * static_cast<double>(static_cast<std::uint64_t>(b.t_ns) - static_cast<std::uint64_t>(a.t_ns));
}

// The velocity at a key: that of the parabola through it and its two neighbours (Barry and Goldman 1988, with the times
// of the keys as knots); at an end, that of the line to the only neighbour.
Vec3d velocity_at(const std::vector<CameraKey>& keys, std::size_t i) {
  const auto slope = [&](std::size_t a) {
    return (keys[a + 1].pose.position_m - keys[a].pose.position_m) / step_s(keys[a], keys[a + 1]);
  };
  if (i == 0) {
    return slope(0);
  }
  if (i + 1 == keys.size()) {
    return slope(i - 1);
  }
  const double before = step_s(keys[i - 1], keys[i]);
  const double after = step_s(keys[i], keys[i + 1]);
  return (slope(i - 1) * after + slope(i) * before) / (before + after);
}

Vec3d on_spline(const std::vector<CameraKey>& keys, std::size_t i, double s) {
  const double span = step_s(keys[i], keys[i + 1]);
  const double s2 = s * s;
  const double s3 = s2 * s;
  return keys[i].pose.position_m * (2 * s3 - 3 * s2 + 1) + velocity_at(keys, i) * ((s3 - 2 * s2 + s) * span) +
         keys[i + 1].pose.position_m * (3 * s2 - 2 * s3) + velocity_at(keys, i + 1) * ((s3 - s2) * span);
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
  const auto since = static_cast<std::uint64_t>(t_ns) - static_cast<std::uint64_t>(a.t_ns);
  const auto span = static_cast<std::uint64_t>(b.t_ns) - static_cast<std::uint64_t>(a.t_ns);
  const double s = static_cast<double>(since) / static_cast<double>(span);
  const auto index = static_cast<std::size_t>(std::distance(keys.begin(), after)) - 1;
  return {interpolation == PathInterpolation::catmull_rom ? on_spline(keys, index, s)
                                                          : a.pose.position_m * (1.0 - s) + b.pose.position_m * s,
          slerp(a.pose.orientation, b.pose.orientation, s)};
}

CameraPath path_of_keys(std::vector<CameraKey> keys, const std::string& source, const Projection& projection,
                        PathInterpolation interpolation) {
  CameraPath result;
  result.source = source;
  result.projection = projection;
  result.is_static = keys.size() == 1;
  result.begin_ns = keys.front().t_ns;
  result.end_ns = keys.back().t_ns;
  const auto shared = std::make_shared<const std::vector<CameraKey>>(std::move(keys));
  result.pose_at = [shared, interpolation](std::int64_t t_ns) { return pose_between(*shared, interpolation, t_ns); };
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
  prepare_keys(keys, source, CameraAxes::gl);
  return path_of_keys(std::move(keys), source, projection, interpolation);
}

CameraPath load_camera_path(const std::string& path, const CameraReadOptions& options) {
  const CameraFile file{path, read_text_file(path)};
  CameraKeys read = choose_format(file, options.format).read(file, options);
  prepare_keys(read.keys, path, options.axes.value_or(read.axes));
  if (!options.keep_time && !read.counts_frames) {
    rebase_times(read.keys, path);
  }
  Projection projection;
  projection.yfov_rad = options.yfov_rad.value_or(read.yfov_rad.value_or(projection.yfov_rad));
  CameraPath result = path_of_keys(std::move(read.keys), path, projection, options.interpolation);
  result.warnings = std::move(read.warnings);
  return result;
}

}  // namespace gazetrace
