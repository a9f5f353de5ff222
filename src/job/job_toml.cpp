// SPDX-License-Identifier: Apache-2.0
// Settings files, which are TOML with a key for each option.

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <system_error>

#include "gazetrace/error.hpp"
#include "gazetrace/former_options.hpp"
#include "gazetrace/option_schema.hpp"
#include "job/settings_paths.hpp"
#include "job/toml_values.hpp"

namespace gazetrace {
namespace {

// A number is written without quotes only when reading it gives exactly the same text back.
bool is_bare_number(const std::string& text) {
  std::int64_t whole = 0;
  const char* end = text.data() + text.size();
  if (const auto result = std::from_chars(text.data(), end, whole); result.ec == std::errc() && result.ptr == end) {
    return fmt::format("{}", whole) == text;
  }
  double number = 0;
  if (const auto result = std::from_chars(text.data(), end, number); result.ec == std::errc() && result.ptr == end) {
    return fmt::format("{}", number) == text && text.find_first_of(".e") != std::string::npos &&
           text.find_first_not_of("0123456789+-.e") == std::string::npos;
  }
  return false;
}

std::string toml_quoted(const std::string& text) {
  std::string result = "\"";
  for (const char c : text) {
    switch (c) {
      case '"':
        result += "\\\"";
        break;
      case '\\':
        result += "\\\\";
        break;
      case '\n':
        result += "\\n";
        break;
      case '\t':
        result += "\\t";
        break;
      default:
        if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) {
          result += fmt::format("\\u{:04X}", static_cast<unsigned>(static_cast<unsigned char>(c)));
        } else {
          result += c;
        }
    }
  }
  return result + "\"";
}

std::string scalar_text(const std::string& value) {
  return is_bare_number(value) ? value : toml_quoted(value);
}

std::string toml_value(const Option& option, const std::vector<std::string>& values) {
  if (option.shape == OptionShape::flag) {
    return values.at(0);
  }
  if (option.shape == OptionShape::value) {
    return scalar_text(values.at(0));
  }
  std::vector<std::string> items = values;
  if (option.shape == OptionShape::list) {
    parse_value(values.at(0), option.name, items);
  }
  std::string text = "[";
  for (std::size_t i = 0; i < items.size(); ++i) {
    text += (i == 0 ? "" : ", ") + (option.shape == OptionShape::list ? scalar_text(items[i]) : toml_quoted(items[i]));
  }
  return text + "]";
}

std::string wrapped_comment(const std::string& text) {
  constexpr std::size_t kColumns = 100;
  std::string result;
  std::string line = "#";
  std::size_t at = 0;
  while (at < text.size()) {
    const std::size_t space = std::min(text.find(' ', at), text.size());
    const std::string word = text.substr(at, space - at);
    if (line.size() + 1 + word.size() > kColumns) {
      result += line + "\n";
      line = "#";
    }
    line += " " + word;
    at = space + 1;
  }
  return result + line + "\n";
}

}  // namespace

std::vector<std::string> toml_values(const TomlNode& node, const Option& option, const std::string& path) {
  if (node.kind != TomlNode::Kind::array) {
    return {toml_scalar(node, path)};
  }
  if (option.shape == OptionShape::flag || option.shape == OptionShape::value) {
    throw Error(ErrorKind::input, toml_place(path, node),
                fmt::format("'{}' takes one value, not an array", option.name));
  }
  std::vector<std::string> values;
  for (const TomlNode& item : node.items) {
    values.push_back(toml_scalar(item, path));
  }
  if (option.shape == OptionShape::repeated) {
    return values;
  }
  return {fmt::format("{}", fmt::join(values, ","))};
}

std::vector<OptionText> given_in(const TomlNode& table, const std::string& path) {
  Option any;
  any.shape = OptionShape::repeated;  // takes any values
  std::vector<OptionText> given;
  for (const auto& [key, node] : table.members) {
    const bool is_value = node.kind == TomlNode::Kind::scalar ||
                          (node.kind == TomlNode::Kind::array &&
                           std::all_of(node.items.begin(), node.items.end(),
                                       [](const TomlNode& item) { return item.kind == TomlNode::Kind::scalar; }));
    if (is_value) {
      given.emplace_back(key, toml_values(node, any, path));
    }
  }
  return given;
}

std::vector<std::string> values_for(const Option& option, const std::vector<std::string>& values) {
  return option.shape == OptionShape::repeated || values.size() < 2
             ? values
             : std::vector{fmt::format("{}", fmt::join(values, ","))};
}

std::vector<TomlSetting> toml_settings(const std::string& key, const TomlNode& node,
                                       const std::vector<OptionText>& beside, const OptionList& options,
                                       const std::string& path, const std::string& remedy, PathsBegin paths,
                                       TomlChecks checks) {
  const std::string place = toml_place(path, node);
  const Option* const present = find_option(options, key);
  if (present == nullptr && find_former_option(key, {}) == nullptr) {
    throw Error(ErrorKind::input, place, unknown_among_many("key", key, names_of(options)), remedy);
  }
  Option former;
  former.shape = OptionShape::repeated;  // takes any values
  const std::vector<std::string> given = toml_values(node, present != nullptr ? *present : former, path);
  // The record of a run of an earlier version states all of its settings, those that are gone, too.
  const FormerOption* const known = find_former_option(key, given.size() == 1 ? given.front() : std::string(), beside);
  if (paths == PathsBegin::working_folder && known != nullptr && refusal_of(*known)) {
    return {};
  }
  const CurrentOptions current = current_options({key, given}, beside, ErrorKind::input, place + ": " + key);
  std::vector<TomlSetting> settings;
  for (const auto& [name, values] : current.settings) {
    const Option* option = find_option(options, name);
    if (option == nullptr) {
      throw Error(ErrorKind::input, place + ": " + key, "means nothing here", remedy);
    }
    if (values.empty()) {
      continue;  // an empty array sets nothing
    }
    TomlSetting setting{name, values_for(*option, values), place, {}, current.notice.empty() ? "" : key};
    if (checks == TomlChecks::values) {
      try {
        option->check(setting.values, place + ": " + name);
      } catch (const Error& error) {
        if (paths == PathsBegin::working_folder && names_file(*option, setting.values.front())) {
          continue;  // a run that has ended needs no file, which may be gone since
        }
        throw Error(ErrorKind::input, "", error.what());
      }
    }
    for (std::string& value : setting.values) {
      if (paths == PathsBegin::beside_settings) {
        LocatedFile file = located_file(*option, value, path);
        value = std::move(file.value);
        setting.warning = file.warning.empty() ? setting.warning : place + ": " + name + ": " + file.warning;
      }
    }
    settings.push_back(std::move(setting));
  }
  if (!current.notice.empty() && !settings.empty()) {
    std::string& warning = settings.front().warning;
    warning = place + ": " + current.notice + (warning.empty() ? "" : "; " + warning);
  }
  return settings;
}

std::vector<TomlSetting> read_toml_settings(const std::string& text, const std::string& path, const OptionList& options,
                                            const std::string& remedy, PathsBegin paths) {
  std::vector<TomlSetting> settings;
  const TomlNode root = parse_toml(text, path);
  const std::vector<OptionText> given = given_in(root, path);
  for (const auto& [key, node] : root.members) {
    for (TomlSetting& setting : toml_settings(key, node, given, options, path, remedy, paths)) {
      settings.push_back(std::move(setting));
    }
  }
  return settings;
}

std::string settings_as_toml(const OptionList& options,
                             const std::function<std::vector<std::string>(const Option&)>& values_of,
                             const std::string& title) {
  std::string text =
      "# Settings of '" + title + "'; relative paths of files to read begin in the folder of this file.\n";
  std::string group;
  for (const Option* option : options) {
    if (option->group != group) {
      group = option->group;
      text += "\n# ---- " + group + "\n";
    }
    const std::string unit = option->unit.empty() ? "" : " (" + option->unit + ")";
    text += "\n" + wrapped_comment(option->help + unit);
    const std::vector<std::string> values = values_of(*option);
    text += values.empty() ? "# " + option->name + " = (not set)\n"
                           : option->name + " = " + toml_value(*option, values) + "\n";
  }
  return text;
}

}  // namespace gazetrace
