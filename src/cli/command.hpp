// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "gazetrace/error.hpp"
#include "gazetrace/former_options.hpp"
#include "gazetrace/job.hpp"
#include "gazetrace/option_schema.hpp"

namespace CLI {
class App;
}

namespace gazetrace {

struct Invocation {
  std::vector<std::string> arguments;  // the whole command line, program included
};

struct Command {
  std::function<int()> run;  // called after parsing; returns an exit code
  // Takes a settings file, after the command line, whose options stay. Empty: the command takes none.
  std::function<void(const std::string& path)> read_config;
  bool watches_signals = false;  // by an Interruption, or lets them go itself
};

// One function a command adds its options to its own subcommand.
#define GAZETRACE_COMMAND(name, help) Command add_##name##_command(CLI::App& app, const Invocation& invocation);
#include "cli/commands.def"
#undef GAZETRACE_COMMAND
#define GAZETRACE_GAZE_COMMAND(name, help) \
  Command add_gaze_##name##_command(CLI::App& app, const Invocation& invocation);
#include "cli/gaze_commands.def"
#undef GAZETRACE_GAZE_COMMAND

// Makes CLI11 options of these. `take` gets the values of each that the command line gives.
using TakeOption = std::function<void(const Option& option, const std::vector<std::string>& values)>;
void bind_options(CLI::App& app, const OptionList& options, const TakeOption& take);

// Options that were renamed to some of these, which a command line gives together: `take` gets each, and
// `then` is called after parsing.
using TakeFormer = std::function<void(const std::string& option, const std::vector<std::string>& values)>;
void bind_former_options(CLI::App& app, const OptionList& options, const TakeFormer& take,
                         const std::function<void()>& then);

// The options of a job: `render` and `plan`. `job` must live until parsing is done.
void bind_job_options(CLI::App& app, Job& job);
void read_job_config(Job& job, const std::string& command, const std::string& path);

// The program's exit code for a failure.
int exit_code_of(const Error& error);

// What to do about a key of a settings file that the command does not have.
std::string unknown_key_remedy(const std::string& command);

void print_warnings(const std::vector<std::string>& warnings);

// The options of a command that has settings of its own.
template <class S>
class CommandOptions {
 public:
  explicit CommandOptions(OptionSchema<S> schema) : schema_(std::move(schema)) {}

  // Both must live until parsing is done.
  void bind(CLI::App& app, S& settings) {
    bind_options(app, schema_.list(), [this, &settings](const Option& option, const std::vector<std::string>& values) {
      schema_.find(option.name)->assign(settings, values, "`" + option.name + "`");
      given_.insert(option.name);
    });
    bind_former_options(
        app, schema_.list(),
        [this](const std::string& option, const std::vector<std::string>& values) {
          former_.emplace_back(option, values);
        },
        [this, &settings] { set_former(settings); });
  }
  void read_config(S& settings, const std::string& command, const std::string& path) const {
    for (const TomlSetting& setting :
         read_toml_settings(read_settings_file(path), path, schema_.list(), unknown_key_remedy(command))) {
      if (!given_.contains(setting.name)) {
        if (!setting.warning.empty()) {
          print_warnings({setting.warning});
        }
        schema_.find(setting.name)->assign(settings, setting.values, setting.place + ": " + setting.name);
      }
    }
  }

 private:
  void set_former(S& settings) {
    for (const OptionText& former : former_) {
      const std::string place = "`" + former.first + "`";
      const CurrentOptions current = current_options(former, former_, ErrorKind::usage, place);
      for (const auto& [name, values] : current.settings) {
        if (!given_.insert(name).second) {
          throw Error(ErrorKind::usage, place, "it is now `" + name + "`, which is given, too: which of them holds?");
        }
        schema_.find(name)->assign(settings, values, place);
      }
      print_warnings({current.notice});
    }
  }

  OptionSchema<S> schema_;
  std::set<std::string> given_;
  std::vector<OptionText> former_;
};
// Writes a result to stdout. A reader that has gone away (head, a closed pager) is no error.
void print_result(const std::string& text);
// Messages of the library name settings in back quotes; the program's users know them as flags: `gaze-start` becomes
// --gaze-start.
std::string with_flags(const std::string& text);
std::vector<std::string> with_flags(std::vector<std::string> texts);

}  // namespace gazetrace
