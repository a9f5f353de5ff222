// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <utility>

#include "aoi/object_names.hpp"
#include "gazetrace/gaze_outlines.hpp"
#include "gazetrace/resolve.hpp"

namespace gazetrace {
namespace {

using Json = nlohmann::ordered_json;

std::vector<Vec2d> pixel_middles(int width_px, int height_px) {
  std::vector<Vec2d> places;
  places.reserve(static_cast<std::size_t>(width_px) * static_cast<std::size_t>(height_px));
  for (int y = 0; y < height_px; ++y) {
    for (int x = 0; x < width_px; ++x) {
      places.push_back({x + 0.5, y + 0.5});
    }
  }
  return places;
}

FrameOutlines outlines_in(const std::vector<RayHit>& hits, int width_px, int height_px, ObjectNames& names) {
  Image<std::uint32_t> numbers(width_px, height_px);
  std::vector<std::int64_t> pixels;
  for (std::size_t i = 0; i < hits.size(); ++i) {
    const std::size_t object = names.of(hits[i]);
    numbers.pixels[i] = static_cast<std::uint32_t>(object);
    pixels.resize(std::max(pixels.size(), object + 1));
    ++pixels[object];
  }
  FrameOutlines found;
  std::vector<std::vector<OutlinePolygon>> outlines = outlines_of(numbers);
  for (std::size_t object = 1; object < outlines.size(); ++object) {
    if (!outlines[object].empty()) {
      found.seen.push_back({object, pixels[object], std::move(outlines[object])});
    }
  }
  return found;
}

Json polygons_as_json(const std::vector<OutlinePolygon>& polygons) {
  Json all = Json::array();
  for (const OutlinePolygon& polygon : polygons) {
    Json rings = Json::array();
    for (const std::vector<PixelCorner>& ring : polygon.rings) {
      Json corners = Json::array();
      for (const PixelCorner& corner : ring) {
        corners.push_back({corner.x, corner.y});
      }
      rings.push_back(std::move(corners));
    }
    all.push_back(std::move(rings));
  }
  return all;
}

std::string one_line(const Json& json) {
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

// A name that no other object has; a node may have several materials.
Json names_as_json(const std::vector<SceneObject>& objects) {
  Json all = Json::array();
  for (std::size_t i = 1; i < objects.size(); ++i) {
    std::size_t of_node = 0;
    for (const SceneObject& other : objects) {
      of_node += other.node == objects[i].node ? 1 : 0;
    }
    const std::string& material = objects[i].material;
    all.push_back({{"name", of_node > 1 ? objects[i].node + " (" + material + ")" : objects[i].node},
                   {"node", objects[i].node},
                   {"material", material}});
  }
  return all;
}

}  // namespace

OutlinesOfJob outlines_of_job(const Job& job) {
  if (job.settings.scene.empty()) {
    throw Error(ErrorKind::usage, "", "no scene was given", "name a .gltf or .glb file");
  }
  const Scene scene = load_job_scene(job.settings);
  ResolveOptions options;
  options.scope = ResolveScope::plan;
  options.loaded = &scene;
  options.tell_idle = false;
  const ResolvedJob resolved = resolve(job, options);
  OutlinesOfJob made{{}, resolved.warnings};
  made.warnings.insert(made.warnings.begin(), scene.warnings.begin(), scene.warnings.end());
  SceneOutlines& outlines = made.outlines;
  const PlanSettings& settings = resolved.plan_settings;
  outlines.width_px = settings.width_px;
  outlines.height_px = settings.height_px;
  outlines.fps = settings.fps;
  outlines.display = settings.display;
  outlines.frame_rect = settings.frame_rect;
  PathTracer tracer(scene, tracer_options(job.settings));
  ObjectNames names(scene);
  const std::vector<Vec2d> places = pixel_middles(settings.width_px, settings.height_px);
  for (const FrameRequest& request : resolved.plan.frames) {
    const PosedScene posed = tracer.at({request.t_video_ns, request.t_video_ns});
    FrameOutlines frame = outlines_in(posed.first_hits(request.camera, request.width_px, request.height_px, places),
                                      request.width_px, request.height_px, names);
    frame.frame = request.frame;
    frame.t_video_ns = request.t_video_ns;
    if (!job.settings.gaze.path.empty()) {
      frame.t_log_ns = request.gaze_true.t_log_ns;
    }
    outlines.frames.push_back(std::move(frame));
  }
  outlines.objects = names.objects();
  return made;
}

std::string outlines_as_json(const SceneOutlines& outlines) {
  Json head{{"format", "gazetrace-outlines-1"}, {"size_px", {outlines.width_px, outlines.height_px}},
            {"fps", to_string(outlines.fps)},   {"display_px", nullptr},
            {"frame_on_display_px", nullptr},   {"objects", names_as_json(outlines.objects)}};
  if (outlines.display) {
    const DisplayGeometry& display = *outlines.display;
    const FrameRect& rect = outlines.frame_rect;
    const bool is_whole = rect.width_px == 0;
    head["display_px"] = {display.width_px, display.height_px};
    head["frame_on_display_px"] = {rect.x_px, rect.y_px, is_whole ? display.width_px : rect.width_px,
                                   is_whole ? display.height_px : rect.height_px};
  }
  // A frame is a line, so that a large file can be read line by line.
  std::string text = one_line(head);
  text.back() = ',';
  text += "\n\"frames\": [";
  const char* before = "\n";
  for (const FrameOutlines& frame : outlines.frames) {
    Json item{{"frame", frame.frame}, {"t_video_ns", frame.t_video_ns}, {"t_log_ns", nullptr}};
    if (frame.t_log_ns) {
      item["t_log_ns"] = *frame.t_log_ns;
    }
    item["objects"] = Json::array();
    for (const FrameOutlines::Seen& seen : frame.seen) {
      item["objects"].push_back(
          {{"object", seen.object - 1}, {"pixels", seen.pixels}, {"polygons", polygons_as_json(seen.polygons)}});
    }
    text += before + one_line(item);
    before = ",\n";
  }
  return text + "\n]}\n";
}

}  // namespace gazetrace
