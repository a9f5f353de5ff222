// SPDX-License-Identifier: Apache-2.0
// Picture files in and out; the only door to OpenImageIO. (EXR frames are written by output/exr.)
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "gazetrace/image.hpp"

namespace gazetrace {

// 8 bits a channel, RGBA interleaved, unassociated alpha, rows from the top.
struct ImageRgba8 {
  int width_px = 0, height_px = 0;
  std::vector<std::uint8_t> rgba;
  bool has_alpha = false;         // some pixel is not opaque
  bool reduced_to_8_bit = false;  // the file holds more than 8 bits a channel
};

// Grey, grey with alpha, RGB and RGBA all become RGBA; values stay encoded as in the file. Error(input) at `place`.
ImageRgba8 read_image_rgba8(const std::string& path, const std::string& place);
// The same from a file's bytes in memory.
ImageRgba8 read_image_rgba8(std::span<const std::uint8_t> file_bytes, const std::string& place);

// Linear floats of an .hdr, .exr or other picture; grey is repeated into RGB, alpha and further channels are left out.
ImageRgb read_image_rgb_float(const std::string& path);

}  // namespace gazetrace
