// SPDX-License-Identifier: Apache-2.0
// The program: parse, run one command, turn the one exception type into one line and an exit code.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <csignal>
#include <cstdio>
#include <exception>
#include <map>
#include <memory>
#include <new>
#include <optional>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "cli/command.hpp"
#include "cli/exit_codes.hpp"
#include "cli/external_program.hpp"
#include "cli/interruption.hpp"
#include "cli/json_output.hpp"
#include "gazetrace/error.hpp"
#include "gazetrace/former_options.hpp"
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

std::vector<std::string> flags_of(const CLI::App& command) {
  std::vector<std::string> flags{"--config"};
  for (const CLI::Option* option : command.get_options()) {
    for (const std::string& name : option->get_lnames()) {
      if (!option->get_group().empty()) {  // those without are hidden
        flags.push_back("--" + name);
      }
    }
  }
  return flags;
}

// The value that the command takes by its place alone, where it has the name of this flag.
const CLI::Option* placed_option(const std::string& flag, const CLI::App& command) {
  const auto all = command.get_options([&](const CLI::Option* option) {
    return option->get_positional() && !option->nonpositional() && "--" + option->get_name(true) == flag;
  });
  return all.empty() ? nullptr : all.front();
}

// What to say of an option that the command does not have, or that stands before it.
std::string unknown_option_text(const std::string& flag, const CLI::App& command, const std::string& words) {
  if (const CLI::Option* placed = placed_option(flag, command)) {
    return fmt::format("'{}' is no option: its value stands by itself, as in '{} {}'", flag, words,
                       placed->get_type_name().empty() ? "VALUE" : placed->get_type_name());
  }
  const std::vector<std::string> known = flags_of(command);
  const auto is_known = [&](const std::string& name) {
    return std::find(known.begin(), known.end(), name) != known.end();
  };
  if (is_known(flag)) {
    return "'" + flag + "' stands before the command; write it after: '" + words + " " + flag + " ...'";
  }
  const FormerOption* former = flag.starts_with("--") ? find_former_option(flag.substr(2), "") : nullptr;
  // What other programs call the options of a job means nothing to a command that has others.
  if (former != nullptr && (former->kind != FormerKind::elsewhere || is_known("--spp"))) {
    if (const std::optional<std::string> refusal = refusal_of(*former)) {
      return flag + ": " + *refusal;
    }
    const auto& now = former->replacements;
    if (!now.empty() && is_known("--" + now.front().first)) {
      return "'" + flag + "' is now --" + now.front().first + "; " + former->reason;
    }
  }
  if (flag == "-o" || flag == "--output") {
    const auto folders = command.get_options([](const CLI::Option* option) {
      return option->get_positional() && (option->get_type_name() == "FOLDER" || option->get_type_name() == "DIR");
    });
    if (!folders.empty()) {
      return fmt::format("'{}' is no option here: the folder stands by itself, as in '{} FOLDER'", flag, words);
    }
  }
  if (flag.starts_with("--") && job_schema().find(flag.substr(2)) != nullptr) {
    return "'" + flag + "' is an option of 'gazetrace render', and none of '" + words + "'";
  }
  if (flag.starts_with("--") && gaze_import_schema().find(flag.substr(2)) != nullptr) {
    return "'" + flag + "' is an option of 'gazetrace gaze import', which writes a file that '" + words + "' reads";
  }
  return unknown_among_many("option", flag, known);
}

// What nobody took, such as the name of a command that does not exist; empty: CLI11's own message is better.
std::string unknown_word_text(const CLI::App& app, const CLI::App* command, const std::string& words) {
  const std::vector<std::string> commands = names_within(command == nullptr ? app : *command);
  for (const std::string& word : app.remaining(true)) {
    const std::string name = word.substr(0, word.find('='));
    if (word.starts_with('-')) {
      return unknown_option_text(name, command == nullptr ? app : *command, words);
    }
    if (!commands.empty()) {
      return command == nullptr ? unknown_among_many("command", name, commands)
                                : unknown_name_message("command", name, commands);
    }
    return fmt::format(
        "'{}' is one word too many: a value with spaces stands in quotes, and the numbers of a value have "
        "commas or an x between",
        word);
  }
  return {};
}

// CLI11's message, or a better one where a word is unknown.
std::string parse_error_text(const CLI::App& app, const CLI::ParseError& error) {
  std::string words = "gazetrace";
  const CLI::App* command = innermost(chosen_command(app), words);
  const std::string unknown = unknown_word_text(app, command, words);
  return (unknown.empty() ? std::string(error.what()) : unknown) + "; see '" + words + " --help'";
}

// Whether help was asked for of a command that does not exist: 'gazetrace study --help'.
bool names_no_command(const CLI::App& app) {
  std::string words;
  const CLI::App* command = innermost(chosen_command(app), words);
  if (command != nullptr && names_within(*command).empty()) {
    return false;
  }
  const std::vector<std::string> rest = app.remaining(true);
  return std::any_of(rest.begin(), rest.end(), [](const std::string& word) { return !word.starts_with('-'); });
}

int run(int argc, char** argv) {
  CLI::App app{"gazetrace: foveated path tracing along a recorded gaze", "gazetrace"};
  app.set_version_flag("--version", std::string("gazetrace ") + kVersion, "Print the version and exit");
  app.require_subcommand(1);
  app.fallthrough(false);
  app.footer(kExitCodesHelp);
  app.option_defaults()->multi_option_policy(CLI::MultiOptionPolicy::TakeLast);  // scripts append what they change

  const Invocation invocation{{argv, argv + argc}};
  std::map<std::string, Command> commands;
#define GAZETRACE_COMMAND(name, help)                         \
  {                                                           \
    CLI::App* sub = app.add_subcommand(#name, help);          \
    sub->fallthrough();                                       \
    sub->footer(kExitCodesHelp);                              \
    commands[#name] = add_##name##_command(*sub, invocation); \
  }
#define GAZETRACE_EXTERNAL(name, help) add_external_command(app, #name, help);
#include "cli/commands.def"
#undef GAZETRACE_COMMAND
  if (const auto external = find_external_program(app, {argv + 1, argv + argc})) {
    let_signals_go();
    return run_external_program(*external);
  }

  std::string config;
  app.add_option("--config", config,
                 "A TOML file with options of the command; the command line wins ('gazetrace render "
                 "--print-config' writes one for 'render' and 'plan')")
      ->type_name("FILE");

  try {
    std::vector<std::string> words = with_json_joined({argv + 1, argv + argc});
    std::reverse(words.begin(), words.end());  // as CLI11 takes a vector
    app.parse(std::move(words));
  } catch (const CLI::Success& help_or_version) {
    if (names_no_command(app)) {
      return report(parse_error_text(app, CLI::ExtrasError(app.remaining(true))), exit_bad_input);
    }
    std::ostringstream text;  // which CLI11 would write without a look at whether it arrives
    const int code = app.exit(help_or_version, text, text);
    print_result(text.str());
    return code;
  } catch (const CLI::ParseError& error) {
    return report(parse_error_text(app, error), exit_bad_input);
  }
  const Command& command = commands.at(chosen_command(app)->get_name());
  if (!config.empty()) {
    if (!command.read_config) {
      throw Error(ErrorKind::usage, "`config`", "only 'render', 'plan' and 'demo' take a settings file");
    }
    command.read_config(config);
  }
  if (!command.watches_signals) {
    let_signals_go();
  }
  return command.run();
}

}  // namespace
}  // namespace gazetrace

int main(int argc, char** argv) {
  using namespace gazetrace;
  hold_signals();                 // before the first thread
  std::signal(SIGPIPE, SIG_IGN);  // a reader of stdout that goes away is no error: see print_result
  std::signal(SIGCHLD, SIG_DFL);  // ignored by who started this, no child would have an exit code
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
