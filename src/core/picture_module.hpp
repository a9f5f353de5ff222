// SPDX-License-Identifier: Apache-2.0
// The border to OpenImageIO. It brings 260 libraries along, which take the loader ten times as long as all the rest
// that the program needs. So whatever calls it (open_image_io.cpp) is a module of its own, `libgazetrace_pictures.so`,
// which is opened when the first picture is read or encoded.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "core/image_io.hpp"

namespace gazetrace {

// A picture that is being read: what its header says, then its pixels.
class PictureReader {
 public:
  virtual ~PictureReader() = default;

  PictureFacts facts;
  std::string format;  // OpenImageIO's name of it
  int depth = 1, channels = 0;
  std::uint64_t decoded_bytes = 0;  // of all pixels, with the file's own channels and depth
  std::string note;

  // The first `count` channels of every pixel, interleaved; what is wrong with them, or nothing.
  virtual std::string read(int count, std::span<std::uint8_t> values) = 0;
  virtual std::string read(int count, std::span<float> values) = 0;
};

// Where a picture is, and how it is to be read. `bytes` outlive the reader.
struct PictureSource {
  const char* format = nullptr;  // OpenImageIO's name of it
  std::string path;              // where `bytes` are empty
  std::span<const std::uint8_t> bytes;
  bool on_one_thread = false;  // since many pictures are read at once
};

// Nothing is thrown but std::bad_alloc.
struct PictureModule {
  const char* build;  // GAZETRACE_PICTURE_MODULE_BUILD of the module
  // Null, and `problem` says why, where it cannot be opened.
  std::unique_ptr<PictureReader> (*open)(const PictureSource& source, std::string& problem);
  // As encode_image(); what went wrong, or nothing.
  std::string (*encode)(const std::string& path, int width_px, int height_px, int bits,
                        std::span<const std::uint8_t> rgb, const EncodeOptions& options,
                        std::vector<std::uint8_t>& file_bytes);
};

// Opens the module the first time, from any thread. Error(runtime) where it is not there, is another build's, or lacks
// one of its own libraries.
const PictureModule& picture_module();

}  // namespace gazetrace
