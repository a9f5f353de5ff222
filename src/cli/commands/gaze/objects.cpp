// SPDX-License-Identifier: Apache-2.0
#include "gazetrace/gaze_objects.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
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
  std::string table, heat_map;
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

int run_objects(ObjectsArguments& arguments) {
  for (const std::string& output : {arguments.table, arguments.heat_map}) {
    if (!output.empty()) {
      check_output_file(output, arguments.job.settings.overwrite);
    }
  }
  arguments.json.check();
  arguments.objects.stimulus = arguments.recorded_here ? Stimulus::recorded : Stimulus::replayed;
  const bool asks_for_heat = !arguments.heat_map.empty();
  const GazeOnScene seen =
      look_at_scene(arguments.job, arguments.objects, asks_for_heat ? std::optional(arguments.heat) : std::nullopt);
  print_warnings(seen.resolved.warnings);
  if (asks_for_heat) {
    write_text_atomically(arguments.heat_map, seen.heat_svg);
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
  app.add_option("--heat-map", arguments->heat_map,
                 "Draws on the surfaces of the scene where the gaze of all frames fell, as one of the frames sees them")
      ->type_name("OUT.svg");
  app.add_option("--heat-frame", arguments->heat.frame, "Which frame; default: the middle one")->type_name("N");
  app.add_option("--heat-picture", arguments->heat.picture,
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
