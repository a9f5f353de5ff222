// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "gazetrace/scene.hpp"

namespace gazetrace {

// Throws Error(input), which says what was left out, where nothing of the scene can be seen.
void check_scene_shows(const Scene& scene);

// Whether anything in it does.
bool moves(const Scene& scene);

}  // namespace gazetrace
