// SPDX-License-Identifier: Apache-2.0
// What the further channels of a linear picture hold.
#pragma once

#include <string>
#include <vector>

#include "gazetrace/frame_layers.hpp"

namespace gazetrace {

struct AovInfo {
  std::string name;
  std::string description;  // channels, what they hold, its space and unit
};
// One for each of aov_names() (output.hpp), in the same order.
const std::vector<AovInfo>& aov_infos();

// What the AOVs need beside the frame's picture and its first hits.
struct ExrSettings;
LayerSettings layer_settings(const ExrSettings& exr);

}  // namespace gazetrace
