// SPDX-License-Identifier: Apache-2.0
#include "job/schema/parts.hpp"

namespace gazetrace {

void add_filter_options(JobSchema& schema) {
  schema.group("Between the samples");
  schema
      .value("--filter", &JobSettings::filter, "NAME", Touch::filter,
             "Fills pixels between samples and takes noise away ('gazetrace list filters'; where the samples are is "
             "--falloff, which has a 'linear', too). auto: guided; linear, "
             "which passes single pixels through, with --enhance-contrast and "
             "--accumulate-order before, and for uniform frames with --accumulate running or --only-pixel")
      .with(Trait::always_stated);
  schema.value("--pass-through", &JobSettings::pass_through_samples, "SPP", Touch::filter,
               "A pixel with at least this many samples of its own keeps their mean, whatever the filter; 0: no pixel "
               "does, since guided and oidn themselves keep detail that the samples establish");
  schema
      .value("--enhance-contrast", &JobSettings::enhance_contrast, "0..1", Touch::filter,
             "Raises the contrast that blocks have lost, since peripheral vision misses contrast more than detail. "
             "This is an enhancement and not an estimate; 1: a wave at half the blocks' frequency limit is as strong "
             "as at the full rate")
      .within(0, 1)
      .need("`filter` linear, push-pull or tent");
}

}  // namespace gazetrace
