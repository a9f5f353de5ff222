// SPDX-License-Identifier: Apache-2.0
#include "cli/json_output.hpp"

#include <CLI/CLI.hpp>

#include "cli/command.hpp"
#include "gazetrace/output.hpp"

namespace gazetrace {

void JsonOutput::check() const {
  if (wanted() && !on_stdout()) {
    check_output_file(path, may_replace && may_replace());
  }
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
        "--overwrite", [](std::int64_t) {}, "Replaces the file of --json when it is there");
  }
  json.may_replace = [overwrite] { return overwrite->count() > 0; };
}

void add_json_option(CLI::App& app, JsonOutput& json, const bool& overwrite) {
  app.add_option("--json", json.path, kJsonHelp)->type_name("[FILE]");
  json.may_replace = [&overwrite] { return overwrite; };
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
