// SPDX-License-Identifier: Apache-2.0
// What the rows of a sweep must have in common, and must not. Each throws Error(input) with the plan's line.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "gazetrace/sweep.hpp"
#include "sweep/plan_file.hpp"

namespace gazetrace {

// Where a row was written, and its first seed.
struct SweepTestPlace {
  std::string place;
  std::uint64_t seed = 0;
};

// `tests` are those before it.
void check_new(const std::vector<SweepTest>& tests, const SweepTest& test, const std::string& place);
// Rows of one gaze share the floor of their reference and what they show, so it must be the same gaze.
void check_gaze(const std::vector<SweepTest>& tests, const SweepTest& test, const std::string& place);
// No row shares a seed with a reference.
void check_seeds(const SweepFile& file, const std::vector<SweepTestPlace>& tests);
// Some metrics look back in time: their frames must follow each other.
void check_frames(const std::string& plan_file, const std::vector<std::string>& metrics,
                  const std::vector<SweepTest>& tests);

}  // namespace gazetrace
