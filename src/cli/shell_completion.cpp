// SPDX-License-Identifier: Apache-2.0
// Each script first finds out which command the words so far name ("gazetrace gaze inspect"), then completes the value
// of the option before the cursor, or the command's options and the commands within it, or files.
#include "cli/shell_completion.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "gazetrace/error.hpp"

namespace gazetrace {
namespace {

std::string path_of(const CommandWords& command) {
  return fmt::format("{}", fmt::join(command.path, " "));
}

// A word of a shell between single quotes, on one line. `quote` stands for a single quote within.
std::string quoted(const std::string& text, const char* quote) {
  std::string result = "'";
  for (const char c : text) {
    result += c == '\'' ? std::string(quote) : std::string(1, c == '\n' ? ' ' : c);
  }
  return result + "'";
}
std::string quoted(const std::string& text) {
  return quoted(text, "'\\''");  // of bash and zsh
}
std::string quoted_fish(const std::string& text) {
  return quoted(text, "\\'");
}

// The first sentence of a help text, for lists.
std::string brief(const std::string& help) {
  const std::size_t end = std::min({help.find(". "), help.find("; "), help.find(" ("), help.find('\n'), help.size()});
  return help.substr(0, end);
}

std::vector<std::string> flags_of(const CommandWords& command) {
  std::vector<std::string> flags;
  for (const OptionWords& option : command.options) {
    if (!option.is_positional()) {
      flags.insert(flags.end(), option.names.begin(), option.names.end());
    }
  }
  return flags;
}

std::vector<std::string> names_within(const CommandWords& command) {
  std::vector<std::string> names;
  for (const CommandWords& within : command.commands) {
    names.push_back(within.path.back());
  }
  return names;
}

// What may stand by itself after the command: the families of list, the shells of completion.
std::vector<std::string> places_of(const CommandWords& command) {
  std::vector<std::string> names;
  for (const OptionWords& option : command.options) {
    if (option.is_positional()) {
      const ValueWords found = values_of(option);
      names.insert(names.end(), found.names.begin(), found.names.end());
    }
  }
  return names;
}

// "gazetrace render"|"gazetrace gaze"|...: what the path so far and a word make a longer path.
std::string longer_paths(const CommandWords& program, const char* between) {
  std::string text;
  for (const CommandWords* command : all_commands(program)) {
    if (command != &program) {
      text += (text.empty() ? "" : between) + quoted(path_of(*command));
    }
  }
  return text;
}

std::string bash_script(const CommandWords& program) {
  std::string values;
  std::string words;
  for (const CommandWords* command : all_commands(program)) {
    for (const OptionWords& option : command->options) {
      const ValueWords found = values_of(option);
      if (option.is_positional() || option.value.empty() || (found.names.empty() && !found.is_file)) {
        continue;
      }
      for (const std::string& name : option.names) {
        values += fmt::format("    {}) names={}; files={} ;;\n", quoted(path_of(*command) + " " + name),
                              quoted(fmt::format("{}", fmt::join(found.names, " "))), found.is_file ? 1 : 0);
      }
    }
    words += fmt::format("    {}) commands={}; places={}; options={} ;;\n", quoted(path_of(*command)),
                         quoted(fmt::format("{}", fmt::join(names_within(*command), " "))),
                         quoted(fmt::format("{}", fmt::join(places_of(*command), " "))),
                         quoted(fmt::format("{}", fmt::join(flags_of(*command), " "))));
  }
  return "# bash completion for gazetrace; made by 'gazetrace completion bash'\n"
         "_gazetrace() {\n"
         "  local cur=${COMP_WORDS[COMP_CWORD]} prev=${COMP_WORDS[COMP_CWORD-1]} at=gazetrace i\n"
         "  local names='' files='' commands='' places='' options='' before=''\n"
         "  for ((i = 1; i < COMP_CWORD; i++)); do\n"
         "    case \"$at ${COMP_WORDS[i]}\" in\n"
         "      " +
         longer_paths(program, "|") +
         ") at=\"$at ${COMP_WORDS[i]}\" ;;\n"
         "    esac\n"
         "  done\n"
         "  case \"$at $prev\" in\n" +
         values +
         "  esac\n"
         "  if [[ -n $names$files ]]; then\n"
         "    [[ -n $names && $cur == *,* ]] && before=${cur%,*},\n"  // the last of a list
         "    COMPREPLY=($(compgen -P \"$before\" -W \"$names\" -- \"${cur#\"$before\"}\"))\n"
         "    [[ $files == 1 ]] && COMPREPLY+=($(compgen -f -- \"$cur\"))\n"
         "    return\n"
         "  fi\n"
         "  case \"$at\" in\n" +
         words +
         "  esac\n"
         "  if [[ $cur == -* ]]; then\n"
         "    COMPREPLY=($(compgen -W \"$options\" -- \"$cur\"))\n"
         "  elif [[ -n $commands ]]; then\n"
         "    COMPREPLY=($(compgen -W \"$commands\" -- \"$cur\"))\n"
         "  elif [[ -n $places ]]; then\n"
         "    COMPREPLY=($(compgen -W \"$places\" -- \"$cur\"))\n"
         "  else\n"
         "    COMPREPLY=($(compgen -f -- \"$cur\"))\n"
         "  fi\n"
         "}\n"
         "complete -o filenames -F _gazetrace gazetrace\n";
}

// In _describe a colon ends the word.
std::string described(const std::string& word, const std::string& help) {
  return quoted(word + ":" + brief(help));
}

std::string zsh_script(const CommandWords& program) {
  std::string values;
  std::string words;
  for (const CommandWords* command : all_commands(program)) {
    std::string options;
    for (const OptionWords& option : command->options) {
      if (option.is_positional()) {
        continue;
      }
      const ValueWords found = values_of(option);
      for (const std::string& name : option.names) {
        options += " " + described(name, option.help);
        if (!option.value.empty() && (found.is_file || !found.names.empty())) {
          values += fmt::format(
              "    ({}) {}{}return ;;\n", quoted(path_of(*command) + " " + name),
              found.names.empty() ? "" : fmt::format("compset -P '*,'; compadd -- {}; ", fmt::join(found.names, " ")),
              found.is_file ? "_files; " : "");
        }
      }
    }
    std::string within;
    for (const CommandWords& one : command->commands) {
      within += " " + described(one.path.back(), one.summary);
    }
    words += fmt::format("    ({}) commands=({}); places=({}); options=({}) ;;\n", quoted(path_of(*command)), within,
                         fmt::join(places_of(*command), " "), options);
  }
  return "#compdef gazetrace\n"
         "# zsh completion for gazetrace; made by 'gazetrace completion zsh'\n"
         "_gazetrace() {\n"
         "  local at=gazetrace word\n"
         "  local -a commands places options\n"
         "  for word in ${words[2,CURRENT-1]}; do\n"
         "    case \"$at $word\" in\n"
         "      (" +
         longer_paths(program, "|") +
         ") at=\"$at $word\" ;;\n"
         "    esac\n"
         "  done\n"
         "  case \"$at ${words[CURRENT-1]}\" in\n" +
         values +
         "  esac\n"
         "  case \"$at\" in\n" +
         words +
         "  esac\n"
         "  if [[ $words[CURRENT] == -* ]]; then\n"
         "    _describe -o option options\n"
         "  elif (( $#commands )); then\n"
         "    _describe command commands\n"
         "  elif (( $#places )); then\n"
         "    compadd -- $places\n"
         "  else\n"
         "    _files\n"
         "  fi\n"
         "}\n"
         "_gazetrace \"$@\"\n";
}

std::string fish_option(const CommandWords& command, const OptionWords& option) {
  std::string line = "complete -c gazetrace -n " + quoted_fish("__gazetrace_at " + path_of(command));
  for (const std::string& name : option.names) {
    line += name.starts_with("--") ? " -l " + name.substr(2) : " -s " + name.substr(1);
  }
  const ValueWords found = values_of(option);
  if (!option.value.empty()) {
    line += found.is_file ? " -r -F" : " -x";
  }
  if (!found.names.empty()) {
    line += " -a " + quoted_fish(fmt::format("(__gazetrace_names {})", fmt::join(found.names, " ")));
  }
  return line + " -d " + quoted_fish(brief(option.help)) + "\n";
}

std::string fish_script(const CommandWords& program) {
  std::string text =
      "# fish completion for gazetrace; made by 'gazetrace completion fish'\n"
      "function __gazetrace_at\n"
      "  set -l at gazetrace\n"
      "  for word in (commandline -opc)[2..-1]\n"
      "    switch \"$at $word\"\n"
      "      case " +
      longer_paths(program, " ") +
      "\n"
      "        set at \"$at $word\"\n"
      "    end\n"
      "  end\n"
      "  test \"$at\" = \"$argv\"\n"
      "end\n"
      "function __gazetrace_names\n"
      "  set -l before (string match -r '.*,' -- (commandline -ct))\n"
      "  for name in $argv\n"
      "    echo \"$before$name\"\n"
      "  end\n"
      "end\n";
  for (const CommandWords* command : all_commands(program)) {
    for (const CommandWords& within : command->commands) {
      text += fmt::format("complete -c gazetrace -f -n {} -a {} -d {}\n",
                          quoted_fish("__gazetrace_at " + path_of(*command)), within.path.back(),
                          quoted_fish(brief(within.summary)));
    }
    if (const std::vector<std::string> places = places_of(*command); !places.empty()) {
      text += fmt::format("complete -c gazetrace -f -n {} -a {}\n", quoted_fish("__gazetrace_at " + path_of(*command)),
                          quoted_fish(fmt::format("{}", fmt::join(places, " "))));
    }
    for (const OptionWords& option : command->options) {
      text += option.is_positional() ? std::string() : fish_option(*command, option);
    }
  }
  return text;
}

}  // namespace

const std::vector<std::string>& completion_shells() {
  static const std::vector<std::string> kShells{"bash", "zsh", "fish"};
  return kShells;
}

std::string shell_completion(const CommandWords& program, const std::string& shell) {
  if (shell == "bash") {
    return bash_script(program);
  }
  if (shell == "zsh") {
    return zsh_script(program);
  }
  if (shell == "fish") {
    return fish_script(program);
  }
  throw Error(ErrorKind::usage, "completion", unknown_name_message("shell", shell, completion_shells()));
}

}  // namespace gazetrace
