// SPDX-License-Identifier: Apache-2.0
#include "gazetrace/gaze_inspect.hpp"

#include <CLI/CLI.hpp>
#include <memory>

#include "cli/command.hpp"
#include "cli/exit_codes.hpp"
#include "cli/json_output.hpp"
#include "gazetrace/error.hpp"
#include "gazetrace/output.hpp"
#include "gazetrace/resolve.hpp"

namespace gazetrace {
namespace {

struct InspectArguments {
  GazeFileSettings gaze;
  ScreenSettings screen;
  std::string save_columns;
  bool keep_ids = false;
  JsonOutput json;
};

// The raw numbers of the trial alone, which an inspection interprets again.
void cut_rows(RawGaze& raw, const GazeTrial& trial) {
  const bool corner_moves = !raw.corners.empty();  // counts rows, which must then stay
  if (!corner_moves) {
    raw.rows.keep_if([&](const RawSample& row) { return row.t_ns >= trial.begin_ns && row.t_ns <= trial.end_ns; });
  }
}

int run_inspect(const InspectArguments& arguments) {
  arguments.json.check({arguments.save_columns});
  GazeUnderInspection gaze = load_for_inspection(arguments.gaze.path, read_options(arguments.gaze, arguments.screen));
  name_trials(gaze.log, arguments.gaze.trial_rules);
  if (!arguments.gaze.trial.empty()) {
    gaze.log = chosen_trial(std::move(gaze.log), arguments.gaze.trial);
    cut_rows(gaze.raw, *gaze.log.trial);
  }
  GazeInspectOptions options;
  options.display = screen_geometry(arguments.screen);
  options.keep_ids = arguments.keep_ids;
  const GazeInspection inspection = inspect_gaze(gaze, options);
  if (!arguments.save_columns.empty()) {
    save_gaze_columns(merged_columns(arguments.gaze), arguments.save_columns);
  }
  arguments.json.print(with_flags(inspection_text(inspection)),
                       [&] { return with_flags(inspection_json(inspection)); });
  return exit_done;
}

}  // namespace

Command add_gaze_inspect_command(CLI::App& app, const Invocation& /*invocation*/) {
  auto arguments = std::make_shared<InspectArguments>();
  OptionSchema<InspectArguments> schema;
  schema.include(gaze_import_schema(), &InspectArguments::gaze);
  schema.include(screen_schema(), &InspectArguments::screen);
  const auto options = std::make_shared<CommandOptions<InspectArguments>>(std::move(schema));
  options->bind(app, *arguments);
  app.add_option("log", arguments->gaze.path, "Gaze log")->required()->type_name("FILE");
  app.add_option("--save-columns", arguments->save_columns, "Writes the given options of columns as a column map")
      ->type_name("MAP.json");
  app.add_flag("--keep-ids", arguments->keep_ids,
               "Also shows data that can identify a person or a session, such as times of day; left out otherwise");
  add_json_option(app, arguments->json);
  return {[arguments, options] { return run_inspect(*arguments); }, {}};
}

}  // namespace gazetrace
