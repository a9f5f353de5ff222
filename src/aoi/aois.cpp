// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <utility>

#include "core/nan.hpp"
#include "gazelog/screen_angles.hpp"
#include "gazetrace/gaze_aois.hpp"
#include "gazetrace/gaze_event_durations.hpp"
#include "gazetrace/gaze_trials.hpp"

namespace gazetrace {
namespace {

constexpr int kConePlaces = 512;

double milliseconds(std::int64_t duration_ns) {
  return static_cast<double>(duration_ns) * 1e-6;
}

// Shares are of whole names, so a pattern without * or ? must be the name.
bool is_object(const Aoi& area, const SceneObject& object) {
  const auto fits = [](const std::string& name, const std::string& pattern) {
    return pattern.empty() ||
           (pattern.find_first_of("*?") == std::string::npos ? name == pattern : fits_pattern(name, pattern));
  };
  return area.shape == AoiShape::object && fits(object.node, area.node) && fits(object.material, area.material);
}

// Finds the AOI of a fixation.
class AoiFinder {
 public:
  AoiFinder(const GazeLog& log, const std::vector<Aoi>& areas, const std::optional<GazeUncertainty>& uncertainty,
            const GazeObjects* objects)
      : areas_(areas), uncertainty_(uncertainty), objects_(objects), screen_(log), step_ns_(event_step_ns(log)) {}

  [[nodiscard]] AoiFixation find(const EyeEvent& event) const {
    AoiFixation fixation{event, event_duration_ns(event, step_ns_), std::nullopt, kNan};
    for (std::size_t i = 0; i < areas_.size(); ++i) {
      if (contains(areas_[i], {event.u, event.v})) {
        fixation.aoi = i;
        fixation.share = share_of(areas_[i], event);
        return fixation;
      }
    }
    if (objects_ != nullptr) {
      find_object(fixation);
    }
    return fixation;
  }

 private:
  [[nodiscard]] double share_of(const Aoi& area, const EyeEvent& event) const {
    if (!uncertainty_ || !screen_.known()) {
      return kNan;
    }
    int inside = 0;
    for (const Vec3d& direction : gaze_cone(event.direction, *uncertainty_, kConePlaces)) {
      inside += contains(area, screen_.place(direction)) ? 1 : 0;
    }
    return static_cast<double>(inside) / kConePlaces;
  }

  // By the frames within the fixation; where it is shorter than a frame, by the nearest one.
  void find_object(AoiFixation& fixation) const {
    std::vector<double> shares(areas_.size() + 1, 0.0);
    double frames = 0;
    const std::int64_t begin_ns = fixation.event.begin_ns;
    const std::int64_t end_ns = fixation.event.end_ns;
    const auto add = [&](const FrameObjects& frame) {
      if (frame.shares.empty()) {
        return;
      }
      ++frames;
      for (const ObjectShare& share : frame.shares) {
        shares[area_of(objects_->objects[share.object])] += share.share;
      }
    };
    const auto first = std::lower_bound(objects_->frames.begin(), objects_->frames.end(), begin_ns,
                                        [](const FrameObjects& f, std::int64_t t) { return f.t_log_ns < t; });
    auto frame = first;
    for (; frame != objects_->frames.end() && frame->t_log_ns <= end_ns; ++frame) {
      add(*frame);
    }
    if (frame == first) {
      // The frame before or after, if it is no farther from the middle than the fixation is long.
      const std::int64_t middle_ns = begin_ns + (end_ns - begin_ns) / 2;
      const auto distance_ns = [&](const FrameObjects& f) { return std::abs(f.t_log_ns - middle_ns); };
      if (first != objects_->frames.begin() &&
          (frame == objects_->frames.end() || distance_ns(*std::prev(first)) < distance_ns(*frame))) {
        frame = std::prev(first);
      }
      if (frame != objects_->frames.end() && distance_ns(*frame) <= end_ns - begin_ns) {
        add(*frame);
      }
    }
    if (frames == 0) {
      return;
    }
    const auto best = std::max_element(shares.begin(), std::prev(shares.end()));
    fixation.share = *best / frames;
    if (fixation.share > 0.5) {
      fixation.aoi = static_cast<std::size_t>(best - shares.begin());
    } else {
      fixation.share = kNan;
    }
  }

  [[nodiscard]] std::size_t area_of(const SceneObject& object) const {
    const auto found =
        std::find_if(areas_.begin(), areas_.end(), [&](const Aoi& area) { return is_object(area, object); });
    return object.node.empty() ? areas_.size() : static_cast<std::size_t>(found - areas_.begin());
  }

  const std::vector<Aoi>& areas_;
  const std::optional<GazeUncertainty>& uncertainty_;
  const GazeObjects* objects_;
  ScreenAngles screen_;
  std::int64_t step_ns_;
};

void count_visits(const GazeLog& log, AoiAnalysis& analysis) {
  const std::size_t none = analysis.areas.size();
  const std::int64_t begin_ns = log.trial ? log.trial->begin_ns : log.samples.front().t_ns;
  analysis.figures.assign(none + 1, AoiFigures{0, 0, 0, 0, kNan, kNan});
  analysis.transitions.assign(none + 1, std::vector<std::size_t>(none + 1, 0));
  std::optional<std::size_t> before;
  std::int64_t visit_begin_ns = 0;
  std::int64_t visit_end_ns = 0;
  const auto end_visit = [&] {
    if (before) {
      analysis.figures[*before].dwell_ms += milliseconds(visit_end_ns - visit_begin_ns);
    }
  };
  for (const AoiFixation& fixation : analysis.fixations) {
    const std::size_t area = fixation.aoi.value_or(none);
    const double duration_ms = milliseconds(fixation.duration_ns);
    AoiFigures& figures = analysis.figures[area];
    if (figures.fixations++ == 0) {
      figures.first_fixation_at_ms = milliseconds(fixation.event.begin_ns - begin_ns);
      figures.first_fixation_ms = duration_ms;
    }
    figures.fixation_ms += duration_ms;
    analysis.fixation_ms += duration_ms;
    if (before != area) {
      end_visit();
      if (before) {
        ++analysis.transitions[*before][area];
      }
      ++figures.visits;
      visit_begin_ns = fixation.event.begin_ns;
      before = area;
    }
    visit_end_ns = fixation.event.begin_ns + fixation.duration_ns;
  }
  end_visit();
}

}  // namespace

bool contains(const Aoi& aoi, const Vec2d& place) {
  const std::vector<Vec2d>& p = aoi.points;
  switch (aoi.shape) {
    case AoiShape::rectangle:
      return place.x >= p[0].x && place.x <= p[1].x && place.y >= p[0].y && place.y <= p[1].y;
    case AoiShape::ellipse: {
      const double x = (place.x - p[0].x) / p[1].x;
      const double y = (place.y - p[0].y) / p[1].y;
      return x * x + y * y <= 1;
    }
    case AoiShape::polygon: {
      bool inside = false;
      for (std::size_t i = 0, j = p.size() - 1; i < p.size(); j = i++) {
        const double side = (p[j].x - p[i].x) * (place.y - p[i].y) - (p[j].y - p[i].y) * (place.x - p[i].x);
        const bool between = place.x >= std::min(p[i].x, p[j].x) && place.x <= std::max(p[i].x, p[j].x) &&
                             place.y >= std::min(p[i].y, p[j].y) && place.y <= std::max(p[i].y, p[j].y);
        if (side == 0 && between) {
          return true;
        }
        // Edges that a ray to the right crosses; a corner counts for the lower of its two edges alone.
        if ((p[i].y > place.y) != (p[j].y > place.y) && (side > 0) == (p[j].y > p[i].y)) {
          inside = !inside;
        }
      }
      return inside;
    }
    case AoiShape::object:
      return false;
  }
  return false;
}

AoiAnalysis analyse_aois(const GazeLog& log, const EyeEvents& events, std::vector<Aoi> areas,
                         const std::optional<GazeUncertainty>& uncertainty, const GazeObjects* objects) {
  for (const Aoi& area : areas) {
    if (area.shape == AoiShape::object && objects == nullptr) {
      throw Error(ErrorKind::usage, "", "area '" + area.name + "' is an object of a scene", "give the scene");
    }
    if (area.shape != AoiShape::object && log.kind != GazeKind::screen) {
      throw Error(ErrorKind::input, log.source,
                  "holds directions, and area '" + area.name + "' is a shape on a display",
                  "use areas that are objects of the scene, by node or material");
    }
  }
  AoiAnalysis analysis;
  analysis.areas = std::move(areas);
  const AoiFinder finder(log, analysis.areas, uncertainty, objects);
  for (const EyeEvent& event : events.events) {
    if (event.movement == EyeMovement::fixation) {
      analysis.fixations.push_back(finder.find(event));
    }
  }
  count_visits(log, analysis);
  return analysis;
}

}  // namespace gazetrace
