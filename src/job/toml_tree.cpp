// SPDX-License-Identifier: Apache-2.0
#include "job/toml_tree.hpp"

#include <fmt/format.h>

#include <toml++/toml.h>
#include <algorithm>
#include <cctype>

#include "core/text.hpp"
#include "gazetrace/error.hpp"

namespace gazetrace {
namespace {

TomlNode tree_of(const toml::node& node) {
  TomlNode tree;
  tree.line = static_cast<int>(node.source().begin.line);
  tree.kind = TomlNode::Kind::scalar;
  if (const auto* text = node.as_string()) {
    tree.text = text->get();
  } else if (const auto* whole = node.as_integer()) {
    tree.text = fmt::format("{}", whole->get());
  } else if (const auto* number = node.as_floating_point()) {
    tree.text = fmt::format("{}", number->get());
  } else if (const auto* truth = node.as_boolean()) {
    tree.text = truth->get() ? "true" : "false";
  } else if (const auto* array = node.as_array()) {
    tree.kind = TomlNode::Kind::array;
    for (const toml::node& item : *array) {
      tree.items.push_back(tree_of(item));
    }
  } else if (const auto* table = node.as_table()) {
    tree.kind = TomlNode::Kind::table;
    std::vector<std::pair<toml::source_position, std::string>> order;
    for (const auto& [key, value] : *table) {
      order.emplace_back(key.source().begin, std::string(key.str()));
    }
    std::stable_sort(order.begin(), order.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
    for (const auto& [position, key] : order) {
      tree.members.push_back({key, tree_of(*table->get(key))});
      // The line of a value may be that of a bracket further down, but people look for the key.
      tree.members.back().node.line = static_cast<int>(position.line);
    }
  } else {
    tree.kind = TomlNode::Kind::other;
  }
  return tree;
}

// The parser calls itself for each dot of a key, without a limit.
void refuse_deep_keys(std::string_view text, const std::string& path) {
  constexpr int kMostDots = 1000;
  int dots = 0;
  int line = 1;
  for (const char c : text) {
    line += c == '\n' ? 1 : 0;
    dots = c == '.' ? dots + 1 : std::string_view("\n,=[]{}").find(c) != std::string_view::npos ? 0 : dots;
    if (dots > kMostDots) {
      throw Error(ErrorKind::input, fmt::format("{}:{}", path, line), "a key is nested too deep", "this is no job");
    }
  }
}

// The line where a quote is opened that nothing closes: on its line or, of three quotes, at all; 0: none.
int line_of_open_quote(std::string_view text) {
  int line = 1;
  for (std::size_t at = 0; at < text.size(); ++at) {
    const char quote = text[at];
    line += quote == '\n' ? 1 : 0;
    if (quote == '#') {
      at = std::min(text.find('\n', at), text.size()) - 1;
    }
    if (quote != '"' && quote != '\'') {
      continue;
    }
    const int opened = line;
    const bool is_long = text.substr(at, 3) == std::string(3, quote);
    const std::string closing(is_long ? 3 : 1, quote);
    at += closing.size();
    while (at < text.size() && text.substr(at, closing.size()) != closing && (is_long || text[at] != '\n')) {
      line += text[at] == '\n' ? 1 : 0;
      at += quote == '"' && text[at] == '\\' ? 2 : 1;
    }
    if (at >= text.size() || text.substr(at, closing.size()) != closing) {
      return opened;
    }
    at += closing.size() - 1;
  }
  return 0;
}

// What to do about a line that is no TOML.
std::string toml_remedy(std::string_view text, std::size_t number, std::string_view problem) {
  for (std::size_t line = 1; line < number && !text.empty(); ++line) {
    text.remove_prefix(std::min(text.find('\n'), text.size() - 1) + 1);
  }
  const std::string_view line = trim(text.substr(0, text.find('\n')));
  const auto is_word = [](char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '-' || c == '_'; };
  const auto word_end = static_cast<std::size_t>(std::find_if_not(line.begin(), line.end(), is_word) - line.begin());
  const std::string_view behind = trim(line.substr(word_end));
  if (behind.starts_with(':') || line.starts_with('{')) {
    return "write each setting on a line of its own, as key = value";
  }
  if (problem.find("redefine") != std::string_view::npos) {
    return "give each key once";
  }
  if (line.find('\\') != std::string_view::npos) {
    return "put a path with \\ into single quotes, or write it with /";
  }
  if (behind.starts_with('=')) {
    const std::string_view value = trim(behind.substr(1));
    return value.starts_with("True") || value.starts_with("False") ? "write true and false in small letters"
                                                                   : "put text into quotes: key = \"text\"";
  }
  return "this is not TOML";
}

}  // namespace

const TomlNode* TomlNode::find(std::string_view key) const {
  const auto found =
      std::find_if(members.begin(), members.end(), [&](const auto& member) { return member.key == key; });
  return found == members.end() ? nullptr : &found->node;
}

TomlNode parse_toml(std::string_view text, const std::string& path) {
  refuse_deep_keys(text, path);
  try {
    return tree_of(toml::parse(text));
  } catch (const toml::parse_error& error) {
    if (const int line = line_of_open_quote(text); line > 0 && line <= static_cast<int>(error.source().end.line)) {
      throw Error(ErrorKind::input, fmt::format("{}:{}", path, line), "a quote is opened and not closed",
                  "close it on the same line");
    }
    throw Error(ErrorKind::input, fmt::format("{}:{}", path, error.source().begin.line),
                std::string(error.description()), toml_remedy(text, error.source().begin.line, error.description()));
  }
}

std::string toml_place(const std::string& path, const TomlNode& node) {
  return fmt::format("{}:{}", path, node.line);
}

std::string toml_scalar(const TomlNode& node, const std::string& path) {
  if (node.kind != TomlNode::Kind::scalar) {
    throw Error(ErrorKind::input, toml_place(path, node), "dates, times and nested tables are no values of options",
                "write text, a number, true, false or an array of them");
  }
  return node.text;
}

}  // namespace gazetrace
