// SPDX-License-Identifier: Apache-2.0
// The program: parse, run one command, turn the one exception type into one line and an exit code.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <csignal>
#include <cstdio>
#include <exception>
#include <map>
#include <memory>
#include <new>
#include <string>
#include <utility>
#include <vector>

#include "cli/command.hpp"
#include "cli/exit_codes.hpp"
#include "cli/json_output.hpp"
#include "gazetrace/error.hpp"
#include "gazetrace/option_schema.hpp"
#include "gazetrace/version.hpp"

namespace gazetrace {
namespace {

constexpr std::size_t kLongestLine = 3000;

int report(const std::string& message, int exit_code) {
  std::fprintf(stderr, "gazetrace: error: %s\n", bounded(with_flags(message), kLongestLine).c_str());
  return exit_code;
}

const CLI::App* chosen_command(const CLI::App& app) {
  const auto parsed = app.get_subcommands();
  return parsed.empty() ? nullptr : parsed.front();
}

// The command within it that was asked for, or itself: "gaze inspect" and its options.
const CLI::App* innermost(const CLI::App* command, std::string& words) {
  while (command != nullptr) {
    words += " " + command->get_name();
    const auto parsed = command->get_subcommands();
    if (parsed.empty()) {
      return command;
    }
    command = parsed.front();
  }
  return nullptr;
}

std::vector<std::string> names_within(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::App* sub : app.get_subcommands([](const CLI::App*) { return true; })) {
    names.push_back(sub->get_name());
  }
  return names;
}

// CLI11's message, with the nearest name where an option is unknown.
std::string parse_error_text(const CLI::App& app, const CLI::ParseError& error) {
  std::string words = "gazetrace";
  const CLI::App* command = innermost(chosen_command(app), words);
  const std::vector<std::string> commands = names_within(command == nullptr ? app : *command);
  std::string text = error.what();
  for (const std::string& word : app.remaining(true)) {
    if (!word.starts_with('-') && commands.empty()) {
      continue;
    }
    std::vector<std::string> known = commands;
    if (commands.empty()) {
      for (const CLI::Option* option : command->get_options()) {
        for (const std::string& name : option->get_lnames()) {
          known.push_back("--" + name);
        }
      }
      known.emplace_back("--config");
    }
    const std::string name = word.substr(0, word.find('='));
    text = commands.empty()     ? unknown_among_many("option", name, known)
           : command == nullptr ? unknown_among_many("command", name, known)
                                : unknown_name_message("command", name, known);
    break;
  }
  return text + "; see '" + words + " --help'";
}

int run(int argc, char** argv) {
  CLI::App app{"gazetrace renders what a person looked at: foveated path tracing along a recorded gaze", "gazetrace"};
  app.set_version_flag("--version", std::string("gazetrace ") + kVersion, "Print the version and exit");
  app.require_subcommand(1);
  app.fallthrough(false);
  app.footer(kExitCodesHelp);

  const Invocation invocation{{argv, argv + argc}};
  std::map<std::string, Command> commands;
#define GAZETRACE_COMMAND(name, help)                         \
  {                                                           \
    CLI::App* sub = app.add_subcommand(#name, help);          \
    sub->fallthrough();                                       \
    sub->footer(kExitCodesHelp);                              \
    commands[#name] = add_##name##_command(*sub, invocation); \
  }
#include "cli/commands.def"
#undef GAZETRACE_COMMAND

  std::string config;
  app.add_option("--config", config,
                 "A TOML file with options of the command; what stands on the command line wins ('gazetrace render "
                 "--print-config' writes one for 'render' and 'plan')")
      ->type_name("FILE");

  try {
    std::vector<std::string> words = with_json_joined({argv + 1, argv + argc});
    std::reverse(words.begin(), words.end());  // as CLI11 takes a vector
    app.parse(std::move(words));
  } catch (const CLI::Success& help_or_version) {
    print_result("");
    return app.exit(help_or_version);
  } catch (const CLI::ParseError& error) {
    return report(parse_error_text(app, error), exit_bad_input);
  }
  const Command& command = commands.at(chosen_command(app)->get_name());
  if (!config.empty()) {
    if (!command.read_config) {
      throw Error(ErrorKind::usage, "`config`", "only 'render' and 'plan' take a settings file");
    }
    command.read_config(config);
  }
  return command.run();
}

}  // namespace
}  // namespace gazetrace

int main(int argc, char** argv) {
  using namespace gazetrace;
  std::signal(SIGPIPE, SIG_IGN);  // a reader of stdout that goes away is no error: see print_result
#ifdef SIGXFSZ
  std::signal(SIGXFSZ, SIG_IGN);  // a file beyond the limit on sizes fails like a full disk
#endif
  try {
    return run(argc, argv);
  } catch (const Error& error) {
    if (error.kind() == ErrorKind::nothing_to_do) {
      std::fprintf(stderr, "gazetrace: %s: nothing to do\n", bounded(with_flags(error.what())).c_str());
      return exit_done;
    }
    return report(error.what(), exit_code_of(error));
  } catch (const std::bad_alloc&) {
    return report("out of memory", exit_failed);
  } catch (const std::exception& error) {
    return report(std::string("something failed that should have been told in better words: ") + error.what() +
                      "; please report it with the command",
                  exit_failed);
  }
}
