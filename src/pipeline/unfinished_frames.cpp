// SPDX-License-Identifier: Apache-2.0
#include "pipeline/unfinished_frames.hpp"

#include <fmt/format.h>

#include <string>
#include <utility>
#include <vector>

#include "core/stopwatch.hpp"
#include "core/text.hpp"
#include "gazetrace/error.hpp"
#include "gazetrace/traced_frame_file.hpp"
#include "output/written_file.hpp"
#include "pipeline/timing_row.hpp"
#include "pipeline/traced_file.hpp"

namespace gazetrace {

bool leaves_unfinished(const PipelineSettings& settings) {
  return settings.stage == SequenceStage::trace;
}

std::string unfinished_file_name(const PipelineSettings& settings, std::int32_t frame) {
  return traced_file_name(settings.output.run_name, frame);
}

std::string read_unfinished_digest(const PipelineSettings& settings, std::int32_t frame) {
  return read_traced_digest(unfinished_file_name(settings, frame));
}

void save_unfinished(std::int32_t frame, const TracedFrame& traced, const PipelineSettings& settings, TimingRow& row,
                     WrittenFiles& files) {
  const Stopwatch watch;
  const std::string path = unfinished_file_name(settings, frame);
  add_prediction(traced.prediction, row);
  WrittenFile file = save_traced(path, frame, traced, settings.settings_digest);
  files.insert_or_assign(name_in_record(folder_of_run(settings.output.run_name), path), std::move(file));
  row.write_ms += watch.elapsed_ms();
}

TracedFrame load_unfinished(const FrameRequest& request, const PipelineSettings& settings) {
  const std::string path = traced_file_name(settings.output.run_name, request.frame);
  TracedFrame traced = load_traced(path, request.frame, settings.settings_digest);
  if (traced.map.width_px != request.width_px || traced.map.height_px != request.height_px) {
    throw Error(ErrorKind::input, path, "holds a frame of another size", "trace it again");
  }
  return traced;
}

void check_all_traced(const std::vector<std::int32_t>& frames, const PipelineSettings& settings) {
  std::vector<std::int32_t> missing;
  for (const std::int32_t frame : frames) {
    if (read_traced_digest(traced_file_name(settings.output.run_name, frame)) != settings.settings_digest) {
      missing.push_back(frame);
    }
  }
  if (!missing.empty()) {
    throw Error(ErrorKind::input, folder_of_run(settings.output.run_name),
                fmt::format("{} frames are not traced under these settings: {}", missing.size(),
                            bounded(format_frame_list(missing), 200)),
                "trace them with `stage` trace");
  }
}

}  // namespace gazetrace
