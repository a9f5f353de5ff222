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
// Between two poses. Orientations always by slerp, the shorter way round, but for step. Positions:
//   linear       on the straight line
//   step         the earlier pose until the later one's time
//   catmull_rom  on the cubic through all keys whose velocity at a key is that of the parabola through it and its two
//                neighbors in time (at the ends: of the straight line to the only one), so uneven steps do no harm
enum class PathInterpolation { linear, step, catmull_rom };
// The order in which three Euler angles are applied about fixed axes: zxy turns about z first, then x, then y, so its
// matrix is Ry Rx Rz.
enum class RotationOrder { xyz, xzy, yxz, yzx, zxy, zyx };

// Frames per second as a fraction, so that frame times are exact integers' quotients: 24000/1001.
struct FrameRate {
  std::int64_t numerator = 24;
  std::int64_t denominator = 1;
  friend bool operator==(const FrameRate&, const FrameRate&) = default;
};
// The middle of frame `frame`, counted from 1, rounded down to a nanosecond: start + (frame - 1/2) / fps. Empty beyond
// int64, and for a rate that is not positive.
std::optional<std::int64_t> mid_frame_ns(std::int64_t frame, const FrameRate& fps, std::int64_t start_ns);

struct CameraReadOptions {
  std::string format;              // a name of `camera_formats()`; empty: by suffix and content
  std::optional<CameraAxes> axes;  // empty: the format's own; gl for CSV, TUM and EuRoC, which do not say
  PathInterpolation interpolation = PathInterpolation::linear;
  std::optional<double> yfov_rad;  // empty: what the file states, else 50 degrees
  // Of formats that count frames and know no time (Nuke, NeRF, COLMAP). Their frame n lies at the middle of the video's
  // frame n, so that every one of them is rendered as it is where the rates agree.
  FrameRate fps;
  RotationOrder rotation_order = RotationOrder::zxy;  // of Nuke's Euler angles; zxy is its own default
  // The first stamp becomes video time 0, and the first frame number frame 1, unless `keep_time`.
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

// A path of one of `camera_formats()`. Error(input) with file:line, also for quaternions whose length is not 1 within
// 1 %, for matrices that are no rotations, and for stamps that do not increase. Views that change along the path,
// shifted centres and distorted lenses are warned of: a path has one field of view.
CameraPath load_camera_path(const std::string& path, const CameraReadOptions& options);

// Where the world of a path lies in that of the scene: x' = scale * turn * (z up made y up) * x, moved so that the
// first position comes to `start_m` where that is given.
struct CameraPlacement {
  bool z_up = false;    // the path's world has z up: (x, y, z) becomes (x, z, -y)
  double turn_deg = 0;  // about +y, to the left seen from above
  double scale = 1;     // metres per unit of the path
  std::optional<Vec3d> start_m;
  friend bool operator==(const CameraPlacement&, const CameraPlacement&) = default;
};
// Error(usage) for a scale that is not positive, and for numbers that are not finite.
CameraPath place_camera(CameraPath path, const CameraPlacement& placement);

// What a camera did in numbered frames, for other programs. The suffix chooses: .chan is Nuke's (frame, position,
// Euler angles in `order`, vertical field of view, degrees), .tum and .txt are TUM's with the video time in seconds to
// the nanosecond. Every digit is kept. Error(usage) for other suffixes, Error(runtime) where it cannot be written.
struct FramePose {
  std::int32_t frame = 1;
  std::int64_t t_ns = 0;
  Camera camera;
};
void write_camera_path(const std::vector<FramePose>& frames, RotationOrder order, const std::string& path);

// Rotation by Euler angles about x, y and z, applied in `order`, and back; the second angle is then within +-90
// degrees. Where it is +-90 the first and the third turn about one axis: any pair with the right sum will do, and one
// is given.
Quatd quaternion_of_euler(const Vec3d& angles_rad, RotationOrder order);
Vec3d euler_of_quaternion(const Quatd& rotation, RotationOrder order);

}  // namespace gazetrace
