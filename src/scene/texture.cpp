// SPDX-License-Identifier: Apache-2.0
#include "scene/texture.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <optional>
#include <tuple>
#include <utility>
#include <vector>

#include "core/half.hpp"
#include "core/srgb.hpp"
#include "scene/texel.hpp"

namespace gazetrace {
namespace {

// A texel while levels are made. For colours: linear RGB times a weight, and the weight; else the stored values, 0..1.
using Texel = Vec4f;

// The weight of transparent texels. It keeps the colour of wholly transparent areas, and is negligible against that of
// any visible texel.
constexpr float kLeastWeight = 1.0F / 65536.0F;

float linear_to_srgb(float linear) {
  return linear <= 0.0031308F ? 12.92F * linear : 1.055F * std::pow(linear, 1.0F / 2.4F) - 0.055F;
}

std::uint8_t to_byte(float value) {
  const float scaled = std::clamp(value, 0.0F, 1.0F) * 255.0F;
  return static_cast<std::uint8_t>(scaled + 0.5F);  // NOLINT(bugprone-incorrect-roundings): never negative
}

struct SrgbTables {
  static constexpr std::size_t kEncodeSteps = 1U << 14U;
  std::array<float, 256> decode{};
  std::array<std::uint8_t, kEncodeSteps + 1> encode{};
  SrgbTables() {
    for (std::size_t i = 0; i < decode.size(); ++i) {
      decode[i] = light_of_srgb(static_cast<float>(i) / 255.0F);
    }
    for (std::size_t i = 0; i < encode.size(); ++i) {
      const float encoded = linear_to_srgb(static_cast<float>(i) / static_cast<float>(kEncodeSteps));
      encode[i] = to_byte(encoded);
    }
  }
};
const SrgbTables& srgb_tables() {
  static const SrgbTables tables;
  return tables;
}

Texel decode_texel(const std::uint8_t* p, TextureUse use, const SrgbTables& tables) {
  if (use == TextureUse::color) {
    const float weight = std::max(static_cast<float>(p[3]) / 255.0F, kLeastWeight);
    return {tables.decode[p[0]] * weight, tables.decode[p[1]] * weight, tables.decode[p[2]] * weight, weight};
  }
  constexpr float kScale = 1.0F / 255.0F;
  return {static_cast<float>(p[0]) * kScale, static_cast<float>(p[1]) * kScale, static_cast<float>(p[2]) * kScale,
          static_cast<float>(p[3]) * kScale};
}

// The unit normal for a stored one, whose components are 0..1.
Vec3f unit_normal(const Vec3f& v) {
  const Vec3f signed_v = v * 2.0F - Vec3f{1, 1, 1};
  const float len = length(signed_v);
  return len > 1e-6F ? (signed_v / len + Vec3f{1, 1, 1}) * 0.5F : v;
}

void encode_texel(const Texel& texel, TextureUse use, const SrgbTables& tables, std::uint8_t* p) {
  if (use == TextureUse::color) {
    const float scale = static_cast<float>(SrgbTables::kEncodeSteps) / texel.w;
    const auto encode = [&](float weighted) {
      const auto step = static_cast<std::size_t>(weighted * scale + 0.5F);  // NOLINT(bugprone-incorrect-roundings)
      return tables.encode[std::min(step, SrgbTables::kEncodeSteps)];
    };
    p[0] = encode(texel.x);
    p[1] = encode(texel.y);
    p[2] = encode(texel.z);
    p[3] = texel.w <= kLeastWeight ? std::uint8_t{0} : to_byte(texel.w);
    return;
  }
  Vec3f v{texel.x, texel.y, texel.z};
  if (use == TextureUse::normal) {
    v = unit_normal(v);
  }
  p[0] = to_byte(v.x);
  p[1] = to_byte(v.y);
  p[2] = to_byte(v.z);
  p[3] = to_byte(texel.w);
}

// The texels of a level that one texel of the next coarser level covers; up to three, since sizes are halved and
// rounded down.
struct Taps {
  int first = 0, count = 1;
  std::array<float, 3> weights{1, 0, 0};
};

std::vector<Taps> box_taps(int from, int to) {
  std::vector<Taps> all(static_cast<std::size_t>(to));
  const double width = static_cast<double>(from) / to;
  for (int i = 0; i < to; ++i) {
    Taps& taps = all[static_cast<std::size_t>(i)];
    const double begin = i * width;
    const double end = (i + 1) * width;
    taps.first = static_cast<int>(begin);
    taps.count = std::min({3, static_cast<int>(std::ceil(end - 1e-9)) - taps.first, from - taps.first});
    for (int k = 0; k < taps.count; ++k) {
      const double overlap = std::min<double>(end, taps.first + k + 1) - std::max<double>(begin, taps.first + k);
      taps.weights[static_cast<std::size_t>(k)] = static_cast<float>(overlap / width);
    }
  }
  return all;
}

void add_weighted(Texel& sum, const Texel& texel, float weight) {
  sum.x += weight * texel.x;
  sum.y += weight * texel.y;
  sum.z += weight * texel.z;
  sum.w += weight * texel.w;
}

// Makes one level from the next finer one, whose texels `read(x, y)` returns.
template <class Read>
std::vector<Texel> halved(int width, int height, int half_width, int half_height, Read read) {
  std::vector<Texel> texels;
  texels.reserve(static_cast<std::size_t>(half_width) * static_cast<std::size_t>(half_height));
  if (width == 2 * half_width && height == 2 * half_height) {  // the usual case: the mean of four texels
    for (int y = 0; y < half_height; ++y) {
      for (int x = 0; x < half_width; ++x) {
        Texel sum{0, 0, 0, 0};
        add_weighted(sum, read(2 * x, 2 * y), 0.25F);
        add_weighted(sum, read(2 * x + 1, 2 * y), 0.25F);
        add_weighted(sum, read(2 * x, 2 * y + 1), 0.25F);
        add_weighted(sum, read(2 * x + 1, 2 * y + 1), 0.25F);
        texels.push_back(sum);
      }
    }
    return texels;
  }
  const std::vector<Taps> rows = box_taps(height, half_height);
  const std::vector<Taps> columns = box_taps(width, half_width);
  for (const Taps& row : rows) {
    for (const Taps& column : columns) {
      Texel sum{0, 0, 0, 0};
      for (int j = 0; j < row.count; ++j) {
        for (int i = 0; i < column.count; ++i) {
          add_weighted(sum, read(column.first + i, row.first + j),
                       row.weights[static_cast<std::size_t>(j)] * column.weights[static_cast<std::size_t>(i)]);
        }
      }
      texels.push_back(sum);
    }
  }
  return texels;
}

// Reads texels of an 8-bit picture, and stores texels of a level.
struct Codec8 {
  const std::vector<std::uint8_t>& bytes;
  TextureUse use;
  const SrgbTables& tables;

  static constexpr TexelFormat format() { return TexelFormat::unorm8; }
  [[nodiscard]] Texel read(std::size_t i) const { return decode_texel(&bytes[4 * i], use, tables); }
  void store(const Texel& texel, std::uint8_t* to) const { encode_texel(texel, use, tables, to); }
};

struct DeepCodec {
  const std::vector<float>& floats;
  TextureUse use;
  bool is_linear;  // otherwise colours are sRGB-encoded

  [[nodiscard]] TexelFormat format() const {
    return is_linear || use == TextureUse::color ? TexelFormat::half : TexelFormat::unorm16;
  }
  [[nodiscard]] Texel read(std::size_t i) const {
    const float* p = &floats[4 * i];
    if (use != TextureUse::color) {
      return {p[0], p[1], p[2], p[3]};
    }
    const float weight = std::max(std::min(p[3], 1.0F), kLeastWeight);
    const auto light = [&](float v) { return std::max(is_linear ? v : light_of_srgb(v), 0.0F) * weight; };
    return {light(p[0]), light(p[1]), light(p[2]), weight};
  }
  void store(const Texel& texel, std::uint8_t* to) const {
    Texel value = texel;
    if (use == TextureUse::color) {
      const float scale = 1.0F / texel.w;
      value = {texel.x * scale, texel.y * scale, texel.z * scale, texel.w <= kLeastWeight ? 0.0F : texel.w};
    } else if (use == TextureUse::normal) {
      const Vec3f v = unit_normal({texel.x, texel.y, texel.z});
      value = {v.x, v.y, v.z, texel.w};
    }
    const bool half = format() == TexelFormat::half;
    const auto code = [half](float v) {
      // NOLINTNEXTLINE(bugprone-incorrect-roundings): never negative
      return half ? float_to_half(v) : static_cast<std::uint16_t>(std::clamp(v, 0.0F, 1.0F) * 65535.0F + 0.5F);
    };
    const std::array<std::uint16_t, 4> codes{code(value.x), code(value.y), code(value.z), code(value.w)};
    std::memcpy(to, codes.data(), sizeof codes);
  }
};

template <class Codec>
void add_levels(Texture& texture, const Codec& codec) {
  texture.format = codec.format();
  const std::size_t bytes = texel_bytes(texture.format);
  std::vector<Texel> above;
  while (texture.levels.back().width_px > 1 || texture.levels.back().height_px > 1) {
    const Texture::Level& last = texture.levels.back();
    const int width = last.width_px;
    Texture::Level level;
    level.width_px = std::max(1, width / 2);
    level.height_px = std::max(1, last.height_px / 2);
    const auto at = [width](int x, int y) {
      return static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x);
    };
    std::vector<Texel> texels = texture.levels.size() == 1
                                    ? halved(width, last.height_px, level.width_px, level.height_px,
                                             [&](int x, int y) { return codec.read(at(x, y)); })
                                    : halved(width, last.height_px, level.width_px, level.height_px,
                                             [&](int x, int y) { return above[at(x, y)]; });
    level.rgba.resize(texels.size() * bytes);
    for (std::size_t i = 0; i < texels.size(); ++i) {
      codec.store(texels[i], &level.rgba[bytes * i]);
    }
    texture.levels.push_back(std::move(level));
    above = std::move(texels);
  }
}

}  // namespace

Texture make_texture(ImageRgba&& image, TextureUse use) {
  Texture texture;
  texture.has_alpha = image.has_alpha;
  texture.levels.push_back({image.width_px, image.height_px, {}});
  if (image.floats.empty()) {
    texture.srgb = use == TextureUse::color;
    add_levels(texture, Codec8{image.bytes, use, srgb_tables()});
    texture.levels[0].rgba = std::move(image.bytes);
    return texture;
  }
  const std::optional<RgbMatrix> to_rec709 = matrix_to_rec709(image.primaries.value_or(kRec709));
  for (std::size_t i = 0; to_rec709 && use == TextureUse::color && i < image.floats.size(); i += 4) {
    float* const v = &image.floats[i];
    const Vec3f rgb = transformed(*to_rec709, {v[0], v[1], v[2]});
    std::tie(v[0], v[1], v[2]) = std::tie(rgb.x, rgb.y, rgb.z);
  }
  const DeepCodec codec{image.floats, use, image.is_linear};
  // On level 0, normals keep the length that they have in the picture.
  const DeepCodec first{image.floats, use == TextureUse::normal ? TextureUse::data : use, image.is_linear};
  const std::size_t bytes = texel_bytes(codec.format());
  texture.levels[0].rgba.resize(image.floats.size() / 4 * bytes);
  for (std::size_t i = 0; i < image.floats.size() / 4; ++i) {
    first.store(first.read(i), &texture.levels[0].rgba[bytes * i]);
  }
  add_levels(texture, codec);
  return texture;
}

}  // namespace gazetrace
