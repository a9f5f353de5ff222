// SPDX-License-Identifier: Apache-2.0
// What lies in a BIDS folder beside the files that a conversion writes.
#pragma once

#include <string>
#include <vector>

namespace gazetrace {

struct BidsLeftover {
  std::string path;
  bool is_own = false;  // gazetrace wrote it: its sidecar says so
};

// Gaze recordings with their sidecars and events, and a screen of gazetrace's own, that have the name of the `written`
// files (of `bids_file_names`, which see) but for recording-, and are not among them. Who reads what was written reads
// them, too. Recordings that are no gaze are none of them. Error(input) for broken sidecars.
std::vector<BidsLeftover> bids_leftovers(const std::vector<std::string>& written);

}  // namespace gazetrace
