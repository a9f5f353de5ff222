// SPDX-License-Identifier: Apache-2.0
// Tobii Studio TSV (3.x): RecordingTimestamp in milliseconds from the start, GazePointX (ADCSpx) in pixels of the whole
// display from the top left, ValidityLeft and Right 0 (sure) to 4 (not found), rows of events without gaze in between.
// (MCSpx) counts from the shown medium and (ADCSmm) from the bottom left: neither is taken for the display's pixels.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "core/statistics.hpp"
#include "core/text.hpp"
#include "gazelog/read_support.hpp"
#include "gazelog/recordings.hpp"

namespace gazetrace {
namespace {

constexpr double kWorstValidity = 1;  // with 0 and 1 this eye was found, and it is certain which eye it is

struct StudioEye {
  OptionalColumn x, y, validity = {}, pupil = {}, distance = {};
  VectorColumns place_mm = {};
};

struct StudioColumns {
  std::size_t time = 0;
  OptionalColumn x, y, left_x_mm, left_y_mm, event_type, fixation, saccade;
  std::array<StudioEye, 2> eyes;    // left, right
  std::vector<std::size_t> events;  // columns with the texts of events
};

StudioColumns find_columns(const DelimitedTable& table, const GazeReadOptions& options, UsedColumns& used) {
  StudioColumns c;
  c.time = used.time(options, used.require("RecordingTimestamp", "is this a Tobii Studio export?"));
  c.x = used.find("GazePointX (ADCSpx)");
  c.y = used.find("GazePointY (ADCSpx)");
  for (std::size_t eye = 0; eye < 2; ++eye) {
    const char* const side = eye == 0 ? "Left" : "Right";
    const auto find = [&](fmt::format_string<const char* const&> name) { return used.find(fmt::format(name, side)); };
    c.eyes[eye] = {find("GazePoint{}X (ADCSpx)"),
                   find("GazePoint{}Y (ADCSpx)"),
                   find("Validity{}"),
                   find("Pupil{}"),
                   find("Distance{}"),
                   {find("EyePos{}X (ADCSmm)"), find("EyePos{}Y (ADCSmm)"), find("EyePos{}Z (ADCSmm)")}};
  }
  c.left_x_mm = used.find("GazePointLeftX (ADCSmm)");
  c.left_y_mm = used.find("GazePointLeftY (ADCSmm)");
  c.event_type = used.find("GazeEventType");
  c.fixation = used.find("FixationIndex");
  c.saccade = used.find("SaccadeIndex");
  for (const std::string_view name : {"StudioEvent", "MouseEvent", "KeyPressEvent", "ExternalEvent"}) {
    if (const auto found = used.find(name)) {
      c.events.push_back(*found);
    }
  }
  if ((!c.x || !c.y) && (!c.eyes[0].x || !c.eyes[0].y) && (!c.eyes[1].x || !c.eyes[1].y)) {
    throw Error(ErrorKind::input, table.place, "there is no gaze in pixels of the display (GazePointX (ADCSpx))",
                "media coordinates (MCSpx) are relative to what was shown; export again with ADCS columns");
  }
  return c;
}

// A line through y over x by least squares.
class Slope {
 public:
  void add(double x, double y) {
    if (std::isfinite(x) && std::isfinite(y)) {
      ++n_;
      sx_ += x;
      sy_ += y;
      sxx_ += x * x;
      sxy_ += x * y;
    }
  }
  [[nodiscard]] double value() const {
    const double spread = n_ * sxx_ - sx_ * sx_;
    return n_ > 10 && spread > n_ * n_ ? (n_ * sxy_ - sx_ * sy_) / spread : 0;
  }

 private:
  double n_ = 0, sx_ = 0, sy_ = 0, sxx_ = 0, sxy_ = 0;
};

class StudioReader {
 public:
  StudioReader(const GazeFile& file, const GazeReadOptions& options)
      : options_(options),
        table_(open_table(file)),
        used_(table_),
        c_(find_columns(table_, options, used_)),
        recordings_(table_, options.columns.recording, {"ParticipantName", "RecordingName"}),
        rows_(file, table_, std::max(used_.needed(), recordings_.needed_cells())),
        raw_(raw_of(file, "recording, from its start", "mm")) {
    const std::string& time = table_.headings[c_.time].text;
    // EyeTrackerTimestamp is in microseconds.
    const int stated = to_lower(time).find("eyetracker") == std::string::npos ? 6 : 3;
    scale_ = declare_time(raw_, options, time, stated, Evidence::format, table_.place);
  }

  RawGaze read() {
    const auto resolution = table_.find("RecordingResolution");
    while (rows_.next()) {
      rows_.check_length();
      if (recordings_.note(rows_, raw_)) {
        runs_.end();
      }
      if (resolution && !raw_.recording_geometry) {
        read_resolution(rows_.cell(*resolution));
      }
      read_row();
    }
    runs_.finish(raw_);
    finish();
    return std::move(raw_);
  }

 private:
  void read_resolution(std::string_view text) {
    const std::size_t cross = text.find('x');
    const auto width = number_from(trim(text.substr(0, cross)));
    const auto height = cross == std::string_view::npos ? std::nullopt : number_from(trim(text.substr(cross + 1)));
    state_display_px(raw_, width.value_or(0), height.value_or(0), Evidence::header, "RecordingResolution");
  }

  void read_row() {
    std::string happened;
    for (const std::size_t column : c_.events) {
      const std::string_view text = rows_.cell(column);
      happened += text.empty() ? "" : (happened.empty() ? "" : "; ") + std::string(text);
    }
    // Rows of events have no gaze and no validity, and no stamp of the tracker either.
    const auto& [left, right] = c_.eyes;
    const bool is_sample = !rows_.cell(left.validity).empty() || !rows_.cell(right.validity).empty() ||
                           (!left.validity && !right.validity && happened.empty());
    if (!is_sample && rows_.cell(c_.time).empty()) {
      return;
    }
    const std::int64_t t_ns = rows_.time_ns(c_.time, scale_);
    if (!happened.empty()) {
      add_message(raw_, t_ns, happened, rows_.line());
    }
    if (!is_sample) {
      return;
    }
    add(t_ns, Eye::cyclopean, {.x = c_.x, .y = c_.y});
    add(t_ns, Eye::left, left);
    if (left.x && left.y && c_.left_x_mm && c_.left_y_mm) {
      const Vec2d mm{rows_.number(c_.left_x_mm), rows_.number(c_.left_y_mm)};
      width_.add(rows_.number(options_.swap_xy ? left.y : left.x), mm.x);
      height_.add(rows_.number(options_.swap_xy ? left.x : left.y), mm.y);
      millimetres_.add(rows_.number(left.x), rows_.number(left.y), mm.x, -mm.y);
    }
    add(t_ns, Eye::right, right);
    read_eye_places();
    const std::string type(rows_.cell(c_.event_type));
    runs_.add_named(type, Eye::cyclopean, rows_.cell(type == "Fixation" ? c_.fixation : c_.saccade), t_ns,
                    rows_.line());
  }

  // The middle between both eyes, measured from the bottom left corner of the display, and from the display to the
  // front.
  void read_eye_places() {
    Vec3d sum;
    double eyes = 0;
    for (const StudioEye& eye : c_.eyes) {
      if (const double distance = rows_.number(eye.distance); distance > 0) {
        distances_mm_.push_back(distance);
      }
      const Vec3d at = rows_.vector(eye.place_mm);
      if (is_finite(at) && at.z > 0) {
        sum += at;
        ++eyes;
      }
    }
    if (eyes == 2) {
      eyes_x_mm_.push_back(0.5 * sum.x);
      eyes_y_mm_.push_back(0.5 * sum.y);
      eyes_z_mm_.push_back(0.5 * sum.z);
    }
  }

  void add(std::int64_t t_ns, Eye eye, const StudioEye& columns) {
    if (!columns.x || !columns.y) {
      return;
    }
    const double validity = rows_.number(columns.validity);
    RawSample sample = position_row(t_ns, rows_.line(), eye, {rows_.number(columns.x), rows_.number(columns.y)},
                                    rows_.number(columns.pupil));
    if (sample.validity == GazeValidity::ok && validity > kWorstValidity) {
      sample.validity = validity >= 4 ? GazeValidity::lost : GazeValidity::low_confidence;
    }
    raw_.rows.push_back(sample);
  }

  void place_eyes(DisplayGeometry& g) {
    if (!eyes_z_mm_.empty() && g.width_cm > 0) {
      g.distance_cm = upper_median(eyes_z_mm_) / 10;
      g.eye_x_cm = upper_median(eyes_x_mm_) / 10 - 0.5 * g.width_cm;
      g.eye_y_cm = upper_median(eyes_y_mm_) / 10 - 0.5 * g.height_cm;
      add_note(raw_, "distance", fmt::format("{:.1f} cm", g.distance_cm), Evidence::header,
               "median of EyePosLeftZ and EyePosRightZ (ADCSmm)");
      add_note(raw_, "eye off the display's center", fmt::format("{:.1f}, {:.1f} cm", g.eye_x_cm, g.eye_y_cm),
               Evidence::header, "right, up: medians of EyePos (ADCSmm)");
    } else if (!distances_mm_.empty()) {
      g.distance_cm = upper_median(distances_mm_) / 10;
      add_note(raw_, "distance", fmt::format("{:.1f} cm", g.distance_cm), Evidence::header,
               "median of DistanceLeft and DistanceRight");
    }
  }

  // Millimetres and pixels of the same points give the display's size; the place or distance of the eyes is in every
  // row.
  void finish() {
    if (raw_.recording_geometry) {
      DisplayGeometry& g = *raw_.recording_geometry;
      const double width_cm = std::abs(width_.value()) * g.width_px / 10;
      const double height_cm = std::abs(height_.value()) * g.height_px / 10;
      if (width_cm > 5 && height_cm > 5) {
        g.width_cm = width_cm;
        g.height_cm = height_cm;
        add_note(raw_, "display size", fmt::format("{:.1f} x {:.1f} cm", width_cm, height_cm), Evidence::header,
                 "(ADCSmm) against (ADCSpx)");
      }
      place_eyes(g);
    }
    millimetres_.finish(raw_, "the left eye in millimetres (ADCSmm)", Eye::left);
    declare_places(raw_,
                   {PositionUnit::px, PositionOrigin::top_left, Evidence::header,
                    c_.x ? "GazePointX (ADCSpx), GazePointY (ADCSpx)" : "GazePointLeftX (ADCSpx), ..."},
                   table_.place);
  }

  const GazeReadOptions& options_;
  DelimitedTable table_;
  UsedColumns used_;
  StudioColumns c_;
  RecordingColumns recordings_;
  TableRows rows_;
  RawGaze raw_;
  TimeScale scale_;
  LabelRuns runs_;
  Slope width_, height_;
  WitnessTally millimetres_;
  std::vector<double> distances_mm_, eyes_x_mm_, eyes_y_mm_, eyes_z_mm_;
};

}  // namespace

double sniff_gaze_tobii_studio(const GazeFile& file) {
  const WordsIn has{first_line_of(file)};
  if (!has("RecordingTimestamp")) {
    return 0.0;
  }
  return has("StudioVersionRec") || has("(ADCSpx)") ? 0.99 : has("GazePoint") || has("ValidityLeft") ? 0.9 : 0.3;
}

RawGaze read_gaze_tobii_studio(const GazeFile& file, const GazeReadOptions& options) {
  return StudioReader(file, options).read();
}

}  // namespace gazetrace
