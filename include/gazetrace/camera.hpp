// SPDX-License-Identifier: Apache-2.0
// Scene cameras decide the view: the projection, and the pose as a function of video time.
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

// Position and orientation of a camera in the world; it looks along its own -z with +y up (glTF).
struct CameraPose {
  Vec3d position_m;
  Quatd orientation;
  friend bool operator==(const CameraPose&, const CameraPose&) = default;
};

// Where `up` is zero or parallel to the view, the axis most nearly across the view takes its place.
CameraPose look_at(const Vec3d& eye, const Vec3d& target, const Vec3d& up);

enum class ProjectionKind : std::uint8_t { perspective, orthographic };

struct Projection {
  ProjectionKind kind = ProjectionKind::perspective;
  double yfov_rad = 50.0 * kRadPerDeg;  // perspective: vertical field of view, 0 < yfov < pi
  double ymag_m = 1.0;                  // orthographic: half the height of the view
  double aspect = 0;  // width over height of the view that the camera shows uncropped; 0: that of any frame
  // Where the frame's middle lies right of and above the view axis: of a perspective camera one metre before it.
  Vec2d middle_m;
  // glTF's znear and zfar: rays are clipped to depths in [near_m, far_m]; far_m 0: infinite.
  double near_m = 0.0, far_m = 0.0;
  friend bool operator==(const Projection&, const Projection&) = default;
};

// Width and height of a pixel: of a perspective camera one metre before it.
double pixel_step_m(const Projection& projection, int height_px);

// The projection for frames of this width over height: where the frame is narrower than the camera's own view, it shows
// more above and below, and crops nothing (glTF 3.10.3). Less than half of one of `width_px` pixels is no difference.
Projection fit_projection(Projection projection, int width_px, int height_px);

// A thin lens. Points at the focus distance are sharp; a point at distance d along the view axis blurs into a disc of
// diameter 2 radius |d - focus| / (d focus), measured in tangents of the view angle. The field of view is that of the
// projection wherever the focus is (no breathing). Orthographic views have a lens too, as a bundle of parallel axes.
struct Lens {
  double radius_m = 0;          // of the aperture; 0: a pinhole, everything is sharp
  double focus_distance_m = 1;  // from the camera to the plane in focus, along the view axis; > 0
  friend bool operator==(const Lens&, const Lens&) = default;
};

// Aperture radius f / (2 N) of a lens with f-number N, where f = height / (2 tan(yfov / 2)) is the focal length that
// gives the field of view on a sensor of that height when focused at infinity. 0 for N = 0.
double lens_radius_m(double f_number, double sensor_height_mm, double yfov_rad);

// Everything that ray generation needs for one frame.
struct Camera {
  CameraPose pose;  // in the middle of the frame's time
  Projection projection;
  Lens lens;
  // How far the frame's middle is right of and below the view axis, in its pixels: not 0 in windows of a larger frame,
  // and where the lens is shifted.
  Vec2d middle_px;
  // Poses at equal steps of time from the opening to the closing of the shutter, both included. Between two of them the
  // position is interpolated linearly and the orientation by slerp. Empty: the camera stands still while the shutter is
  // open.
  std::vector<CameraPose> shutter_poses;
};

// A camera over time. `pose_at` may be called with any video time in [begin_ns, end_ns], and with any time at all where
// `is_static`.
struct CameraPath {
  std::string source;  // for messages: the file, or the file and the camera's name
  Projection projection;
  Lens lens;
  std::function<CameraPose(std::int64_t t_video_ns)> pose_at;
  bool is_static = true;  // does not depend on time, so that it covers every time
  std::int64_t begin_ns = 0;
  std::int64_t end_ns = 0;
  Warnings warnings;
};

CameraPath static_camera(const CameraPose& pose, const Projection& projection);

// Which axes the camera has in a file. gl: -z forward, y up. cv: +z forward, y down, in the same right-handed world.
// unity: +z forward, y up, in a left-handed world; world and camera are mirrored by (x, y, z) -> (x, y, -z).
enum class CameraAxes { gl, cv, unity };
enum class CameraExtrapolation { error, hold };
// How the camera moves between two poses. Orientations are interpolated by slerp the shorter way round, except with
// `step`. Positions:
//   linear       on the straight line
//   step         the whole earlier pose is held until the time of the later one
//   catmull_rom  on the cubic through all poses whose velocity at a pose is that of the parabola through it and its two
//                neighbours in time (at the ends, of the straight line to the only neighbour), which is right for
//                unequal steps of time, too
enum class PathInterpolation { linear, step, catmull_rom };
// The order in which three Euler angles are applied about fixed axes: zxy turns about z first, then about x, then about
// y, so that its matrix is Ry Rx Rz.
enum class RotationOrder { xyz, xzy, yxz, yzx, zxy, zyx };

// Frames per second as a fraction, such as 24000/1001, so that frame times are exact.
struct FrameRate {
  std::int64_t numerator = 24;
  std::int64_t denominator = 1;
  friend bool operator==(const FrameRate&, const FrameRate&) = default;
};
// The middle of frame `frame`, counted from 1: start + (frame - 1/2) / fps, rounded down to a nanosecond. Empty where
// that does not fit int64, and for a rate that is not positive.
std::optional<std::int64_t> mid_frame_ns(std::int64_t frame, const FrameRate& fps, std::int64_t start_ns);

struct CameraReadOptions {
  std::string format;              // a name of `camera_formats()`; empty: found by suffix and content
  std::optional<CameraAxes> axes;  // empty: those of the format; gl for CSV, TUM and EuRoC, which do not say
  PathInterpolation interpolation = PathInterpolation::linear;
  std::optional<double> yfov_rad;  // empty: the file's, else 50 degrees
  // The frame rate of formats that count frames and state no times (Nuke, NeRF, COLMAP). Their frame n gets the time of
  // the middle of the video's frame n, so that each of their poses is rendered as it stands where the rates agree.
  FrameRate fps;
  RotationOrder rotation_order = RotationOrder::zxy;  // of Nuke's Euler angles; zxy is Nuke's default
  // false: the first time stamp becomes video time 0, and the first frame number that of the video. true: both stay.
  bool keep_time = false;
  std::int32_t first_frame = 1;  // the number of the video's first frame
};

// A path through poses with increasing video times. Error(input) that names `source` where there is no pose, and where
// times do not increase.
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

// Reads a path in one of the `camera_formats()`. Error(input) with file:line, among others for quaternions whose length
// is not 1 within 1 %, for matrices that are no rotations, and for time stamps that do not increase. A path has one
// field of view: fields of view that change along the path, shifted centres and lens distortion are ignored with a
// warning.
CameraPath load_camera_path(const std::string& path, const CameraReadOptions& options);

// How the world of a path is placed in the world of the scene: (z up to y up) is applied first, then the turn, then the
// scale; last, everything is moved so that the first position becomes `start_m`, where that is given.
struct CameraPlacement {
  bool z_up = false;    // the path's world has z up: (x, y, z) becomes (x, z, -y)
  double turn_deg = 0;  // about +y, to the left seen from above
  double scale = 1;     // metres per unit of the path
  std::optional<Vec3d> start_m;
  friend bool operator==(const CameraPlacement&, const CameraPlacement&) = default;
};
// Error(usage) for a scale that is not positive, and for numbers that are not finite.
CameraPath place_camera(CameraPath path, const CameraPlacement& placement);

// Writes the camera's poses of numbered frames for other programs. The suffix chooses the format: .chan is Nuke's
// (frame, position, Euler angles in `order` and vertical field of view in degrees), .tum and .txt are TUM's, with the
// video time in seconds to the nanosecond. Every digit is kept. Error(usage) for other suffixes, Error(runtime) where
// the file cannot be written.
struct FramePose {
  std::int32_t frame = 1;
  std::int64_t t_ns = 0;
  Camera camera;
};
void write_camera_path(const std::vector<FramePose>& frames, RotationOrder order, const std::string& path);

// The rotation by Euler angles about x, y and z, applied in `order`, and its inverse, whose second angle is within +-90
// degrees. Where that is +-90 degrees, the first and the third turn about the same axis: one of the many pairs that
// give the rotation is returned.
Quatd quaternion_of_euler(const Vec3d& angles_rad, RotationOrder order);
Vec3d euler_of_quaternion(const Quatd& rotation, RotationOrder order);

}  // namespace gazetrace
