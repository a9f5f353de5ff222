// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>
#include <string>
#include <vector>

#include "cli/command.hpp"
#include "cli/exit_codes.hpp"
#include "cli/job_help.hpp"
#include "cli/option_reference.hpp"
#include "gazetrace/error.hpp"

namespace gazetrace {
namespace {

constexpr const char* kFormerOptions = "former-options";
constexpr const char* kFarmOptions = "farm-options";

int run_help(const CLI::App& program, const std::vector<std::string>& words) {
  const std::string first = words.empty() ? std::string() : words.front();
  if (first == kFormerOptions || first == kFarmOptions) {
    if (words.size() > 1) {
      throw Error(ErrorKind::usage, "help", fmt::format("'{}' has no pages within it", first));
    }
    print_result(first == kFarmOptions ? farm_options_as_text() : former_options_as_text());
    return exit_done;
  }
  const CLI::App* found = &program;
  std::string name = program.get_name();
  for (const std::string& word : words) {
    std::vector<std::string> known;
    const CLI::App* next = nullptr;
    for (const CLI::App* command : found->get_subcommands([](const CLI::App*) { return true; })) {
      known.push_back(command->get_name());
      next = command->get_name() == word ? command : next;
    }
    if (next == nullptr) {
      if (found == &program) {
        known.insert(known.end(), {kFormerOptions, kFarmOptions});
      }
      throw Error(ErrorKind::usage, "help", unknown_name_message("command", word, known));
    }
    found = next;
    name += " " + word;
  }
  // App::help() of a command within which another was chosen is that of the other, which here would be this command.
  print_result(found->get_formatter()->make_help(found, name, CLI::AppFormatMode::Normal));
  return exit_done;
}

}  // namespace

Command add_help_command(CLI::App& app, const Invocation& /*invocation*/) {
  const auto words = std::make_shared<std::vector<std::string>>();
  app.add_option("command", *words,
                 "Such as render or gaze inspect; default: the list of all. farm-options: those of machines "
                 "that share a sequence; former-options: replacements of old options")
      ->type_name("COMMAND");
  return {[words, &app] { return run_help(*app.get_parent(), *words); }, {}};
}

}  // namespace gazetrace
