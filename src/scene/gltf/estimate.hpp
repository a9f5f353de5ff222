// SPDX-License-Identifier: Apache-2.0
// What a document will take in memory, reckoned before it is loaded.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "gazetrace/scene.hpp"
#include "scene/gltf/document.hpp"
#include "scene/gltf/file.hpp"
#include "scene/gltf/material.hpp"

namespace gazetrace {

// The document's node, its places in the world, and what parsing took.
inline constexpr std::uint64_t kNodeBytes = 1200;

// All but pictures, from the counts that the JSON states and the sizes of the files.
SceneEstimate estimate_geometry(const GltfFile& file, const CheckedGltf& checked, const GltfDocument& document);
// Error(input) at `path` where the file alone would take more than the limit, before it is read.
void check_file_memory(const std::string& path, std::uint64_t memory_bytes);
// Error(input) at `path` where the JSON would take more than the limit while it is parsed, before it is.
void check_json_memory(const std::string& path, std::uint64_t file_bytes, std::string_view json,
                       std::uint64_t memory_bytes);
// Adds the pictures that the table would decode, by their headers.
void add_pictures(const TextureTable& textures, int threads, SceneEstimate& estimate);

// Error(input) at `path` where the estimate is above the limit.
void check_memory(const SceneEstimate& estimate, std::uint64_t memory_bytes, const std::string& path);

}  // namespace gazetrace
