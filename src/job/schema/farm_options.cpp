// SPDX-License-Identifier: Apache-2.0
// What machines need that share a sequence. People meet these options in scripts only, so they have a page of their
// own.
#include "job/schema/parts.hpp"

namespace gazetrace {

void add_farm_options(JobSchema& schema) {
  schema.group(kFarmHeading);
  schema
      .value(
          "--chunk", &JobSettings::chunk, "K/N", Touch::frames,
          "Renders the K-th of N parts of the frames, which cost about the same by the samples of the plan; 1/1 makes "
          "all frames that are asked for a part of a longer sequence. Timing and run record carry its frames in their "
          "names, and 'gazetrace merge' joins all parts. The borders are the same "
          "for every task and are written down beside the outputs. A chunk without frames is done at once")
      .decides_nothing()
      .with(Trait::one_run);
  schema
      .flag("--trust-files", &JobSettings::trust_files, Touch::output,
            "--resume believes the headers of finished files and does not read them whole")
      .decides_nothing()
      .with(Trait::one_run);
  schema
      .value("--grace", &JobSettings::grace, "DURATION", Touch::output,
             "After a signal to end (TERM, INT, HUP, USR1, XCPU), the time to finish the frame in hand; then it is "
             "given up, "
             "and the run goes on with --resume")
      .decides_nothing()
      .within(0, 1e18)
      .with(Trait::one_run);
  schema
      .value("--max-time", &JobSettings::max_time, "DURATION", Touch::output,
             "Ends in time as if by a signal, so that the run is over, --grace included, so long after its beginning: "
             "55m before a queue's limit of an hour")
      .decides_nothing()
      .within(0, 1e18)
      .with(Trait::one_run);
}

}  // namespace gazetrace
