// SPDX-License-Identifier: Apache-2.0
// The record of a run as a file. It is written when the run begins and when it ends, so that a killed run has one, too.
#pragma once

#include <functional>
#include <string>

#include "gazetrace/error.hpp"
#include "gazetrace/output.hpp"

namespace gazetrace {

class RunRecordFile {
 public:
  using Words = std::function<std::string(const std::string& text)>;

  // Keeps what an earlier run has left there. With an empty path nothing is read or written. `words` is
  // RunOptions::words.
  RunRecordFile(std::string path, Words words);

  // Embree and libm choose kernels by the machine: frames of two kinds of machine may differ in their last bits, which
  // is a warning. Two denoisers make other pictures: Error(input).
  void check_machine(const RunRecord& now, Warnings& warnings) const;
  void write(RunRecord record) const;
  // Puts back the record of the earlier run, or none where there was none.
  void put_back() const;

 private:
  std::string path_;
  Words words_;
  std::string earlier_;  // the earlier run's record; empty: there was none
};

}  // namespace gazetrace
