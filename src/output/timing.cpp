// SPDX-License-Identifier: Apache-2.0
// timing.csv, with one row per frame. A single list of the columns serves both writing and reading.
#include <fmt/format.h>

#include <charconv>
#include <fstream>
#include <iterator>
#include <type_traits>

#include "gazetrace/output.hpp"

namespace gazetrace {
namespace {

constexpr std::array<const char*, kTimingRegions> kRegions{"fovea",    "intermediate", "periphery", "uniform",
                                                           "block_1",  "block_2",      "block_4",   "block_8",
                                                           "block_16", "block_32",     "block_64"};

// Calls visit(name, field) for every column, in order. Row is TimingRow or const TimingRow.
template <class Row, class Visit>
void for_each_column(Row& row, const Visit& visit) {
  visit("frame", row.frame);
  visit("plan_ms", row.plan_ms);
  visit("guiding_ms", row.guiding_ms);
  visit("pilot_ms", row.pilot_ms);
  visit("trace_ms", row.trace_ms);
  visit("guides_ms", row.guides_ms);
  visit("reconstruct_ms", row.reconstruct_ms);
  visit("temporal_ms", row.temporal_ms);
  visit("exposure_ms", row.exposure_ms);
  visit("layers_ms", row.layers_ms);
  visit("color_ms", row.color_ms);
  visit("write_ms", row.write_ms);
  visit("total_ms", row.total_ms);
  visit("trace_cpu_ms", row.trace_cpu_ms);
  visit("pixels", row.pixels);
  visit("samples", row.samples);
  visit("pilot_samples", row.pilot_samples);
  visit("other_samples", row.other_samples);
  visit("training_paths", row.training_paths);
  visit("rays_primary", row.rays_primary);
  visit("rays_bounce", row.rays_bounce);
  visit("rays_shadow", row.rays_shadow);
  visit("rejected_rays", row.rejected_rays);
  visit("non_finite_samples", row.non_finite_samples);
  for (std::size_t i = 0; i < kRegions.size(); ++i) {
    visit(std::string(kRegions[i]) + "_pixels", row.region_pixels[i]);
    visit(std::string(kRegions[i]) + "_samples", row.region_samples[i]);
    visit(std::string(kRegions[i]) + "_cpu_ms", row.region_cpu_ms[i]);
  }
  visit("exposure_ev", row.exposure_ev);
  visit("predicted_relmse", row.predicted_relmse);
  visit("predicted_jod", row.predicted_jod);
  visit("gaze.u", row.gaze.u);
  visit("gaze.v", row.gaze.v);
  visit("gaze.valid", row.gaze.valid);
  visit("gaze_state", row.gaze_state);
  visit("gaze_event", row.gaze_event);
  visit("gaze_age_ms", row.gaze_age_ms);
  visit("gaze_effective_age_ms", row.gaze_effective_age_ms);
  visit("no_gaze", row.no_gaze);
  visit("peak_memory_mib", row.peak_memory_mib);
}

std::string header_line() {
  return fmt::format("{}", fmt::join(timing_columns(), ","));
}

std::vector<std::string_view> split(std::string_view line) {
  std::vector<std::string_view> cells;
  for (;;) {
    const std::size_t comma = line.find(',');
    cells.push_back(line.substr(0, comma));
    if (comma == std::string_view::npos) {
      return cells;
    }
    line.remove_prefix(comma + 1);
  }
}

TimingRow parse_row(std::string_view line, const std::string& place) {
  const std::vector<std::string_view> cells = split(line);
  const std::size_t expected = timing_columns().size();
  if (cells.size() != expected) {
    throw Error(ErrorKind::input, place, fmt::format("{} columns instead of {}", cells.size(), expected),
                "remove the line or render the frame again");
  }
  TimingRow row;
  std::size_t column = 0;
  for_each_column(row, [&](const std::string& name, auto& field) {
    const std::string_view cell = cells[column++];
    if constexpr (std::is_same_v<std::decay_t<decltype(field)>, std::string>) {
      field = cell;
    } else {
      const auto [end, error] = std::from_chars(cell.data(), cell.data() + cell.size(), field);
      if (error != std::errc() || end != cell.data() + cell.size()) {
        throw Error(ErrorKind::input, place, fmt::format("'{}' is not a number for column {}", cell, name),
                    "remove the line or render the frame again");
      }
    }
  });
  return row;
}

}  // namespace

const std::vector<std::string>& timing_regions() {
  static const std::vector<std::string> kNames(kRegions.begin(), kRegions.end());
  return kNames;
}

std::vector<std::string> timing_columns() {
  std::vector<std::string> names;
  const TimingRow row;
  for_each_column(row, [&](const std::string& name, const auto&) { names.push_back(name); });
  return names;
}

std::string timing_row_text(const TimingRow& row) {
  std::string line;
  for_each_column(row, [&](const std::string& name, const auto& field) {
    line += line.empty() ? "" : ",";
    if constexpr (std::is_same_v<std::decay_t<decltype(field)>, double>) {
      // A tenth of a microsecond is below the noise of any clock. Exposure is a setting and keeps every digit.
      line += name == "exposure_ev"       ? fmt::format("{}", field)
              : name.starts_with("gaze.") ? fmt::format("{:.6f}", field)
                                          : fmt::format("{:.4f}", field);
    } else {
      line += fmt::format("{}", field);
    }
  });
  return line;
}

std::string timing_csv_text(const std::vector<TimingRow>& rows) {
  std::string text = header_line() + '\n';
  for (const TimingRow& row : rows) {
    text += timing_row_text(row) + '\n';
  }
  return text;
}

std::vector<TimingRow> read_timing_csv(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) {
    throw Error(ErrorKind::input, path, "cannot be opened");
  }
  const std::string text{std::istreambuf_iterator<char>(file), {}};
  std::vector<TimingRow> rows;
  std::size_t begin = 0;
  for (int number = 1;; ++number) {
    const std::size_t end = text.find('\n', begin);
    if (end == std::string::npos) {
      if (number == 1) {
        throw Error(ErrorKind::input, path, "is not a timing table: its first line is not complete");
      }
      return rows;  // the last line has no line break: it was cut off when the run ended
    }
    std::string_view line(text.data() + begin, end - begin);
    if (line.ends_with('\r')) {
      line.remove_suffix(1);
    }
    const std::string place = fmt::format("{}:{}", path, number);
    if (number == 1) {
      if (line != header_line()) {
        throw Error(ErrorKind::input, place, "the columns are not those of this version",
                    "read it with the version that wrote it");
      }
    } else if (!line.empty()) {
      rows.push_back(parse_row(line, place));
    }
    begin = end + 1;
  }
}

}  // namespace gazetrace
