// SPDX-License-Identifier: Apache-2.0
// timing.csv while a run goes on: a row appears as soon as its frame is finished.
#pragma once

#include <cstdint>
#include <cstdio>
#include <map>
#include <memory>
#include <string>

#include "gazetrace/output.hpp"

namespace gazetrace {

// The rows of an earlier run, by frame; empty where there is no file.
std::map<std::int32_t, TimingRow> read_earlier_rows(const std::string& path);

class TimingLog {
 public:
  // The file starts with the rows to keep. With an empty path no file is written.
  TimingLog(std::string path, std::map<std::int32_t, TimingRow> kept);

  void add(const TimingRow& row);  // appends and flushes
  void finish();                   // rewrites the file, sorted by frame

 private:
  struct Close {
    void operator()(std::FILE* file) const noexcept { std::fclose(file); }
  };
  [[nodiscard]] std::string text() const;

  std::string path_;
  std::map<std::int32_t, TimingRow> rows_;
  std::unique_ptr<std::FILE, Close> file_;
};

}  // namespace gazetrace
