// SPDX-License-Identifier: Apache-2.0
#include "cli/compare_inputs.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <sstream>

#include "cli/toml_config.hpp"
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
  JobSettings job;
  OptionTable table;
  add_job_options(table, job);
  const TomlConfig config([&] { return TomlConfig::Target{&table, "render", path}; });
  std::istringstream text(record.config_toml);
  for (const CLI::ConfigItem& item : config.from_config(text)) {
    for (const OptionEntry& entry : table.entries()) {
      if (entry.name == item.name && !item.inputs.empty()) {
        entry.assign(item.inputs, path + ": " + item.name);
      }
    }
  }
  return job;
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

std::string path_of(const std::string& pattern, std::int32_t frame) {
  return has_frame_number(pattern) ? frame_file_name(pattern, frame) : pattern;
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

[[noreturn]] void differ(const std::string& path, const std::string& problem, const std::string& remedy) {
  throw Error(ErrorKind::input, path, problem, remedy);
}

}  // namespace

CompareInputs load_compare_inputs(const CompareJob& job) {
  CompareInputs inputs;
  inputs.frames = frames_of_both(job);
  const FrameFacts facts = read_frame_facts(path_of(job.reference, inputs.frames.front()));
  const FrameFacts test_facts = read_frame_facts(path_of(job.test, inputs.frames.front()));
  inputs.reference_run = settings_of_run(job.reference, facts, inputs.reference_view);
  inputs.test_run = settings_of_run(job.test, test_facts, inputs.test_view);
  inputs.screen = screen_geometry(job.shared.screen);
  if (!inputs.screen && inputs.reference_run) {
    inputs.screen = screen_geometry(inputs.reference_run->screen);
  }
  if (!inputs.screen && inputs.reference_run && fs::is_regular_file(inputs.reference_run->gaze.path)) {
    inputs.screen = read_gaze_file(inputs.reference_run->gaze, inputs.reference_run->screen).recording_geometry;
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
  } else if (inputs.reference_run && inputs.reference_run->frame_rect) {
    inputs.frame_rect = *inputs.reference_run->frame_rect;
  }
  if (inputs.frames.size() > 1) {
    if (job.fps) {
      inputs.frames_per_second = static_cast<double>(job.fps->numerator) / static_cast<double>(job.fps->denominator);
    } else if (facts.frames_per_second) {
      inputs.frames_per_second = *facts.frames_per_second;
    } else if (inputs.reference_run) {
      const FrameRate& fps = inputs.reference_run->fps;
      inputs.frames_per_second = static_cast<double>(fps.numerator) / static_cast<double>(fps.denominator);
    }
  }
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

bool knows_gaze(const CompareJob& job, const CompareInputs& inputs) {
  return job.shared.gaze_at || inputs.gaze_log ||
         std::any_of(inputs.frames.begin(), inputs.frames.end(), [&](std::int32_t frame) {
           const FrameFacts facts = read_frame_facts(path_of(job.reference, frame));
           return facts.gaze_true && !facts.gaze_is_direction && gaze_class_of(*facts.gaze_true) != GazeClass::no_gaze;
         });
}

ComparedGaze compared_gaze(const CompareJob& job, const CompareInputs& inputs, const FrameFacts& facts,
                           std::int32_t frame, int width_px, int height_px) {
  std::optional<GazeAtTime> gaze = facts.gaze_true;
  if (job.shared.gaze_at) {
    // An eye that rests there.
    gaze.emplace();
    gaze->state = GazeState::measured;
    gaze->u = job.shared.gaze_at->x;
    gaze->v = job.shared.gaze_at->y;
    gaze->movement = EyeMovement::fixation;
  } else if (inputs.gaze_log) {
    const double middle_s = (frame - 0.5) / (inputs.frames_per_second > 0 ? inputs.frames_per_second : 24);
    const std::int64_t t_ns =
        facts.t_video_ns ? *facts.t_video_ns : static_cast<std::int64_t>(std::floor(middle_s * 1e9));
    gaze = gaze_at(*inputs.gaze_log, gaze_mapping(job.shared, &*inputs.gaze_log), t_ns,
                   inputs.movements.empty() ? nullptr : &inputs.movements);
  }
  if (!gaze) {
    return {};
  }
  if (!gaze->movement && inputs.reference_run && inputs.reference_run->gaze_at) {
    gaze->movement = EyeMovement::fixation;
  }
  const GazeClass gaze_class = gaze_class_of(*gaze);
  if (gaze_class == GazeClass::no_gaze || gaze->kind == GazeKind::direction) {
    return {std::nullopt, gaze_class};
  }
  // Of the screen to those of the frame, which may fill a part of it.
  const FrameRect& rect = inputs.frame_rect;
  const bool whole = !inputs.screen || rect.width_px == 0;
  const double screen_x = whole ? 0 : gaze->u * inputs.screen->width_px;
  const double screen_y = whole ? 0 : gaze->v * inputs.screen->height_px;
  const Vec2d px = whole ? Vec2d{gaze->u * width_px, gaze->v * height_px}
                         : Vec2d{(screen_x - rect.x_px) / rect.width_px * width_px,
                                 (screen_y - rect.y_px) / rect.height_px * height_px};
  return {px, gaze_class};
}

}  // namespace gazetrace
