// SPDX-License-Identifier: Apache-2.0
#include <CLI/CLI.hpp>
#include <memory>

#include "cli/command.hpp"
#include "cli/command_tree.hpp"
#include "cli/exit_codes.hpp"
#include "cli/shell_completion.hpp"

namespace gazetrace {

Command add_completion_command(CLI::App& app, const Invocation& /*invocation*/) {
  const auto shell = std::make_shared<std::string>();
  app.add_option("shell", *shell, "source <(gazetrace completion bash); installed packages bring it along")
      ->required()
      ->type_name("bash|zsh|fish");
  return {[shell, &app] {
            print_result(shell_completion(command_tree(*app.get_parent()), *shell));
            return static_cast<int>(exit_done);
          },
          {}};
}

}  // namespace gazetrace
