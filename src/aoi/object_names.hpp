// SPDX-License-Identifier: Apache-2.0
// Gives each pair of node and material a number; 0 is the environment.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "gazetrace/gaze_objects.hpp"

namespace gazetrace {

class ObjectNames {
 public:
  explicit ObjectNames(const Scene& scene) : scene_(scene) { objects_.emplace_back(); }

  std::size_t of(const RayHit& hit) {
    if (hit.object == 0) {
      return 0;
    }
    const auto [known, is_new] = by_hit_.try_emplace({hit.object, hit.material}, 0);
    if (is_new) {
      const SceneObject object{scene_.instances[hit.object - 1].node, scene_.materials[hit.material - 1].name};
      const auto [named, is_new_name] = by_name_.try_emplace({object.node, object.material}, objects_.size());
      if (is_new_name) {
        objects_.push_back(object);
      }
      known->second = named->second;
    }
    return known->second;
  }
  [[nodiscard]] const std::vector<SceneObject>& objects() const { return objects_; }

 private:
  const Scene& scene_;
  std::vector<SceneObject> objects_;
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::size_t> by_hit_;
  std::map<std::pair<std::string, std::string>, std::size_t> by_name_;
};

}  // namespace gazetrace
