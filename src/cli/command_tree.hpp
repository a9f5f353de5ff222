// SPDX-License-Identifier: Apache-2.0
// The program's commands and options as plain values, for man pages and for completion in shells. They are taken from
// the parser itself, which is made from the definitions of the options, so that they cannot differ from it.
#pragma once

#include <string>
#include <vector>

namespace CLI {
class App;
}

namespace gazetrace {

struct OptionWords {
  std::vector<std::string> names;  // "-o", "--output"; of a positional its one name without dashes
  std::string value;               // what stands for the value in the help: "FILE", "a|b|c"; empty: a flag
  std::string help, group, default_text;
  [[nodiscard]] bool is_positional() const { return !names.front().starts_with('-'); }
};

struct CommandWords {
  std::vector<std::string> path;  // "gazetrace", "gaze", "inspect"
  std::string summary;
  std::vector<OptionWords> options;
  std::vector<CommandWords> commands;  // within it
};

CommandWords command_tree(const CLI::App& program);
// The command itself and all within it, in the order of the help.
std::vector<const CommandWords*> all_commands(const CommandWords& root);

// What the value of an option can be completed to.
struct ValueWords {
  std::vector<std::string> names;  // it is one of these, or begins with one
  bool is_file = false;
};
ValueWords values_of(const OptionWords& option);

// The names that an option such as --filter accepts, as 'gazetrace list' prints them; empty: it takes other values.
// Views are left out, which depend on the OpenColorIO config.
std::vector<std::string> names_of_option(const std::string& flag);

}  // namespace gazetrace
