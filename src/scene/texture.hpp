// SPDX-License-Identifier: Apache-2.0
// Makes a texture with all its mip levels from a decoded picture.
#pragma once

#include "core/image_io.hpp"
#include "gazetrace/scene.hpp"

namespace gazetrace {

enum class TextureUse : std::uint8_t {
  color,   // sRGB; averaged in linear light, weighted by alpha so that transparent texels do not bleed in
  data,    // averaged as stored
  normal,  // averaged as vectors and normalised
};

// Makes levels down to 1 x 1, each half the size of the one before (rounded down) and averaged exactly over the area
// that a texel covers. Every level is made from the unrounded values of the one before.
Texture make_texture(ImageRgba&& image, TextureUse use);

}  // namespace gazetrace
