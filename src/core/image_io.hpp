// SPDX-License-Identifier: Apache-2.0
// Reads and writes picture files; the only way to OpenImageIO, by picture_module.hpp. (EXR frames are written by
// output/exr.)
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "gazetrace/image.hpp"

namespace gazetrace {

// Interleaved RGBA with unassociated alpha, top row first: in `bytes` for files with up to 8 bits per channel, else in
// `floats` (integers as 0..1, floats as they are). The other one is empty.
struct ImageRgba {
  int width_px = 0, height_px = 0;
  std::vector<std::uint8_t> bytes;
  bool has_alpha = false;  // some pixel is not opaque
  std::vector<float> floats;
  bool is_linear = false;  // the file holds floats, which are linear light
};

// What a picture may ask for.
struct PictureLimits {
  // Decoded bytes for each byte of the file, beyond the first `free_bytes`; 0: any number.
  double expansion = 0;
  std::uint64_t free_bytes = 0;
  bool by_memory = false;  // free_bytes is a part of `max-memory`, which a refusal names
};

struct PictureSize {
  int width_px = 0, height_px = 0;
  bool is_deep = false;    // more than 8 bits a channel
  std::uint64_t uses = 1;  // textures that are made of it
};
// From the header alone. Error(input) as the functions below.
PictureSize read_picture_size(const std::string& path, const std::string& place, const PictureLimits& limits = {});
PictureSize read_picture_size(std::span<const std::uint8_t> file_bytes, const std::string& place,
                              const PictureLimits& limits = {});

// Grey, grey with alpha, RGB and RGBA all become RGBA; values stay encoded as in the file. Error(input) that names
// `place`, also for values that are not finite.
ImageRgba read_image_rgba(const std::string& path, const std::string& place, const PictureLimits& limits = {});
// The same from a file's bytes in memory.
ImageRgba read_image_rgba(std::span<const std::uint8_t> file_bytes, const std::string& place,
                          const PictureLimits& limits = {});

// The floats of an .hdr, .exr or other picture; grey is repeated into RGB, alpha and further channels are left out.
ImageRgb read_image_rgb_float(const std::string& path);

struct EncodeOptions {
  int file_bits = 8;       // per channel, in the file: 8, 10 (DPX) or 16
  int quality = 95;        // of JPEG
  bool has_alpha = false;  // pixels are RGBA, with straight alpha
  std::string software;    // the program's name, for the header
  std::string note;        // one line of text for the header, which read_image_note() returns
};
// The bytes of a picture file in the format of `path`'s suffix; nothing is written. `rgb`, or RGBA, is interleaved and
// has `bits` bits (8 or 16) per channel: display code values, which are stored as they are. Error(runtime) that names
// `path`.
std::vector<std::uint8_t> encode_image(const std::string& path, int width_px, int height_px, int bits,
                                       std::span<const std::uint8_t> rgb, const EncodeOptions& options);
// The note; empty where the file cannot be opened or has none.
std::string read_image_note(const std::string& path);

}  // namespace gazetrace
