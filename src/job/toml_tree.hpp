// SPDX-License-Identifier: Apache-2.0
// A TOML file as plain values that know their lines. Only toml_tree.cpp includes toml++.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace gazetrace {

struct TomlMember;

struct TomlNode {
  enum class Kind { scalar, other, array, table };  // other: dates and times
  Kind kind = Kind::other;
  int line = 0;                     // 1-based
  std::string text;                 // of a scalar, as it would be written on the command line
  std::vector<TomlNode> items;      // of an array
  std::vector<TomlMember> members;  // of a table, in the order of the file

  [[nodiscard]] const TomlNode* find(std::string_view key) const;
};

struct TomlMember {
  std::string key;
  TomlNode node;
};

// Throws Error(input) with path:line for a text that is not TOML.
TomlNode parse_toml(std::string_view text, const std::string& path);
std::string toml_place(const std::string& path, const TomlNode& node);  // path:line
// Throws Error(input) unless the node is a scalar.
std::string toml_scalar(const TomlNode& node, const std::string& path);

}  // namespace gazetrace
