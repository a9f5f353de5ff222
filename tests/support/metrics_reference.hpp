// SPDX-License-Identifier: Apache-2.0
// The reference set ../shared/metrics-reference: pictures with the values that the authors' own programs give.
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>

#include "core/image_io.hpp"
#include "gazetrace/fovvideovdp.hpp"
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

// The display of an entry.
inline FovVideoVdpGeometry geometry_of(const nlohmann::json& values) {
  const int width = values["resolution"][0];
  const int height = values["resolution"][1];
  const double distance_m = values["distance_m"];
  if (values.contains("diagonal_size_inches")) {
    return geometry_from_diagonal(width, height, values["diagonal_size_inches"], distance_m);
  }
  if (values.contains("fov_horizontal")) {
    return geometry_from_horizontal_fov(width, height, values["fov_horizontal"], distance_m);
  }
  return geometry_from_diagonal_fov(width, height, values["fov_diagonal"], distance_m);
}

}  // namespace gazetrace

#define GAZETRACE_SKIP_WITHOUT_METRICS_REFERENCE()                                         \
  if (!std::filesystem::exists(gazetrace::metrics_reference_folder() / "expected.json")) { \
    GTEST_SKIP() << gazetrace::metrics_reference_folder() << " is not here";               \
  }
