// SPDX-License-Identifier: Apache-2.0
#include "pipeline/timing_log.hpp"

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <system_error>
#include <utility>
#include <vector>

#include "gazetrace/error.hpp"

namespace gazetrace {
namespace {

[[noreturn]] void fail(const std::string& path) {
  throw Error(ErrorKind::runtime, path, std::string("writing failed: ") + std::strerror(errno));
}

}  // namespace

std::map<std::int32_t, TimingRow> read_earlier_rows(const std::string& path) {
  std::map<std::int32_t, TimingRow> rows;
  std::error_code missing;
  if (path.empty() || std::filesystem::file_size(path, missing) == 0 || missing) {
    return rows;
  }
  for (const TimingRow& row : read_timing_csv(path)) {
    rows[row.frame] = row;
  }
  return rows;
}

TimingLog::TimingLog(std::string path, std::map<std::int32_t, TimingRow> kept)
    : path_(std::move(path)), rows_(std::move(kept)) {
  if (path_.empty()) {
    return;
  }
  write_text_atomically(path_, text());
  file_.reset(std::fopen(path_.c_str(), "ab"));
  if (!file_) {
    fail(path_);
  }
}

void TimingLog::add(const TimingRow& row) {
  rows_[row.frame] = row;
  if (file_) {
    const std::string line = timing_row_text(row) + "\n";
    if (std::fwrite(line.data(), 1, line.size(), file_.get()) != line.size() || std::fflush(file_.get()) != 0) {
      fail(path_);
    }
  }
}

void TimingLog::finish() {
  if (file_) {
    file_.reset();
    write_text_atomically(path_, text());
  }
}

std::string TimingLog::text() const {
  std::vector<TimingRow> rows;
  for (const auto& [frame, row] : rows_) {
    rows.push_back(row);
  }
  return timing_csv_text(rows);
}

}  // namespace gazetrace
