// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "gazetrace/job_settings.hpp"
#include "gazetrace/scene.hpp"

namespace gazetrace {

// Throws Error(input), which says what was left out, where nothing of the scene can be seen.
void check_scene_shows(const Scene& scene);

// Called before a scene is loaded, which may take long. Throws Error(input) where the environment names a file that
// does not exist.
void check_environment_file(const JobSettings& job);

// Whether anything in it does.
bool moves(const Scene& scene);

}  // namespace gazetrace
