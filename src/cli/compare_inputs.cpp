// SPDX-License-Identifier: Apache-2.0
#include "cli/compare_inputs.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "gazetrace/error.hpp"

namespace gazetrace {
namespace {

namespace fs = std::filesystem;

// The settings of the run whose record lies beside the pictures, if it is the record of these.
std::optional<JobSettings> settings_of_run(const std::string& pattern, const FrameFacts& facts, std::string& view) {
  const std::string path = (fs::path(pattern).parent_path() / "run.json").string();
  if (!fs::is_regular_file(path)) {
    return std::nullopt;
  }
  const RunRecord record = read_run_record(path);
  const auto& parts = record.part_digests;
  if (record.settings_digest != facts.settings_digest &&
      std::find(parts.begin(), parts.end(), facts.settings_digest) == parts.end()) {
    return std::nullopt;
  }
  const auto found = record.facts.find("view");
  view = found == record.facts.end() ? std::string() : found->second;
  return job_of_record(record, path).settings;
}

std::vector<std::int32_t> frames_of_both(const CompareJob& job) {
  const std::vector<std::int32_t> reference = find_frames(job.reference);
  const std::vector<std::int32_t> test = find_frames(job.test);
  std::vector<std::int32_t> both;
  std::set_intersection(reference.begin(), reference.end(), test.begin(), test.end(), std::back_inserter(both));
  if (job.frames) {
    for (const std::int32_t frame : job.frames->frames) {
      if (!std::binary_search(both.begin(), both.end(), frame)) {
        throw Error(ErrorKind::input, "--frames", fmt::format("frame {} is not in both sequences", frame));
      }
    }
    return job.frames->frames;
  }
  if (both.empty() || (!job.anyway && reference != test)) {
    throw Error(
        ErrorKind::input, job.test,
        fmt::format("the reference has frames {}, the test {}", format_frame_list(reference), format_frame_list(test)),
        both.empty() ? "compare sequences of the same frames"
                     : "name frames that both have with --frames, or say --anyway");
  }
  return both;
}

// Where the test was foveated by regions, those; else the reference's; else the source paper's.
RetinalRegions regions_of(const CompareJob& job, const CompareInputs& inputs) {
  if (job.region_angles_deg) {
    return retinal_regions(*job.region_angles_deg, job.reading);
  }
  for (const auto& run : {inputs.test_run, inputs.reference_run}) {
    if (run && run->foveation.falloff == "regions") {
      return retinal_regions(run->foveation.region_angles_deg, run->foveation.reading);
    }
  }
  return {};
}

void read_gaze_log(const CompareJob& job, CompareInputs& inputs) {
  GazeLog log = read_gaze_file(job.shared.gaze, job.shared.screen);
  if (log.kind != GazeKind::screen) {
    throw Error(ErrorKind::input, job.shared.gaze.path, "holds directions from the head, not places on a screen",
                "compare such runs without bands, or give --gaze-at");
  }
  if (!inputs.screen) {
    inputs.screen = log.recording_geometry;
  }
  const bool says_screen = screen_geometry(job.shared.screen).has_value() || !inputs.reference_run;
  complete_recording_geometry(log, says_screen ? job.shared.screen : inputs.reference_run->screen);
  if (log.samples.size() > 1 && knows_angles(log)) {
    inputs.movements = detect_events(log, default_event_preset(log)).labels;
  }
  inputs.gaze_log = std::move(log);
}

// The screen of a run: as it was given, else that of its gaze log.
std::optional<DisplayGeometry> screen_of(const JobSettings& run) {
  if (std::optional<DisplayGeometry> screen = screen_geometry(run.screen)) {
    return screen;
  }
  return fs::is_regular_file(run.gaze.path) ? read_gaze_file(run.gaze, run.screen).recording_geometry : std::nullopt;
}

double rate_of(const FrameRate& fps) {
  return static_cast<double>(fps.numerator) / static_cast<double>(fps.denominator);
}

std::optional<double> stated_fps(const CompareJob& job, const CompareInputs& inputs, const FrameFacts& reference,
                                 const FrameFacts& test) {
  if (job.fps) {
    return rate_of(*job.fps);
  }
  if (reference.frames_per_second || inputs.reference_run) {
    return reference.frames_per_second ? *reference.frames_per_second : rate_of(inputs.reference_run->fps);
  }
  return test.frames_per_second ? test.frames_per_second
         : inputs.test_run      ? std::optional(rate_of(inputs.test_run->fps))
                                : std::nullopt;
}

[[noreturn]] void differ(const std::string& path, const std::string& problem, const std::string& remedy) {
  throw Error(ErrorKind::input, path, problem, remedy);
}

}  // namespace

std::string picture_path(const std::string& pattern, std::int32_t frame) {
  return has_frame_number(pattern) ? frame_file_name(pattern, frame) : pattern;
}

CompareInputs load_compare_inputs(const CompareJob& job) {
  CompareInputs inputs;
  inputs.frames = frames_of_both(job);
  const FrameFacts facts = read_frame_facts(picture_path(job.reference, inputs.frames.front()));
  const FrameFacts test_facts = read_frame_facts(picture_path(job.test, inputs.frames.front()));
  inputs.reference_run = settings_of_run(job.reference, facts, inputs.reference_view);
  inputs.test_run = settings_of_run(job.test, test_facts, inputs.test_view);
  inputs.screen = screen_geometry(job.shared.screen);
  // The reference's, or the test's where the reference knows of none.
  const std::optional<JobSettings>* shown = &inputs.reference_run;
  for (const std::optional<JobSettings>* const run : {&inputs.reference_run, &inputs.test_run}) {
    if (!inputs.screen && *run) {
      inputs.screen = screen_of(**run);
      shown = inputs.screen ? run : shown;
    }
  }
  if (!job.shared.gaze.path.empty()) {
    read_gaze_log(job, inputs);
  }
  if (inputs.screen) {
    check_display(*inputs.screen);
  }
  inputs.regions = regions_of(job, inputs);
  if (job.shared.frame_rect) {
    inputs.frame_rect = *job.shared.frame_rect;
  } else if (*shown && (*shown)->frame_rect) {
    inputs.frame_rect = *(*shown)->frame_rect;
  }
  inputs.stated_fps = stated_fps(job, inputs, facts, test_facts);
  if (inputs.frames.size() > 1) {
    inputs.frames_per_second = inputs.stated_fps.value_or(0);
  }
  inputs.gaze = compared_gaze_source(job, inputs);
  return inputs;
}

void check_comparable(const CompareJob& job, const CompareInputs& inputs, const ComparedPicture& reference,
                      const ComparedPicture& test, const std::string& reference_path, const std::string& test_path) {
  const auto size_of = [](const ComparedPicture& picture) {
    const ImageRgb& image = picture.is_linear ? picture.picture.light : picture.picture.code;
    return std::pair{image.width_px, image.height_px};
  };
  const auto [width, height] = size_of(reference);
  const auto [test_width, test_height] = size_of(test);
  if (width != test_width || height != test_height) {
    differ(test_path, fmt::format("has {}x{} pixels, the reference {}x{}", test_width, test_height, width, height),
           "compare pictures of one size");
  }
  if (reference.is_linear != test.is_linear) {
    differ(test_path,
           fmt::format("is {}, the reference {}", test.is_linear ? "linear light" : "a display image",
                       reference.is_linear ? "linear light" : "a display image"),
           "compare two of a kind");
  }
  if (job.anyway) {
    return;
  }
  if (!reference.is_linear && inputs.reference_view != inputs.test_view && !inputs.reference_view.empty() &&
      !inputs.test_view.empty()) {
    differ(test_path,
           fmt::format("was shown through '{}', the reference through '{}'", inputs.test_view, inputs.reference_view),
           "render both with one view, or say --anyway");
  }
  const bool automatic = inputs.reference_run && inputs.reference_run->exposure.mode == ExposureMode::log_average;
  const auto& a = reference.facts.exposure_ev;
  const auto& b = test.facts.exposure_ev;
  constexpr double kSameEv = 1e-9;
  if (a && b && std::fabs(*a - *b) > kSameEv && !(reference.is_linear && (automatic || job.exposure_ev))) {
    differ(test_path, fmt::format("was exposed by {} stops, the reference by {} ({})", *b, *a, reference_path),
           "render both with one exposure, or say --anyway");
  }
}

std::optional<PlanarView> compare_view(const CompareInputs& inputs, int width_px, int height_px) {
  if (!inputs.screen) {
    return std::nullopt;
  }
  return view_of_display(*inputs.screen, inputs.frame_rect, width_px, height_px);
}

}  // namespace gazetrace
