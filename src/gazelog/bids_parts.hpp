// SPDX-License-Identifier: Apache-2.0
// The parts of a recording in BIDS: tables of samples with their sidecars, and tables of events with theirs. Which
// files they become is said in write_bids.cpp.
#pragma once

#include <cmath>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "gazetrace/gaze_log.hpp"

namespace gazetrace {

using BidsJson = nlohmann::ordered_json;

// One row of a recording's table.
struct BidsRow {
  std::int64_t t_ns = 0;
  EyeGaze gaze;
  Vec3f origin_mm{NAN, NAN, NAN};
};

// What one file holds.
struct BidsRecording {
  Eye eye = Eye::cyclopean;
  std::vector<BidsRow> rows;
};

// The gaze of each eye, and the gaze that was made from both unless one eye was taken as it is; or the only gaze there
// is, split by the eyes that its samples name.
std::vector<BidsRecording> bids_recordings(const GazeLog& log);

// The size of the display in pixels; 1 where it is not known, so that the values are fractions instead of pixels.
struct BidsPixelScale {
  double width_px = 1, height_px = 1;
};

BidsPixelScale bids_pixel_scale(const GazeLog& log);
// Whether pixels give back every bit of all places.
bool are_pixels_exact(const std::vector<BidsRecording>& recordings, GazeKind kind, const BidsPixelScale& scale);

// physio.tsv and its sidecar.
struct BidsSamples {
  std::string table;
  BidsJson sidecar;
};
BidsSamples bids_samples(const GazeLog& log, const BidsRecording& recording, const BidsPixelScale& scale,
                         bool is_exact);

// physioevents.tsv and its sidecar: what the log states of the movements of one eye. An empty table: it states nothing.
struct BidsEvents {
  std::string table;
  BidsJson sidecar;
};
BidsEvents bids_events_of_eye(const GazeLog& log, Eye eye, const std::vector<BidsRecording>& recordings);

// events.tsv and its sidecar, with the screen: what happened in the run.
BidsEvents bids_run_events(const GazeLog& log);

// An x with x / scale == value, or with x * scale == value: the rounded one or one of its neighbouring numbers, where
// there is one.
double inverse_of_division(double value, double scale);
double inverse_of_product(double value, double scale);

}  // namespace gazetrace
