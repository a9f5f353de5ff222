// SPDX-License-Identifier: Apache-2.0
#include "gazetrace/version.hpp"

#include <CLI/CLI.hpp>
#include <memory>
#include <nlohmann/json.hpp>

#include "cli/command.hpp"
#include "cli/exit_codes.hpp"
#include "cli/json_output.hpp"

namespace gazetrace {

Command add_version_command(CLI::App& app, const Invocation& /*invocation*/) {
  const auto json = std::make_shared<JsonOutput>();
  add_json_option(app, *json);
  return {[json] {
            json->print(std::string("gazetrace ") + kVersion + "\n", [] {
              return nlohmann::ordered_json{{"name", "gazetrace"}, {"version", kVersion}}.dump(2) + "\n";
            });
            return static_cast<int>(exit_done);
          },
          {}};
}

}  // namespace gazetrace
