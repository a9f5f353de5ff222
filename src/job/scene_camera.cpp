// SPDX-License-Identifier: Apache-2.0
// The camera of a run.
#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>

#include "gazetrace/error.hpp"
#include "job/scene_camera.hpp"
#include "job/whole_scene_camera.hpp"

namespace gazetrace {
namespace {

constexpr double kDefaultYfovDeg = 50.0;

double checked_yfov_rad(double yfov_deg) {
  if (!(yfov_deg > 0 && yfov_deg < 180)) {
    throw Error(ErrorKind::usage, "`yfov`", fmt::format("{} degrees is outside 0..180", yfov_deg));
  }
  return yfov_deg * kRadPerDeg;
}

Projection perspective(const JobSettings& job) {
  Projection projection;
  projection.yfov_rad = checked_yfov_rad(job.yfov_deg.value_or(kDefaultYfovDeg));
  return projection;
}

const SceneCamera& camera_by_name(const JobSettings& job, const Scene& scene) {
  std::size_t index = 0;
  const char* end = job.camera.data() + job.camera.size();
  std::vector<std::string> known;
  for (const SceneCamera& camera : scene.cameras) {
    if (camera.name == job.camera) {
      return camera;
    }
    known.push_back(camera.name);
  }
  if (const auto [stop, code] = std::from_chars(job.camera.data(), end, index); code == std::errc() && stop == end) {
    if (index < scene.cameras.size()) {
      return scene.cameras[index];
    }
    throw Error(ErrorKind::usage, "`camera`",
                fmt::format("there is no camera {}, {} has {}", index, job.scene, known.size()),
                "cameras are counted from 0; 'gazetrace scene' lists them");
  }
  if (known.empty()) {
    throw Error(ErrorKind::usage, "`camera`", job.scene + " has no cameras",
                "give `camera-path`, or `eye` and `target`");
  }
  throw Error(ErrorKind::usage, "`camera`", unknown_name_message("camera", job.camera, known));
}

CameraPath still_camera(const JobSettings& job) {
  if (!job.target) {
    throw Error(ErrorKind::usage, "`eye`", "a still camera needs `target` as well");
  }
  if (*job.eye == *job.target) {
    throw Error(ErrorKind::usage, "`target`", "the camera stands on its target",
                "give it a point that the camera looks at");
  }
  if (!(length(job.up) > 0)) {
    throw Error(ErrorKind::usage, "`up`", "an up vector of no length points nowhere", "leave it out for 0,1,0");
  }
  return static_camera(look_at(*job.eye, *job.target, job.up), perspective(job));
}

// The head's poses on the clock of the video, mapped in the same way as the gaze.
CameraPath head_camera(const GazeLog& log, std::int64_t taken_off_ns, const JobSettings& job) {
  if (log.head.empty()) {
    throw Error(ErrorKind::input, log.source, "has no head pose for `camera-from-gaze`",
                "give `camera-path`, or name its columns in a column map");
  }
  const GazeMapping mapping = gaze_mapping(job, &log, taken_off_ns);
  std::vector<TimedPose> poses;
  poses.reserve(log.head.size());
  for (const HeadPose& pose : log.head) {
    poses.push_back({video_time_ns(log, mapping, pose.t_ns), {pose.position_m, pose.orientation}});
  }
  return camera_from_poses(poses, log.source, perspective(job), job.camera_read.interpolation);
}

CameraPlacement placement_of(const JobSettings& job) {
  CameraPlacement placement = job.camera_placement;
  placement.z_up = job.camera_up == WorldUp::z;
  return placement;
}

CameraPath camera_without_lens(const JobSettings& job, const Scene* scene, const GazeLog* log,
                               std::int64_t taken_off_ns, std::string& decision) {
  const int ways = (job.camera.empty() ? 0 : 1) + (job.camera_path.empty() ? 0 : 1) + (job.camera_from_gaze ? 1 : 0) +
                   (job.eye || job.target ? 1 : 0);
  if (ways > 1) {
    throw Error(ErrorKind::usage, "", "`camera`, `camera-path`, `camera-from-gaze` and `eye` exclude each other",
                "give one of them");
  }
  if (job.camera_from_gaze) {
    if (log == nullptr) {
      throw Error(ErrorKind::usage, "`camera-from-gaze`", "there is no gaze log", "give `gaze`");
    }
    decision = "the head's pose in " + log->source;
    return place_camera(head_camera(*log, taken_off_ns, job), placement_of(job));
  }
  if (job.camera_path.empty() && placement_of(job) != CameraPlacement{}) {
    throw Error(ErrorKind::usage, "", "`camera-up`, `camera-turn`, `camera-scale` and `camera-start` move paths",
                "give them with `camera-path` or `camera-from-gaze`");
  }
  if (job.target && !job.eye) {
    throw Error(ErrorKind::usage, "`target`", "a still camera needs `eye` as well");
  }
  if (job.eye) {
    decision = "still, from `eye`";
    return still_camera(job);
  }
  if (!job.camera_path.empty()) {
    CameraReadOptions options = job.camera_read;
    if (job.yfov_deg) {
      options.yfov_rad = checked_yfov_rad(*job.yfov_deg);
    }
    options.fps = job.camera_fps.value_or(job.fps);
    options.first_frame = job.first_frame;
    decision = job.camera_path;
    return place_camera(load_camera_path(job.camera_path, options), placement_of(job));
  }
  CameraPath camera;
  if (scene == nullptr) {
    if (!job.camera.empty()) {
      throw Error(ErrorKind::usage, "`camera`", "no scene was given", "name a .gltf or .glb file");
    }
    decision = "none: no scene was given";
    camera = static_camera(CameraPose{}, perspective(job));
  } else if (job.camera.empty() && scene->cameras.empty()) {
    decision = "a view of the whole scene (the file has no camera; `eye` and `target` choose another)";
    camera = whole_scene_camera(*scene, perspective(job),
                                static_cast<double>(job.size.width) / static_cast<double>(job.size.height));
  } else {
    const SceneCamera& chosen = job.camera.empty() ? scene->cameras.front() : camera_by_name(job, *scene);
    decision = fmt::format("'{}' of {}{}", chosen.name, job.scene, chosen.path.is_static ? "" : ", animated");
    camera = chosen.path;
    if (job.yfov_deg) {
      if (camera.projection.kind != ProjectionKind::perspective) {
        throw Error(ErrorKind::usage, "`yfov`", fmt::format("camera '{}' is orthographic", chosen.name));
      }
      camera.projection.yfov_rad = checked_yfov_rad(*job.yfov_deg);
      camera.projection.aspect = 0;
    }
    const Projection fitted = fit_projection(camera.projection, job.size.width, job.size.height);
    if (fitted.yfov_rad != camera.projection.yfov_rad || fitted.ymag_m != camera.projection.ymag_m) {
      decision += fmt::format(", higher than it states, so that its width of {:.4g} heights is in the frame",
                              camera.projection.aspect);
    }
    camera.projection = fitted;
  }
  return camera;
}

// Beyond these limits the squares of floats overflow; no camera comes near them.
constexpr double kLeastFocus_m = 1e-6, kMostFocus_m = 1e9;
constexpr double kMostRadius_m = 1e6;

Lens chosen_lens(const JobSettings& job, const Projection& projection) {
  const Aperture& aperture = job.aperture;
  if (job.sensor_height_mm != JobSettings{}.sensor_height_mm && !(aperture.f_number > 0)) {
    throw Error(ErrorKind::usage, "`sensor-height`", "only an f-number needs it", "give `aperture` f/N as well");
  }
  if (!(aperture.f_number > 0) && !(aperture.radius_m > 0)) {
    if (job.focus_distance_m) {
      throw Error(ErrorKind::usage, "`focus-distance`", "a pinhole focuses nowhere", "give `aperture` as well");
    }
    return {};
  }
  if (!job.focus_distance_m) {
    throw Error(ErrorKind::usage, "`aperture`", "a lens needs a distance that is sharp", "give `focus-distance`");
  }
  if (!(*job.focus_distance_m >= kLeastFocus_m && *job.focus_distance_m <= kMostFocus_m)) {
    throw Error(ErrorKind::usage, "`focus-distance`",
                fmt::format("{:g} m is not within {:g} to {:g} m before the lens", *job.focus_distance_m, kLeastFocus_m,
                            kMostFocus_m));
  }
  if (!(job.sensor_height_mm > 0)) {
    throw Error(ErrorKind::usage, "`sensor-height`", fmt::format("{} mm is no height", job.sensor_height_mm));
  }
  double radius_m = aperture.radius_m;
  if (aperture.f_number > 0) {
    if (projection.kind != ProjectionKind::perspective) {
      throw Error(ErrorKind::usage, "`aperture`", "an orthographic camera has no focal length for an f-number",
                  "give a radius in metres");
    }
    radius_m = lens_radius_m(aperture.f_number, job.sensor_height_mm, projection.yfov_rad);
  }
  if (!(radius_m <= kMostRadius_m)) {
    throw Error(ErrorKind::usage, "`aperture`", fmt::format("a lens of {:g} m radius is too large", radius_m));
  }
  return {radius_m, *job.focus_distance_m};
}

}  // namespace

CameraPath choose_camera(const JobSettings& job, const Scene* scene, const GazeLog* log, std::int64_t taken_off_ns,
                         std::string& decision) {
  CameraPath camera = camera_without_lens(job, scene, log, taken_off_ns, decision);
  camera.lens = chosen_lens(job, camera.projection);
  return camera;
}

bool camera_needs_scene(const JobSettings& job) {
  return job.camera_path.empty() && !job.camera_from_gaze && !job.eye;
}

}  // namespace gazetrace
