// SPDX-License-Identifier: Apache-2.0
// From a decoded picture to a texture with all its mip levels.
#pragma once

#include "core/image_io.hpp"
#include "gazetrace/scene.hpp"

namespace gazetrace {

enum class TextureUse : std::uint8_t {
  color,   // sRGB; averaged in linear light, weighted by alpha so that hidden texels do not bleed
  data,    // averaged as stored
  normal,  // averaged as vectors and brought back to unit length
};

// Levels down to 1 x 1, each half the last (rounded down) and averaged exactly over the area it covers. Every level is
// made from the unrounded values of the one above.
Texture make_texture(ImageRgba&& image, TextureUse use);

}  // namespace gazetrace
