// SPDX-License-Identifier: Apache-2.0
#include "gazetrace/version.hpp"

#include <CLI/CLI.hpp>
#include <memory>
#include <nlohmann/json.hpp>

#include "cli/command.hpp"
#include "cli/exit_codes.hpp"
#include "cli/json_output.hpp"
#include "gazetrace/error.hpp"
#include "gazetrace/reconstruct.hpp"

namespace gazetrace {

Command add_version_command(CLI::App& app, const Invocation& /*invocation*/) {
  const auto json = std::make_shared<JsonOutput>();
  add_json_option(app, *json);
  return {[json] {
            DenoiserLibrary found;
            std::string denoiser;
            try {
              found = denoiser_library();
              denoiser = found.path.empty()
                             ? "none: the filter guided takes the place of oidn; " +
                                   (found.problem.empty() ? "cmake/denoiser.sh brings it" : found.problem)
                             : denoiser_description() + ", " + found.path;
            } catch (const Error& unusable) {
              denoiser = unusable.what();
            }
            json->print(std::string("gazetrace ") + kVersion + "\ndenoiser: " + denoiser + "\n", [&] {
              return nlohmann::ordered_json{{"name", "gazetrace"},
                                            {"version", kVersion},
                                            {"denoiser", {{"version", found.version}, {"path", found.path}}}}
                         .dump(2) +
                     "\n";
            });
            return static_cast<int>(exit_done);
          },
          {}};
}

}  // namespace gazetrace
