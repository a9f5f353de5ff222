// SPDX-License-Identifier: Apache-2.0
// SMI BeGaze and iView X text: `## ` preamble (sample rate, calibration area, stimulus in mm, head distance), a line of
// names, rows of Type SMP and MSG. Time in microseconds; POR in pixels from the top left, (0, 0) is missing. Raw is the
// eye camera's picture, not the screen.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/text.hpp"
#include "gazelog/read_support.hpp"

namespace gazetrace {
namespace {

struct SmiEye {
  Eye eye = Eye::left;
  std::size_t x = 0, y = 0;
  OptionalColumn pupil, validity, event;
};

struct SmiColumns {
  std::size_t time = 0, type = 0;
  OptionalColumn trial;
  std::vector<SmiEye> eyes;
};

std::vector<double> numbers_after_colon(std::string_view line) {
  std::vector<double> values;
  std::vector<std::string_view> words;
  const std::size_t colon = line.find(':');
  split_cells(colon == std::string_view::npos ? "" : line.substr(colon + 1), ' ', words);
  for (const std::string_view word : words) {
    if (const auto value = number_from(word); value && *value > 0 && *value < 1e6) {
      values.push_back(*value);
    }
  }
  return values;
}

void read_preamble_lines(const DelimitedTable& table, RawGaze& raw) {
  DisplayGeometry geometry;
  for (const PreambleLine& line : table.preamble) {
    std::string_view text = line.text;
    text.remove_prefix(std::min(text.find_first_not_of('#'), text.size()));
    text = trim(text);
    const std::vector<double> values = numbers_after_colon(text);
    if (text.starts_with("Sample Rate") && !values.empty()) {
      raw.nominal_rate_hz = values[0];
    } else if (text.starts_with("Calibration Area") && values.size() == 2) {
      geometry.width_px = static_cast<int>(std::lround(values[0]));
      geometry.height_px = static_cast<int>(std::lround(values[1]));
    } else if (text.starts_with("Stimulus Dimension") && values.size() == 2) {
      geometry.width_cm = values[0] / 10;
      geometry.height_cm = values[1] / 10;
    } else if (text.starts_with("Head Distance") && !values.empty()) {
      geometry.distance_cm = values[0] / 10;
    }
  }
  if (geometry.width_px > 0) {
    raw.recording_geometry = geometry;
    state_display_px(raw, geometry.width_px, geometry.height_px, Evidence::header, "Calibration Area");
  }
}

std::vector<SmiEye> find_eyes(const DelimitedTable& table, UsedColumns& used) {
  std::vector<SmiEye> eyes;
  for (const auto& [letter, eye] : {std::pair("L", Eye::left), std::pair("R", Eye::right)}) {
    const auto column = [&, side = letter](std::string_view name) {
      return table.find(fmt::format("{} {}", side, name));
    };
    const auto x = column("POR X [px]");
    const auto y = column("POR Y [px]");
    if (x && y) {
      const auto diameter = column("Pupil Diameter [mm]");
      const auto mapped = diameter ? diameter : column("Mapped Diameter [mm]");
      eyes.push_back({eye, *used.use(x), *used.use(y), used.use(mapped ? mapped : column("Dia X [px]")),
                      used.use(column("Validity")), used.use(column("Event Info"))});
    }
  }
  if (eyes.empty()) {
    throw Error(ErrorKind::input, table.place, "there is no point of regard (L POR X [px], R POR X [px])",
                "Raw columns are places in the eye camera's picture; export again with POR");
  }
  return eyes;
}

SmiColumns find_columns(const DelimitedTable& table, const GazeReadOptions& options, UsedColumns& used) {
  const auto own_time = table.find("Time");
  const auto type = used.find("Type");
  if (!own_time || !type) {
    throw Error(ErrorKind::input, table.place, "there are no columns 'Time' and 'Type'", "is this an SMI export?");
  }
  std::vector<SmiEye> eyes = find_eyes(table, used);
  return {used.time(options, *own_time), *type, table.find("Trial"), std::move(eyes)};
}

// The rows of one trial are a segment of the log. `trial` is the name of the one in which the row before was.
void note_trial(RawGaze& raw, std::string& trial, std::string_view name, std::int64_t t_ns, std::int64_t row) {
  if (name != trial) {
    trial = name;
    raw.events.push_back({GazeEventType::segment, Eye::cyclopean, t_ns, t_ns, "trial " + trial.substr(0, 20), row});
    return;
  }
  // Messages may stand behind the segment's own event.
  const auto segment = std::find_if(raw.events.rbegin(), raw.events.rend(),
                                    [](const GazeEvent& event) { return event.type == GazeEventType::segment; });
  if (segment != raw.events.rend()) {
    segment->end_ns = t_ns;
  }
}

RawSample sample_of(TableRows& rows, const SmiEye& eye, std::int64_t t_ns) {
  const Vec2d at{rows.number(eye.x), rows.number(eye.y)};
  const bool is_zero = at.x == 0 && at.y == 0;
  RawSample sample = position_row(t_ns, rows.line(), eye.eye, is_zero ? Vec2d{kNan, kNan} : at, rows.number(eye.pupil));
  if (eye.validity && rows.number(*eye.validity) == 0) {
    sample.validity = GazeValidity::lost;
  }
  if (rows.cell(eye.event) == "Blink") {
    sample.validity = GazeValidity::blink;
  }
  return sample;
}

}  // namespace

double sniff_gaze_smi(const GazeFile& file) {
  const WordsIn has{head_of(file)};
  const bool columns = has("Time\tType\t") && (has("POR X [px]") || has("Raw X [px]"));
  const bool preamble = file.text.starts_with("## ") && (has("[iView]") || has("BeGaze"));
  return columns && preamble ? 0.99 : columns ? 0.9 : preamble ? 0.6 : 0.0;
}

RawGaze read_gaze_smi(const GazeFile& file, const GazeReadOptions& options) {
  const DelimitedTable table = open_table(file);
  UsedColumns used(table);
  const SmiColumns c = find_columns(table, options, used);
  RawGaze raw = raw_of(file, "tracker");
  std::string columns;
  for (const SmiEye& eye : c.eyes) {
    raw.pupil_unit = eye.pupil ? table.headings[*eye.pupil].unit : raw.pupil_unit;
    columns += (columns.empty() ? "" : ", ") + table.headings[eye.x].text + ", " + table.headings[eye.y].text;
  }
  read_preamble_lines(table, raw);
  const TimeScale scale = declare_time(raw, options, table.headings[c.time].text, 3, Evidence::format, table.place);
  std::string trial;
  LabelRuns runs;
  TableRows rows(file, table, used.needed());
  while (rows.next()) {
    const std::int64_t t_ns = rows.time_ns(c.time, scale);
    const std::string_view type = rows.cell(c.type);
    if (type == "MSG") {
      // Free text in the fourth column.
      add_message(raw, t_ns, std::string(rows.cell(std::size_t{3})), rows.line());
    } else if (type == "SMP") {
      rows.check_length();
      if (c.trial) {
        note_trial(raw, trial, rows.cell(*c.trial), t_ns, rows.line());
      }
      for (const SmiEye& eye : c.eyes) {
        raw.rows.push_back(sample_of(rows, eye, t_ns));
      }
      const SmiEye& first = c.eyes.front();
      const std::string event(rows.cell(first.event));
      runs.add_named(event, first.eye, event, t_ns, rows.line());
    }
  }
  runs.finish(raw);
  declare_places(raw, {PositionUnit::px, PositionOrigin::top_left, Evidence::header, columns}, table.place);
  return raw;
}

}  // namespace gazetrace
