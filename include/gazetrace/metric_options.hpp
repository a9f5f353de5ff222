// SPDX-License-Identifier: Apache-2.0
// The metrics and the display that they assume: the options that comparisons and sweeps share.
#pragma once

#include <string>
#include <vector>

#include "gazetrace/compare.hpp"
#include "gazetrace/option_schema.hpp"

namespace gazetrace {

struct MetricChoice {
  std::vector<std::string> metrics;
  ComparisonSettings settings;  // `metrics` are not yet in it
  bool correct_border = false;
};
OptionSchema<MetricChoice> metric_schema();

}  // namespace gazetrace
