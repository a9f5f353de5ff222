// SPDX-License-Identifier: Apache-2.0
#include <CLI/CLI.hpp>
#include <filesystem>
#include <memory>

#include "cli/command.hpp"
#include "cli/exit_codes.hpp"
#include "cli/inputs.hpp"
#include "gazetrace/error.hpp"

namespace gazetrace {
namespace {

struct ConvertArguments {
  GazeFileSettings gaze;
  ScreenSettings screen;
  OptionTable table;
  std::string output;
  bool overwrite = false;
};

int run_convert(const ConvertArguments& arguments) {
  const std::string& output = arguments.output;
  if (!arguments.overwrite && std::filesystem::exists(output)) {
    throw Error(ErrorKind::input, output, "this output exists already", "give --overwrite or another name");
  }
  if (const auto folder = std::filesystem::path(output).parent_path();
      !folder.empty() && !std::filesystem::is_directory(folder)) {
    throw Error(ErrorKind::input, output, "there is no folder " + folder.string(), "make it first");
  }
  const GazeLog log = read_gaze_file(arguments.gaze, arguments.screen);
  print_warnings(log.warnings);
  write_gaze_csv(log, output);
  return exit_done;
}

}  // namespace

Command add_gaze_convert_command(CLI::App& app, const Invocation& /*invocation*/) {
  auto arguments = std::make_shared<ConvertArguments>();
  add_gaze_file_options(arguments->table, arguments->gaze);
  add_screen_options(arguments->table, arguments->screen);
  bind_options(app, arguments->table);
  app.add_option("log", arguments->gaze.path, "Gaze log")->required()->type_name("FILE");
  app.add_option("-o,--output", arguments->output, "gazetrace CSV")->required()->type_name("OUT.csv");
  app.add_flag("--overwrite", arguments->overwrite, "Replaces OUT.csv when it is there");
  return {[arguments] { return run_convert(*arguments); }, nullptr};
}

}  // namespace gazetrace
