// SPDX-License-Identifier: Apache-2.0
// Objects and areas of interest for the gaze of a job.
#include <algorithm>
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

bool knows_uncertainty(const JobSettings& settings, const GazeLog& log) {
  const GazeUncertainty stated = uncertainty_of(log);
  return (settings.gaze_accuracy_deg || stated.accuracy_deg >= 0) &&
         (settings.gaze_precision_deg || stated.precision_deg >= 0);
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
  asked.settings.gaze_uncertainty = true;  // has the plan take accuracy and precision from the log
  asked.settings.gaze_latency = {};        // what steers a rendering late was not seen late
  const Scene scene = load_job_scene(asked.settings);
  ResolveOptions options;
  options.scope = ResolveScope::plan;
  options.loaded = &scene;
  options.tell_idle = false;
  GazeOnScene seen{resolve(asked, options), {}, {}};
  seen.resolved.warnings.insert(seen.resolved.warnings.begin(), scene.warnings.begin(), scene.warnings.end());
  if (seen.resolved.steering) {
    // The processing that was asked for is of the gaze itself here, as nothing is steered.
    for (FrameRequest& request : seen.resolved.plan.frames) {
      request.gaze_true = request.gaze_render;
      request.gaze_direction_true = request.gaze_direction_render;
    }
  }
  settings.uncertainty = *seen.resolved.plan_settings.uncertainty;
  PathTracer tracer(scene, tracer_options(asked.settings));
  settings.keep_hits = settings.keep_hits || heat.has_value();
  seen.objects = gaze_objects(tracer, scene, seen.resolved.plan, settings);
  if (heat) {
    const FrameRate& fps = seen.resolved.plan_settings.fps;
    const double frame_s = static_cast<double>(fps.denominator) / static_cast<double>(fps.numerator);
    seen.heat_svg = scene_heat_svg(tracer, seen.resolved.plan, frame_s, seen.objects, *heat);
  }
  return seen;
}

AoisOfJob aois_of_job(const Job& job, const std::string& aoi_file, const std::string& method) {
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
    settings.nearest = settings.grid_rays = 0;
    seen = look_at_scene(job, settings);
  }
  std::optional<GazeUncertainty> uncertainty;
  if (knows_uncertainty(job.settings, log)) {
    const GazeUncertainty stated = uncertainty_of(log);
    uncertainty = GazeUncertainty{job.settings.gaze_accuracy_deg.value_or(stated.accuracy_deg),
                                  job.settings.gaze_precision_deg.value_or(stated.precision_deg)};
  }
  return {analyse_aois(log, events_by(log, method), std::move(areas), uncertainty, seen ? &seen->objects : nullptr),
          seen ? seen->resolved.warnings : viewing.warnings};
}

}  // namespace gazetrace
