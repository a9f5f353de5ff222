// SPDX-License-Identifier: Apache-2.0
// The library's one exception type. Library code throws it and never prints or exits; the program catches it once.
#pragma once

#include <cstddef>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace gazetrace {

enum class ErrorKind {
  usage,          // settings that contradict each other or name something unknown; exit code 2
  input,          // a file that is missing, broken or does not fit the rest; exit code 2
  runtime,        // the inputs were right, and something failed later (disk full, out of memory); exit code 3
  nothing_to_do,  // the task has no share of the work; exit code 0
  interrupted,    // it was asked to stop before it was done, and nothing is wrong; exit code 4
};

class Error : public std::runtime_error {
 public:
  // One line is built from three parts: `place` (a file, file:line or setting; may be empty), `problem`, and
  // `remedy` (may be empty): "place: problem; remedy".
  //
  // The library names a *setting* in back quotes, as in "`gaze-start`: the log has no such time"; the names are those
  // of a job's options. The program shows them as its flags: "--gaze-start". The same holds for warnings.
  //
  // Text of a file may be in any of the parts: each is shortened by bounded().
  Error(ErrorKind kind, std::string_view place, std::string_view problem, std::string_view remedy = {});
  [[nodiscard]] ErrorKind kind() const noexcept { return kind_; }

 private:
  ErrorKind kind_;
};

// The text on one line of at most about `most` bytes: control characters, which would reach the user's terminal, become
// spaces, and of a text that is too long the middle is left out, between characters of UTF-8, with a note of how much.
std::string bounded(std::string_view text, std::size_t most = 1000);

// Messages that do not stop the work, one line each. Functions that can warn return them beside their result.
using Warnings = std::vector<std::string>;

// The message for every choice by name: "unknown filter 'linaer'; did you mean 'linear'? Known: linear, none".
std::string unknown_name_message(std::string_view what, std::string_view given, const std::vector<std::string>& known);

}  // namespace gazetrace
