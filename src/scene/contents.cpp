// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cstdint>
#include <set>
#include <utility>

#include "gazetrace/scene_contents.hpp"
#include "scene/gltf/accessor.hpp"
#include "scene/gltf/animation.hpp"
#include "scene/gltf/compression.hpp"
#include "scene/open_scene.hpp"

namespace gazetrace {
namespace {

std::string named(const std::string& name, std::size_t index) {
  return name.empty() ? "#" + std::to_string(index) : name;
}

SceneContents::Animation animation_of(const GltfDocument& document, std::size_t index) {
  const GltfAnimation& from = document.animations[index];
  SceneContents::Animation to;
  to.name = animation_name(document, index);
  std::set<int> moved;
  std::set<int> shaped;
  bool first = true;
  for (const GltfAnimation::Channel& channel : from.channels) {
    (channel.path == "weights" ? shaped : moved).insert(channel.node);
    if (channel.sampler < 0 || static_cast<std::size_t>(channel.sampler) >= from.samplers.size()) {
      continue;
    }
    const int input = from.samplers[static_cast<std::size_t>(channel.sampler)].input;
    const std::vector<float> times =
        read_floats(document, input, 1, document.path + ": animations[" + std::to_string(index) + "]");
    if (!times.empty()) {
      to.begin_s = first ? times.front() : std::min<double>(to.begin_s, times.front());
      to.end_s = first ? times.back() : std::max<double>(to.end_s, times.back());
      first = false;
    }
  }
  to.nodes = moved.size();
  to.shapes = shaped.size();
  return to;
}

}  // namespace

SceneContents read_scene_contents(const std::string& path, const SceneReadOptions& options) {
  OpenScene open = open_scene(path, options);
  GltfDocument& document = open.document;
  std::vector<std::vector<std::uint8_t>> storage;
  document.buffers = load_buffers(open.file, open.checked.buffers, storage);
  unpack_meshopt(document, open.checked.meshopt_views, storage, options.threads);
  SceneContents contents;
  for (std::size_t i = 0; i < document.animations.size(); ++i) {
    contents.animations.push_back(animation_of(document, i));
  }
  for (std::size_t i = 0; i < document.skins.size(); ++i) {
    contents.skins.push_back({named(document.skins[i].name, i), document.skins[i].joints.size()});
  }
  for (std::size_t i = 0; i < document.meshes.size(); ++i) {
    const GltfMesh& mesh = document.meshes[i];
    std::size_t targets = 0;
    for (const GltfPrimitive& primitive : mesh.primitives) {
      targets = std::max(targets, primitive.targets.size());
    }
    if (targets == 0) {
      continue;
    }
    SceneContents::MorphedMesh morphed{named(mesh.name, i), {}};
    for (std::size_t t = 0; t < targets; ++t) {
      morphed.targets.push_back(named(t < mesh.target_names.size() ? mesh.target_names[t] : std::string(), t));
    }
    contents.morphed.push_back(std::move(morphed));
  }
  return contents;
}

}  // namespace gazetrace
