// SPDX-License-Identifier: Apache-2.0
// Settings files: CLI11's own TOML loses data (a quoted '#' cuts a value, spaces break strings, unknown keys pass), so
// they are read and written through toml++ and an option table.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>
#include <iosfwd>
#include <string>
#include <vector>

#include "cli/option_table.hpp"
#include "cli/toml_tree.hpp"

namespace gazetrace {

class TomlConfig : public CLI::Config {
 public:
  // The table, command name and file of the command in use, asked for when a file is read. A command without a table
  // takes no settings file.
  struct Target {
    const OptionTable* table = nullptr;
    std::string command;
    std::string path;
  };
  explicit TomlConfig(std::function<Target()> target) : target_(std::move(target)) {}

  // Error(input) with file:line for a syntax error, an unknown key (with the nearest known one) or a wrong value.
  [[nodiscard]] std::vector<CLI::ConfigItem> from_config(std::istream& input) const override;
  // Every option with its present value, help as comments; options that are not set stand in a comment.
  [[nodiscard]] std::string to_config(const CLI::App* app, bool default_also, bool write_description,
                                      std::string prefix) const override;

 private:
  std::function<Target()> target_;
};

// The values that an option takes from a node, as the command line would carry them. Error(input) with path:line.
std::vector<std::string> toml_values(const TomlNode& node, const OptionEntry& entry, const std::string& path);

// Sets a table's options to what the text of settings_as_toml says. Error(input) with path:line, as from_config.
void assign_toml(const OptionTable& table, const std::string& text, const std::string& path);

// The text of to_config, for a table alone.
std::string settings_as_toml(const OptionTable& table, const std::string& title);

}  // namespace gazetrace
