// SPDX-License-Identifier: Apache-2.0
// What a frame has beside its picture: each layer by the pass that finds it.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "gazetrace/frame_layers.hpp"
#include "gazetrace/scene.hpp"

namespace gazetrace {

// nullptr where no layer is named.
std::shared_ptr<const std::vector<MatteTable>> matte_tables(const Scene& scene, const std::vector<std::string>& layers);

}  // namespace gazetrace
