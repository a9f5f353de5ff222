// SPDX-License-Identifier: Apache-2.0
#include "gazetrace/compare_inputs.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "gazetrace/error.hpp"

namespace gazetrace {
namespace {

std::vector<std::int32_t> frames_of_both(const CompareJob& job) {
  const std::vector<std::int32_t> reference = find_frames(job.reference);
  const std::vector<std::int32_t> test = find_frames(job.test);
  std::vector<std::int32_t> both;
  std::set_intersection(reference.begin(), reference.end(), test.begin(), test.end(), std::back_inserter(both));
  if (job.frames && job.frames->frames.empty()) {
    throw Error(ErrorKind::usage, "`frames`", "which fixations there are is asked when frames are rendered",
                "leave it out: frames that are there are compared");
  }
  if (job.frames) {
    for (const std::int32_t frame : job.frames->frames) {
      if (!std::binary_search(both.begin(), both.end(), frame)) {
        throw Error(ErrorKind::input, "`frames`", fmt::format("frame {} is not in both sequences", frame));
      }
    }
    return job.frames->frames;
  }
  if (both.empty() || (!job.anyway && reference != test)) {
    throw Error(
        ErrorKind::input, job.test,
        fmt::format("the reference has frames {}, the test {}", format_frame_list(reference), format_frame_list(test)),
        both.empty() ? "compare sequences of the same frames"
                     : "name frames that both have with `frames`, or say `anyway`");
  }
  return both;
}

// Where the test was foveated by regions, those; else the reference's; else the source paper's.
RetinalRegions regions_of(const CompareJob& job, const CompareInputs& inputs) {
  if (job.region_eccentricities_deg) {
    return retinal_regions(*job.region_eccentricities_deg);
  }
  for (const auto* const run : {&inputs.test_run, &inputs.reference_run}) {
    if (const RegionSampling* const regions = *run ? regions_of((*run)->settings().foveation.sampling) : nullptr) {
      return retinal_regions(regions->eccentricities_deg);
    }
  }
  return {};
}

// The gaze log that is given, seen on the screen that is given or, where none is, on that of the reference.
void read_gaze_log(const CompareJob& job, CompareInputs& inputs) {
  Job viewed;
  viewed.settings = job.shared;
  viewed.settings.gaze_at.reset();
  if (!screen_geometry(job.shared.screen) && inputs.reference_run) {
    viewed.settings.screen = inputs.reference_run->settings().screen;
  }
  ResolveOptions options;
  options.scope = ResolveScope::viewing;
  ResolvedJob resolved = resolve(viewed, options);
  const GazeLog& log = *resolved.gaze;
  if (log.kind != GazeKind::screen) {
    throw Error(ErrorKind::input, job.shared.gaze.path, "holds directions from the head, not places on a screen",
                "compare such runs without bands, or give `gaze-at`");
  }
  if (log.samples.size() > 1 && knows_angles(log)) {
    inputs.movements = detect_events(log, default_event_preset(log)).labels;
  }
  inputs.gaze_log = std::move(resolved);
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
    return reference.frames_per_second ? *reference.frames_per_second : rate_of(inputs.reference_run->settings().fps);
  }
  return test.frames_per_second ? test.frames_per_second
         : inputs.test_run      ? std::optional(rate_of(inputs.test_run->settings().fps))
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
  inputs.reference_run = find_recorded_run(job.reference, facts.settings_digest);
  inputs.test_run = find_recorded_run(job.test, test_facts.settings_digest);
  if (!job.shared.gaze.path.empty()) {
    read_gaze_log(job, inputs);
  }
  inputs.screen = screen_geometry(job.shared.screen);
  // The reference's, or the test's where the reference knows of none, or at last that of the gaze log.
  const RecordedRun* shown = inputs.reference_run ? &*inputs.reference_run : nullptr;
  for (const std::optional<RecordedRun>* const run : {&inputs.reference_run, &inputs.test_run}) {
    if (!inputs.screen && *run && (*run)->resolved.plan_settings.display) {
      inputs.screen = (*run)->resolved.plan_settings.display;
      shown = &**run;
    }
  }
  if (!inputs.screen && inputs.gaze_log) {
    inputs.screen = inputs.gaze_log->plan_settings.display;
  }
  if (inputs.screen) {
    check_display(*inputs.screen);
  }
  inputs.regions = regions_of(job, inputs);
  if (job.shared.frame_rect) {
    inputs.frame_rect = *job.shared.frame_rect;
  } else if (shown != nullptr) {
    inputs.frame_rect = shown->resolved.plan_settings.frame_rect;
  }
  inputs.stated_fps = stated_fps(job, inputs, facts, test_facts);
  if (inputs.frames.size() > 1) {
    inputs.frames_per_second = inputs.stated_fps.value_or(0);
  }
  inputs.gaze = compared_gaze_source(job, inputs);
  if (job.gaze_in_frame.size() > 1 && job.gaze_in_frame.size() != inputs.frames.size()) {
    throw Error(ErrorKind::usage, "`gaze`",
                fmt::format("{} places of gaze for {} frames", job.gaze_in_frame.size(), inputs.frames.size()),
                "give one, or one a frame");
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
  if (reference.first_px != test.first_px) {
    differ(test_path,
           fmt::format("shows the picture plane from pixel {}, {} on, the reference from {}, {}", test.first_px[0],
                       test.first_px[1], reference.first_px[0], reference.first_px[1]),
           "write both with one display window");
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
  const auto& reference_run = inputs.reference_run;
  const std::string reference_view = reference_run ? reference_run->view : "";
  const std::string test_view = inputs.test_run ? inputs.test_run->view : "";
  if (!reference.is_linear && reference_view != test_view && !reference_view.empty() && !test_view.empty()) {
    differ(test_path, fmt::format("was shown through '{}', the reference through '{}'", test_view, reference_view),
           "render both with one view, or say `anyway`");
  }
  const bool automatic = reference_run && reference_run->settings().exposure.mode == ExposureMode::log_average;
  const auto& a = reference.facts.exposure_ev;
  const auto& b = test.facts.exposure_ev;
  constexpr double kSameEv = 1e-9;
  if (a && b && std::fabs(*a - *b) > kSameEv && !(reference.is_linear && (automatic || job.exposure_ev))) {
    differ(test_path, fmt::format("was exposed by {} stops, the reference by {} ({})", *b, *a, reference_path),
           "render both with one exposure, or say `anyway`");
  }
}

ColorSettings compare_color(const CompareJob& job, const CompareInputs& inputs) {
  const ColorSettings& given = job.shared.color;
  const bool any = !given.config.empty() || !given.display.empty() || !given.view.empty();
  return any || !inputs.reference_run ? given : inputs.reference_run->settings().color;
}

std::optional<PlanarView> compare_view(const CompareInputs& inputs, int width_px, int height_px) {
  if (!inputs.screen) {
    return std::nullopt;
  }
  return view_of_display(*inputs.screen, inputs.frame_rect, width_px, height_px);
}

}  // namespace gazetrace
