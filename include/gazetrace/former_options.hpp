// SPDX-License-Identifier: Apache-2.0
// Removed options and their replacements: old settings files and scripts are understood for one
// version, or refused with a remedy.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "gazetrace/error.hpp"

namespace gazetrace {

enum class FormerKind : std::uint8_t {
  renamed,    // still understood
  gone,       // refused
  elsewhere,  // the name that other programs have for an option; refused
};

// An option and its values, as a settings file names it: without dashes.
using OptionText = std::pair<std::string, std::vector<std::string>>;

struct FormerOption {
  FormerKind kind = FormerKind::gone;
  std::string option;                                             // "mode"
  std::string value;                                              // of which alone the row speaks; empty: of all
  bool takes_value = false;                                       // on the command line, and not a flag
  std::string beside, beside_values;                              // which also has to be given; values with | between
  std::vector<std::pair<std::string, std::string>> replacements;  // options and values; "*" or empty: the given values
  std::string reason;                                             // why, or a remedy
};

// A row of the table: former_option(FormerKind::renamed, "--old *", "--new *", "it says more"). A second option in
// `before` is the one beside it.
FormerOption former_option(FormerKind kind, const std::string& before, const std::string& now,
                           const std::string& reason);
// src/job/schema/renamed_options.def, made once and never changed.
const std::vector<FormerOption>& former_options();

// The first row that speaks of this option with this value, among the options that are given with it; nullptr: there is
// none.
const FormerOption* find_former_option(const std::string& option, const std::string& value,
                                       const std::vector<OptionText>& given = {},
                                       const std::vector<FormerOption>& table = former_options());
// Whether a row refuses the option; the text then says why: "this option is gone; use `spp`".
std::optional<std::string> refusal_of(const FormerOption& former);

// Settings that may have former names or values, as they are called now.
struct CurrentOptions {
  std::vector<OptionText> settings;  // those that were given, where no row speaks of them
  std::string notice;                // which option stands for which, and why; empty: nothing was renamed
};
// `given`: the options that are given with it, itself included. Where several former options are one value now, as a
// model and its parameters, one of them gets all of it, and the others nothing. Throws Error(kind, place, ...) for
// options and values that are refused.
CurrentOptions current_options(const OptionText& option, const std::vector<OptionText>& given, ErrorKind kind,
                               const std::string& place, const std::vector<FormerOption>& table = former_options());

}  // namespace gazetrace
