// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>

#include "cli/command.hpp"
#include "cli/exit_codes.hpp"
#include "cli/gaze_uncertainty.hpp"
#include "cli/job_help.hpp"
#include "cli/json_output.hpp"
#include "gazetrace/error.hpp"
#include "gazetrace/gaze_aois.hpp"
#include "gazetrace/gaze_outlines.hpp"
#include "gazetrace/output.hpp"

namespace gazetrace {
namespace {

struct AoisArguments {
  Job job;
  std::string areas, method = "auto", tables, outlines;
  GazeUncertainty uncertainty;
  JsonOutput json;
};

void write_tables(const AoisArguments& arguments, const AoiAnalysis& analysis) {
  const std::filesystem::path folder(arguments.tables);
  const std::pair<const char*, std::string> files[] = {{"aois.tsv", aoi_figures_as_tsv(analysis)},
                                                       {"fixations.tsv", aoi_fixations_as_tsv(analysis)},
                                                       {"transitions.tsv", aoi_transitions_as_tsv(analysis)},
                                                       {"aois.json", aois_as_json(analysis)}};
  std::vector<std::string> names;
  for (const auto& [name, text] : files) {
    names.push_back((folder / name).string());
  }
  arguments.json.check(names, job_files(arguments.job.settings));
  for (const auto& [name, text] : files) {
    write_text_atomically((folder / name).string(), text);
  }
}

void write_outlines(const AoisArguments& arguments) {
  const OutlinesOfJob made = outlines_of_job(arguments.job);
  print_warnings(made.warnings);
  write_text_atomically(arguments.outlines, outlines_as_json(made.outlines));
  if (!arguments.areas.empty()) {
    return;
  }
  const std::size_t frames = made.outlines.frames.size();
  const std::size_t objects = made.outlines.objects.size() - 1;
  arguments.json.print(
      fmt::format("{}: outlines of {} objects in {} frames\n", arguments.outlines, objects, frames), [&] {
        const nlohmann::ordered_json said{{"outlines", arguments.outlines}, {"frames", frames}, {"objects", objects}};
        return said.dump(2) + "\n";
      });
}

int run_aois(const AoisArguments& arguments) {
  if (arguments.areas.empty() && arguments.outlines.empty()) {
    throw Error(ErrorKind::usage, "", "no areas were given",
                "name a file of areas with `aois`, or one for the outlines of objects with `outlines`");
  }
  arguments.json.check({arguments.outlines}, job_files(arguments.job.settings));
  if (!arguments.outlines.empty()) {
    write_outlines(arguments);
  }
  if (arguments.areas.empty()) {
    return exit_done;
  }
  const AoisOfJob found = aois_of_job(arguments.job, arguments.areas, arguments.method, arguments.uncertainty);
  print_warnings(found.warnings);
  if (!arguments.tables.empty()) {
    write_tables(arguments, found.analysis);
  }
  arguments.json.print(aoi_figures_as_tsv(found.analysis), [&] { return aois_as_json(found.analysis); });
  return exit_done;
}

}  // namespace

Command add_gaze_aois_command(CLI::App& app, const Invocation& /*invocation*/) {
  auto arguments = std::make_shared<AoisArguments>();
  bind_job_options(app, arguments->job);
  use_job_help(
      app,
      "gazetrace gaze aois --config examples/example.toml --aois out/aois.toml --gaze-accuracy 0.5 --tables out/aois");
  add_uncertainty_options(app, arguments->uncertainty);
  app.add_option(
         "--aois", arguments->areas,
         "The areas, .toml or .json: rectangles, ellipses and polygons in fractions or pixels of the display, or "
         "objects of the scene by node or material")
      ->type_name("FILE");
  app.add_option("--outlines", arguments->outlines,
                 "Writes where each object of the scene is seen in each frame, as polygons in pixels of the frame, for "
                 "other tools; needs no gaze and no --aois")
      ->type_name("FILE.json");
  app.add_option("--method", arguments->method, "How fixations are found ('gazetrace list event-methods'), or log")
      ->type_name("NAME")
      ->capture_default_str();
  app.add_option("--tables", arguments->tables,
                 "Writes aois.tsv, fixations.tsv, transitions.tsv and aois.json into this folder")
      ->type_name("DIR");
  add_json_option(app, arguments->json, arguments->job.settings.overwrite);
  return {[arguments] { return run_aois(*arguments); },
          [arguments](const std::string& path) { read_job_config(arguments->job, "render", path); }};
}

}  // namespace gazetrace
