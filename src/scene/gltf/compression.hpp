// SPDX-License-Identifier: Apache-2.0
// Geometry that a glTF file holds in packed form. Unpacking appends plain buffers, bufferViews and accessors to the
// document and turns the packed ones towards them, so that whoever reads geometry knows nothing of compression.
// Every error is Error(input) with the JSON place; damaged streams never do worse.
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
  std::map<std::string, std::uint64_t> attributes;  // name to Draco's unique id
};

// `storage` owns the unpacked bytes and must outlive the document.
void unpack_meshopt(GltfDocument& document, const std::vector<MeshoptView>& views,
                    std::vector<std::vector<std::uint8_t>>& storage, int threads);
// An accessor whose count differs from the stream's is an error; component types are converted where they differ.
void unpack_draco(GltfDocument& document, const std::vector<DracoPrimitive>& primitives,
                  std::vector<std::vector<std::uint8_t>>& storage, int threads);

}  // namespace gazetrace
