// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace gazetrace {

enum ExitCode : int {
  exit_done = 0,
  exit_over_threshold = 1,  // a comparison was made and is over its threshold
  exit_bad_input = 2,       // usage or input, or a quality out of reach; no picture was begun
  exit_failed = 3,          // failed while running
  exit_interrupted = 4,     // asked to end before all was done; goes on with --resume
};

inline constexpr const char* kExitCodesHelp =
    "Exit codes: 0 done; 1 compared and over the threshold (reserved for comparisons); 2 usage or input, or a stated "
    "quality is out of reach, before any picture; 3 failed while running; 4 interrupted, goes on with --resume.";

inline constexpr const char* kConfigHelp =
    "--config FILE reads any of these options from a TOML file (frames = \"1-100\"); options on the command line "
    "win. 'gazetrace render --print-config' writes every option of 'render' and 'plan' with its value.\n";

}  // namespace gazetrace
