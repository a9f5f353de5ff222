// SPDX-License-Identifier: Apache-2.0
#include "job/schema/parts.hpp"

namespace gazetrace {
namespace {

constexpr auto camera_read(auto member) {
  return at(&JobSettings::camera_read, member);
}
constexpr auto placement(auto member) {
  return at(&JobSettings::camera_placement, member);
}

constexpr const char* kNeedsPath = "`camera-path` or `camera-from-gaze`";

void add_path_options(JobSchema& schema) {
  schema.value("--camera-format", camera_read(&CameraReadOptions::format), "NAME", Touch::camera,
               "Format of --camera-path; default: by its content");
  schema.value("--camera-axes", camera_read(&CameraReadOptions::axes), choices<CameraAxes>(), Touch::camera,
               "Axes of the poses: gl looks along -z with y up, cv along +z with y down, unity left-handed along +z; "
               "default: the format's own, gl for CSV, TUM and EuRoC");
  schema.value("--camera-rotation-order", camera_read(&CameraReadOptions::rotation_order), choices<RotationOrder>(),
               Touch::camera, "The order in which the rotations of a .chan file are applied, the first letter first");
  schema.value("--camera-fps", &JobSettings::camera_fps, "RATE", Touch::camera,
               "Frames a second of paths that count frames (.chan, NeRF, COLMAP); default: --fps");
  schema
      .value("--camera-up", &JobSettings::camera_up, choices<WorldUp>(), Touch::camera,
             "The axis of the path's world that points up")
      .need(kNeedsPath);
  schema
      .value("--camera-turn", placement(&CameraPlacement::turn_deg), "DEG", Touch::camera,
             "Turns a path or a head's poses about the scene's +y, to the left, degrees")
      .need(kNeedsPath);
  schema
      .value("--camera-scale", placement(&CameraPlacement::scale), "FACTOR", Touch::camera,
             "Metres per unit of the path")
      .need(kNeedsPath);
  schema
      .value("--camera-start", placement(&CameraPlacement::start_m), "X,Y,Z", Touch::camera,
             "Moves a path or a head's poses so that the first one is here, metres")
      .need(kNeedsPath);
  schema.value("--camera-interpolation", camera_read(&CameraReadOptions::interpolation), choices<PathInterpolation>(),
               Touch::camera, "How the camera moves from one pose of the path to the next");
  schema.value("--camera-extrapolation", &JobSettings::camera_extrapolation, choices<CameraExtrapolation>(),
               Touch::camera, "Frames before or after the path: an error, or its first or last pose");
  schema.flag("--camera-keep-time", camera_read(&CameraReadOptions::keep_time), Touch::camera,
              "The path's stamps are video times; otherwise its first stamp is video time 0");
}

void add_lens_options(JobSchema& schema) {
  schema.group("Lens and shutter");
  schema
      .value("--aperture", &JobSettings::aperture, "f/N|METRES", Touch::camera,
             "Depth of field: the lens's f-number, or the radius of its opening in metres; 0 is a pinhole, with which "
             "everything is sharp")
      .need("`focus-distance`");
  schema
      .value("--focus-distance", &JobSettings::focus_distance_m, "METRES", Touch::camera,
             "The distance along the view from the camera at which the picture is sharp; needed with --aperture")
      .need("`aperture`");
  schema
      .value("--sensor-height", &JobSettings::sensor_height_mm, "MM", Touch::camera,
             "Height of the picture on the sensor, millimetres: with the field of view it gives the focal length that "
             "f/N refers to")
      .need("`aperture` as f/N");
  schema.value("--shutter", &JobSettings::shutter, "PART|DEGdeg|OPEN,CLOSE", Touch::camera,
               "Motion blur: how much of a frame's time the shutter is open, about its middle (0.5, 180deg), or from "
               "when to when (0.25,0.75); 0: off");
}

}  // namespace

void add_camera_options(JobSchema& schema) {
  schema.group("Scene camera (the view of the picture)");
  schema
      .value("--camera", &JobSettings::camera, "NAME|INDEX", Touch::camera,
             "Camera of the glTF file by name or number from 0; default: the first one, or a view of the whole scene "
             "when it has none")
      .with(Trait::everyday);
  schema
      .value("--camera-path", &JobSettings::camera_path, "FILE", Touch::camera,
             "Poses over time: gazetrace CSV (t[s],x[m],y[m],z[m],qx,qy,qz,qw), TUM, EuRoC, Nuke .chan, NeRF "
             "transforms.json or COLMAP images.txt")
      .decides_by_file();
  schema
      .flag("--camera-from-gaze", &JobSettings::camera_from_gaze, Touch::camera,
            "The head's pose in a head-mounted display's log is the camera's path")
      .need("`gaze`");
  add_path_options(schema);
  schema.value("--eye", &JobSettings::eye, "X,Y,Z", Touch::camera, "A still camera at this point, metres")
      .need("`target`");
  schema.value("--target", &JobSettings::target, "X,Y,Z", Touch::camera, "The point that --eye looks at, metres")
      .need("`eye`");
  schema.value("--up", &JobSettings::up, "X,Y,Z", Touch::camera, "The direction that is up in the picture of --eye");
  schema.value("--yfov", &JobSettings::yfov_deg, "DEG", Touch::camera,
               "Vertical field of view in degrees for --eye and --camera-path (50 when not set), between 0 and 180; "
               "replaces that of a glTF camera when set");
  add_lens_options(schema);
}

}  // namespace gazetrace
