// SPDX-License-Identifier: Apache-2.0
#include "core/image_io.hpp"

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <memory>
#include <string_view>
#include <utility>

#include "gazetrace/error.hpp"

namespace gazetrace {
namespace {

constexpr int kMaxSidePx = 65536;

// OpenImageIO multiplies PNG colour by alpha unless told not to; colour under alpha 0 would be lost.
OIIO::ImageSpec keep_alpha_unassociated() {
  OIIO::ImageSpec config;
  config.attribute("oiio:UnassociatedAlpha", 1);
  return config;
}

std::string reason(const std::string& message) {
  return message.empty() ? std::string("not a readable picture") : message;
}

const OIIO::ImageSpec& check_size(const OIIO::ImageInput& input, const std::string& place) {
  const OIIO::ImageSpec& spec = input.spec();
  if (spec.width < 1 || spec.height < 1 || spec.nchannels < 1 || spec.width > kMaxSidePx || spec.height > kMaxSidePx ||
      spec.depth > 1) {
    throw Error(ErrorKind::input, place,
                "a picture of " + std::to_string(spec.width) + " x " + std::to_string(spec.height) + " pixels and " +
                    std::to_string(spec.nchannels) + " channels cannot be used");
  }
  return spec;
}

// Spreads `channels` (1 to 4) of each pixel over R, G, B, A in place of a second buffer where there are 4 already.
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

template <class T>
std::vector<T> read_channels(OIIO::ImageInput& input, OIIO::TypeDesc type, int channels, T opaque,
                             const std::string& place) {
  const OIIO::ImageSpec& spec = input.spec();
  const auto count = static_cast<std::size_t>(spec.width) * static_cast<std::size_t>(spec.height);
  std::vector<T> pixels(count * static_cast<std::size_t>(channels));
  if (!input.read_image(0, 0, 0, channels, type, pixels.data())) {
    const std::string message = reason(input.geterror());
    throw Error(ErrorKind::input, place, "the picture is damaged: " + message, "export it again");
  }
  return to_rgba(std::move(pixels), count, channels, opaque);
}

ImageRgba read_rgba(OIIO::ImageInput& input, const std::string& place) {
  const OIIO::ImageSpec& spec = check_size(input, place);
  input.threads(1);  // callers decode many pictures side by side
  ImageRgba image;
  image.width_px = spec.width;
  image.height_px = spec.height;
  const int channels = std::min(spec.nchannels, 4);
  if (spec.format.size() == 1) {
    image.bytes = read_channels<std::uint8_t>(input, OIIO::TypeDesc::UINT8, channels, 255, place);
    image.has_alpha = channels % 2 == 0 && any_transparent<std::uint8_t>(image.bytes, 255);
    return image;
  }
  image.is_linear = spec.format.is_floating_point();
  image.floats = read_channels<float>(input, OIIO::TypeDesc::FLOAT, channels, 1, place);
  for (std::size_t i = 0; i < image.floats.size(); ++i) {
    if (!std::isfinite(image.floats[i])) {
      const std::size_t pixel = i / 4;
      const auto width = static_cast<std::size_t>(spec.width);
      throw Error(ErrorKind::input, place,
                  "pixel " + std::to_string(pixel % width) + ", " + std::to_string(pixel / width) + " is not finite",
                  "repair the picture");
    }
  }
  image.has_alpha = channels % 2 == 0 && any_transparent(image.floats, 1.0F);
  return image;
}

// OpenImageIO picks its reader by the name's suffix; bytes in memory have none, so the magic number speaks.
const char* name_by_content(std::span<const std::uint8_t> bytes) {
  const std::string_view head(reinterpret_cast<const char*>(bytes.data()), std::min<std::size_t>(bytes.size(), 16));
  struct Magic {
    std::string_view start;
    const char* name;
  };
  constexpr std::array<Magic, 8> kMagics{{{"\x89PNG", "memory.png"},
                                          {"\xff\xd8\xff", "memory.jpg"},
                                          {"#?R", "memory.hdr"},
                                          {"\x76\x2f\x31\x01", "memory.exr"},
                                          {"RIFF", "memory.webp"},
                                          {"GIF8", "memory.gif"},
                                          {"BM", "memory.bmp"},
                                          {"DDS ", "memory.dds"}}};
  for (const Magic& magic : kMagics) {
    if (head.starts_with(magic.start)) {
      return magic.name;
    }
  }
  return nullptr;
}

}  // namespace

ImageRgba read_image_rgba(const std::string& path, const std::string& place) {
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(path, ignored)) {
    throw Error(ErrorKind::input, place, "the picture '" + path + "' does not exist", "put it there or fix the uri");
  }
  const OIIO::ImageSpec config = keep_alpha_unassociated();
  const auto input = OIIO::ImageInput::open(path, &config);
  if (!input) {
    throw Error(ErrorKind::input, place, "cannot read the picture '" + path + "': " + reason(OIIO::geterror()));
  }
  return read_rgba(*input, place + " ('" + path + "')");
}

ImageRgba read_image_rgba(std::span<const std::uint8_t> file_bytes, const std::string& place) {
  const char* name = name_by_content(file_bytes);
  if (name == nullptr) {
    throw Error(ErrorKind::input, place, "the bytes are no picture of a known kind", "use PNG or JPEG");
  }
  OIIO::ImageSpec config = keep_alpha_unassociated();
  OIIO::Filesystem::IOMemReader reader(OIIO::cspan<unsigned char>(file_bytes.data(), file_bytes.size()));
  // As an attribute: 2.4 loses a proxy that is handed to open() beside a config.
  void* proxy = &reader;
  config.attribute("oiio:ioproxy", OIIO::TypeDesc::PTR, static_cast<void*>(&proxy));
  const auto input = OIIO::ImageInput::open(name, &config, &reader);
  if (!input) {
    throw Error(ErrorKind::input, place, "cannot read the picture: " + reason(OIIO::geterror()));
  }
  return read_rgba(*input, place);
}

ImageRgb read_image_rgb_float(const std::string& path) {
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(path, ignored)) {
    throw Error(ErrorKind::input, path, "there is no such file");
  }
  const auto input = OIIO::ImageInput::open(path);
  if (!input) {
    throw Error(ErrorKind::input, path, "cannot be read: " + reason(OIIO::geterror()));
  }
  const OIIO::ImageSpec& spec = check_size(*input, path);
  const int channels = spec.nchannels >= 3 ? 3 : 1;
  ImageRgb image(spec.width, spec.height);
  const std::size_t count = image.pixels.size();
  std::vector<float> values(count * static_cast<std::size_t>(channels));
  if (!input->read_image(0, 0, 0, channels, OIIO::TypeDesc::FLOAT, values.data())) {
    throw Error(ErrorKind::input, path, "the picture is damaged: " + reason(input->geterror()), "export it again");
  }
  for (std::size_t i = 0; i < count; ++i) {
    image.pixels[i] = channels == 3 ? Vec3f{values[3 * i], values[3 * i + 1], values[3 * i + 2]}
                                    : Vec3f{values[i], values[i], values[i]};
  }
  return image;
}

std::vector<std::uint8_t> encode_image(const std::string& path, int width_px, int height_px, int bits,
                                       std::span<const std::uint8_t> rgb, const EncodeOptions& options) {
  const auto fail = [&](const std::string& message) {
    throw Error(ErrorKind::runtime, path, "cannot encode the picture: " + message);
  };
  const std::unique_ptr<OIIO::ImageOutput> output = OIIO::ImageOutput::create(path);
  if (!output) {
    fail(OIIO::geterror());
  }
  const OIIO::TypeDesc type = bits == 16 ? OIIO::TypeDesc::UINT16 : OIIO::TypeDesc::UINT8;
  OIIO::ImageSpec spec(width_px, height_px, 3, options.file_bits > 8 ? OIIO::TypeDesc::UINT16 : OIIO::TypeDesc::UINT8);
  spec.attribute("oiio:BitsPerSample", options.file_bits);
  const auto add_text = [&](const char* name, const std::string& value) {
    if (!value.empty()) {  // JPEG's writer ends the process over an empty text
      spec.attribute(name, value);
    }
  };
  add_text("Software", options.software);
  add_text("ImageDescription", options.note);
  add_text("DocumentName", options.note);  // DPX cuts descriptions after 100 characters, project names after 200
  // PNG's filter 64 (the mean of left and upper neighbour) leaves noise with little to gain from a search for repeats:
  // run lengths and Huffman codes alone give files a tenth larger than zlib's level 1 in three quarters of its time.
  if (output->format_name() == std::string_view("png")) {
    spec.attribute("compression", "rle");
    spec.attribute("png:compressionLevel", 1);
    spec.attribute("png:filter", 64);
  }
  spec.attribute("CompressionQuality", options.quality);
  spec.attribute("jpeg:subsampling", "4:4:4");
  // TIFF would otherwise carry the time of writing, and the same frame would not give the same bytes.
  spec.attribute("DateTime", "0000:00:00 00:00:00");

  std::vector<std::uint16_t> reduced;
  const void* pixels = rgb.data();
  if (bits == 16 && options.file_bits == 10) {
    // OpenImageIO cuts the lower bits off: give it values whose upper ten are the nearest ones.
    reduced.resize(rgb.size() / 2);
    std::memcpy(reduced.data(), rgb.data(), rgb.size());
    for (std::uint16_t& value : reduced) {
      const unsigned nearest = (value * 1023U + 32767U) / 65535U;
      value = static_cast<std::uint16_t>(nearest << 6U | nearest >> 4U);
    }
    pixels = reduced.data();
  }

  // Through memory, because a full disk is noticed only by the one who writes the file; see output/atomic_file.cpp.
  std::vector<unsigned char> bytes;
  OIIO::Filesystem::IOVecOutput writer(bytes);
  if (!output->set_ioproxy(&writer) || !output->open(path, spec) || !output->write_image(type, pixels) ||
      !output->close()) {
    fail(output->geterror());
  }
  return bytes;
}

std::string read_image_note(const std::string& path) {
  const auto input = OIIO::ImageInput::open(path);
  if (!input) {
    OIIO::geterror();  // or it would be printed when the program ends
    return {};
  }
  // DPX keeps the whole of it in the name only; the others have no name or the same text in both.
  const std::string name(input->spec().get_string_attribute("DocumentName"));
  return name.empty() ? std::string(input->spec().get_string_attribute("ImageDescription")) : name;
}

}  // namespace gazetrace
