// SPDX-License-Identifier: Apache-2.0
#include "foveation_gain/rows.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <utility>

#include "gazetrace/error.hpp"

namespace gazetrace::gain {
namespace {

constexpr std::size_t kPlainFields = 14;
constexpr std::size_t kFields = kPlainFields + kColumns * (1 + kMetrics);

// Empty where there is no such file.
std::string text_of(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::stringstream text;
  text << file.rdbuf();
  return text.str();
}

std::string header() {
  std::string line = "kind,scene,arm,filter,gaze,u,v,seed,spp,plan_ms,guides_ms,trace_ms,reconstruct_ms,temporal_ms";
  for (std::size_t c = 0; c < kColumns; ++c) {
    line += ",share_" + column_name(c);
  }
  for (const char* metric : kMetricNames) {
    for (std::size_t c = 0; c < kColumns; ++c) {
      line += fmt::format(",{}_{}", metric, column_name(c));
    }
  }
  return line;
}

std::string line_of(const Row& row) {
  std::string line =
      fmt::format("{},{},{},{},{},{:.9g},{:.9g},{},{:.9g},{:.4f},{:.4f},{:.4f},{:.4f},{:.4f}", row.kind, row.scene,
                  row.arm, row.filter, row.gaze, row.u, row.v, row.seed, row.spp, row.time.plan_ms, row.time.guides_ms,
                  row.time.trace_ms, row.time.reconstruct_ms, row.time.temporal_ms);
  const auto add = [&](const ByColumn& values) {
    for (const double value : values) {
      line += std::isfinite(value) ? fmt::format(",{:.9g}", value) : ",";
    }
  };
  add(row.share);
  std::for_each(row.score.begin(), row.score.end(), add);
  return line;
}

std::vector<std::string> fields_of(const std::string& line) {
  std::vector<std::string> fields(1);
  for (const char c : line) {
    if (c == ',') {
      fields.emplace_back();
    } else {
      fields.back() += c;
    }
  }
  return fields;
}

Row row_of(const std::vector<std::string>& fields, const std::string& place) {
  if (fields.size() != kFields) {
    throw Error(ErrorKind::input, place, fmt::format("{} fields where {} belong", fields.size(), kFields),
                "take another file, or remove the line");
  }
  const auto number = [&](std::size_t i) {
    if (fields[i].empty()) {
      return std::numeric_limits<double>::quiet_NaN();
    }
    char* rest = nullptr;
    const double value = std::strtod(fields[i].c_str(), &rest);
    if (*rest != '\0') {
      throw Error(ErrorKind::input, place, fmt::format("'{}' is no number", fields[i]), "remove the line");
    }
    return value;
  };
  Row row{fields[0], fields[1], fields[2], fields[3], fields[4], number(5), number(6), 0, number(8), {}, {}, {}};
  row.seed = static_cast<int>(number(7));
  row.time = {number(9), number(10), number(11), number(12), number(13)};
  for (std::size_t c = 0; c < kColumns; ++c) {
    row.share.at(c) = number(kPlainFields + c);
    for (std::size_t m = 0; m < kMetrics; ++m) {
      row.score.at(m).at(c) = number(kPlainFields + kColumns * (1 + m) + c);
    }
  }
  return row;
}

}  // namespace

std::string column_name(std::size_t column) {
  return column == 0 ? "frame" : eccentricity_band_name(column - 1);
}

std::string Row::key() const {
  return fmt::format("{},{},{},{},{},{:.9g},{:.9g},{}", kind, scene, arm, filter, gaze, u, v, seed);
}

std::vector<Row> read_rows(const std::string& path) {
  const std::string all = text_of(path);
  std::vector<Row> rows;
  std::size_t number = 0;
  for (std::size_t begin = 0; begin < all.size();) {
    const std::size_t end = all.find('\n', begin);
    if (end == std::string::npos) {
      break;
    }
    ++number;
    const std::string line = all.substr(begin, end - begin);
    begin = end + 1;
    if (number == 1) {
      if (line != header()) {
        throw Error(ErrorKind::input, path + ":1", "this is no file of measured arms", "take another file");
      }
      continue;
    }
    rows.push_back(row_of(fields_of(line), fmt::format("{}:{}", path, number)));
  }
  return rows;
}

RowFile::RowFile(std::string path) : path_(std::move(path)) {
  for (const Row& row : read_rows(path_)) {
    keys_.insert(row.key());
    if (row.kind == "setup" || row.kind == "timed") {
      setups_.push_back(row);
    }
  }
  // A line that was cut off in the writing goes; the next one would continue it.
  const std::string text = text_of(path_);
  const std::size_t end = text.find_last_of('\n') + 1;
  if (end == 0) {
    std::ofstream(path_, std::ios::binary) << header() << '\n';
  } else if (end < text.size()) {
    std::filesystem::resize_file(path_, end);
  }
}

void RowFile::claim(const std::string& kind, const std::string& scene, const std::string& setup) {
  for (const Row& row : setups_) {
    if (row.kind == kind && row.scene == scene) {
      if (row.arm != setup) {
        throw Error(ErrorKind::usage, path_, fmt::format("{} is in it with '{}', not '{}'", scene, row.arm, setup),
                    "take another file");
      }
      return;
    }
  }
  Row row;
  row.kind = kind;
  row.scene = scene;
  row.arm = setup;
  setups_.push_back(row);
  add(row);
}

void RowFile::add(const Row& row) {
  std::ofstream file(path_, std::ios::binary | std::ios::app);
  file << line_of(row) + '\n' << std::flush;
  if (!file) {
    throw Error(ErrorKind::runtime, path_, "cannot be written", "check the folder and the disk");
  }
  keys_.insert(row.key());
}

}  // namespace gazetrace::gain
