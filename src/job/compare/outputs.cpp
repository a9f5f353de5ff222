// SPDX-License-Identifier: Apache-2.0
// What `compare` writes, checked before it writes anything.
#include <filesystem>
#include <set>
#include <system_error>

#include "gazetrace/compare_inputs.hpp"
#include "gazetrace/error.hpp"

namespace gazetrace {
namespace {

namespace fs = std::filesystem;

fs::path place_of(const std::string& path) {
  std::error_code problem;
  const fs::path canonical = fs::weakly_canonical(fs::absolute(path), problem);
  return problem ? fs::absolute(path).lexically_normal() : canonical;
}

std::set<fs::path> files_read(const CompareJob& job, const CompareInputs& inputs) {
  std::set<fs::path> read;
  for (const std::string& pattern : {job.reference, job.test}) {
    read.insert(place_of(run_record_file_name(run_name_of(pattern), "", false)));
    for (const std::int32_t frame : inputs.frames) {
      read.insert(place_of(picture_path(pattern, frame)));
    }
  }
  for (const std::string& path : {job.shared.gaze.path, job.shared.screen.name, job.pooling_weights}) {
    if (!path.empty()) {
      read.insert(place_of(path));
    }
  }
  return read;
}

}  // namespace

std::string map_pattern(const CompareJob& job, const std::string& metric) {
  return job.maps + "/" + metric + ".####.png";
}

void check_compare_outputs(const CompareJob& job, const CompareInputs& inputs,
                           const std::vector<std::string>& metrics) {
  std::vector<std::string> outputs;
  for (const std::string& path : {job.csv, job.json}) {
    if (!path.empty() && path != "-") {
      outputs.push_back(path);
    }
  }
  const std::size_t files = outputs.size();
  for (const std::string& metric : metrics) {
    for (std::size_t f = 0; f < inputs.frames.size() && !job.maps.empty(); ++f) {
      outputs.push_back(frame_file_name(map_pattern(job, metric), inputs.frames[f]));
    }
  }
  const std::set<fs::path> read = files_read(job, inputs);
  std::set<fs::path> written;
  for (std::size_t i = 0; i < outputs.size(); ++i) {
    const std::string& path = outputs[i];
    if (read.contains(place_of(path))) {
      throw Error(ErrorKind::usage, path, "this output would replace an input", "give another name");
    }
    if (!written.insert(place_of(path)).second) {
      throw Error(ErrorKind::usage, path, "two outputs have this name", "give each its own");
    }
    if (i < files || fs::exists(path)) {  // the folder of maps is made
      check_output_file(path, job.overwrite);
    }
  }
}

}  // namespace gazetrace
