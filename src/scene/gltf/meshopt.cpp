// SPDX-License-Identifier: Apache-2.0
// EXT_meshopt_compression with the meshoptimizer library, which only this file uses. Its decoders are safe for any
// bytes; sizes that they only assert are checked before.
#include <meshoptimizer.h>

#include <limits>
#include <span>
#include <utility>

#include "gazetrace/error.hpp"
#include "scene/gltf/compression.hpp"
#include "scene/gltf/document.hpp"
#include "scene/parallel_errors.hpp"

namespace gazetrace {
namespace {

[[noreturn]] void refuse_stream(const std::string& place, const std::string& problem) {
  throw Error(ErrorKind::input, place, problem, "compress the file again");
}

bool is_stride_allowed(const MeshoptView& packed) {
  const std::uint64_t stride = packed.stride;
  if (packed.mode != "ATTRIBUTES") {
    return stride == 2 || stride == 4;
  }
  if (packed.filter == "OCTAHEDRAL") {
    return stride == 4 || stride == 8;
  }
  return packed.filter == "QUATERNION" ? stride == 8 : stride >= 4 && stride <= 256 && stride % 4 == 0;
}

void check(const GltfDocument& document, const MeshoptView& packed, const std::string& place) {
  const bool attributes = packed.mode == "ATTRIBUTES";
  if (!attributes && packed.mode != "TRIANGLES" && packed.mode != "INDICES") {
    refuse_stream(place, "mode '" + packed.mode + "' does not exist");
  }
  const bool filtered = packed.filter != "NONE";
  if (filtered && packed.filter != "OCTAHEDRAL" && packed.filter != "QUATERNION" && packed.filter != "EXPONENTIAL") {
    refuse_stream(place, "filter '" + packed.filter + "' does not exist");
  }
  if (filtered && !attributes) {
    refuse_stream(place, "filter '" + packed.filter + "' is not for mode " + packed.mode);
  }
  if (!is_stride_allowed(packed)) {
    refuse_stream(place, "a byteStride of " + std::to_string(packed.stride) + " is not allowed for mode " +
                             packed.mode + " with filter " + packed.filter);
  }
  if (packed.mode == "TRIANGLES" && packed.count % 3 != 0) {
    refuse_stream(place, "a count of " + std::to_string(packed.count) + " is not a multiple of 3");
  }
  const GltfBufferView& view = document.buffer_views[static_cast<std::size_t>(packed.view)];
  if (packed.count * packed.stride != view.length) {  // count < 2^32, stride <= 256
    refuse_stream(place, std::to_string(packed.count) + " elements of " + std::to_string(packed.stride) +
                             " bytes are not the bufferView's byteLength of " + std::to_string(view.length));
  }
  const std::uint64_t size = document.buffers[static_cast<std::size_t>(packed.buffer)].size();
  if (packed.offset > size || packed.length > size - packed.offset) {
    refuse_stream(place, "bytes " + std::to_string(packed.offset) + " + " + std::to_string(packed.length) +
                             " lie outside buffers[" + std::to_string(packed.buffer) + "] of " + std::to_string(size) +
                             " bytes");
  }
  // The codecs need at least a byte for a triangle or an index, and two bits for 16 equal bytes of attributes. No
  // stream can hold more, so this check keeps a file from asking for memory that it cannot fill.
  const std::uint64_t most = attributes ? packed.length * 64 : packed.length * (packed.mode == "TRIANGLES" ? 3 : 1);
  if ((attributes ? view.length : packed.count) > most) {
    refuse_stream(place,
                  std::to_string(packed.length) + " bytes cannot hold " + std::to_string(packed.count) + " elements");
  }
}

std::vector<std::uint8_t> unpack(const GltfDocument& document, const MeshoptView& packed, const std::string& place) {
  const std::span<const std::uint8_t> bytes =
      document.buffers[static_cast<std::size_t>(packed.buffer)].subspan(packed.offset, packed.length);
  std::vector<std::uint8_t> plain(packed.count * packed.stride);
  const int status =
      packed.count == 0 ? 0
      : packed.mode == "ATTRIBUTES"
          ? meshopt_decodeVertexBuffer(plain.data(), packed.count, packed.stride, bytes.data(), bytes.size())
      : packed.mode == "TRIANGLES"
          ? meshopt_decodeIndexBuffer(plain.data(), packed.count, packed.stride, bytes.data(), bytes.size())
          : meshopt_decodeIndexSequence(plain.data(), packed.count, packed.stride, bytes.data(), bytes.size());
  if (status != 0) {
    refuse_stream(place, "the compressed bytes are damaged");
  }
  if (packed.filter == "OCTAHEDRAL") {
    meshopt_decodeFilterOct(plain.data(), packed.count, packed.stride);
  } else if (packed.filter == "QUATERNION") {
    meshopt_decodeFilterQuat(plain.data(), packed.count, packed.stride);
  } else if (packed.filter == "EXPONENTIAL") {
    meshopt_decodeFilterExp(plain.data(), packed.count, packed.stride);
  }
  return plain;
}

}  // namespace

void unpack_meshopt(GltfDocument& document, const std::vector<MeshoptView>& views,
                    std::vector<std::vector<std::uint8_t>>& storage, int threads) {
  std::vector<std::vector<std::uint8_t>> plain(views.size());
  parallel_for_first_error(views.size(), threads, [&](std::size_t i) {
    const std::string place =
        document.path + ": bufferViews[" + std::to_string(views[i].view) + "].extensions.EXT_meshopt_compression";
    check(document, views[i], place);
    plain[i] = unpack(document, views[i], place);
  });
  for (std::size_t i = 0; i < views.size(); ++i) {
    GltfBufferView& view = document.buffer_views[static_cast<std::size_t>(views[i].view)];
    view.buffer = static_cast<int>(document.buffers.size());
    view.offset = 0;
    storage.push_back(std::move(plain[i]));
    document.buffers.emplace_back(storage.back());
  }
}

}  // namespace gazetrace
