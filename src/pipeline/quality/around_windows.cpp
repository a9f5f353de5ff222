// SPDX-License-Identifier: Apache-2.0
#include "pipeline/quality/around_windows.hpp"

#include <cstdint>
#include <utility>

#include "gazetrace/fovvideovdp.hpp"
#include "pipeline/quality/clip_score.hpp"
#include "pipeline/quality/discarded.hpp"
#include "pipeline/trace_counts.hpp"

namespace gazetrace {
namespace {

constexpr std::uint64_t kAroundTag = 0x41524f554e44ULL;  // "AROUND"
constexpr double kAroundSpp = 1;

}  // namespace

AroundWindows::AroundWindows(PathTracer& tracer, const JudgedFrames& judged, const JudgedWindows& windows,
                             const FrameSettings& settings, const ColorPipeline& color, TraceStats& stats)
    : judged_(judged), windows_(windows), settings_(settings), color_(color) {
  const FrameSettings around = raw(discarded(settings, kAroundTag), kAroundSpp, "guided");
  for (const std::vector<FrameRequest>& run : judged.runs) {
    if (!pictures_.empty() && !judged.view_moves) {
      break;
    }
    const FrameRequest& first = run.front();
    pictures_.emplace_back();
    if (windows.is_whole_frame()) {
      pictures_.back().radiance = ImageRgb(first.width_px, first.height_px);
      continue;
    }
    RenderedFrame rendered = FrameRenderer(tracer, around).render(first);
    add_traces(rendered.samples, stats);
    pictures_.back().radiance = std::move(rendered.frame.radiance);
  }
}

void AroundWindows::expose(const WindowPictures& reference) {
  for (std::size_t v = 0; v < reference.size(); ++v) {
    for (std::size_t w = 0; w < windows_.windows.size(); ++w) {
      paste(reference[v][w], windows_.windows[w].traced, pictures_[picture_of(v)].radiance);
    }
  }
  for (Picture& picture : pictures_) {
    picture.exposure_ev = choose_exposure_ev(picture.radiance, settings_.exposure);
    picture.shown = shown(picture.radiance, picture.exposure_ev);
  }
}

ImageGray AroundWindows::shown(const std::vector<ImageRgb>& windows, std::size_t index) const {
  const Picture& picture = pictures_[picture_of(index)];
  ImageGray luminance = picture.shown;
  std::vector<ImageGray> parts;
  for (std::size_t w = 0; w < windows.size(); ++w) {
    parts.push_back(shown(windows[w], picture.exposure_ev));
    paste(parts.back(), windows_.windows[w].traced, luminance);
  }
  // Where foveae overlap, what counts is never the margin of another.
  for (std::size_t w = 0; w < parts.size(); ++w) {
    const JudgedWindow& window = windows_.windows[w];
    const PixelRect inner{window.counted.x_px - window.traced.x_px, window.counted.y_px - window.traced.y_px,
                          window.counted.width_px, window.counted.height_px};
    paste(cut_out(parts[w], inner), window.counted, luminance);
  }
  return luminance;
}

ImageGray AroundWindows::shown(const ImageRgb& radiance, double exposure_ev) const {
  return display_luminance(shown_code(radiance, color_, exposure_ev, settings_.threads), {}, settings_.threads);
}

std::size_t AroundWindows::picture_of(std::size_t index) const {
  std::size_t run = 0;
  while (judged_.view_moves && index >= judged_.runs[run].size()) {
    index -= judged_.runs[run].size();
    ++run;
  }
  return run;
}

}  // namespace gazetrace
