// SPDX-License-Identifier: Apache-2.0
#include "job/frame_size.hpp"

#include <fmt/format.h>

#include <cmath>
#include <optional>

#include "gazetrace/error.hpp"
#include "job/outputs.hpp"
#include "job/plan_settings.hpp"

namespace gazetrace {

void follow_screen_shape(const GazeLog* log, std::int64_t taken_off_ns, Job& job, Decisions& decisions) {
  JobSettings& settings = job.settings;
  const SizePx usual = JobSettings{}.size;
  const bool is_usual = settings.size.width == usual.width && settings.size.height == usual.height;
  if (job.sources.contains("size") || !is_usual || settings.frame_rect) {
    return;
  }
  Decisions unused;
  const std::optional<DisplayGeometry> screen = plan_settings(settings, {1}, log, taken_off_ns, unused).display;
  if (!screen || screen->width_px < 1 || screen->height_px < 1) {
    return;
  }
  const double height = std::round(static_cast<double>(usual.width) * screen->height_px / screen->width_px);
  if (height >= 1 && height != usual.height) {
    settings.size.height = static_cast<int>(height);
    decisions.emplace_back("size", fmt::format("{}x{}, which has the shape of the screen (`size` chooses another)",
                                               settings.size.width, settings.size.height));
  }
}

void check_frame_size(const JobSettings& job) {
  if (job.only_pixel && (job.only_pixel->x >= job.size.width || job.only_pixel->y >= job.size.height)) {
    throw Error(
        ErrorKind::usage, "`only-pixel`",
        fmt::format("{},{} lies outside {}x{}", job.only_pixel->x, job.only_pixel->y, job.size.width, job.size.height),
        "pixels count from 0 at the top left");
  }
  check_display_image_size(output_settings(job).display, job.size.width, job.size.height);
}

void check_frame_memory(const JobSettings& job) {
  constexpr double kLeastBytesOfAPixel = 40;
  const double bytes = kLeastBytesOfAPixel * job.size.width * job.size.height;
  if (const auto most = static_cast<double>(most_memory_bytes()); bytes > most) {
    throw Error(ErrorKind::usage, "`size`",
                fmt::format("a frame of {}x{} pixels takes more than {:.0f} GiB of memory, and there are {:.1f}",
                            job.size.width, job.size.height, bytes / 1073741824.0, most / 1073741824.0),
                "give a smaller one");
  }
  const AccumulateSettings window = accumulate_of(job);
  if (window.past_frames + window.future_frames == 0) {
    return;
  }
  // With the surfaces that filters work on, mostly one a pixel.
  constexpr double kBytesOfAPixelInAWindow = 250;
  const int frames = 1 + window.past_frames + window.future_frames;
  const double all = kBytesOfAPixelInAWindow * frames * job.size.width * job.size.height;
  const auto most = static_cast<double>(job.max_memory.bytes > 0 ? job.max_memory.bytes : most_memory_bytes());
  if (all > most) {
    throw Error(ErrorKind::usage, "`accumulate-past`",
                fmt::format("a window of {} frames takes about {:.2f} GiB of memory, and {:.2f} GiB is the most",
                            frames, all / 1073741824.0, most / 1073741824.0),
                "shorten it and `accumulate-future`, give a smaller `size`, or raise `max-memory`");
  }
}

}  // namespace gazetrace
