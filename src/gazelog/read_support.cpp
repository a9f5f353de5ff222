// SPDX-License-Identifier: Apache-2.0
#include "gazelog/read_support.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <utility>

#include "core/text.hpp"
#include "gazelog/row_samples.hpp"
#include "gazelog/units.hpp"

namespace gazetrace {

RawGaze raw_of(const GazeFile& file, std::string clock, std::string pupil_unit) {
  RawGaze raw;
  raw.source = file.path;
  raw.clock = std::move(clock);
  raw.pupil_unit = std::move(pupil_unit);
  return raw;
}

void add_note(RawGaze& raw, std::string what, std::string value, Evidence evidence, std::string detail) {
  raw.notes.push_back({std::move(what), std::move(value), evidence, std::move(detail)});
}

void state_display_px(RawGaze& raw, double width, double height, Evidence evidence, std::string detail) {
  if (!(width >= 1 && height >= 1 && width < 1e5 && height < 1e5)) {
    return;
  }
  DisplayGeometry g = raw.recording_geometry.value_or(DisplayGeometry{});
  g.width_px = static_cast<int>(std::lround(width));
  g.height_px = static_cast<int>(std::lround(height));
  raw.recording_geometry = g;
  add_note(raw, "display size", fmt::format("{}x{} px", g.width_px, g.height_px), evidence, std::move(detail));
}

void guess_picture_size(RawGaze& raw) {
  double widest = 0;
  for (const RawSample sample : raw.rows) {
    widest = sample.at.x > widest && sample.at.x < 1600 ? sample.at.x : widest;
  }
  raw.picture_px = widest > 1100 ? Vec2d{1600, 1200} : Vec2d{1088, 1080};
  add_note(raw, "picture size", fmt::format("{}x{} px", raw.picture_px->x, raw.picture_px->y), Evidence::statistics,
           fmt::format("places reach {:.0f} px", widest));
}

std::vector<double> first_stamps(const GazeFile& file, const DelimitedTable& table, std::size_t column,
                                 bool is_checked) {
  constexpr std::size_t kEnough = 2000;
  std::vector<double> stamps;
  TableRows rows(file, table, column + 1);
  while (stamps.size() < kEnough && rows.next()) {
    const std::string_view text = rows.cell(column);
    if (const auto value = number_from(text)) {
      stamps.push_back(*value);
    } else if (is_checked && stamps.empty() && !is_missing(text)) {
      rows.time_ns(column, {});  // says what it is
    }
  }
  return stamps;
}

TimeScale declare_time(RawGaze& raw, const GazeReadOptions& options, std::string_view column, int stated,
                       Evidence evidence, const std::string& place) {
  const auto given = time_exponent_of(options.columns.time_unit);
  if (given && *given != stated) {
    raw.warnings.push_back(fmt::format("{}: {} says that '{}' is in {}; `time-unit` {} was given and is used", place,
                                       evidence == Evidence::header ? "the header" : "the format", column,
                                       time_unit_text(stated), time_unit_text(*given)));
  }
  raw.declared.time_column = {
      std::string(column), options.columns.time.empty() ? Evidence::header : Evidence::option, {}};
  raw.declared.time_exponent = {given.value_or(stated), given ? Evidence::option : evidence, {}};
  return {raw.declared.time_exponent.value, 0};
}

double least_confidence(const GazeReadOptions& options, double own) {
  return std::isnan(options.min_confidence) ? own : options.min_confidence;
}

void declare_places(RawGaze& raw, const PlaceSpace& space, const std::string& place) {
  Conventions& c = raw.declared;
  c.form = PlaceForm::position;
  c.position_columns = {space.columns, Evidence::header, {}};
  c.unit = {space.unit, space.evidence, {}};
  c.origin = {space.origin, space.origin_evidence.value_or(space.evidence), {}};
  c.off_screen_is_told = space.validity_is_final;
  raw.place = place;
}

void declare_directions(RawGaze& raw, Concluded<std::string> columns, GazeAxes axes, Evidence evidence,
                        const std::string& place) {
  Conventions& c = raw.declared;
  c.form = PlaceForm::vector;
  c.position_columns = std::move(columns);
  c.unit = {PositionUnit::unit_vector, evidence, {}};
  c.axes = {axes, evidence, {}};
  raw.kind = GazeKind::direction;
  raw.place = place;
}

void add_message(RawGaze& raw, std::int64_t t_ns, std::string text, std::int64_t row) {
  raw.events.push_back({GazeEventType::message, Eye::cyclopean, t_ns, t_ns, std::move(text), row});
}

void WitnessTally::add(double x, double y, double witness_x, double witness_y) {
  const std::array<double, 4> value{x, y, witness_x, witness_y};
  if (!std::isfinite(x + y + witness_x + witness_y)) {
    return;
  }
  ++count_;
  std::array<double, 4> before{};
  for (std::size_t i = 0; i < 4; ++i) {
    before[i] = value[i] - mean_[i];
    mean_[i] += before[i] / static_cast<double>(count_);
  }
  for (std::size_t i = 0; i < 4; ++i) {
    for (std::size_t j = 0; j < 4; ++j) {
      product_[i][j] += before[i] * (value[j] - mean_[j]);
    }
  }
}

void WitnessTally::finish(RawGaze& raw, std::string what, std::optional<Eye> eye) const {
  constexpr std::size_t kLeast = 5;
  if (count_ < kLeast) {
    return;
  }
  const auto correlation = [&](std::size_t i, std::size_t j) {
    const double spread = std::sqrt(product_[i][i]) * std::sqrt(product_[j][j]);
    return spread > 0 ? product_[i][j] / spread : kNan;
  };
  raw.witnesses.push_back(
      {std::move(what), count_, correlation(0, 2), correlation(1, 3), correlation(0, 3), correlation(1, 2), eye});
}

Quatd quaternion_from_unity_euler_deg(const Vec3d& rotation) {
  const auto about = [](double x, double y, double z, double angle_deg) {
    const double half = 0.5 * angle_deg * kRadPerDeg;
    return Quatd{x * std::sin(half), y * std::sin(half), z * std::sin(half), std::cos(half)};
  };
  return about(0, 1, 0, rotation.y) * about(1, 0, 0, rotation.x) * about(0, 0, 1, rotation.z);
}

HeadPose head_pose_from_axes(std::int64_t t_ns, const Vec3d& position_m, const Quatd& orientation, GazeAxes axes) {
  const Quatd& q = orientation;
  // Axes of the other handedness are mirrored: rotations about what is not mirrored turn the other way.
  const bool is_left_handed = axes == GazeAxes::unity || axes == GazeAxes::unreal;
  const Vec3d turn = from_axes({q.x, q.y, q.z}, axes) * (is_left_handed ? -1.0 : 1.0);
  return {t_ns, from_axes(position_m, axes), {turn.x, turn.y, turn.z, q.w}};
}

void LabelRuns::add(GazeEventType type, Eye eye, std::string_view key, std::int64_t t_ns, std::int64_t row,
                    std::string_view text) {
  if (!open_ || key_ != key || events_.back().type != type) {
    events_.push_back({type, eye, t_ns, t_ns, std::string(text), row});
    key_ = key;
    open_ = true;
  }
  events_.back().end_ns = t_ns;
}

void LabelRuns::add_named(std::string_view word, Eye eye, std::string_view key, std::int64_t t_ns, std::int64_t row) {
  if (word == "Fixation" || word == "Saccade" || word == "Blink") {
    add(word == "Fixation"  ? GazeEventType::fixation
        : word == "Saccade" ? GazeEventType::saccade
                            : GazeEventType::blink,
        eye, key, t_ns, row);
  } else {
    end();
  }
}

void LabelRuns::end() {
  open_ = false;
}

void LabelRuns::finish(RawGaze& raw) {
  raw.events.insert(raw.events.end(), events_.begin(), events_.end());
}

void label_by_ids(TableRows& rows, const OptionalColumn& blink, const OptionalColumn& fixation, RawSample& sample,
                  LabelRuns& runs) {
  if (const std::string_view blink_id = rows.cell(blink); !is_missing(blink_id)) {
    sample.validity = GazeValidity::blink;
    runs.add(GazeEventType::blink, Eye::cyclopean, blink_id, sample.t_ns, sample.row);
  } else if (const std::string_view id = rows.cell(fixation); !is_missing(id)) {
    runs.add(GazeEventType::fixation, Eye::cyclopean, id, sample.t_ns, sample.row);
  } else {
    runs.end();
  }
}

RawSample missing_row(std::int64_t t_ns, std::int64_t row, Eye eye) {
  const auto unknown = static_cast<float>(kNan);
  return {t_ns, {kNan, kNan, kNan}, GazeValidity::lost, eye, unknown, unknown, row};
}

RawSample position_row(std::int64_t t_ns, std::int64_t row, Eye eye, const Vec2d& at, double pupil) {
  RawSample sample = missing_row(t_ns, row, eye);
  sample.pupil = static_cast<float>(pupil > 0 ? pupil : kNan);
  const bool is_known = !std::isnan(at.x) && !std::isnan(at.y);
  sample.at = is_known ? Vec3d{at.x, at.y, 0} : Vec3d{kNan, kNan, 0};
  sample.validity = is_known ? GazeValidity::ok : GazeValidity::lost;
  return sample;
}

}  // namespace gazetrace
