// SPDX-License-Identifier: Apache-2.0
// Unpacks compressed geometry of a glTF file. Unpacking appends plain buffers, bufferViews and accessors to the
// document and makes the packed ones refer to them, so that the code that reads geometry need not know about
// compression. Every error, also for damaged streams, is an Error(input) with the place in the JSON.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace gazetrace {

struct GltfDocument;

// EXT_meshopt_compression of one bufferView.
struct MeshoptView {
  int view = 0, buffer = 0;
  std::uint64_t offset = 0, length = 0;  // packed
  std::uint64_t stride = 0, count = 0;   // unpacked
  std::string mode, filter;
};

// KHR_draco_mesh_compression of one primitive.
struct DracoPrimitive {
  int mesh = 0, primitive = 0, buffer_view = 0;
  std::map<std::string, std::uint64_t> attributes;  // from names to Draco's unique ids
};

// `storage` owns the unpacked bytes and must outlive the document.
void unpack_meshopt(GltfDocument& document, const std::vector<MeshoptView>& views,
                    std::vector<std::vector<std::uint8_t>>& storage, int threads);
// Component types are converted where accessor and stream differ; a different count is an error.
void unpack_draco(GltfDocument& document, const std::vector<DracoPrimitive>& primitives,
                  std::vector<std::vector<std::uint8_t>>& storage, int threads);

}  // namespace gazetrace
