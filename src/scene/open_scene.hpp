// SPDX-License-Identifier: Apache-2.0
// A scene's file as a checked document, before anything is made of it.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "gazetrace/scene.hpp"
#include "scene/gltf/document.hpp"
#include "scene/gltf/file.hpp"

namespace gazetrace {

// A document before its buffers are read.
struct OpenScene {
  GltfFile file;
  CheckedGltf checked;
  GltfDocument document;
};
// SceneReadOptions::memory_bytes, or what stands for 0.
std::uint64_t memory_limit(const SceneReadOptions& options);
OpenScene open_scene(const std::string& path, const SceneReadOptions& options);

// The bytes of all buffers; `storage` owns those that are not in the .glb itself.
std::vector<std::span<const std::uint8_t>> load_buffers(const GltfFile& file,
                                                        const std::vector<GltfBufferSource>& sources,
                                                        std::vector<std::vector<std::uint8_t>>& storage);

}  // namespace gazetrace
