// SPDX-License-Identifier: Apache-2.0
#include "job/registry_names.hpp"
#include "job/schema/parts.hpp"

namespace gazetrace {

void add_filter_options(JobSchema& schema) {
  schema.group("Between the samples");
  schema
      .value("--filter", &JobSettings::filter, "NAME", Touch::filter,
             "Fills pixels between samples and takes noise away ('gazetrace list filters'; where the samples are is "
             "--density, which has a 'linear', too). auto: guided; linear, "
             "which passes single pixels through, with --accumulate-order before, and for uniform frames "
             "with --accumulate running or --only-pixel")
      .checked_by(check_filter_name)
      .with(Trait::always_stated)
      .with(Trait::everyday);
}

}  // namespace gazetrace
