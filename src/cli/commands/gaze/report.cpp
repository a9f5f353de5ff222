// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <memory>
#include <utility>

#include "cli/command.hpp"
#include "cli/exit_codes.hpp"
#include "cli/json_output.hpp"
#include "gazetrace/error.hpp"
#include "gazetrace/gaze_privacy.hpp"
#include "gazetrace/gaze_report.hpp"
#include "gazetrace/output.hpp"
#include "gazetrace/resolve.hpp"

namespace gazetrace {
namespace {

struct GazeReportArguments {
  GazeFileSettings gaze;
  ScreenSettings screen;
  GazeReportSettings report;
  std::vector<std::string> steps;
  std::string output = "gaze.html", folder;
  bool overwrite = false;
  JsonOutput json;
};

int run_gaze_report(const GazeReportArguments& arguments) {
  if (!arguments.output.empty()) {
    check_output_file(arguments.output, arguments.overwrite);
  }
  arguments.json.check();
  GazeLog log = read_gaze_file(arguments.gaze, arguments.screen);
  complete_recording_geometry(log, arguments.screen);
  if (!arguments.report.keep_ids) {
    log = without_times_of_day(std::move(log)).log;
  }
  log.warnings = with_flags(std::move(log.warnings));  // the page shows them to the program's users
  GazeReportSettings settings = arguments.report;
  settings.steps = gaze_steps_of(arguments.steps);
  GazeReport report = gaze_report(log, settings);
  report.html = with_flags(report.html);
  report.json = with_flags(report.json);
  print_warnings(report.warnings);
  std::vector<std::pair<std::string, const std::string*>> files;
  if (!arguments.folder.empty()) {
    const std::filesystem::path folder(arguments.folder);
    std::error_code problem;
    std::filesystem::create_directories(folder, problem);
    if (problem) {
      throw Error(ErrorKind::usage, "`parts`",
                  "cannot make the folder '" + arguments.folder + "': " + problem.message());
    }
    for (const GazePlot& plot : report.plots) {
      files.emplace_back((folder / (plot.name + ".svg")).string(), &plot.svg);
    }
    for (const GazeReportTable& table : report.tables) {
      files.emplace_back((folder / table.name).string(), &table.text);
    }
    for (const auto& [path, text] : files) {
      check_output_file(path, arguments.overwrite);
    }
  }
  files.emplace_back(arguments.output, &report.html);
  for (const auto& [path, text] : files) {
    write_text_atomically(path, *text);
  }
  const GazeQuality& q = report.quality.front();
  arguments.json.print(
      fmt::format("{}: {} samples, data loss {:.1f} %, {} diagrams, {:.2f} MiB\n", arguments.output, q.samples,
                  100 * q.data_loss, report.plots.size(), static_cast<double>(report.html.size()) / (1024.0 * 1024.0)),
      [&] { return report.json; });
  return exit_done;
}

}  // namespace

Command add_gaze_report_command(CLI::App& app, const Invocation& /*invocation*/) {
  auto arguments = std::make_shared<GazeReportArguments>();
  OptionSchema<GazeReportArguments> schema;
  schema.group("Events");
  schema.value(
      "--method", at(&GazeReportArguments::report, &GazeReportSettings::method), "NAME",
      "A method with its published constants ('gazetrace list event-methods'), or log; auto: as 'gaze events'");
  schema.value("--device", at(&GazeReportArguments::report, &GazeReportSettings::device), "desktop|head-mounted",
               "What it was recorded on, where places or directions do not tell");
  schema.include(gaze_file_schema(), &GazeReportArguments::gaze);
  schema.include(screen_schema(), &GazeReportArguments::screen);
  schema.include(gaze_process_schema().with_headings([](const Option&) { return "Processing"; }),
                 &GazeReportArguments::steps);
  const auto options = std::make_shared<CommandOptions<GazeReportArguments>>(std::move(schema));
  options->bind(app, *arguments);
  app.add_option("log", arguments->gaze.path, "Gaze log")->required()->type_name("FILE");
  app.add_option("-o,--output", arguments->output, "The page, one file that needs nothing else")
      ->type_name("OUT.html")
      ->capture_default_str();
  add_json_option(app, arguments->json, arguments->overwrite);
  app.add_option("--parts", arguments->folder,
                 "Writes every diagram as .svg, and as .tsv the events, those of each eye and the vergence of the eyes")
      ->type_name("DIR");
  app.add_option("--frame-image", arguments->report.picture,
                 "A .png or .jpg of what was seen, such as a rendered frame, behind scanpath and heat map")
      ->type_name("FILE");
  app.add_option("--heat-sigma", arguments->report.heat_sigma_deg,
                 "Size of a fixation's spot on the heat map, its standard deviation")
      ->type_name("DEG")
      ->capture_default_str();
  app.add_option(
         "--pupil-distance", arguments->report.pupil_distance_mm,
         "How far the pupils are apart, for the vergence of gaze on a screen and for where lines of sight meet; "
         "default: what the log says of the places of the eyes")
      ->type_name("MM");
  app.add_flag("--overwrite", arguments->overwrite, "Replaces files that are there");
  app.add_flag("--keep-ids", arguments->report.keep_ids,
               "Keeps what can identify a person or a session, such as times of day");
  return {[arguments, options] { return run_gaze_report(*arguments); }, {}};
}

}  // namespace gazetrace
