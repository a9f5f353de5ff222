// SPDX-License-Identifier: Apache-2.0
#include "cli/json_output.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>

#include "cli/command.hpp"
#include "gazetrace/output.hpp"

namespace gazetrace {

namespace {

// What the options and words of a command name, but for the one that asks for each output.
std::vector<std::string> named_beside(const CLI::App* app, std::vector<std::string> outputs) {
  std::vector<std::string> names;
  for (; app != nullptr; app = app->get_parent()) {
    for (const CLI::Option* option : app->get_options()) {
      for (const std::string& value : option->results()) {
        const auto asked = std::find_if(outputs.begin(), outputs.end(), [&](const std::string& output) {
          return std::filesystem::path(output).lexically_normal() == std::filesystem::path(value).lexically_normal();
        });
        if (asked == outputs.end()) {
          names.push_back(value);
        } else {
          outputs.erase(asked);
        }
      }
    }
  }
  return names;
}

}  // namespace

void JsonOutput::check(const std::vector<std::string>& outputs, std::vector<std::string> inputs) const {
  std::vector<std::string> all = outputs;
  all.push_back(on_stdout() ? std::string() : path);
  const std::vector<std::string> named = named_beside(app, all);
  inputs.insert(inputs.end(), named.begin(), named.end());
  check_outputs(all, inputs, may_replace());
}

void JsonOutput::print(const std::string& text, const std::function<std::string()>& json) const {
  if (wanted() && !on_stdout()) {
    check();
    write_text_atomically(path, json());
  }
  print_result(on_stdout() ? json() : text);
}

void add_json_option(CLI::App& app, JsonOutput& json) {
  app.add_option("--json", json.path, kJsonHelp)->type_name("[FILE]");
  CLI::Option* overwrite = app.get_option_no_throw("--overwrite");
  if (overwrite == nullptr) {
    overwrite = app.add_flag_function(
        "--overwrite", [](std::int64_t) {}, "Replaces files that are there");
  }
  json.may_replace = [overwrite] { return overwrite->count() > 0; };
  json.app = &app;
}

void add_json_option(CLI::App& app, JsonOutput& json, const bool& overwrite) {
  app.add_option("--json", json.path, kJsonHelp)->type_name("[FILE]");
  json.may_replace = [&overwrite] { return overwrite; };
  json.app = &app;
}

std::vector<std::string> with_json_joined(const std::vector<std::string>& arguments) {
  std::vector<std::string> joined;
  for (std::size_t i = 0; i < arguments.size(); ++i) {
    if (arguments[i] == "--") {
      joined.insert(joined.end(), arguments.begin() + static_cast<std::ptrdiff_t>(i), arguments.end());
      break;
    }
    if (arguments[i] != "--json") {
      joined.push_back(arguments[i]);
      continue;
    }
    const std::string next = i + 1 < arguments.size() ? arguments[i + 1] : std::string();
    const bool is_file = next == "-" || (next.ends_with(".json") && !next.starts_with("-"));
    joined.push_back("--json=" + (is_file ? next : std::string("-")));
    i += is_file ? 1 : 0;
  }
  return joined;
}

}  // namespace gazetrace
