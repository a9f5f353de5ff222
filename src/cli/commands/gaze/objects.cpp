// SPDX-License-Identifier: Apache-2.0
#include "gazetrace/gaze_objects.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <memory>

#include "cli/command.hpp"
#include "cli/exit_codes.hpp"
#include "cli/gaze_uncertainty.hpp"
#include "cli/job_help.hpp"
#include "cli/json_output.hpp"
#include "gazetrace/error.hpp"
#include "gazetrace/output.hpp"

namespace gazetrace {
namespace {

struct ObjectsArguments {
  Job job;
  GazeObjectsSettings objects;
  bool recorded_here = false;
  std::string table, heat_map, heat_picture;
  SceneHeatSettings heat;
  JsonOutput json;
};

std::string summary(const ObjectsArguments& arguments, const GazeObjects& objects) {
  const GazeUncertainty& u = objects.settings.uncertainty;
  return fmt::format(
      "{}: {} frames, {} objects; accuracy {:.3g} deg, precision {:.3g} deg: 95 % of the cone within {:.3g} deg\n{}\n",
      arguments.table, objects.frames.size(), objects.objects.size() - 1, u.accuracy_deg, u.precision_deg,
      gaze_cone_95_deg(u),
      arguments.recorded_here ? "recorded on this stimulus, as stated"
                              : "replayed: nobody stated that the viewer saw this (--recorded-here)");
}

void write_heat(const ObjectsArguments& arguments, const SceneHeat& heat) {
  if (arguments.heat_map.ends_with(".csv")) {
    write_text_atomically(arguments.heat_map, scene_heat_csv(heat));
  } else {
    const std::vector<std::uint8_t> png = scene_heat_png(heat, arguments.heat_picture);
    write_text_atomically(arguments.heat_map, std::string(png.begin(), png.end()));
  }
  std::fprintf(stderr, "%s: %.2g s of gaze in the scene; as frame %d sees it, up to %.3g s per square metre\n",
               arguments.heat_map.c_str(), heat.seconds, heat.frame, heat.highest);
}

int run_objects(ObjectsArguments& arguments) {
  arguments.json.check({arguments.table, arguments.heat_map}, job_files(arguments.job.settings));
  if (!arguments.heat_map.empty() && !arguments.heat_map.ends_with(".png") && !arguments.heat_map.ends_with(".csv")) {
    throw Error(ErrorKind::usage, "`heat-map`", "is written as .png or .csv, not as '" + arguments.heat_map + "'");
  }
  arguments.objects.stimulus = arguments.recorded_here ? Stimulus::recorded : Stimulus::replayed;
  const bool asks_for_heat = !arguments.heat_map.empty();
  const GazeOnScene seen =
      look_at_scene(arguments.job, arguments.objects, asks_for_heat ? std::optional(arguments.heat) : std::nullopt);
  print_warnings(seen.resolved.warnings);
  if (asks_for_heat) {
    write_heat(arguments, *seen.heat);
  }
  const bool json = arguments.table.ends_with(".json");
  const std::string text = json ? objects_as_json(seen.objects) : objects_as_tsv(seen.objects);
  const auto as_json = [&] { return objects_as_json(seen.objects); };
  if (arguments.table.empty()) {
    arguments.json.print(text, as_json);
  } else {
    write_text_atomically(arguments.table, text);
    arguments.json.print(summary(arguments, seen.objects), as_json);
  }
  return exit_done;
}

}  // namespace

Command add_gaze_objects_command(CLI::App& app, const Invocation& /*invocation*/) {
  auto arguments = std::make_shared<ObjectsArguments>();
  bind_job_options(app, arguments->job);
  use_job_help(app,
               "gazetrace gaze objects --config examples/example.toml --gaze-accuracy 0.5 --table out/objects.tsv");
  add_uncertainty_options(app, arguments->objects.uncertainty);
  app.add_option("--table", arguments->table, "Where the table goes, .tsv or .json; default: as TSV to stdout")
      ->type_name("FILE");
  app.add_flag("--recorded-here", arguments->recorded_here,
               "States that the viewer saw this scene on this path while the log was recorded; else it is a replay");
  app.add_option("--cone-rays", arguments->objects.rays, "Directions in the cone of each frame")
      ->type_name("N")
      ->capture_default_str();
  app.add_option("--nearest", arguments->objects.nearest, "How many of the objects nearest to the gaze are named")
      ->type_name("N")
      ->capture_default_str();
  app.add_option("--grid-rays", arguments->objects.grid_rays,
                 "Rays over the frame that look for these; they are found to half a step of the grid")
      ->type_name("N")
      ->capture_default_str();
  app.add_option(
         "--heat-map", arguments->heat_map,
         "Where on the surfaces of the scene the gaze of all frames fell, as one of the frames sees them: a .png, "
         "or as .csv its values")
      ->type_name("OUT");
  app.add_option("--heat-frame", arguments->heat.frame, "Which frame; default: the middle one")->type_name("N");
  app.add_option("--heat-picture", arguments->heat_picture,
                 "A .png or .jpg of that frame to draw upon; default: its surfaces in grey")
      ->type_name("FILE");
  app.add_option("--heat-sigma", arguments->heat.sigma_deg,
                 "How far each direction of the cone spreads on its surface, a standard deviation seen from the eye")
      ->type_name("DEG")
      ->capture_default_str();
  add_json_option(app, arguments->json, arguments->job.settings.overwrite);
  return {[arguments] { return run_objects(*arguments); },
          [arguments](const std::string& path) { read_job_config(arguments->job, "render", path); }};
}

}  // namespace gazetrace
