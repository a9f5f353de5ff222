// SPDX-License-Identifier: Apache-2.0
#include "output/exr_describe.hpp"

#include <ImathMatrix.h>
#include <OpenEXR/ImfChromaticities.h>
#include <OpenEXR/ImfDoubleAttribute.h>
#include <OpenEXR/ImfFloatAttribute.h>
#include <OpenEXR/ImfIntAttribute.h>
#include <OpenEXR/ImfRationalAttribute.h>
#include <OpenEXR/ImfStandardAttributes.h>
#include <OpenEXR/ImfStringAttribute.h>
#include <OpenEXR/ImfTimeCode.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

#include "output/gaze_text.hpp"

namespace gazetrace {

void add_text(Imf::Header& header, const std::string& name, const std::string& value) {
  header.insert("gazetrace:" + name, Imf::StringAttribute(value));
}

namespace {

// The primaries of SMPTE ST 2065-1 (AP0) and S-2014-004 (AP1, of ACEScg) with ACES' white, and the way to them from
// Rec.709 (SMPTE RP 177) with Bradford's adaptation: AP1's matrix is that of the public ACES configurations.
struct SpaceInfo {
  const char* name;
  std::array<Vec2f, 4> chromaticities;  // of red, green, blue and white
  std::array<Vec3f, 3> from_rec709;
};
const SpaceInfo& info_of(ExrSpace space) {
  static constexpr Vec2f kAcesWhite{0.32168F, 0.33767F};
  static const SpaceInfo kRec709{
      "lin_rec709", {Vec2f{0.64F, 0.33F}, {0.3F, 0.6F}, {0.15F, 0.06F}, {0.3127F, 0.329F}}, {}};
  static const SpaceInfo kAcesCg{"ACEScg",
                                 {Vec2f{0.713F, 0.293F}, {0.165F, 0.83F}, {0.128F, 0.044F}, kAcesWhite},
                                 {Vec3f{0.613097402F, 0.339523146F, 0.047379451F},
                                  {0.070193722F, 0.916353879F, 0.013452398F},
                                  {0.020615593F, 0.109569773F, 0.869814634F}}};
  static const SpaceInfo kAces{"ACES2065-1",
                               {Vec2f{0.7347F, 0.2653F}, {0, 1}, {0.0001F, -0.077F}, kAcesWhite},
                               {Vec3f{0.439632982F, 0.382988698F, 0.177378320F},
                                {0.089776443F, 0.813439429F, 0.096784128F},
                                {0.017541170F, 0.111546553F, 0.870912276F}}};
  return space == ExrSpace::acescg ? kAcesCg : space == ExrSpace::aces2065_1 ? kAces : kRec709;
}

void add_color_space(Imf::Header& header, ExrSpace space) {
  const SpaceInfo& info = info_of(space);
  const auto place = [&](std::size_t i) { return Imath::V2f(info.chromaticities[i].x, info.chromaticities[i].y); };
  Imf::addChromaticities(header, {place(0), place(1), place(2), place(3)});
  header.insert("colorSpace", Imf::StringAttribute(info.name));
}

// From world space to the camera space of the EXR standard, which is left-handed with +z forward. Imath multiplies row
// vectors: p M.
Imath::M44d world_to_camera(const CameraPose& pose) {
  const Vec3d right = rotate(pose.orientation, {1, 0, 0});
  const Vec3d up = rotate(pose.orientation, {0, 1, 0});
  const Vec3d forward = rotate(pose.orientation, {0, 0, -1});
  const Vec3d& p = pose.position_m;
  return {right.x,        up.x,        forward.x,        0,  //
          right.y,        up.y,        forward.y,        0,  //
          right.z,        up.z,        forward.z,        0,  //
          -dot(right, p), -dot(up, p), -dot(forward, p), 1};
}

// From that camera space to NDC, with (0, 0) at the top left and (1, 1) at the bottom right. Depth, which the standard
// leaves open, is 0 at the near plane.
Imath::M44d camera_to_ndc(const Projection& projection, double aspect) {
  const double near_m = projection.near_m > 0 ? projection.near_m : 1e-3;
  const bool parallel = projection.kind == ProjectionKind::orthographic;
  const double half_height = parallel ? projection.ymag_m : std::tan(projection.yfov_rad / 2);
  const double x = 0.5 / (half_height * aspect);
  const double y = -0.5 / half_height;
  const double middle_x = 0.5 - x * projection.middle_m.x;
  const double middle_y = 0.5 - y * projection.middle_m.y;
  if (parallel) {
    return {x, 0, 0, 0, 0, y, 0, 0, 0, 0, 1, 0, middle_x, middle_y, -near_m, 1};
  }
  return {x, 0, 0, 0, 0, y, 0, 0, middle_x, middle_y, 1, 1, 0, 0, -near_m, 0};
}

std::string camera_text(const Camera& camera) {
  const Vec3d& p = camera.pose.position_m;
  const Quatd& q = camera.pose.orientation;
  const Projection& projection = camera.projection;
  const std::string view = projection.kind == ProjectionKind::perspective
                               ? fmt::format("perspective yfov_rad={}", projection.yfov_rad)
                               : fmt::format("orthographic ymag_m={}", projection.ymag_m);
  const std::string lens = camera.lens.radius_m > 0 ? fmt::format(" aperture_radius_m={} focus_distance_m={}",
                                                                  camera.lens.radius_m, camera.lens.focus_distance_m)
                                                    : "";
  const Vec2d& m = projection.middle_m;
  const std::string middle = m == Vec2d{} ? "" : fmt::format(" middle_m={},{}", m.x, m.y);
  return fmt::format("position_m={},{},{} orientation_xyzw={},{},{},{} projection={}{} near_m={} far_m={}{}", p.x, p.y,
                     p.z, q.x, q.y, q.z, q.w, view, middle, projection.near_m, projection.far_m, lens);
}

std::string gaze_header(const GazeAtTime& gaze) {
  return gaze_words(gaze) + " reason=" + gaze.reason;
}

// SMPTE 12M counts frames within a second in two digits up to 29. Rates up to 60 count pairs of frames, and mark the
// second of each in the bit for the field; beyond that there is no time code. Rates such as 30000/1001 count on without
// dropping numbers.
void add_time_code(Imf::Header& header, const FrameHeader& frame) {
  constexpr std::int64_t kMostFrames = 30;
  // Rounded; the sum of numerator and half the denominator may be beyond the largest number.
  const std::int64_t denominator = std::max<std::int64_t>(frame.fps.denominator, 1);
  const bool up = frame.fps.numerator % denominator >= denominator - denominator / 2;
  const std::int64_t rate = frame.fps.numerator / denominator + (up ? 1 : 0);
  const bool in_pairs = rate > kMostFrames;
  if (rate < 1 || rate > 2 * kMostFrames || frame.frame < 1) {
    return;
  }
  const std::int64_t index = frame.frame - 1;
  const std::int64_t second = index / rate;
  const auto within = static_cast<int>(index % rate);
  Imf::TimeCode code(static_cast<int>(second / 3600 % 24), static_cast<int>(second / 60 % 60),
                     static_cast<int>(second % 60), in_pairs ? within / 2 : within);
  code.setFieldPhase(in_pairs && within % 2 == 1);
  Imf::addTimeCode(header, code);
}

void add_gaze_numbers(Imf::Header& header, const GazeNumbers& gaze) {
  header.insert("gaze.u", Imf::FloatAttribute(static_cast<float>(gaze.u)));
  header.insert("gaze.v", Imf::FloatAttribute(static_cast<float>(gaze.v)));
  header.insert("gaze.valid", Imf::IntAttribute(gaze.valid));
}

}  // namespace

std::optional<std::array<Vec3f, 3>> matrix_to(ExrSpace space) {
  return space == ExrSpace::rec709 ? std::nullopt : std::optional(info_of(space).from_rec709);
}

void describe(Imf::Header& header, const FrameHeader& frame, ExrSpace space) {
  Camera camera = frame.camera;
  camera.projection = frame.window.is_part() ? frame.window.projection : camera.projection;
  const Imath::V2i corner = header.displayWindow().size();  // the last pixel
  const double aspect = (corner.x + 1.0) / (corner.y + 1.0);
  add_color_space(header, space);
  header.insert("software", Imf::StringAttribute(frame.software));
  if (frame.fps.numerator <= std::numeric_limits<int>::max() &&
      frame.fps.denominator <= std::numeric_limits<int>::max()) {
    Imf::addFramesPerSecond(
        header, Imf::Rational(static_cast<int>(frame.fps.numerator), static_cast<int>(frame.fps.denominator)));
  }
  add_time_code(header, frame);
  add_gaze_numbers(header, frame.gaze);
  const Imath::M44d to_camera = world_to_camera(camera.pose);
  Imf::addWorldToCamera(header, Imath::M44f(to_camera));
  Imf::addWorldToNDC(header, Imath::M44f(to_camera * camera_to_ndc(camera.projection, aspect)));
  header.insert("gazetrace:frame", Imf::IntAttribute(frame.frame));
  header.insert("gazetrace:exposure_ev", Imf::DoubleAttribute(frame.exposure_ev));
  // Stored as text, since there is no attribute type for 64-bit integers.
  add_text(header, "t_video_ns", std::to_string(frame.t_video_ns));
  add_text(header, "seed", std::to_string(frame.seed));
  add_text(header, "settings_digest", frame.settings_digest);
  if (!frame.mean_digest.empty()) {
    add_text(header, "mean_digest", frame.mean_digest);
  }
  if (frame.samples_per_pixel > 0) {
    add_text(header, "samples_per_pixel", fmt::format("{}", frame.samples_per_pixel));
  }
  add_text(header, "camera", camera_text(camera));
  if (frame.shutter_close_ns > frame.shutter_open_ns) {
    add_text(header, "shutter_ns", fmt::format("{},{}", frame.shutter_open_ns, frame.shutter_close_ns));
  }
  add_text(header, "gaze_render", gaze_header(frame.gaze_render));
  add_text(header, "gaze_true", gaze_header(frame.gaze_true));
  if (!frame.gaze_processing.empty()) {
    add_text(header, "gaze_processing", fmt::format("{}", fmt::join(frame.gaze_processing, "; ")));
  }
}

}  // namespace gazetrace
