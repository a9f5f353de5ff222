// SPDX-License-Identifier: Apache-2.0
// The further channels of a linear picture.
#pragma once

#include <string>
#include <vector>

#include "gazetrace/frame_layers.hpp"

namespace gazetrace {

struct AovInfo {
  std::string name;
  std::string description;  // channels, their contents, space and unit
};
// One for each of aov_names() (output.hpp), in the same order.
const std::vector<AovInfo>& aov_infos();

// Inputs of the AOVs beside the frame's picture and its first hits.
struct ExrSettings;
LayerSettings layer_settings(const ExrSettings& exr);

}  // namespace gazetrace
