// SPDX-License-Identifier: Apache-2.0
// The parts of an inspection; each file in this folder holds one or two of them.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string_view>
#include <vector>

#include "gazelog/eyes.hpp"
#include "gazelog/screen_angles.hpp"
#include "gazetrace/gaze_inspect.hpp"
#include "gazetrace/gaze_log.hpp"
#include "gazetrace/gaze_raw.hpp"

namespace gazetrace {

// Gaze as two coordinates, positive to the right and up. They are degrees where the geometry is known or the log has
// directions, else pixels of the display, else fractions of the picture's width.
class GazePlane {
 public:
  GazePlane(const GazeLog& log, const std::optional<DisplayGeometry>& given);

  [[nodiscard]] const std::string& unit() const { return unit_; }
  // The speed of 30 deg/s in this unit; a guess where angles are unknown.
  [[nodiscard]] double units_per_degree() const { return units_per_degree_; }
  [[nodiscard]] Vec2d at(const Vec3d& place) const;  // (u, v, 0) or a direction
  [[nodiscard]] Vec2d of(const GazeSample& sample) const { return at(place_of(sample, kind_)); }

 private:
  GazeKind kind_;
  ScreenAngles screen_;
  double x_scale_ = 1, y_scale_ = 1;
  double units_per_degree_ = 1;
  std::string unit_ = "deg";
};

GazeLoss measure_loss(const GazeLog& log, double median_step_ns);
GazeFrozen measure_frozen(const GazeLog& log);
std::optional<GazePrecision> measure_precision(const GazeLog& log, const GazePlane& plane, double median_step_ns);
std::optional<GazeDisparity> measure_disparity(const GazeLog& log, const GazePlane& plane);
std::vector<VorTest> test_vor(const GazeLog& log);

void add_finding(GazeInspection& inspection, FindingKind kind, std::string code, std::string what, std::string evidence,
                 std::string setting = {});
// Whether there is a finding with one of these codes.
bool has_finding(const GazeInspection& inspection, std::initializer_list<std::string_view> codes);

// Of the stamps: their order, their unit, and when they were taken. `whole` as below.
void find_faults_of_time(const GazeLog& log, const GazeUnderInspection* whole, GazeInspection& inspection);

// Writes the directions of the axes, and the findings about them, into `inspection`. Returns whether the axes are
// exchanged, or could not be tested because `unit_is_wrong`.
bool examine_axes(const GazeLog& log, bool unit_is_wrong, GazeInspection& inspection);

// Fills axes, findings, verdict and settings from the rest of the inspection. `whole` is the log with the numbers of
// its file, or null.
void find_what_is_wrong(const GazeLog& log, const GazeUnderInspection* whole, const GazeInspectOptions& options,
                        GazeInspection& inspection);

// A place that gaze leaves and returns to by jumps alone, over and over, which no eye does.
struct RecurringPlace {
  Vec3d raw;             // in the file's unit; z only of vectors
  std::size_t rows = 0;  // the rows at this place that count as good
};

// The place with the most rows. Beside the display a few rows are enough; elsewhere it takes a hundredth of the rows.
std::optional<RecurringPlace> find_recurring_place(const RawGaze& raw, const Conventions& conventions);
// Trackers that lose one axis alone write their mark, a whole negative number, into that one: it, and in how many rows.
std::optional<RecurringPlace> find_mark_in_one_axis(const RawGaze& raw, const Conventions& conventions);

inline constexpr std::array kReportedValidities{GazeValidity::ok,         GazeValidity::low_confidence,
                                                GazeValidity::blink,      GazeValidity::lost,
                                                GazeValidity::off_screen, GazeValidity::interpolated};
inline constexpr std::array kReportedEvents{GazeEventType::fixation, GazeEventType::saccade, GazeEventType::blink,
                                            GazeEventType::message,  GazeEventType::segment, GazeEventType::trial,
                                            GazeEventType::aoi};

}  // namespace gazetrace
