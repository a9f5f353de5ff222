// SPDX-License-Identifier: Apache-2.0
#include "results/json_node.hpp"

#include <fmt/format.h>

#include "gazetrace/error.hpp"

namespace gazetrace {

void JsonNode::fail(const std::string& problem) const {
  throw Error(ErrorKind::input, file_ + (path_.empty() ? "" : ": " + path_), problem,
              "write it again with gazetrace sweep");
}

bool JsonNode::has(const std::string& key) const {
  return json_.is_object() && json_.contains(key) && !json_.at(key).is_null();
}

JsonNode JsonNode::at(const std::string& key) const {
  if (!json_.is_object()) {
    fail("is no object");
  }
  if (!json_.contains(key)) {
    fail("has no '" + key + "'");
  }
  return {json_.at(key), file_, path_.empty() ? key : path_ + "." + key};
}

std::vector<JsonNode> JsonNode::items() const {
  if (!json_.is_array()) {
    fail("is no list");
  }
  std::vector<JsonNode> nodes;
  nodes.reserve(json_.size());
  for (std::size_t i = 0; i < json_.size(); ++i) {
    nodes.emplace_back(json_[i], file_, fmt::format("{}[{}]", path_, i));
  }
  return nodes;
}

std::vector<std::pair<std::string, JsonNode>> JsonNode::members() const {
  if (!json_.is_object()) {
    fail("is no object");
  }
  std::vector<std::pair<std::string, JsonNode>> nodes;
  for (const auto& [key, value] : json_.items()) {
    nodes.emplace_back(key, JsonNode{value, file_, path_.empty() ? key : path_ + "." + key});
  }
  return nodes;
}

double JsonNode::number() const {
  if (!json_.is_number()) {
    fail("is no number");
  }
  return json_.get<double>();
}

std::string JsonNode::text() const {
  if (!json_.is_string()) {
    fail("is no text");
  }
  return json_.get<std::string>();
}

bool JsonNode::truth() const {
  if (!json_.is_boolean()) {
    fail("is neither true nor false");
  }
  return json_.get<bool>();
}

std::string JsonNode::shown() const {
  if (json_.is_string()) {
    return json_.get<std::string>();
  }
  if (json_.is_number_float()) {
    return fmt::format("{:.6g}", json_.get<double>());
  }
  if (json_.is_array()) {
    std::string list;
    for (const JsonNode& item : items()) {
      list += (list.empty() ? "" : ", ") + item.shown();
    }
    return list;
  }
  return json_.is_null() ? "not set" : json_.dump(-1, ' ', false, Json::error_handler_t::replace);
}

}  // namespace gazetrace
