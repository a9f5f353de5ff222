// SPDX-License-Identifier: Apache-2.0
// Whole numbers of JSON files. The JSON library makes any number into any other: 3.7 into 3, and 1e300 into something
// undefined.
#pragma once

#include <cstdint>
#include <string>
#include <type_traits>
#include <utility>

#include "gazetrace/error.hpp"

namespace gazetrace {

// Error(input) for a number that is not whole, or that T cannot hold. What is no number is left to the JSON library.
template <class T, class Json>
T json_whole(const Json& value, const std::string& path) {
  static_assert(std::is_integral_v<T> && !std::is_same_v<T, bool>);
  const bool holds = value.is_number_unsigned()  ? std::in_range<T>(value.template get<std::uint64_t>())
                     : value.is_number_integer() ? std::in_range<T>(value.template get<std::int64_t>())
                                                 : !value.is_number();
  if (!holds) {
    throw Error(ErrorKind::input, path, value.dump() + " is not a whole number that can stand there",
                "it is damaged: remove it, and repeat the command that wrote it");
  }
  return value.template get<T>();
}

// The value as whatever `to` is; whole numbers are checked.
template <class T, class Json>
void read_json(const Json& value, const std::string& path, T& to) {
  if constexpr (std::is_integral_v<T> && !std::is_same_v<T, bool>) {
    to = json_whole<T>(value, path);
  } else {
    value.get_to(to);
  }
}

}  // namespace gazetrace
