// SPDX-License-Identifier: Apache-2.0
// Choosing one of a list by its name.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "gazetrace/error.hpp"

namespace gazetrace {

// The one of `infos`, each with a `name`, that is called so. Error(usage, place) that names the nearest.
template <class Infos>
const auto& find_named(const Infos& infos, std::string_view name, const std::string& kind, const std::string& place,
                       const std::string& remedy = {}) {
  std::vector<std::string> known;
  for (const auto& info : infos) {
    if (info.name == name) {
      return info;
    }
    known.emplace_back(info.name);
  }
  throw Error(ErrorKind::usage, place, unknown_name_message(kind, name, known), remedy);
}

}  // namespace gazetrace
