// SPDX-License-Identifier: Apache-2.0
// Synthetic gaze logs that are written to files and read again.
#pragma once

#include <gtest/gtest.h>

#include <string>
#include <string_view>

#include "gazetrace/gaze.hpp"
#include "support/text_file.hpp"

namespace gazetrace {

class GazeFormats : public ::testing::Test {
 protected:
  GazeLog read(std::string_view name, std::string_view text, const GazeReadOptions& options = {}) {
    return load_gaze_log(files_.write(name, text), options);
  }
  std::string refusal(std::string_view name, std::string_view text, const GazeReadOptions& options = {}) {
    return refusal_of(files_.write(name, text), options);
  }
  static std::string refusal_of(const std::string& path, const GazeReadOptions& options = {}) {
    try {
      load_gaze_log(path, options);
    } catch (const Error& error) {
      return error.what();
    }
    return "accepted";
  }
  void put(std::string_view name, std::string_view text) { ASSERT_FALSE(files_.write(name, text).empty()); }
  TextFiles files_;
};

// An EyeLink file of one block on a screen of 1920 x 1080, from its SAMPLES line and its rows.
inline std::string asc(const std::string& samples_line, const std::string& rows) {
  return "** CONVERTED FROM a.edf using edfapi\n** EYELINK II 1\nMSG\t1 GAZE_COORDS 0 0 1919 1079\n"
         "START\t100 \tLEFT\tSAMPLES\tEVENTS\nPUPIL\tDIAMETER\n" +
         samples_line + "\n" + rows + "END\t200 \tSAMPLES\tEVENTS\tRES\t 40\t 40\n";
}

}  // namespace gazetrace
