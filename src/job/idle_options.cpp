// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <vector>

#include "gazetrace/job.hpp"

namespace gazetrace {

Warnings idle_option_warnings(const Job& job, const JobSchema& schema) {
  Warnings warnings;
  std::vector<std::string> for_gaze;  // that somebody forgot
  for (const OptionOf<JobSettings>& option : schema.options()) {
    if (!job.is_given(option.name)) {
      continue;
    }
    // An option without a value of its own, such as a density while another sampling is chosen, has no default to keep.
    const bool is_default = !option.defaults.empty() && option.values(job.settings) == option.defaults;
    const auto rule = std::find_if(option.idle.begin(), option.idle.end(),
                                   [&](const IdleRule<JobSettings>& one) { return one.holds(job.settings); });
    if (rule == option.idle.end()) {
      continue;
    }
    // A default in a file may be one of all that `print-config` wrote; who types it wants what it needs.
    const bool is_typed = job.sources.at(option.name).origin == Origin::given;
    if ((rule->said ? rule->said(job.settings) : rule->words) == "without gaze") {
      if (!is_default || is_typed) {
        for_gaze.push_back("`" + option.name + "`");
      }
    } else if (!is_default) {
      warnings.push_back(
          fmt::format("`{}` does nothing {}", option.name, rule->said ? rule->said(job.settings) : rule->words));
    }
  }
  if (!for_gaze.empty()) {
    warnings.insert(warnings.begin(),
                    fmt::format("there is no gaze, and without it {} {} nothing: give `gaze` or `gaze-at`",
                                fmt::join(for_gaze, ", "), for_gaze.size() == 1 ? "does" : "do"));
  }
  return warnings;
}

}  // namespace gazetrace
