// SPDX-License-Identifier: Apache-2.0
// Texts such as "mar:slope=0.022,foveal=0.0208": a name, and values of some of its parameters.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "core/named.hpp"
#include "gazetrace/density.hpp"

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

}  // namespace gazetrace
