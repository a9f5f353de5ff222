// SPDX-License-Identifier: Apache-2.0
#include <CLI/CLI.hpp>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "cli/command.hpp"
#include "cli/command_tree.hpp"
#include "cli/exit_codes.hpp"
#include "cli/man_page.hpp"
#include "gazetrace/error.hpp"
#include "gazetrace/output.hpp"

namespace gazetrace {
namespace {

struct ManArguments {
  std::vector<std::string> command;
  std::string folder;
};

int run_man(const ManArguments& arguments, const CommandWords& program) {
  std::vector<std::string> known;
  for (const CommandWords* command : all_commands(program)) {
    if (!arguments.folder.empty()) {
      const std::string path = (std::filesystem::path(arguments.folder) / man_page_name(*command)).string();
      check_outputs({path}, {}, true);
      write_text_atomically(path, man_page(*command));
      continue;
    }
    const std::vector<std::string> words(command->path.begin() + 1, command->path.end());
    if (words == arguments.command) {
      print_result(man_page(*command));
      return exit_done;
    }
    if (words.size() == 1) {
      known.push_back(words.front());
    }
  }
  if (arguments.folder.empty()) {
    throw Error(ErrorKind::usage, "man", unknown_name_message("command", arguments.command.front(), known));
  }
  return exit_done;
}

}  // namespace

Command add_man_command(CLI::App& app, const Invocation& /*invocation*/) {
  const auto arguments = std::make_shared<ManArguments>();
  app.add_option("command", arguments->command, "Such as render or gaze inspect; default: of the program itself")
      ->type_name("COMMAND");
  app.add_option("--folder", arguments->folder, "Writes the pages of all commands into this folder")->type_name("DIR");
  return {[arguments, &app] { return run_man(*arguments, command_tree(*app.get_parent())); }, {}};
}

}  // namespace gazetrace
