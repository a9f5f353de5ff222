// SPDX-License-Identifier: Apache-2.0
#include "core/image_io.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <memory>
#include <new>
#include <optional>
#include <string_view>
#include <utility>

#include "core/exr_header.hpp"
#include "core/exr_reader.hpp"
#include "core/picture_module.hpp"
#include "core/png_file.hpp"
#include "gazetrace/error.hpp"

namespace gazetrace {
namespace {

constexpr std::string_view kExr = "openexr";  // read by OpenEXR itself
constexpr int kMaxSidePx = 65536;
constexpr std::uint64_t kMaxPixels = std::uint64_t{1} << 30U;        // 4 GiB of bytes, 16 of floats
constexpr std::uint64_t kPixelsOfAnyFile = std::uint64_t{1} << 20U;  // whatever its size
// Environments and pictures to compare: of one colour or nearly, 8192 x 5461 half floats may come from a few bytes.
constexpr PictureLimits kFloatLimits{200, std::uint64_t{256} << 20U};

std::string reason(const std::string& message) {
  return message.empty() ? std::string("not a readable picture") : message;
}

// A picture that is being read, together with the bytes that it is read from.
struct OpenPicture {
  std::vector<std::uint8_t> bytes;
  std::unique_ptr<PictureReader> reader;
  std::string problem;  // why there is no reader
  std::uint64_t file_size = 0;
};

// The most pixels that a byte of a file can stand for, by OpenImageIO's name of the format. PNG: deflate's 1032 bytes
// of 8 pixels each, rounded up; others: more than any real picture has. (Of EXRs core/exr_reader.cpp judges.)
// Formats that are not listed may hold any number of equal pixels.
std::uint64_t most_pixels_a_byte(std::string_view format) {
  constexpr std::array<std::string_view, 3> kOthers{"jpeg", "hdr", "bmp"};
  return format == "png" ? 8448 : std::find(kOthers.begin(), kOthers.end(), format) != kOthers.end() ? 65536 : 0;
}

// Called before any memory is allocated, since the size is only the claim of a header of a few bytes.
PictureReader& check_size(const OpenPicture& picture, const std::string& place, const PictureLimits& limits = {}) {
  PictureReader& reader = *picture.reader;
  const std::string size = std::to_string(reader.width_px) + " x " + std::to_string(reader.height_px);
  if (reader.width_px < 1 || reader.height_px < 1 || reader.channels < 1 || reader.width_px > kMaxSidePx ||
      reader.height_px > kMaxSidePx || reader.depth > 1) {
    throw Error(ErrorKind::input, place,
                "a picture of " + size + " pixels and " + std::to_string(reader.channels) + " channels cannot be used");
  }
  const std::uint64_t pixels =
      static_cast<std::uint64_t>(reader.width_px) * static_cast<std::uint64_t>(reader.height_px);
  if (pixels > kMaxPixels) {
    throw Error(
        ErrorKind::input, place,
        "a picture of " + size + " pixels is too large; at most " + std::to_string(kMaxPixels) + " are possible",
        "make it smaller");
  }
  const std::uint64_t a_byte = most_pixels_a_byte(reader.format);
  if (a_byte > 0 && pixels > kPixelsOfAnyFile + a_byte * picture.file_size) {
    throw Error(ErrorKind::input, place,
                "the picture is damaged: a file of " + std::to_string(picture.file_size) + " bytes cannot hold " +
                    size + " pixels",
                "export it again");
  }
  const auto decoded = static_cast<double>(reader.decoded_bytes);
  const auto allowed =
      static_cast<double>(limits.free_bytes) + limits.expansion * static_cast<double>(picture.file_size);
  if (limits.expansion > 0 && decoded > allowed) {
    throw Error(ErrorKind::input, place,
                "a file of " + std::to_string(picture.file_size) + " bytes unpacks to " +
                    std::to_string(static_cast<std::uint64_t>(decoded) >> 20U) + " MiB; the limit is " +
                    std::to_string(limits.free_bytes >> 20U) + " MiB and " +
                    std::to_string(static_cast<std::uint64_t>(limits.expansion)) + " times the file",
                limits.by_memory ? "make the picture smaller, or raise `max-memory`" : "make it smaller");
  }
  return reader;
}

[[noreturn]] void fail_for_memory(const PictureReader& reader, const std::string& place) {
  throw Error(ErrorKind::runtime, place,
              "there is no memory for a picture of " + std::to_string(reader.width_px) + " x " +
                  std::to_string(reader.height_px) + " pixels",
              "make it smaller");
}

// Makes RGBA from `channels` (1 to 4) channels per pixel; where there are 4 already, the buffer itself is returned.
template <class T>
std::vector<T> to_rgba(std::vector<T>&& pixels, std::size_t count, int channels, T opaque) {
  if (channels == 4) {
    return std::move(pixels);
  }
  std::vector<T> rgba(count * 4);
  const auto step = static_cast<std::size_t>(channels);
  const std::size_t green = channels == 3 ? 1 : 0;
  const std::size_t blue = channels == 3 ? 2 : 0;
  for (std::size_t i = 0; i < count; ++i) {
    const T* from = &pixels[i * step];
    T* to = &rgba[i * 4];
    to[0] = from[0];
    to[1] = from[green];
    to[2] = from[blue];
    to[3] = channels == 2 ? from[1] : opaque;
  }
  return rgba;
}

template <class T>
bool any_transparent(const std::vector<T>& rgba, T opaque) {
  for (std::size_t i = 3; i < rgba.size(); i += 4) {
    if (rgba[i] < opaque) {
      return true;
    }
  }
  return false;
}

void check_read(const std::string& problem, const std::string& place) {
  if (!problem.empty()) {
    throw Error(ErrorKind::input, place, "the picture is damaged: " + problem, "export it again");
  }
}

template <class T>
std::vector<T> read_channels(PictureReader& reader, int channels, T opaque, const std::string& place) {
  const auto count = static_cast<std::size_t>(reader.width_px) * static_cast<std::size_t>(reader.height_px);
  try {
    std::vector<T> pixels(count * static_cast<std::size_t>(channels));
    check_read(reader.read(channels, pixels), place);
    return to_rgba(std::move(pixels), count, channels, opaque);
  } catch (const std::bad_alloc&) {
    fail_for_memory(reader, place);
  }
}

ImageRgba read_rgba(const OpenPicture& picture, const std::string& place, const PictureLimits& limits) {
  PictureReader& reader = check_size(picture, place, limits);
  ImageRgba image;
  image.width_px = reader.width_px;
  image.height_px = reader.height_px;
  const int channels = std::min(reader.channels, 4);
  if (!reader.is_deep) {
    image.bytes = read_channels<std::uint8_t>(reader, channels, 255, place);
    image.has_alpha = channels % 2 == 0 && any_transparent<std::uint8_t>(image.bytes, 255);
    return image;
  }
  image.is_linear = reader.is_linear;
  image.floats = read_channels<float>(reader, channels, 1, place);
  for (std::size_t i = 0; i < image.floats.size(); ++i) {
    if (!std::isfinite(image.floats[i])) {
      const std::size_t pixel = i / 4;
      const auto width = static_cast<std::size_t>(reader.width_px);
      throw Error(ErrorKind::input, place,
                  "pixel " + std::to_string(pixel % width) + ", " + std::to_string(pixel / width) + " is not finite",
                  "repair the picture");
    }
  }
  image.has_alpha = channels % 2 == 0 && any_transparent(image.floats, 1.0F);
  return image;
}

// OpenImageIO chooses a reader by the suffix of the name and, where that one fails, tries all it has: films, raw
// photographs, medical volumes. Here the content decides, and only among the kinds that a picture of ours may be.
const char* format_by_content(std::span<const std::uint8_t> bytes) {
  using namespace std::string_view_literals;
  const std::string_view head(reinterpret_cast<const char*>(bytes.data()), std::min<std::size_t>(bytes.size(), 16));
  struct Magic {
    std::string_view start;
    const char* format;  // OpenImageIO's name of it
  };
  constexpr std::array<Magic, 13> kMagics{{{"\x89PNG\r\n\x1a\n"sv, "png"},
                                           {"\xff\xd8\xff"sv, "jpeg"},
                                           {"#?R"sv, "hdr"},
                                           {"\x76\x2f\x31\x01"sv, kExr.data()},
                                           {"RIFF"sv, "webp"},
                                           {"II*\0"sv, "tiff"},
                                           {"MM\0*"sv, "tiff"},
                                           {"II+\0"sv, "tiff"},
                                           {"MM\0+"sv, "tiff"},
                                           {"SDPX"sv, "dpx"},
                                           {"XPDS"sv, "dpx"},
                                           {"BM"sv, "bmp"},
                                           {"DDS "sv, "dds"}}};
  for (const Magic& magic : kMagics) {
    if (head.starts_with(magic.start)) {
      return magic.format;
    }
  }
  return nullptr;
}

constexpr const char* kNoKnownKind = "it is no picture of a known kind (PNG, JPEG, WebP, TIFF, DPX, EXR, HDR, ...)";

// Textures are read with their alpha beside the color, many at once.
enum class Use { picture, texture };

// `picture.reader` is empty, and `problem` says why, where it cannot be opened. `bytes` must be the picture's own, or
// outlive it; where they are empty, the file is read.
void open_as(OpenPicture& picture, const char* format, const std::string& path, std::span<const std::uint8_t> bytes,
             Use use, const std::string& place) {
  const PictureSource source{format, path, bytes, use == Use::texture, use == Use::texture};
  if (format != kExr) {
    picture.reader = picture_module().open(source, picture.problem);
    return;
  }
  auto reader = std::make_unique<ExrReader>(source, place);
  reader->choose_light();
  picture.reader = std::move(reader);
}

void open_png(OpenPicture& picture, std::span<const std::uint8_t> file_bytes, Use use, const std::string& place) {
  picture.bytes = essential_png(file_bytes, place);
  open_as(picture, "png", {}, picture.bytes, use, place);
}

// Of a PNG all bytes are read, so that its size is held against that of its pixels before: those of the largest depth,
// as if they did not pack at all, and what is written beside them.
void check_size_of_png(std::span<const std::uint8_t> head, std::uint64_t file_size, const std::string& place) {
  constexpr std::size_t kWidthAt = 16;  // big-endian, behind the signature and the length and name of IHDR
  constexpr std::uint64_t kBytesOfAPixel = 16;
  constexpr std::uint64_t kBeside = std::uint64_t{64} << 20U;
  const auto number = [&](std::size_t at) {
    std::uint64_t value = 0;
    for (std::size_t i = at; i < at + 4 && i < head.size(); ++i) {
      value = value << 8U | head[i];
    }
    return value;
  };
  const std::uint64_t width = std::min<std::uint64_t>(number(kWidthAt), kMaxSidePx);
  const std::uint64_t height = std::min<std::uint64_t>(number(kWidthAt + 4), kMaxSidePx);
  if (file_size > kBeside + kBytesOfAPixel * width * height) {
    throw Error(ErrorKind::input, place,
                "a PNG of " + std::to_string(width) + " x " + std::to_string(height) + " pixels has no use for " +
                    std::to_string(file_size >> 20U) + " MiB",
                "export it again");
  }
}

// Error(input) where the file begins as PNG does but is broken.
OpenPicture open_file(const std::string& path, Use use, const std::string& place) {
  OpenPicture picture;
  std::error_code ignored;
  picture.file_size = std::filesystem::file_size(path, ignored);
  std::ifstream stream(path, std::ios::binary);
  std::vector<std::uint8_t> bytes(24);
  stream.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  bytes.resize(static_cast<std::size_t>(stream.gcount()));
  const char* const format = format_by_content(bytes);
  if (format == nullptr) {
    picture.problem = kNoKnownKind;
    return picture;
  }
  check_exr_header(path, place);
  if (is_png(bytes)) {
    check_size_of_png(bytes, picture.file_size, place);
    const std::size_t got = bytes.size();
    bytes.resize(std::max<std::uint64_t>(picture.file_size, got));
    stream.clear();  // a file may end within its head
    if (got == bytes.size() ||
        stream.read(reinterpret_cast<char*>(bytes.data() + got), static_cast<std::streamsize>(bytes.size() - got))) {
      open_png(picture, bytes, use, place);
    }
  } else {
    open_as(picture, format, path, {}, use, place);
  }
  return picture;
}

std::string place_of(const std::string& path, const std::string& place) {
  return place + " ('" + path + "')";
}

OpenPicture open_picture(const std::string& path, const std::string& place) {
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(path, ignored)) {
    throw Error(ErrorKind::input, place, "the picture '" + path + "' does not exist", "put it there or fix the uri");
  }
  OpenPicture picture = open_file(path, Use::texture, place_of(path, place));
  if (!picture.reader) {
    throw Error(ErrorKind::input, place, "cannot read the picture '" + path + "': " + reason(picture.problem));
  }
  return picture;
}

OpenPicture open_picture(std::span<const std::uint8_t> file_bytes, const std::string& place) {
  const char* const format = format_by_content(file_bytes);
  if (format == nullptr) {
    throw Error(ErrorKind::input, place, "the bytes are no picture of a known kind", "use PNG or JPEG");
  }
  check_exr_header(file_bytes, place);
  OpenPicture picture;
  picture.file_size = file_bytes.size();
  if (is_png(file_bytes)) {
    open_png(picture, file_bytes, Use::texture, place);
  } else {
    open_as(picture, format, {}, file_bytes, Use::texture, place);
  }
  if (!picture.reader) {
    throw Error(ErrorKind::input, place, "cannot read the picture: " + reason(picture.problem));
  }
  return picture;
}

// After the checks of its size, since it unpacks all pixels once: what is damaged in them would be printed by the
// library that reads them, and data beyond them unpacked to the end.
void check_pixels_of_png(const OpenPicture& picture, const std::string& place, const PictureLimits& limits) {
  check_size(picture, place, limits);
  if (is_png(picture.bytes)) {
    check_png_pixels(picture.bytes, place);
  }
}

PictureSize size_of(const OpenPicture& picture, const std::string& place, const PictureLimits& limits) {
  const PictureReader& reader = check_size(picture, place, limits);
  return {reader.width_px, reader.height_px, reader.is_deep, 1};
}

}  // namespace

ImageRgb read_rgb(PictureReader& reader, const std::string& place) {
  const int channels = reader.channels >= 3 ? 3 : 1;
  try {
    ImageRgb image(reader.width_px, reader.height_px);
    const std::size_t count = image.pixels.size();
    std::vector<float> values(count * static_cast<std::size_t>(channels));
    check_read(reader.read(channels, values), place);
    for (std::size_t i = 0; i < count; ++i) {
      image.pixels[i] = channels == 3 ? Vec3f{values[3 * i], values[3 * i + 1], values[3 * i + 2]}
                                      : Vec3f{values[i], values[i], values[i]};
    }
    return image;
  } catch (const std::bad_alloc&) {
    fail_for_memory(reader, place);
  }
}

ImageRgba read_image_rgba(const std::string& path, const std::string& place, const PictureLimits& limits) {
  const std::string full_place = place_of(path, place);
  const OpenPicture picture = open_picture(path, place);
  check_pixels_of_png(picture, full_place, limits);
  return read_rgba(picture, full_place, limits);
}

ImageRgba read_image_rgba(std::span<const std::uint8_t> file_bytes, const std::string& place,
                          const PictureLimits& limits) {
  const OpenPicture picture = open_picture(file_bytes, place);
  check_pixels_of_png(picture, place, limits);
  return read_rgba(picture, place, limits);
}

PictureSize read_picture_size(const std::string& path, const std::string& place, const PictureLimits& limits) {
  return size_of(open_picture(path, place), place_of(path, place), limits);
}

PictureSize read_picture_size(std::span<const std::uint8_t> file_bytes, const std::string& place,
                              const PictureLimits& limits) {
  return size_of(open_picture(file_bytes, place), place, limits);
}

ImageRgb read_image_rgb_float(const std::string& path) {
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(path, ignored)) {
    throw Error(ErrorKind::input, path, "there is no such file");
  }
  const OpenPicture picture = open_file(path, Use::picture, path);
  if (!picture.reader) {
    throw Error(ErrorKind::input, path, "cannot be read: " + reason(picture.problem));
  }
  check_pixels_of_png(picture, path, kFloatLimits);
  return read_rgb(*picture.reader, path);
}

std::vector<std::uint8_t> encode_image(const std::string& path, int width_px, int height_px, int bits,
                                       std::span<const std::uint8_t> rgb, const EncodeOptions& options) {
  std::vector<std::uint8_t> bytes;
  const std::string problem = picture_module().encode(path, width_px, height_px, bits, rgb, options, bytes);
  if (!problem.empty()) {
    throw Error(ErrorKind::runtime, path, "cannot encode the picture: " + problem);
  }
  return bytes;
}

std::string read_image_note(const std::string& path) {
  if (const std::optional<std::string> note = png_description(path)) {
    return *note;
  }
  try {
    const OpenPicture picture = open_file(path, Use::picture, path);
    return picture.reader ? picture.reader->note : std::string();
  } catch (const Error&) {
    return {};
  }
}

}  // namespace gazetrace
