// SPDX-License-Identifier: Apache-2.0
// KHR_draco_mesh_compression with the Draco library, which only this file uses.
#include <draco/compression/decode.h>

#include <algorithm>
#include <cstring>
#include <exception>
#include <memory>
#include <new>
#include <span>
#include <utility>

#include "gazetrace/error.hpp"
#include "scene/gltf/accessor.hpp"
#include "scene/gltf/compression.hpp"
#include "scene/gltf/constants.hpp"
#include "scene/gltf/document.hpp"
#include "scene/gltf/draco_claims.hpp"
#include "scene/parallel_errors.hpp"

namespace gazetrace {
namespace {

[[noreturn]] void fail(const std::string& place, const std::string& problem) {
  throw Error(ErrorKind::input, place, problem, "compress the file again");
}

// A new accessor with its bytes.
struct Plain {
  GltfAccessor accessor;
  std::vector<std::uint8_t> bytes;
};

struct PlainPrimitive {
  Plain indices;
  std::map<std::string, Plain> attributes;
};

std::unique_ptr<draco::Mesh> decode(std::span<const std::uint8_t> bytes, const std::string& place) {
  draco::DecoderBuffer buffer;
  buffer.Init(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  std::string reason;
  try {
    const auto type = draco::Decoder::GetEncodedGeometryType(&buffer);
    if (!type.ok() || type.value() != draco::TRIANGULAR_MESH) {
      fail(place, "the compressed bytes are no Draco mesh");
    }
    draco::Decoder decoder;
    auto mesh = decoder.DecodeMeshFromBuffer(&buffer);
    if (mesh.ok()) {
      return std::move(mesh).value();
    }
    reason = mesh.status().error_msg_string();
  } catch (const Error&) {
    throw;
  } catch (const std::bad_alloc&) {
    reason = "there is no memory for the sizes that they state";
  } catch (const std::exception& error) {
    reason = error.what();
  }
  fail(place, "the compressed bytes are damaged" + (reason.empty() ? reason : " (" + reason + ")"));
}

template <class T>
bool convert(const draco::PointAttribute& attribute, std::uint32_t points, std::size_t components,
             std::vector<std::uint8_t>& out) {
  out.resize(points * components * sizeof(T));
  std::vector<T> element(components);
  for (std::uint32_t i = 0; i < points; ++i) {
    const draco::AttributeValueIndex at = attribute.mapped_index(draco::PointIndex(i));
    if (at.value() >= attribute.size() ||
        !attribute.ConvertValue<T>(at, static_cast<std::int8_t>(components), element.data())) {
      return false;
    }
    std::memcpy(&out[i * components * sizeof(T)], element.data(), components * sizeof(T));
  }
  return true;
}

bool convert_to(int component_type, const draco::PointAttribute& attribute, std::uint32_t points,
                std::size_t components, std::vector<std::uint8_t>& out) {
  switch (component_type) {
    case kByte:
      return convert<std::int8_t>(attribute, points, components, out);
    case kUnsignedByte:
      return convert<std::uint8_t>(attribute, points, components, out);
    case kShort:
      return convert<std::int16_t>(attribute, points, components, out);
    case kUnsignedShort:
      return convert<std::uint16_t>(attribute, points, components, out);
    case kUnsignedInt:
      return convert<std::uint32_t>(attribute, points, components, out);
    default:
      return convert<float>(attribute, points, components, out);
  }
}

Plain unpack_attribute(const GltfDocument& document, const draco::Mesh& mesh, int declared, std::uint64_t unique_id,
                       const std::string& place) {
  Plain plain{document.accessors[static_cast<std::size_t>(declared)], {}};
  GltfAccessor& accessor = plain.accessor;
  const draco::PointAttribute* attribute = mesh.GetAttributeByUniqueId(static_cast<std::uint32_t>(unique_id));
  if (attribute == nullptr) {
    fail(place, "the compressed mesh has no attribute with the id " + std::to_string(unique_id));
  }
  if (accessor.count != mesh.num_points()) {
    fail(place, "accessors[" + std::to_string(declared) + "] has a count of " + std::to_string(accessor.count) +
                    ", the compressed mesh has " + std::to_string(mesh.num_points()) + " points");
  }
  if (attribute->num_components() != accessor.components) {
    fail(place, "accessors[" + std::to_string(declared) + "] has " + std::to_string(accessor.components) +
                    " components, the compressed attribute has " + std::to_string(attribute->num_components()));
  }
  if (!convert_to(accessor.component_type, *attribute, mesh.num_points(), static_cast<std::size_t>(accessor.components),
                  plain.bytes)) {
    fail(place, "the compressed attribute cannot be read as accessors[" + std::to_string(declared) + "] requires");
  }
  return plain;
}

Plain unpack_indices(const draco::Mesh& mesh) {
  Plain plain;
  plain.accessor.component_type = kUnsignedInt;
  plain.accessor.count = std::uint64_t{3} * mesh.num_faces();
  plain.bytes.resize(plain.accessor.count * sizeof(std::uint32_t));
  std::size_t at = 0;
  for (std::uint32_t f = 0; f < mesh.num_faces(); ++f) {
    for (const draco::PointIndex& corner : mesh.face(draco::FaceIndex(f))) {
      const std::uint32_t value = corner.value();
      std::memcpy(&plain.bytes[at], &value, sizeof value);
      at += sizeof value;
    }
  }
  return plain;
}

// The memory of a scene is reckoned by its accessors, so a stream must not ask for much more than they have. That it
// has exactly as much is looked at once it is decoded; here, what a stream counts otherwise than accessors do, such as
// vertices at seams, has room.
void check_claims(const GltfDocument& document, const GltfPrimitive& primitive, std::span<const std::uint8_t> bytes,
                  const std::string& place) {
  constexpr std::uint64_t kRoom = 16;
  const auto claims = draco_claims(bytes);
  if (!claims) {
    fail(place, "the compressed bytes are no Draco mesh");
  }
  const auto positions = primitive.attributes.find("POSITION");
  const std::uint64_t vertices = positions == primitive.attributes.end()
                                     ? 0
                                     : document.accessors[static_cast<std::size_t>(positions->second)].count;
  if (std::max(claims->vertices, claims->faces) > kRoom * vertices) {
    fail(place, "the compressed bytes claim " + std::to_string(claims->faces) + " triangles of " +
                    std::to_string(claims->vertices) + " vertices; the accessors have " + std::to_string(vertices) +
                    " vertices");
  }
}

PlainPrimitive unpack(const GltfDocument& document, const DracoPrimitive& packed) {
  const std::string place = document.path + ": meshes[" + std::to_string(packed.mesh) + "].primitives[" +
                            std::to_string(packed.primitive) + "].extensions.KHR_draco_mesh_compression";
  const GltfPrimitive& primitive =
      document.meshes[static_cast<std::size_t>(packed.mesh)].primitives[static_cast<std::size_t>(packed.primitive)];
  if (primitive.mode != kTriangles && primitive.mode != kTriangles + 1) {
    fail(place, "mode " + std::to_string(primitive.mode) + " is neither triangles nor a triangle strip");
  }
  const std::span<const std::uint8_t> bytes = view_bytes(document, packed.buffer_view, place);
  check_claims(document, primitive, bytes, place);
  const auto mesh = decode(bytes, place);
  PlainPrimitive plain;
  plain.indices = unpack_indices(*mesh);
  if (plain.indices.accessor.count == 0) {
    fail(place, "the compressed mesh has no triangles");
  }
  for (const auto& [name, unique_id] : packed.attributes) {
    std::string attribute_place = place;
    attribute_place.append(".attributes.").append(name);
    plain.attributes[name] =
        unpack_attribute(document, *mesh, primitive.attributes.at(name), unique_id, attribute_place);
  }
  return plain;
}

}  // namespace

void unpack_draco(GltfDocument& document, const std::vector<DracoPrimitive>& primitives,
                  std::vector<std::vector<std::uint8_t>>& storage, int threads) {
  std::vector<PlainPrimitive> plain(primitives.size());
  parallel_for_first_error(primitives.size(), threads,
                           [&](std::size_t i) { plain[i] = unpack(document, primitives[i]); });
  const auto append = [&](Plain& from) {
    from.accessor.buffer_view = static_cast<int>(document.buffer_views.size());
    from.accessor.offset = 0;
    from.accessor.sparse.reset();
    document.buffer_views.push_back({static_cast<int>(document.buffers.size()), 0, from.bytes.size(), 0});
    storage.push_back(std::move(from.bytes));
    document.buffers.emplace_back(storage.back());
    document.accessors.push_back(from.accessor);
    return static_cast<int>(document.accessors.size()) - 1;
  };
  for (std::size_t i = 0; i < primitives.size(); ++i) {
    GltfPrimitive& primitive = document.meshes[static_cast<std::size_t>(primitives[i].mesh)]
                                   .primitives[static_cast<std::size_t>(primitives[i].primitive)];
    primitive.mode = kTriangles;  // strips are also packed as separate triangles
    primitive.indices = append(plain[i].indices);
    for (auto& [name, attribute] : plain[i].attributes) {
      primitive.attributes[name] = append(attribute);
    }
  }
}

}  // namespace gazetrace
