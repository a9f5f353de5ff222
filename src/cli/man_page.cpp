// SPDX-License-Identifier: Apache-2.0
#include "cli/man_page.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>

#include "cli/exit_codes.hpp"
#include "gazetrace/version.hpp"

namespace gazetrace {
namespace {

// Text of the page: hyphens that must stay hyphens, backslashes, and no line that begins like a request.
std::string roff(const std::string& text) {
  std::string result;
  bool at_begin = true;
  for (const char c : text) {
    if (at_begin && (c == '.' || c == '\'')) {
      result += "\\&";
    }
    at_begin = c == '\n';
    result += c == '\\' ? std::string("\\e") : c == '-' ? std::string("\\-") : std::string(1, c);
  }
  return result;
}

std::string page_title(const CommandWords& command) {
  return fmt::format("{}", fmt::join(command.path, "-"));
}

std::string synopsis(const CommandWords& command) {
  std::string text = fmt::format(".B {}\n", roff(fmt::format("{}", fmt::join(command.path, " "))));
  if (!command.commands.empty()) {
    text += ".I COMMAND\n";
  }
  for (const OptionWords& option : command.options) {
    if (option.is_positional()) {
      text += fmt::format(".I {}\n", roff(option.names.front()));
    }
  }
  return text + "[options]\n";
}

std::string option_text(const OptionWords& option) {
  std::string text = ".TP\n";
  for (std::size_t i = 0; i < option.names.size(); ++i) {
    text += fmt::format("{}\\fB{}\\fR", i == 0 ? "" : ", ", roff(option.names[i]));
  }
  if (!option.value.empty()) {
    text += fmt::format(" \\fI{}\\fR", roff(option.value));
  }
  text += "\n" + roff(option.help) + "\n";
  if (!option.default_text.empty()) {
    text += fmt::format("Default: {}\n", roff(option.default_text));
  }
  return text;
}

std::string upper(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(), [](unsigned char c) { return std::toupper(c); });
  return text;
}

}  // namespace

std::string man_page_name(const CommandWords& command) {
  return page_title(command) + ".1";
}

std::string man_page(const CommandWords& command) {
  const std::string title = page_title(command);
  std::string text =
      fmt::format(".TH {} 1 \"\" \"gazetrace {}\" \"gazetrace\"\n.ad l\n.SH NAME\n{} \\- {}\n.SH SYNOPSIS\n{}",
                  upper(title), kVersion, roff(title), roff(command.summary), synopsis(command));
  if (!command.commands.empty()) {
    text += ".SH COMMANDS\n";
    for (const CommandWords& within : command.commands) {
      text += fmt::format(".TP\n\\fB{}\\fR\n{}; see {}(1)\n", roff(within.path.back()), roff(within.summary),
                          roff(page_title(within)));
    }
  }
  text += ".SH OPTIONS\n";
  std::vector<std::string> groups;
  for (const OptionWords& option : command.options) {
    if (std::find(groups.begin(), groups.end(), option.group) == groups.end()) {
      groups.push_back(option.group);
    }
  }
  for (const std::string& group : groups) {
    if (groups.size() > 1) {
      text += fmt::format(".SS {}\n", roff(group));
    }
    for (const OptionWords& option : command.options) {
      text += option.group == group ? option_text(option) : std::string();
    }
  }
  text += fmt::format(".SH EXIT STATUS\n{}\n", roff(kExitCodesHelp));
  if (command.path.size() > 1) {
    const std::vector<std::string> above(command.path.begin(), command.path.end() - 1);
    text += fmt::format(".SH SEE ALSO\n{}(1)\n", roff(fmt::format("{}", fmt::join(above, "-"))));
  }
  return text;
}

}  // namespace gazetrace
