// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "cli/option_table.hpp"

namespace CLI {
class App;
}

namespace gazetrace {

struct Invocation {
  std::vector<std::string> arguments;  // the whole command line, program included
};

struct Command {
  std::function<int()> run;                    // called after parsing; returns an exit code
  std::shared_ptr<const OptionTable> options;  // what a settings file may hold; empty: takes none
};

// One function a command adds its options to its own subcommand.
#define GAZETRACE_COMMAND(name, help) Command add_##name##_command(CLI::App& app, const Invocation& invocation);
#include "cli/commands.def"
#undef GAZETRACE_COMMAND
#define GAZETRACE_GAZE_COMMAND(name, help) \
  Command add_gaze_##name##_command(CLI::App& app, const Invocation& invocation);
#include "cli/gaze_commands.def"
#undef GAZETRACE_GAZE_COMMAND

// Makes CLI11 options of a table's entries; both must live until parsing is done.
void bind_options(CLI::App& app, const OptionTable& table);

// Error(input) where the file exists and may not be replaced, or its folder does not.
void check_output_file(const std::string& path, bool overwrite);

// Writes a result to stdout. A reader that has gone away (head, a closed pager) is no error.
void print_result(const std::string& text);
// Messages of the library name settings in back quotes; the program's users know them as flags: `gaze-start` becomes
// --gaze-start.
std::string with_flags(const std::string& text);
std::vector<std::string> with_flags(std::vector<std::string> texts);
void print_warnings(const std::vector<std::string>& warnings);

}  // namespace gazetrace
