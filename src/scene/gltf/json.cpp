// SPDX-License-Identifier: Apache-2.0
#include "scene/gltf/json.hpp"

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>

namespace gazetrace {
namespace {

void tidy_value(Json& value, bool sizes) {
  constexpr double kLargestInt = std::numeric_limits<std::int32_t>::max();
  constexpr double kLargestExact = 9007199254740992.0;  // 2^53
  if (value.is_number()) {
    const auto number = value.get<double>();
    if (value.is_number_float() && std::trunc(number) == number &&
        std::abs(number) <= (sizes ? kLargestExact : kLargestInt)) {
      if (number >= 0) {
        value = static_cast<std::uint64_t>(number);
      } else {
        value = static_cast<std::int64_t>(number);
      }
    } else if (value.is_number_integer() && !sizes && std::abs(number) > kLargestInt) {
      value = number;
    }
  } else if (value.is_structured()) {
    for (Json& item : value) {
      tidy_value(item, sizes);
    }
  }
}

// Calls `see` with every character outside of strings, until it returns false.
template <class See>
void for_each_mark(std::string_view text, See&& see) {
  bool in_string = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (in_string) {
      if (c == '\\') {
        ++i;
      } else if (c == '"') {
        in_string = false;
      }
    } else if (c == '"') {
      in_string = true;
    } else if (!see(c)) {
      return;
    }
  }
}

}  // namespace

bool is_nested_too_deep(std::string_view text, int most) {
  int depth = 0;
  for_each_mark(text, [&](char c) {
    if (c == '{' || c == '[') {
      ++depth;
    } else if (c == '}' || c == ']') {
      --depth;
    }
    return depth <= most;
  });
  return depth > most;
}

std::uint64_t json_memory_bytes(std::string_view text) {
  // Of glibc's allocator: a value is 16 bytes, in a vector that doubles while it is copied; arrays and objects are
  // blocks of their own; a member is a node of a map with its key.
  constexpr std::uint64_t kValue = 48, kArray = 48, kObject = 64, kMember = 96;
  std::uint64_t bytes = 2 * text.size();
  for_each_mark(text, [&](char c) {
    bytes += c == ',' ? kValue : c == '[' ? kArray : c == '{' ? kObject : c == ':' ? kMember : 0;
    return true;
  });
  return bytes;
}

void tidy_numbers(Json& root) {
  for (const auto& [key, value] : root.items()) {
    tidy_value(value, key == "buffers" || key == "bufferViews" || key == "accessors");
  }
}

}  // namespace gazetrace
