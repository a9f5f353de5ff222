// SPDX-License-Identifier: Apache-2.0
#include "cli/toml_config.hpp"

#include <fmt/format.h>

#include <charconv>
#include <istream>
#include <iterator>
#include <system_error>

#include "gazetrace/error.hpp"

namespace gazetrace {
namespace {

// A number stands bare only when reading it gives the very same text back.
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

std::string toml_value(const OptionEntry& entry, const std::vector<std::string>& values) {
  if (entry.shape == OptionShape::flag) {
    return values.at(0);
  }
  if (entry.shape == OptionShape::value) {
    return scalar_text(values.at(0));
  }
  std::vector<std::string> items = values;
  if (entry.shape == OptionShape::list) {
    parse_value(values.at(0), entry.name, items);
  }
  std::string text = "[";
  for (std::size_t i = 0; i < items.size(); ++i) {
    text += (i == 0 ? "" : ", ") + (entry.shape == OptionShape::list ? scalar_text(items[i]) : toml_quoted(items[i]));
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

std::vector<std::string> toml_values(const TomlNode& node, const OptionEntry& entry, const std::string& path) {
  if (node.kind != TomlNode::Kind::array) {
    return {toml_scalar(node, path)};
  }
  if (entry.shape == OptionShape::flag || entry.shape == OptionShape::value) {
    throw Error(ErrorKind::input, toml_place(path, node),
                fmt::format("'{}' takes one value, not an array", entry.name));
  }
  std::vector<std::string> values;
  for (const TomlNode& item : node.items) {
    values.push_back(toml_scalar(item, path));
  }
  if (entry.shape == OptionShape::repeated) {
    return values;
  }
  return {fmt::format("{}", fmt::join(values, ","))};
}

namespace {

CLI::ConfigItem item_of(const TomlConfig::Target& target, const std::string& key, const TomlNode& node) {
  const std::string place = toml_place(target.path, node);
  const OptionEntry* entry = target.table->find(key);
  if (entry == nullptr) {
    throw Error(ErrorKind::input, place, unknown_among_many("key", key, target.table->names()),
                fmt::format("'gazetrace {} --print-config' lists every key", target.command));
  }
  CLI::ConfigItem item;
  item.parents = {target.command};
  item.name = key;
  item.inputs = toml_values(node, *entry, target.path);
  if (!item.inputs.empty()) {
    try {
      entry->check(item.inputs, place + ": " + key);
    } catch (const Error& error) {
      throw Error(ErrorKind::input, "", error.what());
    }
  }
  return item;
}

}  // namespace

std::vector<CLI::ConfigItem> TomlConfig::from_config(std::istream& input) const {
  const Target target = target_();
  if (target.table == nullptr) {
    throw Error(ErrorKind::usage, "--config", "only 'render' and 'plan' take a settings file");
  }
  const std::string text((std::istreambuf_iterator<char>(input)), std::istreambuf_iterator<char>());
  std::vector<CLI::ConfigItem> found;
  for (const auto& [key, node] : parse_toml(text, target.path).members) {
    CLI::ConfigItem item = item_of(target, key, node);
    if (!item.inputs.empty()) {  // an empty array sets nothing
      found.push_back(std::move(item));
    }
  }
  return found;
}

std::string TomlConfig::to_config(const CLI::App* /*app*/, bool /*default_also*/, bool /*write_description*/,
                                  std::string /*prefix*/) const {
  const Target target = target_();
  return target.table == nullptr ? std::string() : settings_as_toml(*target.table, "gazetrace " + target.command);
}

void assign_toml(const OptionTable& table, const std::string& text, const std::string& path) {
  for (const auto& [key, node] : parse_toml(text, path).members) {
    const OptionEntry* entry = table.find(key);
    if (entry == nullptr) {
      throw Error(ErrorKind::input, toml_place(path, node), "unknown key '" + key + "'",
                  "use the version of gazetrace that wrote it");
    }
    const std::vector<std::string> values = toml_values(node, *entry, path);
    if (!values.empty()) {
      entry->assign(values, toml_place(path, node) + ": " + key);
    }
  }
}

std::string settings_as_toml(const OptionTable& table, const std::string& title) {
  std::string text = "# Settings of '" + title + "'; paths are relative to the folder it is started in.\n";
  std::string group;
  for (const OptionEntry& entry : table.entries()) {
    if (entry.group != group) {
      group = entry.group;
      text += "\n# ---- " + group + "\n";
    }
    const std::string unit = entry.unit.empty() ? "" : " (" + entry.unit + ")";
    text += "\n" + wrapped_comment(entry.help + unit);
    const std::vector<std::string> values = entry.values();
    text +=
        values.empty() ? "# " + entry.name + " = (not set)\n" : entry.name + " = " + toml_value(entry, values) + "\n";
  }
  return text;
}

}  // namespace gazetrace
