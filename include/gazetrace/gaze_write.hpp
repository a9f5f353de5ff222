// SPDX-License-Identifier: Apache-2.0
// Writing gaze logs: as gazetrace CSV, and as BIDS eye tracking.
#pragma once

#include <string>
#include <vector>

#include "gazetrace/error.hpp"
#include "gazetrace/gaze_log.hpp"

namespace gazetrace {

// Lossless, bit by bit, for samples, both eyes and origins, but `row`: header `t[ns],u[1],v[1],valid,eye,...` or
// `t[ns],dx,dy,dz,...`. With both eyes there are three rows a time; where the gaze is one eye's everywhere, that eye's
// rows are not written twice and `# eye` names it. The head's pose stands in the first row of a time; poses between
// samples, events, messages and calibrations stand in lines before the header.
void write_gaze_csv(const GazeLog& log, const std::string& path);

// The same as BIDS eye tracking: one file for each eye, and one for what was made of both, with sidecars, the log's
// events and the screen, but no head poses. `path` names it: sub-01_task-view_physio.tsv.gz; a recording- in it is
// replaced by eye1, eye2 and cyclopean. Lossless as above. Error(usage) for another name, Error(input) for gaze on a
// scene camera's picture.
void write_gaze_bids(const GazeLog& log, const std::string& path);
std::vector<std::string> bids_file_names(const GazeLog& log, const std::string& path);  // what it would write
bool is_bids_file_name(const std::string& path);

struct BidsLeftover {
  std::string path;
  bool is_own = false;  // gazetrace wrote it: its sidecar says so
};

// Gaze recordings with their sidecars and events, and a screen of gazetrace's own, that have the name of the `written`
// files (of `bids_file_names`, which see) but for recording-, and are not among them. Who reads what was written reads
// them, too. Recordings that are no gaze are none of them. Error(input) for broken sidecars.
std::vector<BidsLeftover> bids_leftovers(const std::vector<std::string>& written);

}  // namespace gazetrace
