// SPDX-License-Identifier: Apache-2.0
// The one rule for results as JSON: `--json` alone, or with `-`, prints them on stdout in place of the text; `--json
// FILE` writes them to the file, and the text is printed as without the option.
#pragma once

#include <functional>
#include <string>
#include <vector>

namespace CLI {
class App;
}

namespace gazetrace {

inline constexpr const char* kJsonHelp =
    "Results as JSON, into a .json file, or on stdout in place of text (no FILE, or -)";

struct JsonOutput {
  std::string path;  // empty: nobody asked for JSON; "-": stdout

  [[nodiscard]] bool wanted() const { return !path.empty(); }
  [[nodiscard]] bool on_stdout() const { return path == "-"; }
  // check_outputs() for the file and the command's other `outputs`, for the beginning of work that takes long. Inputs
  // are whatever else the command line names, and `inputs`: what these name in turn.
  void check(const std::vector<std::string>& outputs = {}, std::vector<std::string> inputs = {}) const;
  // Prints `text`, unless the JSON takes its place, and writes the JSON where it is wanted.
  void print(const std::string& text, const std::function<std::string()>& json) const;

  std::function<bool()> may_replace;  // whether a file that is there is replaced
  const CLI::App* app = nullptr;      // of the command
};

// Adds --json to a command. Called after the command's other options: where it has no --overwrite, one is added.
void add_json_option(CLI::App& app, JsonOutput& json);
// The same for a command that already has --overwrite, and where `overwrite` may also come from a settings file.
void add_json_option(CLI::App& app, JsonOutput& json, const bool& overwrite);

// The arguments with the file of --json joined to it, as in --json=FILE: what follows is its file only where it is `-`
// or ends in .json, so that `gazetrace scene --json room.gltf` reads the scene.
std::vector<std::string> with_json_joined(const std::vector<std::string>& arguments);

}  // namespace gazetrace
