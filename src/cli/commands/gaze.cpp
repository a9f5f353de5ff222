// SPDX-License-Identifier: Apache-2.0
// Nothing but the way to the commands about gaze logs, each of which has a file in commands/gaze/.
#include <CLI/CLI.hpp>
#include <map>
#include <memory>

#include "cli/command.hpp"
#include "cli/exit_codes.hpp"
#include "cli/external_program.hpp"
#include "gazetrace/error.hpp"

namespace gazetrace {

Command add_gaze_command(CLI::App& app, const Invocation& invocation) {
  auto commands = std::make_shared<std::map<std::string, Command>>();
#define GAZETRACE_GAZE_COMMAND(name, help)                            \
  {                                                                   \
    CLI::App* const sub = app.add_subcommand(#name, help);            \
    sub->fallthrough();                                               \
    sub->footer(kExitCodesHelp);                                      \
    (*commands)[#name] = add_gaze_##name##_command(*sub, invocation); \
  }
#define GAZETRACE_EXTERNAL(name, help) add_external_command(app, #name, help);
#include "cli/gaze_commands.def"
#undef GAZETRACE_GAZE_COMMAND
  // The former name of `import`, understood for one version.
  CLI::App* const former = app.add_subcommand("convert", "")->group("");
  former->fallthrough();
  const Command import = add_gaze_import_command(*former, invocation);
  (*commands)["convert"] = {[import] {
                              print_warnings({"'gaze convert' is now 'gaze import'"});
                              return import.run();
                            },
                            import.read_config};
  app.require_subcommand(1);
  const auto chosen = [commands, &app]() -> const Command& {
    return commands->at(app.get_subcommands().front()->get_name());
  };
  return {[chosen] { return chosen().run(); },
          [chosen](const std::string& path) {
            if (!chosen().read_config) {
              throw Error(ErrorKind::usage, "`config`",
                          "only commands with the options of 'render' take a settings file");
            }
            chosen().read_config(path);
          }};
}

}  // namespace gazetrace
