// SPDX-License-Identifier: Apache-2.0
// A sweep's plan as it is written in TOML, with every value checked on its own and the line in every message.
#pragma once

#include <algorithm>
#include <cstdint>
#include <iterator>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "gazetrace/job.hpp"
#include "gazetrace/metric_options.hpp"

namespace gazetrace {

// `names`: any list of texts.
template <class Names>
bool is_among(const Names& names, std::string_view name) {
  return std::find(std::begin(names), std::end(names), name) != std::end(names);
}

// An option of `render` and what a plan gives it.
struct Assignment {
  std::string option;
  std::vector<std::string> values;
  std::string place;    // file:line
  std::string warning;  // of a file that was found in another place than the plan says; empty: none
  std::string former;   // the former option that stands there; empty: none
};

struct SweepFileScene {
  std::string name, place;
  std::vector<Assignment> options;
};
using SweepFileGaze = SweepFileScene;

struct SweepFileSetting {
  std::string label;  // of a [[setting]]; if empty, it is made from the options
  std::string place;
  std::vector<Assignment> options;
  double resolution_scale = 1;
};

// Values that were published elsewhere for a scene and a setting of this label.
struct SweepFilePublished {
  std::string scene, setting, source, place;
  double speed_up = 0;
};

struct SweepFileReference {
  std::vector<Assignment> options;
  int scramblings = 4;
  std::uint64_t seed = 1000003;
  bool is_auto = false;    // spp = "auto"
  double most_spp = 8192;  // of all scramblings together
  bool go_on = false;
};

struct SweepFileMeasure {
  int repeats = 3, warm_up = 1;
  DurationNs leave_out;
  std::vector<std::string> baselines{"uniform-reference-rate", "equal-samples", "equal-time", "low-resolution"};
  bool controls = true;
  std::uint32_t reference_rate = 32;
  std::vector<std::string> uniform_rates;
  std::vector<std::string> quality;  // METRIC=VALUE
  std::string pictures = "png";      // png, exr, both, none
  std::uint32_t efficiency_spp = 4;
  MetricChoice compare;  // metrics and the display they need
};

struct SweepFile {
  std::string path, title;
  std::vector<Assignment> common;
  std::vector<SweepFileScene> scenes;
  std::vector<SweepFileGaze> gazes;
  std::vector<SweepFileSetting> settings;  // every [[setting]] with every combination of the [grid]
  std::vector<SweepFilePublished> published;
  SweepFileReference reference;
  SweepFileMeasure measure;
  std::map<std::string, std::string> places;  // of the keys of [reference] and [measure]
  std::vector<std::string> varied;            // options that settings give
};

// Throws Error(input) with a message of one line for every error that can be found from the file alone.
SweepFile read_sweep_file(const std::string& path, const JobSchema& schema);
// The line of a key of [reference] or [measure]; where it is not given, the file.
std::string place_of(const SweepFile& file, const std::string& key);

}  // namespace gazetrace
