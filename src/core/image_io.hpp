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

// RGBA interleaved, unassociated alpha, rows from the top: `bytes` of files with up to 8 bits a channel, `floats` of
// others (integers as 0..1, floats as they are); the other is empty.
struct ImageRgba {
  int width_px = 0, height_px = 0;
  std::vector<std::uint8_t> bytes;
  bool has_alpha = false;  // some pixel is not opaque
  std::vector<float> floats;
  bool is_linear = false;  // the file holds floats: linear light, not encoded
};

// Grey, grey with alpha, RGB and RGBA all become RGBA; values stay encoded as in the file. Error(input) at `place`,
// also for values that are not finite.
ImageRgba read_image_rgba(const std::string& path, const std::string& place);
// The same from a file's bytes in memory.
ImageRgba read_image_rgba(std::span<const std::uint8_t> file_bytes, const std::string& place);

// Linear floats of an .hdr, .exr or other picture; grey is repeated into RGB, alpha and further channels are left out.
ImageRgb read_image_rgb_float(const std::string& path);

struct EncodeOptions {
  int file_bits = 8;     // a channel, in the file: 8, 10 (DPX) or 16
  int quality = 95;      // JPEG
  int png_level = 1;     // zlib level; measured in tests/benchmarks/color_and_write.cpp
  std::string software;  // who wrote it
  std::string note;      // one line of text that read_image_note() gives back
};
// The bytes of a picture file whose format is that of `path`'s suffix; nothing is written. RGB interleaved, 8 or 16
// bits (`bits`), display code values that are stored as they are. Error(runtime) at `path`.
std::vector<std::uint8_t> encode_image(const std::string& path, int width_px, int height_px, int bits,
                                       std::span<const std::uint8_t> rgb, const EncodeOptions& options);
// The note; empty where the file cannot be opened or has none.
std::string read_image_note(const std::string& path);

}  // namespace gazetrace
