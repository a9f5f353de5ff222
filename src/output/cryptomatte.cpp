// SPDX-License-Identifier: Apache-2.0
#include "gazetrace/cryptomatte.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <map>
#include <nlohmann/json.hpp>

#include "gazetrace/error.hpp"

namespace gazetrace {
namespace {

// A block of four bytes, lowest first, scrambled before it enters the hash.
std::uint32_t scrambled(std::uint32_t block) {
  return std::rotl(block * 0xcc9e2d51U, 15) * 0x1b873593U;
}

std::uint32_t byte_at(std::string_view bytes, std::size_t i) {
  return static_cast<unsigned char>(bytes[i]);
}

std::string name_of_material(const Scene& scene, std::size_t index) {
  const std::string& name = scene.materials[index].name;
  return name.empty() ? fmt::format("#{}", index) : name;
}

std::vector<std::string> names_of(const Scene& scene, const std::string& layer) {
  std::vector<std::string> names;
  if (layer == "crypto_material") {
    for (std::size_t i = 0; i < scene.materials.size(); ++i) {
      names.push_back(name_of_material(scene, i));
    }
    return names;
  }
  for (std::size_t i = 0; i < scene.instances.size(); ++i) {
    const Instance& instance = scene.instances[i];
    const std::string& name = layer == "crypto_asset" && !instance.asset.empty() ? instance.asset : instance.node;
    names.push_back(name.empty() ? fmt::format("#{}", i) : name);
  }
  return names;
}

}  // namespace

std::uint32_t murmur3_32(std::string_view bytes, std::uint32_t seed) {
  std::uint32_t hash = seed;
  std::size_t at = 0;
  for (; at + 4 <= bytes.size(); at += 4) {
    const std::uint32_t block = byte_at(bytes, at) | byte_at(bytes, at + 1) << 8U | byte_at(bytes, at + 2) << 16U |
                                byte_at(bytes, at + 3) << 24U;
    hash = std::rotl(hash ^ scrambled(block), 13) * 5U + 0xe6546b64U;
  }
  std::uint32_t rest = 0;
  for (std::size_t i = bytes.size(); i > at; --i) {
    rest = rest << 8U | byte_at(bytes, i - 1);
  }
  if (at < bytes.size()) {
    hash ^= scrambled(rest);
  }
  hash ^= static_cast<std::uint32_t>(bytes.size());
  hash = (hash ^ hash >> 16U) * 0x85ebca6bU;
  hash = (hash ^ hash >> 13U) * 0xc2b2ae35U;
  return hash ^ hash >> 16U;
}

std::uint32_t cryptomatte_id(std::string_view name) {
  const std::uint32_t hash = murmur3_32(name);
  const std::uint32_t exponent = hash >> 23U & 0xffU;
  return exponent == 0 || exponent == 0xffU ? hash ^ 1U << 23U : hash;
}

const std::vector<std::string>& cryptomatte_layers() {
  static const std::vector<std::string> kLayers{"crypto_object", "crypto_material", "crypto_asset"};
  return kLayers;
}

MatteTable matte_table(const Scene& scene, const std::string& layer) {
  const std::vector<std::string>& layers = cryptomatte_layers();
  if (std::find(layers.begin(), layers.end(), layer) == layers.end()) {
    throw Error(ErrorKind::usage, "", unknown_name_message("Cryptomatte layer", layer, layers));
  }
  MatteTable table;
  table.layer = layer;
  table.surfaces.by_material = layer == "crypto_material";
  std::map<std::string, std::string> manifest;
  for (const std::string& name : names_of(scene, layer)) {
    const std::uint32_t id = cryptomatte_id(name);
    table.surfaces.ids.push_back(id);
    manifest[name] = fmt::format("{:08x}", id);
  }
  table.manifest = nlohmann::json(manifest).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
  return table;
}

std::vector<std::pair<std::string, std::string>> cryptomatte_attributes(const MatteTable& table) {
  // The specification keeps these names short, since older files allow 31 letters.
  const std::string key = "cryptomatte/" + fmt::format("{:08x}", cryptomatte_id(table.layer)).substr(0, 7) + "/";
  return {{key + "name", table.layer},
          {key + "hash", "MurmurHash3_32"},
          {key + "conversion", "uint32_to_float32"},
          {key + "manifest", table.manifest}};
}

}  // namespace gazetrace
