// SPDX-License-Identifier: Apache-2.0
// Scene cameras: what is pictured. Pose and projection as functions of video time.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "gazetrace/display.hpp"
#include "gazetrace/error.hpp"
#include "gazetrace/math.hpp"

namespace gazetrace {

// Camera to world: looks along its own -z, +y up (glTF).
struct CameraPose {
  Vec3d position_m;
  Quatd orientation;
  friend bool operator==(const CameraPose&, const CameraPose&) = default;
};

// Degenerate `up` (parallel to the view, zero) falls back to the axis most across the view.
CameraPose look_at(const Vec3d& eye, const Vec3d& target, const Vec3d& up);

enum class ProjectionKind : std::uint8_t { perspective, orthographic };

struct Projection {
  ProjectionKind kind = ProjectionKind::perspective;
  double yfov_rad = 50.0 * kRadPerDeg;  // perspective: vertical field of view, 0 < yfov < pi
  double ymag_m = 1.0;                  // orthographic: half the height of the view
  // glTF's znear/zfar clip rays: [near_m, far_m]; far 0 = infinite.
  double near_m = 0.0, far_m = 0.0;
  friend bool operator==(const Projection&, const Projection&) = default;
};

// A thin lens: what lies at the focus distance is sharp; a point at distance d along the view axis blurs into a disc
// that covers 2 radius |d - focus| / (d focus) in tangents of the view angle. Shape and field of view are those of the
// projection, wherever the focus is (no breathing). Applies to orthographic views too, as a bundle of parallel axes.
struct Lens {
  double radius_m = 0;          // of the aperture; 0: a pinhole, everything is sharp
  double focus_distance_m = 1;  // from the camera to the plane in focus, along the view axis; > 0
  friend bool operator==(const Lens&, const Lens&) = default;
};

// Aperture radius of a lens with f-number N on a sensor of the given height, f / (2 N), with the focal length that
// gives the field of view at infinity: f = height / (2 tan(yfov / 2)). Radius 0 for N = 0.
double lens_radius_m(double f_number, double sensor_height_mm, double yfov_rad);

// All that ray generation needs for one frame.
struct Camera {
  CameraPose pose;  // in the middle of the frame's time
  Projection projection;
  Lens lens;
  // Poses at equal steps from opening to closing of the shutter, the first and last ones included; between two of them
  // positions are linear and orientations slerp. Empty: the camera stands still while the shutter is open.
  std::vector<CameraPose> shutter_poses;
};

// A camera over time. `pose_at` may be called with any time inside [begin_ns, end_ns].
struct CameraPath {
  std::string source;  // file, or file + camera name
  Projection projection;
  Lens lens;
  std::function<CameraPose(std::int64_t t_video_ns)> pose_at;
  bool is_static = true;  // no time dependence: every time is inside
  std::int64_t begin_ns = 0;
  std::int64_t end_ns = 0;
  Warnings warnings;
};

CameraPath static_camera(const CameraPose& pose, const Projection& projection);

// How a file names the camera's own axes. gl: -z forward, y up. cv: +z forward, y down, in the same right-handed world.
// unity: +z forward, y up, in a left-handed world; world and camera are mirrored by (x, y, z) -> (x, y, -z).
enum class CameraAxes { gl, cv, unity };
enum class CameraExtrapolation { error, hold };
enum class PathInterpolation { linear, step };  // linear: positions linear, orientations slerp

struct CameraReadOptions {
  std::string format;  // a name of `camera_formats()`; empty: by suffix and content
  CameraAxes axes = CameraAxes::gl;
  PathInterpolation interpolation = PathInterpolation::linear;
  Projection projection;  // poses files carry none
  // First stamp becomes video time 0 unless `keep_time`.
  bool keep_time = false;
};

// A path from poses with increasing times. Error(input) at `source` for none, and for times that do not increase.
struct TimedPose {
  std::int64_t t_ns = 0;
  CameraPose pose;
};
CameraPath camera_from_poses(const std::vector<TimedPose>& poses, const std::string& source,
                             const Projection& projection, PathInterpolation interpolation);

struct CameraFormatInfo {
  std::string name;
  std::string description;
};
std::vector<CameraFormatInfo> camera_formats();

// A timestamped path: gazetrace CSV (`t[s],x[m],y[m],z[m],qx,qy,qz,qw`, t also [ns|us|ms]) or TUM
// (`t tx ty tz qx qy qz qw`, seconds, `#` comments). Error(input) with file:line.
CameraPath load_camera_path(const std::string& path, const CameraReadOptions& options);

}  // namespace gazetrace
