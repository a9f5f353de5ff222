// SPDX-License-Identifier: Apache-2.0
#include "job/schema/parts.hpp"

namespace gazetrace {

void add_filter_options(JobSchema& schema) {
  schema.group("Between the samples");
  schema
      .value(
          "--filter", &JobSettings::filter, "NAME", Touch::filter,
          "Fills pixels between samples and takes noise away ('gazetrace list filters'). auto: guided; linear, which "
          "passes single pixels through, with --aperture or --shutter, --sample-range, --enhance-contrast and "
          "--accumulate-order before. What guided takes from first hits shows no blur of lens and shutter")
      .with(Trait::always_stated);
  schema.value(
      "--pass-through", &JobSettings::pass_through_samples, "SPP", Touch::filter,
      "Pixels that have a site of their own with at least so many samples keep the mean of these samples in every "
      "filter; 0, the default: none do, since guided and oidn themselves give back what samples know better");
  schema
      .value("--enhance-contrast", &JobSettings::enhance_contrast, "0..1", Touch::filter,
             "An enhancement, no estimate: raises what contrast blocks have left, as the eye's periphery misses "
             "contrast more than detail; 1: a wave of half the blocks' limit is as strong as at full rate")
      .within(0, 1)
      .need("`filter` linear, push-pull or tent");
}

}  // namespace gazetrace
