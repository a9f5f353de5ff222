// SPDX-License-Identifier: Apache-2.0
// One BIDS recording: the table of an eye, what its sidecars say about it, and the events beside it.
#pragma once

#include <cstddef>
#include <string>

#include "gazelog/bids_sidecars.hpp"
#include "gazelog/table.hpp"
#include "gazetrace/gaze_raw.hpp"

namespace gazetrace {

struct BidsColumns {
  std::size_t time = 0, x = 0, y = 0;
  OptionalColumn pupil;
  // For recordings that gazetrace wrote: columns that hold every bit of the places, and values for which the standard
  // has no name.
  OptionalColumn z, validity, confidence;
  VectorColumns origin;
  bool is_fraction = false, is_direction = false;
  std::string x_name, y_name;
};

// The bytes of a table, unpacked.
std::string read_bids_table(const std::string& path,
                            std::uint64_t most_unpacked_bytes = std::numeric_limits<std::uint64_t>::max());

Eye recorded_eye(const Sidecars& sidecars);

// Adds the samples and origins of one file to the raw gaze, with places as they stand in the file. Returns the file's
// columns.
BidsColumns read_bids_samples(const GazeFile& file, const Sidecars& sidecars, const GazeReadOptions& options,
                              RawGaze& raw);

// Adds the events of the ..._physioevents.tsv(.gz) beside the recording at `path`, where there is one.
void read_bids_events(const Sidecars& physio, const std::string& path, RawGaze& raw);

// A unit, and how many of it one count of the file is.
struct StatedUnit {
  PositionUnit unit = PositionUnit::px;
  double each = 1;
  bool operator==(const StatedUnit&) const = default;
};

// The unit of the positions that the sidecar states or, where it states none that is understood, the user. `path` is
// that of the recording, for messages.
StatedUnit stated_bids_unit(const Sidecars& sidecars, const BidsColumns& columns, const GazeReadOptions& options,
                            const std::string& path, RawGaze& raw, Evidence& evidence);

// The space of the positions; gaze-on-screen where none is stated.
std::string bids_coordinate_system(const Sidecars& sidecars);

// The origin of the positions; top_left where none is stated. Throws Error(input) for an origin that cannot be read.
PositionOrigin bids_screen_origin(const Sidecars& events, const GazeReadOptions& options);
bool states_screen_origin(const Sidecars& events);

// Writes the size, distance and pixel density of the screen into the raw gaze, with warnings for values that are not
// taken as they stand in the file.
void read_bids_screen(const Sidecars& events, RawGaze& raw);

}  // namespace gazetrace
