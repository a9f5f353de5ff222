// SPDX-License-Identifier: Apache-2.0
#include "gazetrace/gaze_measure.hpp"

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
#include "gazetrace/output.hpp"
#include "gazetrace/resolve.hpp"

namespace gazetrace {
namespace {

struct MeasureArguments {
  GazeFileSettings gaze;
  ScreenSettings screen;
  GazeMeasureSettings measure;
  std::vector<std::string> steps;
  std::string folder;
  JsonOutput json;
};

std::string summary(const GazeMeasurements& measured) {
  const GazeQuality& q = measured.quality.front();
  return fmt::format("{} samples in {:.5g} s, data loss {:.1f} %, {} events{}\n", q.samples, q.duration_s,
                     100 * q.data_loss, measured.events.events.size(),
                     measured.trials.size() > 1 ? fmt::format(", {} trials", measured.trials.size()) : std::string());
}

int run_gaze_measure(const MeasureArguments& arguments) {
  arguments.json.check();
  GazeLog log = read_gaze_file(arguments.gaze, arguments.screen);
  complete_recording_geometry(log, arguments.screen);
  if (!arguments.measure.keep_ids) {
    log = without_times_of_day(std::move(log)).log;
  }
  log.warnings = with_flags(std::move(log.warnings));  // they are shown to the program's users
  GazeMeasureSettings settings = arguments.measure;
  settings.steps = gaze_steps_of(arguments.steps);
  const GazeMeasurements measured = measure_gaze(log, settings);
  print_warnings(measured.warnings);
  if (!arguments.folder.empty()) {
    const std::filesystem::path folder(arguments.folder);
    std::vector<std::string> names;
    for (const GazeTable& table : measured.tables) {
      names.push_back((folder / table.name).string());
    }
    arguments.json.check(names);
    for (const GazeTable& table : measured.tables) {
      write_text_atomically((folder / table.name).string(), table.text);
    }
  }
  arguments.json.print(summary(measured), [&] { return with_flags(measured.json); });
  return exit_done;
}

}  // namespace

Command add_gaze_measure_command(CLI::App& app, const Invocation& /*invocation*/) {
  auto arguments = std::make_shared<MeasureArguments>();
  OptionSchema<MeasureArguments> schema;
  schema.group("Events");
  schema.value(
      "--method", at(&MeasureArguments::measure, &GazeMeasureSettings::method), "NAME",
      "A method with its published constants ('gazetrace list event-methods'), or log; auto: as 'gaze events'");
  schema.value("--device", at(&MeasureArguments::measure, &GazeMeasureSettings::device), "desktop|head-mounted",
               "The device of the recording, where places or directions do not tell it");
  schema.include(gaze_choice_schema(), &MeasureArguments::gaze);
  schema.include(screen_schema(), &MeasureArguments::screen);
  schema.include(gaze_process_schema().with_headings([](const Option&) { return "Processing"; }),
                 &MeasureArguments::steps);
  const auto options = std::make_shared<CommandOptions<MeasureArguments>>(std::move(schema));
  options->bind(app, *arguments);
  app.add_option("log", arguments->gaze.path, "Gaze log")->required()->type_name("FILE");
  app.add_option("--tables", arguments->folder,
                 "Writes as .tsv the events, those of each eye, the samples and the vergence of the eyes")
      ->type_name("DIR");
  app.add_option(
         "--pupil-distance", arguments->measure.pupil_distance_mm,
         "How far the pupils are apart, for the vergence of gaze on a screen and for where lines of sight meet; "
         "default: from the places of the eyes in the log")
      ->type_name("MM");
  app.add_flag("--keep-ids", arguments->measure.keep_ids,
               "Keeps data that can identify a person or a session, such as times of day");
  add_json_option(app, arguments->json);
  return {[arguments, options] { return run_gaze_measure(*arguments); }, {}};
}

}  // namespace gazetrace
