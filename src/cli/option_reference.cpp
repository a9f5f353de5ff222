// SPDX-License-Identifier: Apache-2.0
#include "cli/option_reference.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <vector>

#include "cli/command.hpp"
#include "gazetrace/former_options.hpp"

namespace gazetrace {
namespace {

constexpr const char* kHead =
    "# Options of a job\n\n"
    "The options of `gazetrace render` and `gazetrace plan`, for the command line, a settings file (`--config`) and "
    "programs\n"
    "that embed the library. In a settings file the name stands without dashes: `spp = 16`.\n\n"
    "This page is made by `gazetrace list options --markdown` from the definitions in `src/job/schema/`; a test holds "
    "it\n"
    "against them. *Touches* names the stages that an option changes: options that touch `sampling` have no effect on "
    "a\n"
    "uniform frame, and options that only touch `speed`, `output` or `talk` change no pixel's light.\n";

bool is_positional(const Option& option) {
  return !option.flags.starts_with('-');
}

std::string shown_name(const Option& option) {
  return is_positional(option) ? option.name : "--" + option.name;
}

// "DEG" as it is; what has characters that markdown reads otherwise is code.
std::string default_text(const Option& option) {
  if (option.defaults.empty()) {
    return "not set";
  }
  return fmt::format("`{}`", fmt::join(option.defaults, "`, `"));
}

std::string joined(const std::vector<std::string>& texts, const char* between) {
  return fmt::format("{}", fmt::join(texts, between));
}

// Markdown would take what stands in angle brackets for a tag.
std::string escaped(const std::string& text) {
  std::string result;
  for (const char c : text) {
    if (c == '<' || c == '>' || c == '*' || c == '_') {
      result += '\\';
    }
    result += c;
  }
  return result;
}

std::string option_section(const Option& option) {
  std::string text = fmt::format("\n### `{}{}{}`\n\n{}\n\n", shown_name(option), option.unit.empty() ? "" : " ",
                                 option.unit, escaped(option.help));
  text += fmt::format("Default: {}.", default_text(option));
  if (option.range) {
    text += fmt::format(" Range: {}.", option.range->words());
  }
  if (option.shape == OptionShape::repeated) {
    text += " May be given several times.";
  }
  if (option.is_on_by_default()) {
    text += fmt::format(" Turned off by `--no-{}`.", option.name);
  }
  text += fmt::format(" Touches: {}.", joined(touch_names(option.touches), ", "));
  if (option.decides == Decides::file) {
    text += " The content of the file counts, not its name.";
  }
  if (!option.needs.empty()) {
    text += fmt::format(" Needs {}.", joined(option.needs, ", "));
  }
  if (!option.idle_words.empty()) {
    text += fmt::format(" Does nothing {}.", joined(option.idle_words, "; "));
  }
  return text + "\n";
}

// A bar would end a cell of a table.
std::string in_cell(std::string text) {
  for (std::size_t bar = text.find('|'); bar != std::string::npos; bar = text.find('|', bar + 2)) {
    text.insert(bar, 1, '\\');
  }
  return text;
}

// "--mode fast", and what is said of it.
using FormerLine = std::pair<std::string, std::string>;

std::vector<FormerLine> former_lines() {
  std::vector<FormerLine> lines;
  for (const FormerOption& former : former_options()) {
    std::string now = refusal_of(former).value_or("");
    if (former.kind == FormerKind::renamed) {
      for (const auto& [option, value] : former.replacements) {
        now += fmt::format("{}`{}`{}{}", now.empty() ? "" : " ", option, value.empty() ? "" : " ", value);
      }
      now += (now.empty() ? "passed over; " : "; ") + former.reason;
    }
    const std::string given = former.value.empty() && former.takes_value ? "*" : former.value;
    std::string before = fmt::format("--{}{}{}", former.option, given.empty() ? "" : " ", given);
    if (!former.beside.empty()) {
      before += fmt::format(" --{} {}", former.beside, former.beside_values);
    }
    lines.emplace_back(before, with_flags(now));
  }
  return lines;
}

std::string former_options_as_markdown() {
  std::string text =
      "\n## Former options\n\nReplacements of options that were removed, and of names in other programs "
      "(`gazetrace help former-options`).\nA `*` is the value that was given.\n\n| option | now |\n| --- | --- |\n";
  for (const auto& [option, now] : former_lines()) {
    text += fmt::format("| `{}` | {} |\n", in_cell(option), in_cell(escaped(now)));
  }
  return text;
}

}  // namespace

std::string options_as_markdown(const JobSchema& schema) {
  std::string text = kHead;
  std::string group;
  for (const Option* option : schema.list()) {
    if (option->group != group) {
      group = option->group;
      text += "\n## " + group + "\n";
    }
    text += option_section(*option);
  }
  return text + former_options_as_markdown();
}

std::string former_options_as_text() {
  std::string text;
  for (const auto& [option, now] : former_lines()) {
    text += fmt::format("{:<28}  {}\n", option, now);
  }
  return text;
}

std::string options_as_text(const JobSchema& schema, const std::string& only) {
  OptionList options = schema.list();
  std::erase_if(options, [&](const Option* option) { return !only.empty() && option->group != only; });
  std::size_t width = 0;
  for (const Option* option : options) {
    width = std::max(width, shown_name(*option).size());
  }
  std::string text;
  std::string group;
  for (const Option* option : options) {
    if (option->group != group) {
      group = option->group;
      text += (text.empty() ? "" : "\n") + group + "\n";
    }
    text += fmt::format("  {:<{}}  {}\n", shown_name(*option), width, option->help);
  }
  return text;
}

std::string options_as_json(const JobSchema& schema) {
  nlohmann::ordered_json json = nlohmann::ordered_json::array();
  for (const Option* option : schema.list()) {
    nlohmann::ordered_json one{{"name", option->name},        {"group", option->group},
                               {"unit", option->unit},        {"help", option->help},
                               {"default", option->defaults}, {"touches", touch_names(option->touches)},
                               {"needs", option->needs},      {"idle", option->idle_words}};
    if (option->range) {
      one["range"] = option->range->words();
    }
    if (option->is_on_by_default()) {
      one["off"] = "no-" + option->name;
    }
    json.push_back(std::move(one));
  }
  return json.dump(2) + "\n";
}

}  // namespace gazetrace
