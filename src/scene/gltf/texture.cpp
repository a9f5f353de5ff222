// SPDX-License-Identifier: Apache-2.0
// Chooses the pictures to read, and decodes each of them once.
#include <filesystem>
#include <system_error>
#include <utility>

#include "scene/gltf/accessor.hpp"
#include "scene/gltf/file.hpp"
#include "scene/gltf/material.hpp"
#include "scene/parallel_errors.hpp"

namespace gazetrace {
namespace {

constexpr int kNearest = 9728, kClampToEdge = 33071, kMirroredRepeat = 33648;

TextureWrap wrap_mode(int gl_value) {
  return gl_value == kClampToEdge      ? TextureWrap::clamp
         : gl_value == kMirroredRepeat ? TextureWrap::mirror
                                       : TextureWrap::repeat;
}

std::string image_place(const GltfDocument& document, int image) {
  return document.path + ": images[" + std::to_string(image) + "]";
}

}  // namespace

std::int32_t TextureTable::request(int gltf_texture, TextureUse use, Warnings& warnings) {
  const GltfTexture& texture = document_.textures[static_cast<std::size_t>(gltf_texture)];
  const int picture = texture.source < 0 ? -1 : picture_of_image(texture.source);
  warnings.insert(warnings.end(), missing_.begin(), missing_.end());
  missing_.clear();
  if (picture < 0) {
    if (!std::exchange(warned_[gltf_texture], true)) {
      warnings.push_back("textures[" + std::to_string(gltf_texture) +
                         "] has no picture that can be read; the material is shown without it");
    }
    return -1;
  }
  const GltfSampler sampler =
      texture.sampler < 0 ? GltfSampler{} : document_.samplers[static_cast<std::size_t>(texture.sampler)];
  const auto key = std::make_tuple(picture, static_cast<int>(wrap_mode(sampler.wrap_s)),
                                   static_cast<int>(wrap_mode(sampler.wrap_t)), sampler.mag_filter == kNearest, use);
  const auto [it, is_new] = known_.try_emplace(key, static_cast<std::int32_t>(entries_.size()));
  if (is_new) {
    pictures_[static_cast<std::size_t>(picture)].entries.push_back(entries_.size());
    entries_.push_back({picture, sampler, use});
  }
  return it->second;
}

int TextureTable::picture_of_image(int image) {
  const auto seen = picture_by_image_.find(image);
  if (seen != picture_by_image_.end()) {
    return seen->second;
  }
  const GltfImageSource& source = document_.images[static_cast<std::size_t>(image)];
  int index = -1;
  if (source.buffer_view >= 0 || is_data_uri(source.uri)) {
    index = static_cast<int>(pictures_.size());
    pictures_.push_back({image, "", {}});
  } else if (!source.uri.empty()) {
    const std::string place = image_place(document_, image);
    const bool is_elsewhere = source.uri.find("://") != std::string::npos;  // in the web, or on another machine
    const std::string path =
        is_elsewhere ? bounded(source.uri, 200) : resolve_uri(document_.path, document_.data_roots, source.uri, place);
    std::error_code unknown;
    if (is_elsewhere || !std::filesystem::exists(path, unknown)) {
      if (!allow_missing_) {
        throw Error(ErrorKind::input, place, "there is no picture '" + path + "'",
                    is_elsewhere ? "bring it beside the scene and use its name, or give `allow-missing` to show the "
                                   "scene without it"
                                 : "bring it there, or give `allow-missing` to show the scene without it");
      }
      missing_.push_back(place + ": there is no picture '" + path + "'");
      return picture_by_image_[image] = -1;
    }
    const auto [it, is_new] = picture_by_path_.try_emplace(path, static_cast<int>(pictures_.size()));
    if (is_new) {
      pictures_.push_back({image, path, {}});
    }
    index = it->second;
  }
  picture_by_image_[image] = index;
  return index;
}

PictureInput TextureTable::input_of(const Picture& picture, const std::string& place,
                                    std::vector<std::uint8_t>& decoded) const {
  if (!picture.path.empty()) {
    return picture.path;
  }
  const GltfImageSource& source = document_.images[static_cast<std::size_t>(picture.image)];
  if (source.buffer_view >= 0) {
    return view_bytes(document_, source.buffer_view, place);
  }
  return decoded = decode_data_uri(source.uri, place);
}

std::vector<PictureSize> TextureTable::sizes() const {
  std::vector<PictureSize> sizes;
  for (const Picture& picture : pictures_) {
    const std::string place = image_place(document_, picture.image);
    std::vector<std::uint8_t> decoded;
    sizes.push_back(read_picture_size(input_of(picture, place, decoded), place, limits_));
    sizes.back().uses = picture.entries.size();
  }
  return sizes;
}

std::vector<Texture> TextureTable::load(int threads, const std::function<void()>& picture_done) const {
  std::vector<Texture> textures(entries_.size());
  parallel_for_first_error(pictures_.size(), threads, [&](std::size_t i) {
    const Picture& picture = pictures_[i];
    const std::string place = image_place(document_, picture.image);
    std::vector<std::uint8_t> decoded;
    ImageRgba image = read_image_rgba(input_of(picture, place, decoded), place, limits_);
    const GltfImageSource& source = document_.images[static_cast<std::size_t>(picture.image)];
    std::vector<ImageRgba> images(picture.entries.size() - 1,
                                  image);  // with one entry, the usual case, nothing is copied
    images.push_back(std::move(image));
    for (std::size_t k = 0; k < picture.entries.size(); ++k) {
      const Entry& entry = entries_[picture.entries[k]];
      Texture texture = make_texture(std::move(images[k]), entry.use);
      texture.name = !source.name.empty() ? source.name : is_data_uri(source.uri) ? std::string("data:") : source.uri;
      texture.nearest = entry.sampler.mag_filter == kNearest;
      texture.wrap_u = wrap_mode(entry.sampler.wrap_s);
      texture.wrap_v = wrap_mode(entry.sampler.wrap_t);
      textures[picture.entries[k]] = std::move(texture);
    }
    picture_done();
  });
  return textures;
}

}  // namespace gazetrace
