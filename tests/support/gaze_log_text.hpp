// SPDX-License-Identifier: Apache-2.0
// A whole gaze log in words, to compare two of them by. Each structure is taken apart in all its members, so that a new
// member does not compile until it is compared, too.
#pragma once

#include <fmt/format.h>

#include <array>
#include <optional>
#include <string>
#include <type_traits>
#include <vector>

#include "gazetrace/gaze_log.hpp"

namespace gazetrace {

class GazeLogText {
 public:
  explicit GazeLogText(const GazeLog& log) {
    const auto& [kind, source, format, format_confidence, clock, pupil_unit, geometry, pixels_per_degree, rate_hz,
                 age_unknown, origins, head, events, calibrations, stated_eye, device, witnesses, recordings, recording,
                 warnings] = static_cast<const GazeRecord&>(log);
    put(kind, source, format, format_confidence, clock, pupil_unit, geometry, pixels_per_degree, rate_hz, age_unknown,
        origins, head, events, calibrations, stated_eye, device, witnesses, recordings, recording, warnings);
    // What a log has besides cannot be taken apart, since it has a base: its size shows a new member.
    static_assert(sizeof(GazeLog) == sizeof(GazeRecord) + sizeof(log.samples) + sizeof(log.eyes) + sizeof(log.facts) +
                                         sizeof(log.conventions) + sizeof(log.order) + sizeof(log.trial));
    put(log.samples, log.eyes, log.conventions, log.facts, log.order, log.trial);
  }
  [[nodiscard]] const std::string& text() const { return text_; }

 private:
  template <class... Members>
  void put(const Members&... members) {
    (one(members), ...);
    text_ += '\n';
  }

  template <class Value>
  std::enable_if_t<std::is_arithmetic_v<Value>> one(const Value& value) {
    text_ += fmt::format("{} ", value);  // numbers with all their digits
  }
  template <class Value>
  std::enable_if_t<std::is_enum_v<Value>> one(const Value& value) {
    one(static_cast<int>(value));
  }
  void one(const std::string& value) { text_ += "'" + value + "' "; }
  template <class Value>
  void one(const std::vector<Value>& values) {
    text_ += fmt::format("[{}] ", values.size());
    for (const Value& value : values) {
      one(value);
    }
  }
  template <class Value, std::size_t size>
  void one(const std::array<Value, size>& values) {
    for (const Value& value : values) {
      one(value);
    }
  }
  template <class Value>
  void one(const std::optional<Value>& value) {
    text_ += value ? "is " : "none ";
    if (value) {
      one(*value);
    }
  }
  template <class Value>
  void one(const Concluded<Value>& concluded) {
    const auto& [value, evidence, detail] = concluded;
    put(value, evidence, detail);
  }
  template <class Number>
  void one(const Vec2<Number>& v) {
    put(v.x, v.y);
  }
  template <class Number>
  void one(const Vec3<Number>& v) {
    put(v.x, v.y, v.z);
  }
  void one(const Quatd& q) { put(q.x, q.y, q.z, q.w); }
  void one(const DisplayGeometry& geometry) {
    const auto& [width_px, height_px, width_cm, height_cm, distance_cm, eye_x_cm, eye_y_cm, luminance] = geometry;
    put(width_px, height_px, width_cm, height_cm, distance_cm, eye_x_cm, eye_y_cm, luminance);
  }
  void one(const GazeSample& sample) {
    const auto& [t_ns, u, v, direction, validity, eye, confidence, pupil, row] = sample;
    put(t_ns, u, v, direction, validity, eye, confidence, pupil, row);
  }
  void one(const EyeGaze& eye) {
    const auto& [at, confidence, pupil, validity] = eye;
    put(at, confidence, pupil, validity);
  }
  void one(const BothEyes& eyes) {
    const auto& [left, right] = eyes;
    put(left, right);
  }
  void one(const EyeOrigins& origins) {
    const auto& [left_mm, right_mm, t_ns] = origins;
    put(left_mm, right_mm, t_ns);
  }
  void one(const HeadPose& pose) {
    const auto& [t_ns, position_m, orientation] = pose;
    put(t_ns, position_m, orientation);
  }
  void one(const GazeEvent& event) {
    const auto& [type, eye, begin_ns, end_ns, words, row, duration_ns, amplitude_deg, peak_velocity_deg_s] = event;
    put(type, eye, begin_ns, end_ns, words, row, duration_ns, amplitude_deg, peak_velocity_deg_s);
  }
  void one(const GazeTrial& trial) {
    const auto& [number, name, begin_ns, end_ns, block] = trial;
    put(number, name, begin_ns, end_ns, block);
  }
  void one(const GazeRecording& recording) {
    const auto& [name, is_block, rows, first_row, first_ns, last_ns] = recording;
    put(name, is_block, rows, first_row, first_ns, last_ns);
  }
  void one(const GazeCalibration& calibration) {
    const auto& [t_ns, eye, mean_error_deg, max_error_deg, row] = calibration;
    put(t_ns, eye, mean_error_deg, max_error_deg, row);
  }
  void one(const GazeFact& fact) {
    const auto& [what, value, evidence, detail] = fact;
    put(what, value, evidence, detail);
  }
  void one(const GazeOrder& order) {
    const auto& [rows, backward_steps, longest_backward_ns, first_backward_row, row_before, first_backward_ns,
                 before_ns, duplicates, identical_duplicates, first_duplicate_row, row_repeated, first_duplicate_ns] =
        order;
    put(rows, backward_steps, longest_backward_ns, first_backward_row, row_before, first_backward_ns, before_ns,
        duplicates, identical_duplicates, first_duplicate_row, row_repeated, first_duplicate_ns);
  }
  void one(const GazeWitness& witness) {
    const auto& [what, count, xx, yy, xy, yx, eye] = witness;
    put(what, count, xx, yy, xy, yx, eye);
  }
  void one(const SceneLens& lens) {
    const auto& [fx, fy, cx, cy, k] = lens;
    put(fx, fy, cx, cy, k);
  }
  void one(const Conventions::Taken& taken) {
    const auto& [eye, is_alone] = taken;
    put(eye, is_alone);
  }
  void one(const Conventions& conventions) {
    const auto& [time_column, time_exponent, form, position_columns, unit, unit_scale, origin, corner, are_directions,
                 off_screen_is_told, lens, axes, x_is_turned, swap_xy, flip_x, flip_y, missing_value, zero_is_missing,
                 display, geometry, unordered, eye, eye_taken, warnings, doubts] = conventions;
    put(time_column, time_exponent, form, position_columns, unit, unit_scale, origin, corner, are_directions,
        off_screen_is_told, lens, axes, x_is_turned, swap_xy, flip_x, flip_y, missing_value, zero_is_missing, display,
        geometry, unordered, eye, eye_taken, warnings, doubts);
  }
  void one(const ReadingDoubt& doubt) {
    const auto& [code, what, evidence, setting, is_open, refuses] = doubt;
    put(code, what, evidence, setting, is_open, refuses);
  }

  std::string text_;
};

inline std::string everything_of(const GazeLog& log) {
  return GazeLogText(log).text();
}

}  // namespace gazetrace
