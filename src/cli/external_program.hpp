// SPDX-License-Identifier: Apache-2.0
// Commands that are programs of their own: `gazetrace NAME` runs gazetrace-NAME, and `gazetrace gaze NAME` runs
// gazetrace-gaze-NAME, which lies beside this program or on the PATH, for names that are not built in.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace CLI {
class App;
}

namespace gazetrace {

struct ExternalProgram {
  std::filesystem::path path;
  std::vector<std::string> arguments;
};

// A command that is listed with the others, and run by a program of its own.
void add_external_command(CLI::App& above, const std::string& name, const std::string& help);

// What runs these words; empty where they name what is built in, or nothing that is found. Error(input) where they name
// a listed command whose program is missing.
std::optional<ExternalProgram> find_external_program(const CLI::App& program, std::vector<std::string> words);

// Becomes that program; returns only by Error(runtime).
int run_external_program(const ExternalProgram& external);

// The first file of this name in the folders of the PATH.
std::optional<std::filesystem::path> find_on_path(const std::string& name);

}  // namespace gazetrace
