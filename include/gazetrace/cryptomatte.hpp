// SPDX-License-Identifier: Apache-2.0
// Cryptomatte, after its specification, version 1.2.0 (Friedman and Jones, Psyop, 2015 to 2018): mattes for everything
// in a picture, as pairs of an identifier and a coverage, and a manifest that gives identifiers their names.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "gazetrace/coverage.hpp"
#include "gazetrace/scene.hpp"

namespace gazetrace {

// MurmurHash3 for 32 bits by Austin Appleby, of the bytes of a text.
std::uint32_t murmur3_32(std::string_view bytes, std::uint32_t seed = 0);
// The identifier of a name: its hash, with the lowest bit of the exponent flipped where the bits, read as a float,
// would be a denormal number, an infinity or not a number. Compositing programs would not keep these.
std::uint32_t cryptomatte_id(std::string_view name);

// The layers that can be asked for, by the names of their AOVs:
//   crypto_object    the node of the scene's file that places a surface, by Instance::node
//   crypto_material  its material; "#3" for material 3 without a name
//   crypto_asset     the outermost named group that the node belongs to, by Instance::asset
// Things of the same name share one matte.
const std::vector<std::string>& cryptomatte_layers();

// The inputs of one layer from the scene, for all of its frames.
struct MatteTable {
  std::string layer;  // one of cryptomatte_layers()
  SurfaceIds surfaces;
  std::string manifest;  // JSON: names, sorted, and their identifiers as eight hexadecimal digits
};
// Error(usage) for an unknown layer.
MatteTable matte_table(const Scene& scene, const std::string& layer);

// The attributes of the EXR's header for a layer: names, which begin with "cryptomatte/" and the first seven digits of
// the layer's own hash, and texts.
std::vector<std::pair<std::string, std::string>> cryptomatte_attributes(const MatteTable& table);

}  // namespace gazetrace
