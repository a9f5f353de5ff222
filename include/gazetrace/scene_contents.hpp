// SPDX-License-Identifier: Apache-2.0
// The moving and deforming parts of a scene's file: animations, skins and morph targets. It is read for people who look
// into a file; a Scene (scene.hpp) has these things in the form in which they are rendered.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "gazetrace/scene.hpp"

namespace gazetrace {

struct SceneContents {
  struct Animation {
    std::string name;               // "#0" where the file gives none
    double begin_s = 0, end_s = 0;  // of its first and last keyframe
    std::size_t nodes = 0;          // that it moves, turns or scales
    std::size_t shapes = 0;         // whose morph targets it weights
  };
  struct Skin {
    std::string name;  // "#0" where the file gives none
    std::size_t joints = 0;
  };
  struct MorphedMesh {
    std::string name;                  // "#0" where the file gives none
    std::vector<std::string> targets;  // "#0" where the file names none
  };
  std::vector<Animation> animations;
  std::vector<Skin> skins;
  std::vector<MorphedMesh> morphed;
};

// Error(input) as load_scene().
SceneContents read_scene_contents(const std::string& path, const SceneReadOptions& options = {});

}  // namespace gazetrace
