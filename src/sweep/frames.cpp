// SPDX-License-Identifier: Apache-2.0
#include "sweep/frames.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/hash.hpp"

namespace gazetrace {
namespace {

constexpr double kWrongEnoughDeg = 2;

std::string event_of(const FrameRequest& request, bool is_still) {
  const GazeClass gaze_class = gaze_class_of(request.gaze_true);
  if (!request.gaze_direction_true || gaze_class == GazeClass::no_gaze) {
    return "none";
  }
  return gaze_class == GazeClass::unclassified && is_still ? "fixation" : std::string(to_string(gaze_class));
}

bool is_still(const FramePlan& plan) {
  const auto& first = plan.frames.front().gaze_direction_true;
  return std::all_of(plan.frames.begin(), plan.frames.end(),
                     [&](const FrameRequest& request) { return request.gaze_direction_true == first; });
}

// Radii of the region borders in pixels, measured along a row of pixels through the middle of the view.
std::vector<double> rings_of(const FoveationSettings& foveation, const PlanarView& view) {
  std::vector<double> rings;
  const RegionSampling* const regions = regions_of(foveation.sampling);
  if (regions != nullptr && view.step_x > 0) {
    for (const double eccentricity : regions->eccentricities_deg) {
      if (eccentricity < 90) {
        rings.push_back(std::tan(eccentricity * kRadPerDeg) / view.step_x);
      }
    }
  }
  return rings;
}

double angle_deg(const Vec3d& a, const Vec3d& b) {
  return std::atan2(length(cross(a, b)), dot(a, b)) * kDegPerRad;
}

void steer_by(const FrameRequest& from, FrameRequest& to) {
  to.gaze_render = from.gaze_render;
  to.gaze_direction_render = from.gaze_direction_render;
  to.eye_in_saccade = from.eye_in_saccade;
  to.saccade_since_last_frame = from.saccade_since_last_frame;
  to.blink_since_last_frame = from.blink_since_last_frame;
}

void steer_to(const Vec2d& pixel, FrameRequest& request) {
  const PlanarView& view = request.view;
  request.gaze_direction_render = view.direction(pixel.x, pixel.y);
  request.gaze_render.u = pixel.x / view.width_px;
  request.gaze_render.v = pixel.y / view.height_px;
  request.gaze_render.direction = normalize(*request.gaze_direction_render);
}

// Of frames that are not rendered: those that are read around others, and those that are judged.
std::vector<std::vector<FrameRequest>*> requests_beside(FramePlan& plan) {
  std::vector<std::vector<FrameRequest>*> all{&plan.around};
  for (std::vector<FrameRequest>& run : plan.judged.runs) {
    all.push_back(&run);
  }
  return all;
}

std::vector<std::vector<FrameRequest>*> all_requests(FramePlan& plan) {
  std::vector<std::vector<FrameRequest>*> all = requests_beside(plan);
  all.push_back(&plan.frames);
  return all;
}

FramePlan shuffled(const FramePlan& plan) {
  std::vector<std::size_t> order(plan.frames.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [](std::size_t a, std::size_t b) { return hash64(a) < hash64(b); });
  FramePlan result = plan;
  for (std::size_t i = 0; i < order.size(); ++i) {
    // Each frame takes the gaze of the next one in a cycle through all frames, so that none keeps its own.
    steer_by(plan.frames[order[(i + 1) % order.size()]], result.frames[order[i]]);
  }
  // The others have no place in the cycle.
  std::size_t next = 0;
  for (std::vector<FrameRequest>* requests : requests_beside(result)) {
    for (FrameRequest& request : *requests) {
      steer_by(plan.frames[order[next++ % order.size()]], request);
    }
  }
  return result;
}

}  // namespace

std::vector<ResultFrame> sweep_frames(const FramePlan& plan, const FoveationSettings& foveation, double leave_out_s) {
  std::vector<ResultFrame> frames;
  const bool still = is_still(plan);
  for (const FrameRequest& request : plan.frames) {
    ResultFrame frame;
    frame.index = request.frame;
    frame.t_s = static_cast<double>(request.t_video_ns) * 1e-9;
    frame.event = event_of(request, still);
    const auto into_clip_s = static_cast<double>(request.t_video_ns - plan.frames.front().t_video_ns) * 1e-9;
    if (into_clip_s < leave_out_s) {
      frame.event = "start";
    }
    if (request.gaze_direction_true && !request.gaze_true.no_gaze) {
      const Vec2d pixel = request.view.pixel(*request.gaze_direction_true);
      if (std::isfinite(pixel.x) && std::isfinite(pixel.y)) {
        frame.gaze_px = pixel;
      }
    }
    frame.rings_px = rings_of(foveation, request.view);
    frames.push_back(std::move(frame));
  }
  return frames;
}

std::vector<bool> scored_frames(const std::vector<ResultFrame>& frames) {
  const auto fixates = [](const ResultFrame& frame) { return frame.event == "fixation"; };
  const auto looks = [](const ResultFrame& frame) {
    return frame.gaze_px && frame.event != "start" && frame.event != "blink";
  };
  const bool any_fixates = std::any_of(frames.begin(), frames.end(), fixates);
  const bool any_looks = std::any_of(frames.begin(), frames.end(), looks);
  std::vector<bool> scored;
  for (const ResultFrame& frame : frames) {
    scored.push_back(any_fixates ? fixates(frame) : any_looks ? looks(frame) : frame.event != "start");
  }
  return scored;
}

std::map<std::string, double> event_shares(const std::vector<ResultFrame>& frames) {
  std::map<std::string, double> shares;
  double all = 0;
  for (const ResultFrame& frame : frames) {
    if (frame.event != "start") {
      shares[frame.event] += 1;
      all += 1;
    }
  }
  for (auto& [event, share] : shares) {
    share /= all;
  }
  return shares;
}

RasterSize scaled_size(const RasterSize& size, double scale) {
  constexpr int kFineEnough = 16;
  const int unit = std::gcd(size.width_px, size.height_px);
  if (unit >= kFineEnough) {
    const int steps = std::max(1, static_cast<int>(std::lround(scale * unit)));
    return {size.width_px / unit * steps, size.height_px / unit * steps};
  }
  return {std::max(1, static_cast<int>(std::lround(scale * size.width_px))),
          std::max(1, static_cast<int>(std::lround(scale * size.height_px)))};
}

FramePlan resized(const FramePlan& plan, const RasterSize& size) {
  FramePlan result = plan;
  for (std::vector<FrameRequest>* requests : all_requests(result)) {
    for (FrameRequest& request : *requests) {
      PlanarView& view = request.view;
      view.step_x *= static_cast<double>(view.width_px) / size.width_px;
      view.step_y *= static_cast<double>(view.height_px) / size.height_px;
      view.width_px = request.width_px = size.width_px;
      view.height_px = request.height_px = size.height_px;
    }
  }
  return result;
}

const std::vector<std::string>& wrong_gazes() {
  static const std::vector<std::string> kNames{"shuffled", "center", "mirrored"};
  return kNames;
}

std::optional<FramePlan> with_wrong_gaze(const FramePlan& plan, const std::string& wrong) {
  FramePlan result = plan;
  if (wrong == "shuffled") {
    result = shuffled(result);
  } else if (wrong == "center" || wrong == "mirrored") {
    for (std::vector<FrameRequest>* requests : all_requests(result)) {
      for (FrameRequest& request : *requests) {
        if (request.gaze_direction_render) {
          const Vec2d middle{request.view.width_px / 2.0, request.view.height_px / 2.0};
          const Vec2d at = request.view.pixel(*request.gaze_direction_render);
          steer_to(wrong == "center" ? middle : Vec2d{2 * middle.x - at.x, 2 * middle.y - at.y}, request);
        }
      }
    }
  } else {
    return std::nullopt;
  }
  double off_deg = 0;
  std::size_t count = 0;
  for (std::size_t i = 0; i < plan.frames.size(); ++i) {
    const auto& right = plan.frames[i].gaze_direction_render;
    const auto& other = result.frames[i].gaze_direction_render;
    if (right && other && is_finite(*other)) {
      off_deg += angle_deg(*right, *other);
      ++count;
    } else if (other && !is_finite(*other)) {
      return std::nullopt;
    }
  }
  if (count == 0 || off_deg / static_cast<double>(count) < kWrongEnoughDeg) {
    return std::nullopt;
  }
  return result;
}

}  // namespace gazetrace
