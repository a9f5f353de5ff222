// SPDX-License-Identifier: Apache-2.0
#include "cli/demo_measurement.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <vector>

#include "cli/progress.hpp"

namespace gazetrace {
namespace {

namespace fs = std::filesystem;

std::vector<std::int32_t> frame_numbers(const Job& job, const std::string& frames) {
  if (!frames.empty()) {
    return parse_frame_list(frames);
  }
  const bool are_named = job.settings.frames && !job.settings.frames->frames.empty();
  return are_named ? job.settings.frames->frames : std::vector<std::int32_t>{1};
}

constexpr int kMeasuredWidthPx = 320;
constexpr double kMeasuredFrames = 4;
constexpr double kMeasuredSpp = 250;  // of reference, settings, baselines and repeats, about
// The time of the shipped measurement over that of the example's frame by itself, as measured on two cores.
constexpr double kShippedFrames = 80;

// One option with its value as a line of TOML, without the help; files by their whole names.
std::string option_line(const Job& job, const Option& option) {
  std::vector<std::string> values = option_values(job, option.name);
  std::error_code ignored;
  for (std::string& value : values) {
    value = fs::is_regular_file(value, ignored) ? fs::absolute(value).lexically_normal().string() : value;
  }
  const std::string text = settings_as_toml(
      {&option}, [&](const Option&) { return values; }, "");
  const std::size_t line = text.rfind("\n" + option.name + " = ");
  return line == std::string::npos ? std::string() : text.substr(line + 1);
}

}  // namespace

std::int32_t middle_frame(const Job& job, const std::string& frames) {
  const std::vector<std::int32_t> numbers = frame_numbers(job, frames);
  return numbers[numbers.size() / 2];
}

double own_sweep_s(const Job& job, const FirstFrame& first) {
  const double smaller = std::min(1.0, static_cast<double>(kMeasuredWidthPx) / job.settings.size.width);
  return kMeasuredFrames * smaller * smaller * kMeasuredSpp / std::max(first.spp, 0.1) * first.seconds;
}

double shipped_sweep_s(const FirstFrame& first) {
  return kShippedFrames * first.seconds;
}

std::string estimate_text(const Job& job, const std::string& frames, const FirstFrame& first, double sweep_s) {
  constexpr double kJoining = 1.3;  // a window's frames are joined, and some lie outside of the range
  const double sequences_s = 2 * static_cast<double>(frame_numbers(job, frames).size()) * first.seconds * kJoining;
  return fmt::format("\nThis frame took {} with {:.2f} samples a pixel, so that all will take about {}{}.\n",
                     duration_text(first.seconds), first.spp, duration_text(sequences_s + sweep_s),
                     job.settings.frames || !frames.empty() ? "" : " for each frame");
}

std::string measurement_of(const Job& job, const std::string& middle) {
  std::string common;
  std::string scene = "name = \"scene\"\n";
  std::string gaze = "name = \"gaze\"\n";
  for (const Option* option : job_schema().list()) {
    const bool is_replaced = option->name == "size" || option->name == "frames" || option->name == "spp" ||
                             option->name == "seed" || option->name == "chunk";
    if (!job.is_given(option->name) || is_replaced || option->is(Trait::one_run)) {
      continue;
    }
    std::string& table = option->is(Trait::gaze_source)                                           ? gaze
                         : option->touches.has(Touch::scene) || option->touches.has(Touch::light) ? scene
                                                                                                  : common;
    table += option_line(job, *option);
  }
  const SizePx& size = job.settings.size;
  const int width = std::min(size.width, kMeasuredWidthPx);
  const int frame = std::stoi(middle);
  return fmt::format(
      "# Written by gazetrace demo: foveated beside uniform sampling of the same cost.\n"
      "title = \"My scene, my gaze: sampled where the eye looked, and everywhere\"\n\n[common]\nsize = \"{}x{}\"\n"
      "frames = \"{}-{}\"\n{}\n[[scene]]\n{}\n[[gaze]]\n{}\n[grid]\nspp = [1, 2]\n\n[reference]\nspp = 128\ngo-on = "
      "true\n\n"
      "[measure]\nrepeats = 3\nmetrics = [\"fovvideovdp\", \"relmse\"]\n",
      width, std::max(1, size.height * width / size.width), frame, frame + static_cast<int>(kMeasuredFrames) - 1,
      common, scene, gaze);
}

}  // namespace gazetrace
