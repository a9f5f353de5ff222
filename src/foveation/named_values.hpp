// SPDX-License-Identifier: Apache-2.0
// Texts such as "mar:slope=0.022,foveal=0.0208": a name, and values of some of its parameters.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "gazetrace/density.hpp"
#include "gazetrace/error.hpp"

namespace gazetrace {

struct NamedText {
  std::string_view name, values;
};
NamedText split_named_text(std::string_view text);

// All values in the order of the parameters, those that are not given as published. Error(usage, place) for unknown
// names and values out of range.
std::vector<double> parse_values(std::string_view text, const std::vector<NamedParameter>& parameters,
                                 const std::string& place);
// ":slope=0.03" for what is not as published; empty where all is.
std::string values_text(const std::vector<double>& values, const std::vector<NamedParameter>& parameters);

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
