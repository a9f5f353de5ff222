// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <cmath>
#include <filesystem>
#include <span>

#include "core/atomic_file.hpp"
#include "core/text.hpp"
#include "gazetrace/camera.hpp"

namespace gazetrace {
namespace {

// Seconds with nine decimals, from integers. Unsigned, so that the least int64 has an absolute value.
std::string seconds_text(std::int64_t t_ns) {
  const auto bits = static_cast<std::uint64_t>(t_ns);
  const std::uint64_t size = t_ns < 0 ? ~bits + 1 : bits;
  return fmt::format("{}{}.{:09}", t_ns < 0 ? "-" : "", size / 1'000'000'000, size % 1'000'000'000);
}

std::string as_tum(const std::vector<FramePose>& frames) {
  std::string text = "# timestamp tx ty tz qx qy qz qw (s, m; looks along -z, y up)\n";
  for (const FramePose& frame : frames) {
    const Vec3d& p = frame.camera.pose.position_m;
    const Quatd& q = frame.camera.pose.orientation;
    text += fmt::format("{} {} {} {} {} {} {} {}\n", seconds_text(frame.t_ns), p.x, p.y, p.z, q.x, q.y, q.z, q.w);
  }
  return text;
}

std::string as_chan(const std::vector<FramePose>& frames, RotationOrder order) {
  std::string text;
  for (const FramePose& frame : frames) {
    const Vec3d& p = frame.camera.pose.position_m;
    const Vec3d a = euler_of_quaternion(frame.camera.pose.orientation, order) * kDegPerRad;
    text += fmt::format("{} {} {} {} {} {} {}", frame.frame, p.x, p.y, p.z, a.x, a.y, a.z);
    const Projection& projection = frame.camera.projection;
    text +=
        projection.kind == ProjectionKind::perspective ? fmt::format(" {}\n", projection.yfov_rad * kDegPerRad) : "\n";
  }
  return text;
}

}  // namespace

void write_camera_path(const std::vector<FramePose>& frames, RotationOrder order, const std::string& path) {
  const std::string suffix = to_lower(std::filesystem::path(path).extension().string());
  if (suffix != ".chan" && suffix != ".tum" && suffix != ".txt") {
    throw Error(ErrorKind::usage, path, "its suffix is not that of a known camera path format",
                "end it in .chan for Nuke, .tum or .txt for TUM");
  }
  const std::string text = suffix == ".chan" ? as_chan(frames, order) : as_tum(frames);
  write_bytes_atomically(path, std::as_bytes(std::span(text)));
}

}  // namespace gazetrace
