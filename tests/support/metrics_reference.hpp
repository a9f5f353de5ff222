// SPDX-License-Identifier: Apache-2.0
// The reference set ../shared/metrics-reference: pictures with the values that the authors' own programs give.
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>

#include "core/image_io.hpp"
#include "gazetrace/metrics.hpp"

namespace gazetrace {

inline std::filesystem::path metrics_reference_folder() {
  return std::filesystem::path(GAZETRACE_SHARED_DIR) / "metrics-reference";
}

inline nlohmann::json read_reference_json(const std::string& name) {
  std::ifstream file(metrics_reference_folder() / name);
  return nlohmann::json::parse(file);
}

// 8-bit code values as floats.
inline ImageRgb reference_code(const std::string& path) {
  return read_picture((metrics_reference_folder() / path).string()).rgb;
}

}  // namespace gazetrace

#define GAZETRACE_SKIP_WITHOUT_METRICS_REFERENCE()                                         \
  if (!std::filesystem::exists(gazetrace::metrics_reference_folder() / "expected.json")) { \
    GTEST_SKIP() << gazetrace::metrics_reference_folder() << " is not here";               \
  }
