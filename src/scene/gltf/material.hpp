// SPDX-License-Identifier: Apache-2.0
// Makes materials, and the textures that they need.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <tuple>
#include <vector>

#include "core/image_io.hpp"
#include "gazetrace/scene.hpp"
#include "scene/gltf/document.hpp"
#include "scene/texture.hpp"

namespace gazetrace {

// Assigns indices into Scene::textures, one entry for each picture, sampler and use. Each picture is decoded once,
// however many entries and glTF images share it.
class TextureTable {
 public:
  // `memory_bytes`, `allow_missing`: as SceneReadOptions, the first never 0.
  TextureTable(const GltfDocument& document, std::uint64_t memory_bytes, bool allow_missing)
      : document_(document), limits_{kMostExpansion, memory_bytes / 16, true}, allow_missing_(allow_missing) {}

  // -1, with one warning per glTF texture, where the file names no picture that can be read. Error(input) for one that
  // is missing, unless it may be.
  std::int32_t request(int gltf_texture, TextureUse use, Warnings& warnings);

  [[nodiscard]] std::size_t picture_count() const { return pictures_.size(); }
  // By the headers of the pictures; Error(input) as load().
  [[nodiscard]] std::vector<PictureSize> sizes() const;
  // Decodes everything that was requested so far; `picture_done` is called for each picture, from several threads.
  // Error(input) names the glTF file, the image and the picture file.
  std::vector<Texture> load(int threads, const std::function<void()>& picture_done) const;

 private:
  struct Entry {
    int picture = 0;
    GltfSampler sampler;
    TextureUse use = TextureUse::color;
  };
  struct Picture {
    int image = 0;     // the first glTF image with this picture
    std::string path;  // empty: in the file itself
    std::vector<std::size_t> entries;
  };
  int picture_of_image(int image);
  // `decoded` holds what is written as text, and outlives the input.
  PictureInput input_of(const Picture& picture, const std::string& place, std::vector<std::uint8_t>& decoded) const;

  // Pictures of one colour pack a thousand to one, and small ones may.
  static constexpr double kMostExpansion = 200;

  const GltfDocument& document_;
  PictureLimits limits_;
  bool allow_missing_;
  std::vector<Entry> entries_;
  std::vector<Picture> pictures_;
  std::map<std::tuple<int, int, int, bool, TextureUse>, std::int32_t> known_;
  std::map<std::string, int> picture_by_path_;
  std::map<int, int> picture_by_image_;
  std::map<int, bool> warned_;
  Warnings missing_;  // pictures, of the last request
};

std::vector<Material> make_materials(const GltfDocument& document, TextureTable& textures, Warnings& warnings);

// MASK and BLEND cost a test at every hit. Materials without any transparent texel, vertex or factor become opaque,
// which looks the same.
void drop_needless_alpha(const std::vector<Texture>& textures, const std::vector<Mesh>& meshes,
                         std::vector<Material>& materials);

// The vertex attributes that a material reads.
struct VertexNeeds {
  bool uv0 = false, uv1 = false, tangents = false;
};
VertexNeeds vertex_needs(const Material& material);

}  // namespace gazetrace
