// SPDX-License-Identifier: Apache-2.0
#include "gazelog/gazepoint_columns.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "gazelog/read_support.hpp"

namespace gazetrace {
namespace {

GazepointPupils find_pupils(const DelimitedTable& table) {
  const auto has = [&](const char* name) { return table.find(name).has_value(); };
  const bool in_mm = has("LPMM") || has("RPMM");
  if (in_mm) {
    return {{{{table.find("LPMM"), table.find("LPMMV")}, {table.find("RPMM"), table.find("RPMMV")}}},
            "mm",
            "LPMM, RPMM",
            has("LPD") || has("RPD") ? "LPD and RPD, in pixels of the camera, are left out" : ""};
  }
  if (has("LPD") || has("RPD")) {
    return {{{{table.find("LPD"), table.find("LPV")}, {table.find("RPD"), table.find("RPV")}}},
            "px",
            "LPD, RPD",
            "diameters in pixels of the camera"};
  }
  return {};
}

std::optional<std::size_t> column_starting(const DelimitedTable& table, std::string_view prefix) {
  for (std::size_t i = 0; i < table.headings.size(); ++i) {
    const std::string& text = table.headings[i].text;
    if (text.starts_with(prefix) &&
        (text.size() == prefix.size() || text[prefix.size()] == '(' || text[prefix.size()] == ' ')) {
      return i;
    }
  }
  return std::nullopt;
}

std::vector<GazepointPoint> find_points(const DelimitedTable& table, const std::string& place) {
  std::vector<GazepointPoint> points;
  for (const auto& [stem, eye] :
       {std::pair("BPOG", Eye::cyclopean), std::pair("LPOG", Eye::left), std::pair("RPOG", Eye::right)}) {
    const auto x = table.find(fmt::format("{}X", stem));
    const auto y = table.find(fmt::format("{}Y", stem));
    if (x && y) {
      points.push_back({eye, *x, *y, table.find(fmt::format("{}V", stem))});
    }
  }
  if (points.empty()) {
    const bool fixations = table.find("FPOGX").has_value();
    throw Error(ErrorKind::input, place,
                fixations ? "there is only FPOG, the mean of the fixation so far" : "there is no point of gaze (BPOGX)",
                "export all gaze with BPOG, or read FPOGX and FPOGY by `format` generic with "
                "`x-column` and `y-column`");
  }
  return points;
}

}  // namespace

double GazepointPupils::of(TableRows& rows, Eye eye) const {
  double sum = 0;
  double count = 0;
  for (const Eye side : {Eye::left, Eye::right}) {
    const GazepointPupils::Columns& pupil = eyes[side == Eye::left ? 0 : 1];
    const double size = rows.number(pupil.size);
    const bool is_measured = size > 0 && (!pupil.valid || rows.number(*pupil.valid) == 1);
    if (is_measured && (eye == side || eye == Eye::cyclopean)) {
      sum += size;
      ++count;
    }
  }
  return count > 0 ? sum / count : kNan;
}

GazepointColumns find_gazepoint_columns(const DelimitedTable& table, const GazeReadOptions& options,
                                        const std::string& place) {
  GazepointColumns c;
  c.seconds = column_starting(table, "TIME");
  c.ticks = column_starting(table, "TIMETICK");
  if (!c.seconds && !c.ticks && options.columns.time.empty()) {
    throw Error(ErrorKind::input, place, "there is no column TIME(...)", "name it with `time-column`");
  }
  c.pupils = find_pupils(table);
  c.time = time_column(table, options, c.seconds ? *c.seconds : c.ticks.value_or(0), place);
  c.points = find_points(table, place);
  c.blink = table.find("BKID");
  c.media = table.find("MEDIA_ID");
  c.fixation = table.find("FPOGID");
  c.fixation_valid = table.find("FPOGV");
  c.aoi = table.find("AOI");
  c.fixation_start = table.find("FPOGS");
  c.fixation_duration = table.find("FPOGD");
  return c;
}

std::size_t needed_cells(const GazepointColumns& c) {
  std::size_t needed = cells_up_to({c.time, c.blink, c.media, c.fixation, c.fixation_valid, c.aoi});
  if (c.state_fixations()) {
    needed = std::max(needed, cells_up_to({c.fixation_start, c.fixation_duration, c.seconds}));
  }
  for (const GazepointPupils::Columns& pupil : c.pupils.eyes) {
    needed = std::max(needed, cells_up_to({pupil.size, pupil.valid}));
  }
  for (const GazepointPoint& point : c.points) {
    needed = std::max(needed, cells_up_to({point.x, point.y, point.valid}));
  }
  return needed;
}

}  // namespace gazetrace
