// SPDX-License-Identifier: Apache-2.0
// The checks that need only the settings of a job.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "gazetrace/error.hpp"
#include "gazetrace/foveation.hpp"
#include "gazetrace/reconstruct.hpp"
#include "gazetrace/resolve.hpp"
#include "job/defaults.hpp"
#include "job/outputs.hpp"
#include "job/schema/parts.hpp"
#include "pipeline/quality/adaptive_rates.hpp"

namespace gazetrace {
namespace {

// Farther beside the screen than this nobody looks: such numbers are pixels that were taken for fractions.
constexpr double kMaxGazeScreens = 3;

void check_ranges(const JobSettings& job, const JobSchema& schema) {
  for (const OptionOf<JobSettings>& option : schema.options()) {
    if (!option.range) {
      continue;
    }
    const std::vector<double> numbers = option.numbers(job);
    for (const double number : numbers) {
      if (!option.range->holds(number)) {
        const std::string text = numbers.size() == 1 ? option.values(job).front() : fmt::format("{}", number);
        throw Error(ErrorKind::usage, "`" + option.name + "`",
                    fmt::format("{} is {}{}", text, option.range->least && option.range->most ? "outside " : "not ",
                                option.range->words()),
                    option.range->remedy);
      }
    }
  }
}

void check_target(const JobSettings& job) {
  if (!job.foveation.target.jod) {
    return;
  }
  const char* const option = "`target-jod`";
  if (job.gaze.path.empty() && !job.gaze_at) {
    throw Error(ErrorKind::usage, option, "visibility depends on where the eye looks",
                "give `gaze` or `gaze-at`, and the `screen`");
  }
  if (regions_of(job.foveation.sampling) != nullptr) {
    throw Error(ErrorKind::usage, option, "the rates and blocks of `sampling` regions are not chosen by quality",
                "give `sampling` adaptive or a `density` (a preset that is named may have chosen regions), or `spp`");
  }
  if (has_frame_number(picture_files_of(job.foveation.sampling))) {
    throw Error(ErrorKind::usage, option, "the frames that are judged may have no picture in `density`",
                "give one picture for all frames, or `spp`");
  }
  if (job.only_pixel) {
    throw Error(ErrorKind::usage, option, "with `only-pixel` a single pixel is traced, and no quality is chosen",
                "give `spp`, as the run's record says of its rate");
  }
}

void check_chunk(const JobSettings& job) {
  constexpr std::uint32_t kMostChunks = 1000000;
  if (job.chunk && job.chunk->count > kMostChunks) {
    throw Error(ErrorKind::usage, "`chunk`", fmt::format("{} chunks are more than {}", job.chunk->count, kMostChunks),
                "give no more of them than there are frames");
  }
}

}  // namespace

void check_job(const Job& asked, const JobSchema& schema) {
  const Job whole = with_default_sampling(asked);
  const JobSettings& job = whole.settings;
  check_foveation(job.foveation);
  check_filter_name(job.filter, "`filter`");
  if (job.filter == "oidn" && denoiser_library().path.empty()) {  // a record may be read without it
    const std::string& problem = denoiser_library().problem;
    throw Error(ErrorKind::usage, "`filter`",
                "Open Image Denoise was not found" + (problem.empty() ? "" : "; " + problem),
                "run cmake/denoiser.sh with the build folder, or name the library in GAZETRACE_OIDN_LIBRARY");
  }
  if (looks_first(job.foveation.sampling) && !job.foveation.target.is_given()) {
    FrameRequest request;
    request.width_px = job.size.width;
    request.height_px = job.size.height;
    check_pilot_budget(job.foveation, request);
  }
  check_ranges(job, schema);
  check_target(job);
  check_chunk(job);
  const auto is_near = [](double place) { return place >= -kMaxGazeScreens && place <= 1 + kMaxGazeScreens; };
  if (job.gaze_at && !(is_near(job.gaze_at->x) && is_near(job.gaze_at->y))) {
    throw Error(ErrorKind::usage, "`gaze-at`",
                fmt::format("{},{} lies far outside of the screen", job.gaze_at->x, job.gaze_at->y),
                "give fractions of it from its top left, such as 0.5,0.5");
  }
  gaze_steps_of(job.gaze_process);  // checks names and values of the steps
  const std::vector<std::string> progress_modes{"auto", "always", "never", "openjd", "json"};
  const bool has_descriptor = job.progress.starts_with("json:") && job.progress.size() > 5 &&
                              job.progress.find_first_not_of("0123456789", 5) == std::string::npos;
  if (!has_descriptor &&
      std::find(progress_modes.begin(), progress_modes.end(), job.progress) == progress_modes.end()) {
    throw Error(ErrorKind::usage, "`progress`", unknown_name_message("progress mode", job.progress, progress_modes));
  }
  const OutputSettings output = output_settings(job);
  check_output_settings(output, job.frames && job.frames->frames.size() != 1);
  check_output_folders(output);
}

FilterChoice filter_of(const JobSettings& job) {
  if (job.filter != "auto") {
    return {job.filter, {}};
  }
  const bool has_gaze = !job.gaze.path.empty() || job.gaze_at;
  const Sampling& sampling = job.foveation.sampling;
  const bool foveated = has_gaze ? !is_uniform(sampling) : follows_picture(sampling);
  return choose_filter({.foveated = foveated,
                        .single_pixel = job.only_pixel.has_value(),
                        .has_denoiser = !denoiser_library().path.empty()});
}

}  // namespace gazetrace
