// SPDX-License-Identifier: Apache-2.0
// What the numbers of a log mean: what the user says wins over what the log says, and what nobody says is guessed.
#include <fmt/format.h>

#include <array>
#include <cmath>

#include "core/statistics.hpp"
#include "gazelog/judge.hpp"
#include "gazelog/row_samples.hpp"

namespace gazetrace {
namespace {

void refuse_scene_camera(const RawGaze& raw, const GazeReadOptions& options) {
  if (raw.kind == GazeKind::scene_camera && options.frame == GazeFrame::automatic) {
    throw Error(ErrorKind::input, raw.source,
                "holds gaze on the picture of a scene camera, which moves with the head: it is no place on a display",
                raw.way_out);
  }
}

// x and y as the file has them, but for marks of missing values: a unit is guessed before anything else is known.
RawRows rows_for_a_guess(const RawGaze& raw, const Conventions& c) {
  Conventions plain;
  plain.missing_value = c.missing_value;
  plain.corner = c.corner;
  return measurable_rows(raw, plain);
}

// What is known of the display or of the scene camera's picture, before anything is converted.
DisplayGeometry known_display(const RawGaze& raw, const GazeReadOptions& options) {
  DisplayGeometry display = completed_geometry(options.display.value_or(DisplayGeometry{}),
                                               raw.recording_geometry.value_or(DisplayGeometry{}));
  display = completed_geometry(display, options.fallback_display.value_or(DisplayGeometry{}));
  if (raw.picture_px) {
    display.width_px = static_cast<int>(raw.picture_px->x);
    display.height_px = static_cast<int>(raw.picture_px->y);
  }
  return display;
}

void conclude_unit(const RawGaze& raw, const GazeReadOptions& options, Conventions& c) {
  const PositionUnit given = options.columns.position_unit;
  if (c.unit.value == PositionUnit::automatic && given == PositionUnit::automatic) {
    UnitReading reading = read_unit(rows_for_a_guess(raw, c), raw, known_display(raw, options));
    c.unit = {reading.unit, Evidence::statistics, reading.evidence};
    if (reading.doubt && (reading.doubt->is_open || !(options.accepts_inferred || options.guess_display))) {
      c.doubts.push_back(*std::move(reading.doubt));
    }
  }
  if (given != PositionUnit::automatic && given != c.unit.value) {
    if (c.unit.value != PositionUnit::automatic) {
      c.warnings.push_back(fmt::format("{}: positions of {} are in {}; `unit` {} was given and is used", raw.place,
                                       raw.format, to_string(c.unit.value), to_string(given)));
    }
    c.unit = {given, Evidence::option, {}};
    c.origin.value = given == PositionUnit::deg || given == PositionUnit::rad ? PositionOrigin::center : c.origin.value;
  }
  if (c.unit.value == PositionUnit::rad) {
    c.unit.value = PositionUnit::deg;
    c.unit.detail = "radians";
    c.unit_scale *= kDegPerRad;
  }
}

void conclude_origin(const RawGaze& raw, const GazeReadOptions& options, Conventions& c) {
  const PositionOrigin given = options.columns.origin;
  if (c.unit.value == PositionUnit::norm || c.unit.value == PositionUnit::height) {
    c.origin = {PositionOrigin::center, c.unit.evidence, "of PsychoPy's units"};
    return;
  }
  if (given != PositionOrigin::automatic && given != c.origin.value) {
    if (c.origin.value != PositionOrigin::automatic) {
      c.warnings.push_back(fmt::format("{}: positions of {} count from the {}; `origin` {} was given and is used",
                                       raw.place, raw.format, to_string(c.origin.value), to_string(given)));
    }
    c.origin = {given, Evidence::option, {}};
  }
  if (c.origin.value == PositionOrigin::automatic) {
    const bool is_deg = c.unit.value == PositionUnit::deg;
    c.origin = {is_deg ? PositionOrigin::center : PositionOrigin::top_left, Evidence::statistics,
                is_deg ? "degrees count from straight ahead" : "as usual; no data tell it from the bottom left"};
  }
}

// The smallest usual display that holds nearly all places: good enough to look at a log, never to render from one.
void guess_display(const RawGaze& raw, Conventions& c) {
  using Size = std::array<int, 2>;
  static constexpr std::array kUsual{Size{640, 480},   Size{800, 600},   Size{1024, 768},  Size{1280, 720},
                                     Size{1280, 1024}, Size{1600, 900},  Size{1680, 1050}, Size{1920, 1080},
                                     Size{1920, 1200}, Size{2560, 1440}, Size{3840, 2160}, Size{7680, 4320}};
  std::size_t usable = 0;
  std::array<std::size_t, kUsual.size()> inside{};
  for (const RawSample row : measurable_rows(raw, c)) {
    if (!is_usable(row.validity)) {
      continue;
    }
    ++usable;
    for (std::size_t i = 0; i < kUsual.size(); ++i) {
      inside[i] += row.at.x <= kUsual[i][0] && row.at.y <= kUsual[i][1] ? 1 : 0;
    }
  }
  std::size_t best = 0;
  while (best + 1 < kUsual.size() && inside[best] * 100 < usable * 98) {
    ++best;
  }
  DisplayGeometry display = c.display ? c.display->value : DisplayGeometry{};
  display.width_px = kUsual[best][0];
  display.height_px = kUsual[best][1];
  c.display = {display, Evidence::statistics, "the smallest usual display that holds 98 % of the positions"};
}

void conclude_display(const RawGaze& raw, const GazeReadOptions& options, Conventions& c) {
  c.display = conversion_display(raw, options, c);
  const bool sized = c.display && c.display->value.width_px > 0 && c.display->value.height_px > 0;
  if (c.unit.value == PositionUnit::px && !sized && options.guess_display) {
    guess_display(raw, c);
  }
}

void conclude_axes(const RawGaze& raw, const GazeReadOptions& options, Conventions& c) {
  const GazeAxes given = options.columns.axes;
  const GazeAxes own = c.axes.value;
  if (given != GazeAxes::automatic && given != own) {
    if (own != GazeAxes::automatic) {
      c.warnings.push_back(fmt::format("{}: directions of this log are in {} axes; `axes` {} was given and is used",
                                       raw.place, to_string(own), to_string(given)));
    }
    c.axes = {given, Evidence::option, {}};
  }
  if (c.axes.value == GazeAxes::automatic) {
    c.axes.value = GazeAxes::gl;
  }
}

// The left eye lies left of the right one: where the log's origins say otherwise, its x axis is the other way round, as
// in logs whose maker had already turned the vectors.
void conclude_handedness(const RawGaze& raw, const GazeReadOptions& options, Conventions& c) {
  if (!c.x_is_turned || options.columns.axes != GazeAxes::automatic) {
    c.x_is_turned.reset();
    return;
  }
  std::vector<float> differences;
  for (const EyeOrigins& origins : raw.origins) {
    const auto x_of = [&](const Vec3f& origin) { return to_float(from_axes(to_double(origin), c.axes.value)).x; };
    const float difference = x_of(origins.left_mm) - x_of(origins.right_mm);
    if (std::isfinite(difference) && difference != 0) {
      differences.push_back(difference);
    }
  }
  if (differences.empty()) {
    c.x_is_turned.reset();
    return;
  }
  const float median = upper_median(differences);
  c.x_is_turned = {!(median < 0), Evidence::statistics,
                   fmt::format("the left eye lies {:.0f} mm to the {} of the right one in these axes", std::abs(median),
                               median < 0 ? "left" : "right")};
}

}  // namespace

Conventions conclude_conventions(const RawGaze& raw, const GazeReadOptions& options) {
  refuse_scene_camera(raw, options);
  Conventions c = raw.declared;
  c.swap_xy = options.swap_xy;
  c.flip_x = options.flip_x;
  c.flip_y = options.flip_y;
  c.zero_is_missing = options.missing_value == 0.0;  // besides the mark of the format
  c.missing_value = options.missing_value && !(c.zero_is_missing && raw.declared.missing_value)
                        ? options.missing_value
                        : raw.declared.missing_value;
  c.corner = options.corner.value_or(raw.declared.corner);
  c.unordered = options.unordered;
  c.eye = options.eye;
  c.recording_geometry = raw.recording_geometry;
  if (c.form != PlaceForm::position) {
    conclude_axes(raw, options, c);
    conclude_handedness(raw, options, c);
    c.doubts = judge_reading(raw, c, {});
    return c;
  }
  conclude_unit(raw, options, c);
  conclude_origin(raw, options, c);
  const bool no_display = !options.display && !raw.recording_geometry && !raw.picture_px;
  c.degrees_are_directions =
      c.unit.value == PositionUnit::deg &&
      (c.degrees_are_directions || options.frame == GazeFrame::head || (options.guess_display && no_display));
  if (!c.degrees_are_directions) {
    conclude_display(raw, options, c);
  }
  DisplayGeometry display = known_display(raw, options);
  display = completed_geometry(display, c.display ? c.display->value : DisplayGeometry{});
  for (ReadingDoubt& doubt : judge_reading(raw, c, display)) {
    c.doubts.push_back(std::move(doubt));
  }
  if (are_other_numbers_meant(raw)) {
    c.doubts.clear();
  }
  return c;
}

}  // namespace gazetrace
