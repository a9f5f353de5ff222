// SPDX-License-Identifier: Apache-2.0
// One BIDS recording: the table of an eye, what its sidecars say of it, and the events beside it.
#pragma once

#include <algorithm>
#include <cstddef>
#include <optional>
#include <string>

#include "gazelog/bids_sidecars.hpp"
#include "gazelog/gaze_format.hpp"

namespace gazetrace {

struct BidsColumns {
  std::size_t time = 0, x = 0, y = 0;
  std::optional<std::size_t> pupil;
  // Of recordings that gazetrace wrote: every bit of the places, and what the standard has no name for.
  std::optional<std::size_t> z, validity, confidence, origin_x, origin_y, origin_z;
  bool is_fraction = false, is_direction = false;
  std::string x_name, y_name;

  [[nodiscard]] std::size_t needed() const {
    std::size_t last = std::max({time, x, y});
    for (const auto& column : {pupil, z, validity, confidence, origin_x, origin_y, origin_z}) {
      last = std::max(last, column.value_or(0));
    }
    return last + 1;
  }
};

// The bytes of a table, unpacked.
std::string read_bids_table(const std::string& path);

Eye recorded_eye(const Sidecars& sidecars);

// Samples and origins of one file into the raw, places as they stand there. Returns its columns.
BidsColumns read_bids_samples(const GazeFile& file, const Sidecars& sidecars, const GazeReadOptions& options,
                              RawGaze& raw);

// Those of the ..._physioevents.tsv(.gz) beside the recording at `path`, where there is one.
void read_bids_events(const Sidecars& physio, const std::string& path, RawGaze& raw);

// A unit, and how many of it a number of the file counts.
struct StatedUnit {
  PositionUnit unit = PositionUnit::px;
  double each = 1;
  bool operator==(const StatedUnit&) const = default;
};

// What the sidecar says of the positions' unit, or the user where it says nothing that is understood. `path`: of the
// recording, for messages.
StatedUnit stated_bids_unit(const Sidecars& sidecars, const BidsColumns& columns, const GazeReadOptions& options,
                            const std::string& path, RawGaze& raw, Evidence& evidence);

// gaze-on-screen where none is stated.
std::string bids_coordinate_system(const Sidecars& sidecars);

}  // namespace gazetrace
