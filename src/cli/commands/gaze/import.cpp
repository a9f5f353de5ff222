// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>

#include "cli/command.hpp"
#include "cli/exit_codes.hpp"
#include "cli/json_output.hpp"
#include "gazetrace/error.hpp"
#include "gazetrace/gaze_privacy.hpp"
#include "gazetrace/gaze_read.hpp"
#include "gazetrace/gaze_write.hpp"
#include "gazetrace/resolve.hpp"

namespace gazetrace {
namespace {

struct ImportArguments {
  GazeFileSettings gaze;
  ScreenSettings screen;
  std::vector<std::string> steps;
  std::string output;
  bool overwrite = false;
  bool keep_ids = false;
  JsonOutput json;
};

std::string file_names(const std::vector<BidsLeftover>& files) {
  std::string names;
  for (const BidsLeftover& file : files) {
    names += (names.empty() ? "" : ", ") + std::filesystem::path(file.path).filename().string();
  }
  return names;
}

// Recordings of the name that is written to are read with it. Those of an earlier conversion go with --overwrite, never
// others, nor what is being converted.
std::vector<BidsLeftover> removable_leftovers(const std::vector<std::string>& written,
                                              const ImportArguments& arguments) {
  std::vector<BidsLeftover> leftovers = bids_leftovers(written);
  if (leftovers.empty()) {
    return leftovers;
  }
  const auto is_source = [&](const std::string& path) {
    std::error_code code;
    return std::filesystem::equivalent(path, arguments.gaze.path, code);
  };
  const bool reads_itself =
      std::any_of(written.begin(), written.end(), is_source) ||
      std::any_of(leftovers.begin(), leftovers.end(), [&](const BidsLeftover& l) { return is_source(l.path); });
  std::vector<BidsLeftover> foreign = leftovers;
  std::erase_if(foreign, [](const BidsLeftover& leftover) { return leftover.is_own; });
  if (reads_itself || !foreign.empty() || !arguments.overwrite) {
    throw Error(ErrorKind::input, arguments.output,
                fmt::format("beside it lies, and would be read with it: {}",
                            file_names(reads_itself || foreign.empty() ? leftovers : foreign)),
                reads_itself       ? "it is the input: give another name"
                : !foreign.empty() ? "gazetrace did not write that: move it away, or give another name"
                                   : "give --overwrite, which removes it, or another name");
  }
  return leftovers;
}

nlohmann::ordered_json decisions_as_json(const std::vector<GazeFact>& facts) {
  nlohmann::ordered_json json = nlohmann::ordered_json::array();
  for (const GazeFact& fact : facts) {
    json.push_back({{"what", fact.what},
                    {"value", fact.value},
                    {"evidence", to_string(fact.evidence)},
                    {"detail", with_flags(fact.detail)}});
  }
  return json;
}

int run_import(const ImportArguments& arguments) {
  const bool is_bids = is_bids_file_name(arguments.output);
  arguments.json.check({is_bids ? std::string() : arguments.output});
  std::vector<std::string> reports;  // of the steps of processing
  const auto tell = [&](const GazeLog& log, const std::vector<std::string>& files) {
    std::string text = decisions_in_words(log.facts);
    text = arguments.keep_ids ? text : without_dates(text);
    for (const std::string& report : reports) {
      text += report + "\n";
    }
    arguments.json.print(text, [&] {
      const nlohmann::ordered_json json{{"files", files},
                                        {"samples", log.samples.size()},
                                        {"processing", reports},
                                        {"decisions", decisions_as_json(log.facts)},
                                        {"warnings", with_flags(log.warnings)}};
      return json.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
    });
  };
  GazeFileSettings settings = arguments.gaze;
  settings.read.accepts_inferred = true;
  GazeLog log = read_gaze_file(settings, arguments.screen);
  print_warnings(log.warnings);
  if (!arguments.keep_ids) {
    print_warnings(leave_out_identities(log));
  }
  if (!arguments.steps.empty()) {
    complete_recording_geometry(log, arguments.screen);
    ProcessedGaze processed = process_gaze(log, gaze_steps_of(arguments.steps));
    reports = std::move(processed.reports);
    log = std::move(processed.log);
  }
  if (!is_bids) {
    write_gaze_csv(log, arguments.output);
    tell(log, {arguments.output});
    return exit_done;
  }
  check_outputs({arguments.output}, {}, true);  // makes the folder, which is held while it is looked at and written
  std::vector<std::string> written;
  std::vector<BidsLeftover> leftovers;
  write_gaze_bids(log, arguments.output, [&](const std::vector<std::string>& files) {
    written = files;
    leftovers = removable_leftovers(written, arguments);
    std::vector<std::string> removed;
    for (const BidsLeftover& leftover : leftovers) {
      removed.push_back(leftover.path);
    }
    arguments.json.check(written);
    return removed;
  });
  if (!log.head.empty()) {
    print_warnings(
        {fmt::format("{}: {} poses of the head are left out: BIDS eye tracking has no place for them, "
                     "gazetrace CSV keeps them",
                     log.source, log.head.size())});
  }
  if (!leftovers.empty()) {
    print_warnings({fmt::format("{}: removed, of an earlier conversion: {}", arguments.output, file_names(leftovers))});
  }
  tell(log, written);
  return exit_done;
}

}  // namespace

Command add_gaze_import_command(CLI::App& app, const Invocation& /*invocation*/) {
  auto arguments = std::make_shared<ImportArguments>();
  OptionSchema<ImportArguments> schema;
  schema.include(gaze_import_schema(), &ImportArguments::gaze);
  schema.include(screen_schema(), &ImportArguments::screen);
  schema.include(gaze_process_schema().with_headings([](const Option&) { return "Processing"; }),
                 &ImportArguments::steps);
  const auto options = std::make_shared<CommandOptions<ImportArguments>>(std::move(schema));
  options->bind(app, *arguments);
  app.add_option("log", arguments->gaze.path, "Gaze log")->required()->type_name("FILE");
  app.add_option("-o,--output", arguments->output,
                 "gazetrace CSV, or BIDS where the name is one of it: sub-01_task-view_physio.tsv.gz, with a file for "
                 "each eye, "
                 "sidecars and events beside it")
      ->required()
      ->type_name("OUT");
  app.add_flag(
      "--overwrite", arguments->overwrite,
      "Replaces files that are there; recordings of that BIDS name that an earlier conversion left are removed");
  app.add_flag("--keep-ids", arguments->keep_ids,
               "Also writes messages of the experiment and dates in the description of the clock, which can identify a "
               "person or a session; stamps are written as they are either way");
  add_json_option(app, arguments->json, arguments->overwrite);
  return {[arguments, options] { return run_import(*arguments); }, {}};
}

}  // namespace gazetrace
