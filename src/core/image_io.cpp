// SPDX-License-Identifier: Apache-2.0
#include "core/image_io.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <memory>
#include <new>
#include <optional>
#include <string_view>
#include <type_traits>
#include <utility>

#include "core/exr_reader.hpp"
#include "core/jpeg_file.hpp"
#include "core/picture_module.hpp"
#include "core/png_file.hpp"
#include "core/radiance_file.hpp"
#include "gazetrace/error.hpp"

namespace gazetrace {
namespace {

// OpenImageIO's names of what is read without it.
constexpr std::string_view kExr = "openexr";
constexpr std::string_view kRadiance = "hdr";
constexpr int kMaxSidePx = 65536;
constexpr std::uint64_t kMaxPixels = std::uint64_t{1} << 30U;        // 4 GiB of bytes, 16 of floats
constexpr std::uint64_t kPixelsOfAnyFile = std::uint64_t{1} << 20U;  // whatever its size
// A picture that is being read, together with the bytes that it is read from.
struct OpenPicture {
  std::vector<std::uint8_t> bytes;
  std::unique_ptr<PictureReader> reader;  // never empty
  std::uint64_t file_size = 0;
};

struct Opening {
  bool on_one_thread = false;
  const std::vector<std::string>* channels = nullptr;  // of an EXR: one of these, as numbers; null: its light
};

// The most pixels that a byte of a file can stand for, by OpenImageIO's name of the format. PNG: deflate's 1032 bytes
// of 8 pixels each, rounded up; others: more than any real picture has. (Of EXRs core/exr_reader.cpp judges.)
// Formats that are not listed may hold any number of equal pixels.
std::uint64_t most_pixels_a_byte(std::string_view format) {
  constexpr std::array<std::string_view, 3> kOthers{"jpeg", "hdr", "bmp"};
  return format == "png" ? 8448 : std::find(kOthers.begin(), kOthers.end(), format) != kOthers.end() ? 65536 : 0;
}

// Called before any memory is allocated, since the size is only the claim of a header of a few bytes.
void check_size(const OpenPicture& picture, const std::string& place, const PictureLimits& limits) {
  const PictureReader& reader = *picture.reader;
  const PictureFacts& facts = reader.facts;
  const std::string size = std::to_string(facts.width_px) + " x " + std::to_string(facts.height_px);
  if (facts.width_px < 1 || facts.height_px < 1 || reader.channels < 1 || facts.width_px > kMaxSidePx ||
      facts.height_px > kMaxSidePx || reader.depth > 1) {
    throw Error(ErrorKind::input, place,
                "a picture of " + size + " pixels and " + std::to_string(reader.channels) + " channels cannot be used");
  }
  const std::uint64_t pixels = static_cast<std::uint64_t>(facts.width_px) * static_cast<std::uint64_t>(facts.height_px);
  const bool is_for_memory = limits.most_pixels > 0 && limits.most_pixels < kMaxPixels;
  const std::uint64_t most = is_for_memory ? limits.most_pixels : kMaxPixels;
  if (pixels > most) {
    throw Error(ErrorKind::input, place,
                "a picture of " + size + " pixels is too large; at most " + std::to_string(most) + " are possible" +
                    (is_for_memory ? " in the limit of memory" : ""),
                is_for_memory ? "make it smaller, or raise `max-memory`" : "make it smaller");
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
}

// What `read` makes of a picture.
template <class Read>
auto with_memory(const PictureFacts& facts, const std::string& place, const Read& read) {
  try {
    return read();
  } catch (const std::bad_alloc&) {
    throw Error(ErrorKind::runtime, place,
                "there is no memory for a picture of " + std::to_string(facts.width_px) + " x " +
                    std::to_string(facts.height_px) + " pixels",
                "make it smaller");
  }
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

std::size_t pixels_of(const PictureFacts& facts) {
  return static_cast<std::size_t>(facts.width_px) * static_cast<std::size_t>(facts.height_px);
}

template <class T>
std::vector<T> read_channels(PictureReader& reader, int channels, const std::string& place) {
  std::vector<T> pixels(pixels_of(reader.facts) * static_cast<std::size_t>(channels));
  check_read(reader.read(channels, pixels), place);
  return pixels;
}

void check_finite(const ImageRgba& image, const std::string& place) {
  for (std::size_t i = 0; i < image.floats.size(); ++i) {
    if (!std::isfinite(image.floats[i])) {
      const std::size_t pixel = i / 4;
      const auto width = static_cast<std::size_t>(image.width_px);
      throw Error(ErrorKind::input, place,
                  "pixel " + std::to_string(pixel % width) + ", " + std::to_string(pixel / width) + " is not finite",
                  "repair the picture");
    }
  }
}

// Colors that were multiplied by alpha become what they were; where alpha is 0 nothing is known of them.
template <class T>
void divide_by_alpha(std::vector<T>& rgba, T opaque) {
  constexpr bool is_code = std::is_integral_v<T>;
  constexpr auto kMost = static_cast<float>(std::numeric_limits<T>::max());
  for (std::size_t i = 0; i < rgba.size(); i += 4) {
    const T alpha = rgba[i + 3];
    if (!(alpha > 0 && alpha < opaque)) {
      continue;
    }
    for (std::size_t c = i; c < i + 3; ++c) {
      const float color = static_cast<float>(rgba[c]) * static_cast<float>(opaque) / static_cast<float>(alpha);
      rgba[c] = static_cast<T>(std::min(is_code ? color + 0.5F : color, kMost));
    }
  }
}

ImageRgba read_rgba(PictureReader& reader, const std::string& place) {
  const PictureFacts& facts = reader.facts;
  ImageRgba image;
  image.width_px = facts.width_px;
  image.height_px = facts.height_px;
  image.is_linear = facts.is_linear;
  image.primaries = facts.primaries;
  const int channels = std::min(reader.channels, 4);
  const auto take = [&]<class T>(std::vector<T>& pixels, T opaque) {
    pixels = to_rgba(read_channels<T>(reader, channels, place), pixels_of(facts), channels, opaque);
    image.has_alpha = channels % 2 == 0 && any_transparent(pixels, opaque);
    if (image.has_alpha && facts.alpha == Alpha::premultiplied) {
      divide_by_alpha(pixels, opaque);
    }
  };
  if (facts.is_deep) {
    take(image.floats, 1.0F);
    check_finite(image, place);
  } else {
    take(image.bytes, std::uint8_t{255});
  }
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
                                           {"#?R"sv, kRadiance.data()},
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

std::string place_of(const PictureInput& input, const std::string& place) {
  return input.path.empty() || input.path == place ? place : place + " ('" + input.path + "')";
}

std::vector<std::uint8_t> bytes_of_file(std::ifstream& stream, std::uint64_t size) {
  std::vector<std::uint8_t> bytes(size);
  stream.clear();  // a file may end within its head
  stream.seekg(0);
  stream.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(size));
  bytes.resize(static_cast<std::size_t>(stream.gcount()));
  return bytes;
}

// Opens a picture by the kind that its content says, with the bytes that concern it. Error(input) for what is no
// picture.
OpenPicture open_bytes(const char* format, PictureInput input, std::vector<std::uint8_t> own, const Opening& opening,
                       const std::string& place) {
  OpenPicture picture;
  picture.bytes = std::move(own);
  if (!picture.bytes.empty()) {
    input.bytes = picture.bytes;
  }
  const std::string_view kind = format;
  if (kind == "png" || kind == "jpeg") {
    picture.bytes = kind == "png" ? essential_png(input.bytes, place) : essential_jpeg(input.bytes, place);
    input.bytes = picture.bytes;
  }
  if (kind == kExr) {
    auto reader = open_exr(input, place);
    if (opening.channels != nullptr) {
      reader->choose_channel(*opening.channels);
    } else {
      reader->choose_light();
    }
    picture.reader = std::move(reader);
  } else if (opening.channels != nullptr) {
    throw Error(ErrorKind::input, place, "is no EXR, which numbers for each pixel are read from", "write an EXR");
  } else if (kind == kRadiance) {
    picture.reader = open_radiance(input.bytes, place);
  } else {
    const PictureSource source{format, input.path, input.bytes, opening.on_one_thread};
    std::string problem;
    picture.reader = picture_module().open(source, problem);
    if (!picture.reader) {
      throw Error(ErrorKind::input, place,
                  "cannot be read: " + (problem.empty() ? std::string("not a readable picture") : problem));
    }
  }
  std::optional<Primaries>& primaries = picture.reader->facts.primaries;
  if (primaries == Primaries{}) {  // as some programs write that nothing is known
    primaries.reset();
  }
  if (primaries && !is_space(*primaries)) {
    throw Error(ErrorKind::input, place, "the primaries that its header states span no colors", "export it again");
  }
  return picture;
}

// The kinds whose bytes are looked at, or read, before a library sees them.
bool is_read_whole(std::string_view format) {
  return format == "png" || format == "jpeg" || format == "webp" || format == kRadiance;
}

void check_is_there(const std::string& path, const std::string& place) {
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(path, ignored)) {
    throw place == path
        ? Error(ErrorKind::input, place, "there is no such file")
        : Error(ErrorKind::input, place, "the picture '" + path + "' does not exist", "put it there or fix the uri");
  }
}

// The only place at which a picture comes in, whatever it is for.
OpenPicture open_picture(const PictureInput& input, const std::string& place, const Opening& opening = {}) {
  const bool is_file = !input.path.empty();
  if (is_file) {
    check_is_there(input.path, place);
  }
  std::error_code ignored;
  const std::string where = place_of(input, place);
  const std::uint64_t size = is_file ? std::filesystem::file_size(input.path, ignored) : input.bytes.size();
  std::ifstream stream;
  if (is_file) {
    stream.open(input.path, std::ios::binary);
  }
  constexpr std::size_t kHead = 24;
  const std::vector<std::uint8_t> head = is_file ? bytes_of_file(stream, kHead) : std::vector<std::uint8_t>();
  const char* const format = format_by_content(is_file ? head : input.bytes);
  if (format == nullptr) {
    throw Error(ErrorKind::input, where,
                "cannot be read: it is no picture of a known kind (PNG, JPEG, WebP, TIFF, DPX, EXR, HDR, ...)");
  }
  constexpr std::uint64_t kMostFileBytes = std::uint64_t{4} << 30U;
  if (is_png(head)) {
    check_size_of_png(head, size, where);
  } else if (is_file && is_read_whole(format) && size > kMostFileBytes) {
    throw Error(ErrorKind::input, where,
                "a file of " + std::to_string(size >> 30U) + " GiB is no " + format + " picture", "export it again");
  }
  OpenPicture picture = open_bytes(
      format, input, is_file && is_read_whole(format) ? bytes_of_file(stream, size) : std::vector<std::uint8_t>(),
      opening, where);
  picture.file_size = size;
  return picture;
}

// A picture whose size is no more than it may be. Of a PNG all pixels are unpacked once: what is damaged in them would
// be printed by the library that reads them, and data beyond them unpacked to the end.
OpenPicture open_to_read(const PictureInput& input, const std::string& place, const PictureLimits& limits,
                         const Opening& opening = {}) {
  OpenPicture picture = open_picture(input, place, opening);
  if (picture.reader->facts.is_film_scan) {
    throw Error(ErrorKind::input, place_of(input, place),
                "it holds densities of a film, and no code values of a display",
                "convert it, for example by 'oiiotool IN.dpx --colorconvert KodakLog sRGB -o OUT.exr'");
  }
  const std::string where = place_of(input, place);
  check_size(picture, where, limits);
  if (is_png(picture.bytes)) {
    check_png_pixels(picture.bytes, where);
  }
  return picture;
}

ImageRgb read_rgb(PictureReader& reader, const std::string& place) {
  const PictureFacts& facts = reader.facts;
  ImageRgb image(facts.width_px, facts.height_px);
  if (reader.channels >= 3) {
    static_assert(sizeof(Vec3f) == 3 * sizeof(float));
    check_read(reader.read(3, std::span(&image.pixels.front().x, 3 * image.pixels.size())), place);
  } else {
    const std::vector<float> gray = read_channels<float>(reader, 1, place);
    std::transform(gray.begin(), gray.end(), image.pixels.begin(), [](float v) { return Vec3f{v, v, v}; });
  }
  return image;
}

// Turned as Exif's orientation asks: 5 to 8 exchange rows and columns; then mirrored in x, in y or both.
ImageRgb upright(ImageRgb image, int orientation) {
  if (orientation <= 1 || orientation > 8) {
    return image;
  }
  const bool is_turned = orientation >= 5;
  const bool from_right = orientation == 2 || orientation == 3 || orientation == 6 || orientation == 7;
  const bool from_bottom = orientation == 3 || orientation == 4 || orientation == 7 || orientation == 8;
  ImageRgb out(is_turned ? image.height_px : image.width_px, is_turned ? image.width_px : image.height_px);
  for (int y = 0; y < out.height_px; ++y) {
    for (int x = 0; x < out.width_px; ++x) {
      const int i = from_right ? out.width_px - 1 - x : x;
      const int j = from_bottom ? out.height_px - 1 - y : y;
      out(x, y) = is_turned ? image(j, i) : image(i, j);
    }
  }
  return out;
}

}  // namespace

ImageRgba read_image_rgba(const PictureInput& input, const std::string& place, const PictureLimits& limits) {
  const OpenPicture picture = open_to_read(input, place, limits, {.on_one_thread = true});
  return with_memory(picture.reader->facts, place, [&] { return read_rgba(*picture.reader, place_of(input, place)); });
}

PictureSize read_picture_size(const PictureInput& input, const std::string& place, const PictureLimits& limits) {
  const OpenPicture picture = open_picture(input, place, {.on_one_thread = true});
  check_size(picture, place_of(input, place), limits);
  const PictureFacts& facts = picture.reader->facts;
  return {facts.width_px, facts.height_px, facts.is_deep, 1};
}

Picture read_picture(const std::string& path, const PictureLimits& limits) {
  const OpenPicture open = open_to_read(path, path, limits);
  Picture picture{open.reader->facts, {}};
  picture.rgb = with_memory(picture.facts, path,
                            [&] { return upright(read_rgb(*open.reader, path), picture.facts.orientation); });
  picture.facts.width_px = picture.rgb.width_px;
  picture.facts.height_px = picture.rgb.height_px;
  const std::optional<RgbMatrix> to_rec709 = matrix_to_rec709(picture.facts.primaries.value_or(kRec709));
  if (picture.facts.is_linear && to_rec709) {
    for (Vec3f& pixel : picture.rgb.pixels) {
      pixel = transformed(*to_rec709, pixel);
    }
  }
  return picture;
}

ImageGray read_picture_channel(const std::string& path, const std::vector<std::string>& names) {
  const OpenPicture picture = open_to_read(path, path, kPictureLimits, {.channels = &names});
  PictureReader& reader = *picture.reader;
  return with_memory(reader.facts, path, [&] {
    ImageGray image(reader.facts.width_px, reader.facts.height_px);
    check_read(reader.read(1, image.pixels), path);
    return image;
  });
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
    return open_picture(path, path).reader->note;
  } catch (const Error&) {
    return {};
  }
}

}  // namespace gazetrace
