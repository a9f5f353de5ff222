// SPDX-License-Identifier: Apache-2.0
// What `compare` reads and writes.
#include "gazetrace/compare_inputs.hpp"

namespace gazetrace {

std::string map_pattern(const CompareJob& job, const std::string& metric) {
  return job.maps + "/" + metric + ".####.png";
}

std::vector<std::string> compared_files(const CompareJob& job, const CompareInputs& inputs) {
  std::vector<std::string> files{job.shared.gaze.path, job.shared.screen.name, job.pooling_weights};
  for (const std::string& pattern : {job.reference, job.test}) {
    files.push_back(run_record_file_name(run_name_of(pattern), "", false));
    for (const std::int32_t frame : inputs.frames) {
      files.push_back(picture_path(pattern, frame));
    }
  }
  return files;
}

void check_compare_outputs(const CompareJob& job, const CompareInputs& inputs,
                           const std::vector<std::string>& metrics) {
  std::vector<std::string> outputs{job.csv, job.json == "-" ? std::string() : job.json};
  for (const std::string& metric : job.maps.empty() ? std::vector<std::string>() : metrics) {
    for (const std::int32_t frame : inputs.frames) {
      outputs.push_back(frame_file_name(map_pattern(job, metric), frame));
    }
  }
  check_outputs(outputs, compared_files(job, inputs), job.overwrite);
}

}  // namespace gazetrace
