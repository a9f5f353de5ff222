// SPDX-License-Identifier: Apache-2.0
#include "scene/open_scene.hpp"

#include "core/data_root.hpp"
#include "gazetrace/error.hpp"
#include "scene/gltf/accessor.hpp"
#include "scene/gltf/animation.hpp"
#include "scene/gltf/estimate.hpp"

namespace gazetrace {

std::uint64_t memory_limit(const SceneReadOptions& options) {
  return options.memory_bytes > 0 ? options.memory_bytes : most_memory_bytes();
}

OpenScene open_scene(const std::string& path, const SceneReadOptions& options) {
  OpenScene scene;
  const std::uint64_t memory_bytes = memory_limit(options);
  check_file_memory(path, memory_bytes);
  scene.file = read_gltf_file(path);
  if (!options.allow_outside) {
    scene.file.roots = data_roots(path);
  }
  check_json_memory(path, scene.file.bytes.size(), scene.file.json, memory_bytes);
  scene.checked = check_gltf_json(path, scene.file.json, memory_bytes);
  scene.document = parse_gltf(path, scene.checked);
  scene.document.data_roots = scene.file.roots;
  if (!options.animation.empty()) {
    keep_animation(scene.document, options.animation);
  }
  check_gltf_ranges(scene.document, scene.checked.buffers);
  return scene;
}

std::vector<std::span<const std::uint8_t>> load_buffers(const GltfFile& file,
                                                        const std::vector<GltfBufferSource>& sources,
                                                        std::vector<std::vector<std::uint8_t>>& storage) {
  std::vector<std::span<const std::uint8_t>> buffers;
  storage.reserve(sources.size());
  for (std::size_t i = 0; i < sources.size(); ++i) {
    const GltfBufferSource& source = sources[i];
    const std::string place = file.path + ": buffers[" + std::to_string(i) + "]";
    std::span<const std::uint8_t> bytes;
    if (!source.uri.empty()) {
      storage.push_back(is_data_uri(source.uri) ? decode_data_uri(source.uri, place)
                                                : read_bytes(resolve_uri(file.path, file.roots, source.uri, place),
                                                             place, source.byte_length));
      bytes = storage.back();
    } else if (i == 0 && file.is_binary && !source.fallback) {
      bytes = file.bin_chunk;
    } else {
      buffers.emplace_back();  // no data; it is an error only where something reads from it
      continue;
    }
    if (bytes.size() < source.byte_length) {
      throw Error(ErrorKind::input, place,
                  "byteLength says " + std::to_string(source.byte_length) + ", there are " +
                      std::to_string(bytes.size()) + " bytes",
                  "the file is incomplete; copy or export it again");
    }
    buffers.push_back(bytes.first(source.byte_length));
  }
  return buffers;
}

}  // namespace gazetrace
