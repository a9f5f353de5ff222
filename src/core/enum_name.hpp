// SPDX-License-Identifier: Apache-2.0
// Names of enumerations whose values count from 0.
#pragma once

#include <cstddef>
#include <initializer_list>
#include <string_view>

namespace gazetrace {

// `names` in the order of the values.
template <class E>
std::string_view name_of(E value, std::initializer_list<std::string_view> names) {
  const auto i = static_cast<std::size_t>(value);
  return i < names.size() ? names.begin()[i] : std::string_view();
}

}  // namespace gazetrace
