// SPDX-License-Identifier: Apache-2.0
// Means of sequences that were rendered with different seeds, so that several runs share the samples of one picture.
#pragma once

#include <string>
#include <vector>

#include "gazetrace/output.hpp"

namespace gazetrace {

struct MeanSettings {
  std::vector<std::string> renders;  // patterns of linear pictures, or single ones
  std::string output;                // the pattern of their means
  std::vector<std::string> command_line;
  bool allow_missing = false;  // take the mean of the others where a render lacks frames
  bool overwrite = false;
  // The means that are there take in the renders that are not behind them yet. A frame of them that a render lacks is
  // missing as any other.
  bool resume = false;
};

// Writes the mean of each frame, weighted by the samples of its pixels, and a record beside the pictures. The mean's
// own header states its seeds and samples, so that it can be one of the `renders` later. A frame appears under its name
// only when it is complete. Error(usage) for fewer than two renders, and where a mean exists; Error(input) for renders
// of different jobs or the same seed, for frames that are missing, and for pictures that do not state their samples.
MergeResult merge_means(const MeanSettings& settings);

}  // namespace gazetrace
