// SPDX-License-Identifier: Apache-2.0
// Parts of the samples of every frame, rendered by several machines, and the pictures that are made of them.
#pragma once

#include <string>
#include <vector>

#include "gazetrace/color.hpp"
#include "gazetrace/output.hpp"
#include "gazetrace/pipeline.hpp"
#include "gazetrace/plan.hpp"
#include "gazetrace/sample_sums.hpp"

namespace gazetrace {

// Why pictures cannot be made later from parts of the samples under these settings; empty: they can.
std::string needs_all_samples(const PipelineSettings& settings);
// Adds up the parts of the samples of every frame of the plan and writes what one run over all samples would have
// written, to the bit, with its table of times and its record; files that exist are replaced. `settings` are those of
// the parts without `trace.samples`, for which needs_all_samples() is empty. Error(input) for damaged files, for files
// of other settings, and where samples are missing or present twice; Error(runtime) for sums of another sampling map.
MergeResult merge_samples(const std::vector<RunPart>& parts, const FramePlan& plan, const ColorPipeline& color,
                          const PipelineSettings& settings);

// The sums of one frame's samples in a file, to the bit. The file appears under its name only when it is complete.
// Error(runtime) where it cannot be written. The file does not say which frame it is of, and WrittenFile::frame is 0.
WrittenFile save_samples(const std::string& path, const SampleSums& sums, const std::string& settings_digest);
// Error(input) for a file that holds no such sums, is damaged, or was made under other settings.
SampleSums load_samples(const std::string& path, const std::string& settings_digest);

}  // namespace gazetrace
