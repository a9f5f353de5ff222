// SPDX-License-Identifier: Apache-2.0
// Objects and areas of interest for the gaze of a job.
#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "gazetrace/gaze_aois.hpp"
#include "gazetrace/gaze_objects.hpp"
#include "gazetrace/resolve.hpp"

namespace gazetrace {
namespace {

EyeEvents events_by(const GazeLog& log, const std::string& method) {
  if (method == "log") {
    return events_of_log(log);
  }
  return detect_events(log, method == "auto" ? default_event_preset(log) : event_preset(method));
}

// Throws where neither the settings nor the log say how far the gaze is off.
GazeUncertainty needed_uncertainty(const GazeUncertainty& stated, const GazeLog& log) {
  const GazeUncertainty known = known_uncertainty(stated, log);
  if (std::isnan(known.accuracy_deg)) {
    throw Error(ErrorKind::input, log.source, "has no validation that would tell the tracker's accuracy",
                "give `gaze-accuracy` DEG");
  }
  if (std::isnan(known.precision_deg)) {
    throw Error(ErrorKind::input, log.source, "has no fixation to measure the tracker's precision in",
                "give `gaze-precision` DEG");
  }
  return known;
}

}  // namespace

GazeOnScene look_at_scene(const Job& job, GazeObjectsSettings settings, const std::optional<SceneHeatSettings>& heat) {
  if (job.settings.scene.empty()) {
    throw Error(ErrorKind::usage, "", "no scene was given", "name a .gltf or .glb file");
  }
  if (job.settings.gaze.path.empty() && !job.settings.gaze_at) {
    throw Error(ErrorKind::usage, "", "no gaze was given", "name a log with `gaze`");
  }
  Job asked = job;
  asked.settings.gaze_latency = {};  // what steers a rendering late was not seen late
  const Scene scene = load_job_scene(asked.settings);
  ResolveOptions options;
  options.scope = ResolveScope::plan;
  options.loaded = &scene;
  options.tell_idle = false;
  GazeOnScene seen{resolve(asked, options), {}, std::nullopt};
  seen.resolved.warnings.insert(seen.resolved.warnings.begin(), scene.warnings.begin(), scene.warnings.end());
  if (seen.resolved.steering) {
    // The processing that was asked for is of the gaze itself here, as nothing is steered.
    for (FrameRequest& request : seen.resolved.plan.frames) {
      request.gaze_true = request.gaze_render;
      request.gaze_direction_true = request.gaze_direction_render;
    }
  }
  settings.uncertainty = needed_uncertainty(settings.uncertainty, *seen.resolved.gaze);
  PathTracer tracer(scene, tracer_options(asked.settings));
  settings.keep_hits = settings.keep_hits || heat.has_value();
  seen.objects = gaze_objects(tracer, scene, seen.resolved.plan, settings);
  if (heat) {
    const FrameRate& fps = seen.resolved.plan_settings.fps;
    const double frame_s = static_cast<double>(fps.denominator) / static_cast<double>(fps.numerator);
    seen.heat = scene_heat(tracer, seen.resolved.plan, frame_s, seen.objects, *heat);
  }
  return seen;
}

AoisOfJob aois_of_job(const Job& job, const std::string& aoi_file, const std::string& method,
                      const GazeUncertainty& uncertainty) {
  if (job.settings.gaze.path.empty()) {
    throw Error(ErrorKind::usage, "", "no gaze was given", "name a log with `gaze`");
  }
  ResolveOptions options;
  options.scope = ResolveScope::viewing;
  const ResolvedJob viewing = resolve(job, options);
  const GazeLog& log = *viewing.gaze;
  std::vector<Aoi> areas = load_aois(aoi_file, log.recording_geometry);
  const bool has_objects =
      std::any_of(areas.begin(), areas.end(), [](const Aoi& area) { return area.shape == AoiShape::object; });
  std::optional<GazeOnScene> seen;
  if (has_objects) {
    GazeObjectsSettings settings;
    settings.uncertainty = uncertainty;
    settings.nearest = settings.grid_rays = 0;
    seen = look_at_scene(job, settings);
  }
  const GazeUncertainty known = known_uncertainty(uncertainty, log);
  const bool is_known = known.accuracy_deg >= 0 && known.precision_deg >= 0;
  return {analyse_aois(log, events_by(log, method), std::move(areas), is_known ? std::optional(known) : std::nullopt,
                       seen ? &seen->objects : nullptr),
          seen ? seen->resolved.warnings : viewing.warnings};
}

}  // namespace gazetrace
