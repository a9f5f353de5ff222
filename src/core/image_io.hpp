// SPDX-License-Identifier: Apache-2.0
// Reads and writes picture files; the only way to OpenImageIO, by picture_module.hpp. (EXR frames are written by
// output/exr.)
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "core/primaries.hpp"
#include "gazetrace/image.hpp"

namespace gazetrace {

// A file, or the bytes of one, which outlive what reads them.
struct PictureInput {
  PictureInput(std::string file) : path(std::move(file)) {}                         // NOLINT: a name is an input
  PictureInput(std::span<const std::uint8_t> file_bytes) : bytes(file_bytes) {}     // NOLINT: so are bytes
  PictureInput(const std::vector<std::uint8_t>& file_bytes) : bytes(file_bytes) {}  // NOLINT
  std::string path;                                                                 // empty: `bytes`
  std::span<const std::uint8_t> bytes;
};

enum class Alpha : std::uint8_t { none, straight, premultiplied };

// How a file is to be understood, whatever its format.
struct PictureFacts {
  int width_px = 0, height_px = 0;  // of the display window
  int x_px = 0, y_px = 0;           // where the display window begins
  bool is_deep = false;             // more than 8 bits a channel
  bool is_linear = false;           // light; otherwise code values of a display
  bool is_half = false;             // half floats, which end at 65504
  bool is_cube_map = false;         // six faces, in whatever order
  bool is_film_scan = false;        // densities of a film, which are neither light nor code values of a display
  Alpha alpha = Alpha::none;
  int orientation = 1;                 // Exif's: 1 is upright, 2 to 8 are what turns the stored raster upright
  std::optional<Primaries> primaries;  // empty: not stated
  std::string part, layer;             // of an EXR, that are the picture; empty: without a name
};

// Interleaved RGBA with unassociated alpha, the raster as it is stored: in `bytes` for files with up to 8 bits per
// channel, else in `floats` (integers as 0..1, floats as they are). The other one is empty.
struct ImageRgba {
  int width_px = 0, height_px = 0;
  std::vector<std::uint8_t> bytes;
  bool has_alpha = false;  // some pixel is not opaque
  std::vector<float> floats;
  bool is_linear = false;              // the file holds floats, which are linear light
  std::optional<Primaries> primaries;  // of the floats, where they are color
};

// What a picture may ask for.
struct PictureLimits {
  // Decoded bytes for each byte of the file, beyond the first `free_bytes`; 0: any number.
  double expansion = 0;
  std::uint64_t free_bytes = 0;
  bool by_memory = false;         // free_bytes is a part of `max-memory`, which a refusal names
  std::uint64_t most_pixels = 0;  // that `max-memory` has room for; 0: any number
};

struct PictureSize {
  int width_px = 0, height_px = 0;
  bool is_deep = false;    // more than 8 bits a channel
  std::uint64_t uses = 1;  // textures that are made of it
};
// From the header alone. Error(input) as the function below.
PictureSize read_picture_size(const PictureInput& input, const std::string& place, const PictureLimits& limits = {});

// Of a texture. Grey, grey with alpha, RGB and RGBA all become RGBA; values stay encoded as in the file. Error(input)
// that names `place`, also for values that are not finite.
ImageRgba read_image_rgba(const PictureInput& input, const std::string& place, const PictureLimits& limits = {});

// A picture that is looked at or gives light: upright, its display window, black where that has no data. Grey is
// repeated; alpha is left out, of code values with color as the file has it.
struct Picture {
  PictureFacts facts;
  ImageRgb rgb;  // linear Rec.709 where facts.is_linear, else code values from 0 to 1
};
// Of one colour or nearly, 8192 x 5461 half floats may come from a few bytes.
inline constexpr PictureLimits kPictureLimits{200, std::uint64_t{256} << 20U, false, 0};
Picture read_picture(const std::string& path, const PictureLimits& limits = kPictureLimits);

// One channel of an EXR as numbers: its only one, or the first that there is of these names.
ImageGray read_picture_channel(const std::string& path, const std::vector<std::string>& names);

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
