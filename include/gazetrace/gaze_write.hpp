// SPDX-License-Identifier: Apache-2.0
// Writing gaze logs: as gazetrace CSV, and as BIDS eye tracking.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "gazetrace/error.hpp"
#include "gazetrace/gaze_log.hpp"

namespace gazetrace {

// Writes gazetrace CSV. Samples, both eyes and the eyes' origins are read again bit by bit; only `GazeSample::row` is
// not kept. The header is `t[ns],u[1],v[1],valid,eye,...` or `t[ns],dx,dy,dz,...`. A log with both eyes has three rows
// for each time. Where the gaze is one eye's everywhere, the rows of that eye are not written twice, and `# eye` names
// it. The head's pose stands in the first row of a time; poses between samples, events, messages and calibrations stand
// in lines above the header. Error(runtime) where the file cannot be written.
void write_gaze_csv(const GazeLog& log, const std::string& path);

// Writes the log as BIDS eye tracking: one file for each eye and one for the gaze that was made of both, with sidecars,
// the log's events and the screen, but without the head's poses. `path` names it, as in
// sub-01_task-view_physio.tsv.gz; a `recording-` in the name is replaced by eye1, eye2 and cyclopean. The files
// are read again bit by bit, as above. Error(usage) for a name that is none of BIDS, Error(input) for gaze on a scene
// camera's picture.
//
// The files of a conversion belong together. Their folder is held from the first look at it to the last change of it,
// so that of several conversions at once, in any processes, one comes wholly after the other; nothing is held where a
// file system has no locks. `look` is called with the tables that will be written while the folder is held. It returns
// the files that are to be removed once all is written, or throws, and nothing is written. Error(runtime) for a file
// that cannot be removed.
using BidsLook = std::function<std::vector<std::string>(const std::vector<std::string>& written)>;
void write_gaze_bids(const GazeLog& log, const std::string& path, const BidsLook& look = {});
// The tables that `write_gaze_bids` would write.
std::vector<std::string> bids_file_names(const GazeLog& log, const std::string& path);
bool is_bids_file_name(const std::string& path);

// A file that lies in a BIDS folder beside those that a conversion writes, and that would be read together with them.
struct BidsLeftover {
  std::string path;
  bool is_own = false;  // gazetrace wrote it: its sidecar says so
};

// Finds them. `written` are the tables of a conversion, as `bids_file_names` lists them. A leftover has their name
// except for its `recording-` part, and is not among them: a gaze recording, its sidecar and its events, or a screen
// that gazetrace wrote. Recordings of other signals, such as pulse, are left out. Error(input) for broken sidecars.
std::vector<BidsLeftover> bids_leftovers(const std::vector<std::string>& written);

}  // namespace gazetrace
