// SPDX-License-Identifier: Apache-2.0
// WEKA ARFF as GazeCom has it: `%@METADATA width_px 1280.0` and so on, @ATTRIBUTE time, x, y, confidence, @DATA, rows.
// Time is in microseconds and places are in pixels from the top left; a sample with confidence 0 is lost.
#include <fmt/format.h>

#include <cmath>

#include "core/text.hpp"
#include "gazelog/read_support.hpp"

namespace gazetrace {
namespace {

struct ArffHeader {
  std::vector<std::string> names;
  DisplayGeometry geometry;
  bool has_geometry = false;
  std::string_view rows;
  std::int64_t lines_above = 0;
};

ArffHeader read_header(const GazeFile& file) {
  ArffHeader header;
  LineReader lines(file.text);
  std::vector<std::string_view> words;
  for (std::string_view line; lines.next(line);) {
    split_cells(trim(line), ' ', words);
    if (words.empty()) {
      continue;
    }
    const std::string key = to_lower(words[0]);
    if (key == "%@metadata" && words.size() >= 3) {
      const double value = number_from(words[2]).value_or(0);
      const bool good = value > 0 && value < 1e6;
      header.has_geometry = header.has_geometry || good;
      DisplayGeometry& g = header.geometry;
      for (const auto& [name, px] : {std::pair("width_px", &g.width_px), std::pair("height_px", &g.height_px)}) {
        *px = good && words[1] == name ? static_cast<int>(std::lround(value)) : *px;
      }
      for (const auto& [name, cm] : {std::pair("width_mm", &g.width_cm), std::pair("height_mm", &g.height_cm),
                                     std::pair("distance_mm", &g.distance_cm)}) {
        *cm = good && words[1] == name ? value / 10 : *cm;
      }
    } else if (key == "@attribute" && words.size() >= 2) {
      header.names.emplace_back(words[1]);
    } else if (key == "@data") {
      header.rows = lines.rest();
      header.lines_above = lines.number();
      return header;
    }
  }
  throw Error(ErrorKind::input, file.path, "has no @DATA section", "the file may be cut off");
}

}  // namespace

double sniff_gaze_arff(const GazeFile& file) {
  const std::string head = to_lower(head_of(file, 4096));
  const bool relation = head.find("@relation") != std::string::npos;
  const bool attribute = head.find("@attribute") != std::string::npos;
  const bool gaze = head.find("@relation gaze") != std::string::npos || head.find("%@metadata") != std::string::npos;
  return relation && attribute ? gaze ? 0.99 : 0.6 : 0.0;
}

RawGaze read_gaze_arff(const GazeFile& file, const GazeReadOptions& options) {
  const ArffHeader header = read_header(file);
  DelimitedTable table = open_headerless(header.rows, ',', header.names);
  table.lines_above = header.lines_above;
  table.place = place_of(file, header.lines_above);
  UsedColumns used(table);
  const auto named = [&](const std::string& declared, std::string_view own) {
    if (!declared.empty()) {
      return *used.use(declared_column(table, declared));
    }
    if (const auto found = used.find(own)) {
      return *found;
    }
    throw Error(ErrorKind::input, table.place, fmt::format("there is no attribute '{}'", own),
                "its attributes are: " + column_listing(table));
  };
  RawGaze raw = raw_of(file, "");
  const std::size_t time = named(options.columns.time, "time");
  const std::size_t x = named(options.columns.x, "x");
  const std::size_t y = named(options.columns.y, "y");
  const auto confidence = used.find("confidence");
  if (header.has_geometry) {
    raw.recording_geometry = header.geometry;
    add_note(raw, "display size", fmt::format("{}x{} px", header.geometry.width_px, header.geometry.height_px),
             Evidence::header, "%@METADATA");
  }
  const TimeScale scale = declare_time(raw, options, table.headings[time].text, 3, Evidence::format, table.place);
  const double least = least_confidence(options, 1e-9);
  TableRows rows(file, table, used.needed());
  while (rows.next()) {
    if (rows.cell(std::size_t{0}).starts_with('%')) {
      continue;
    }
    rows.check_length();
    RawSample sample;
    sample.t_ns = rows.time_ns(time, scale);
    sample.row = rows.line();
    sample.at.x = rows.number(x);
    sample.at.y = rows.number(y);
    sample.confidence = static_cast<float>(rows.number(confidence));
    sample.pupil = static_cast<float>(kNan);
    const bool zero = sample.at.x == 0 && sample.at.y == 0 && sample.confidence == 0;
    if (zero || std::isnan(sample.at.x) || std::isnan(sample.at.y)) {
      sample = missing_row(sample.t_ns, sample.row, Eye::cyclopean);
      sample.confidence = 0;
    } else if (sample.confidence < least) {
      sample.validity = GazeValidity::low_confidence;
    }
    raw.rows.push_back(sample);
  }
  declare_places(raw, {PositionUnit::px, PositionOrigin::top_left, Evidence::format, "x, y"}, table.place);
  return raw;
}

}  // namespace gazetrace
