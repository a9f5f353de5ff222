// SPDX-License-Identifier: Apache-2.0
// The module `libgazetrace_pictures.so`: pictures through OpenImageIO, for core/image_io.cpp.
#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>

#include <algorithm>
#include <cstring>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/picture_module.hpp"

namespace gazetrace {
namespace {

// The WebP with its alpha taken off; empty where it is not one picture. Container: RIFF; the chunk "VP8 " has no alpha
// of its own, and "VP8L" states in its fifth byte whether it does (RFC 9649, sections 2 and 3.4).
std::vector<std::uint8_t> opaque_webp(std::span<const std::uint8_t> bytes) {
  constexpr std::size_t kHeader = 12;
  constexpr std::uint8_t kHasAlpha = 0x10;
  const auto number = [&](std::size_t at) {
    return std::size_t{bytes[at]} | std::size_t{bytes[at + 1]} << 8U | std::size_t{bytes[at + 2]} << 16U |
           std::size_t{bytes[at + 3]} << 24U;
  };
  for (std::size_t at = kHeader; at + 8 <= bytes.size();) {
    const std::string_view name(reinterpret_cast<const char*>(&bytes[at]), 4);
    const std::size_t size = number(at + 4);
    const std::size_t whole = 8 + size + size % 2;
    if (size > bytes.size() - at - 8) {
      return {};
    }
    if (name == "VP8 " || name == "VP8L") {
      const std::size_t there = std::min(whole, bytes.size() - at);
      std::vector<std::uint8_t> copy(bytes.begin(), bytes.begin() + kHeader);
      copy.insert(copy.end(), bytes.begin() + static_cast<std::ptrdiff_t>(at),
                  bytes.begin() + static_cast<std::ptrdiff_t>(at + there));
      copy.resize(kHeader + whole);
      for (std::size_t i = 0; i < 4; ++i) {
        copy[4 + i] = static_cast<std::uint8_t>((whole + 4) >> 8 * i);
      }
      if (name == "VP8L" && size > 4) {
        copy[kHeader + 8 + 4] &= static_cast<std::uint8_t>(~kHasAlpha);
      }
      return copy;
    }
    at += whole;
  }
  return {};
}

class OpenImageIoReader final : public PictureReader {
 public:
  // What is wrong, or nothing.
  std::string open(const PictureSource& source) {
    OIIO::ImageSpec config;
    // OpenImageIO multiplies straight colour by alpha unless told otherwise, which would lose the colour where alpha is
    // 0.
    config.attribute("oiio:UnassociatedAlpha", 1);
    constexpr std::size_t kFlagsAt = 20;  // of the chunk VP8X, which is the first
    constexpr std::uint8_t kAnimated = 0x02;
    const std::string_view head(reinterpret_cast<const char*>(source.bytes.data()), source.bytes.size());
    if (source.format == std::string_view("webp") && source.bytes.size() > kFlagsAt && head.substr(12, 4) == "VP8X" &&
        (source.bytes[kFlagsAt] & kAnimated) != 0) {
      return "an animated WebP is several pictures";
    }
    input_ = OIIO::ImageInput::create(source.format);
    if (!input_) {
      return OIIO::geterror();
    }
    std::string name = source.path;
    if (!source.bytes.empty()) {
      name = std::string("memory.") + source.format;
      memory_ = std::make_unique<OIIO::Filesystem::IOMemReader>(
          OIIO::cspan<unsigned char>(source.bytes.data(), static_cast<std::ptrdiff_t>(source.bytes.size())));
      // Also as an attribute, since some readers of OpenImageIO 2.4 lose a proxy that comes with a config.
      void* proxy = memory_.get();
      config.attribute("oiio:ioproxy", OIIO::TypeDesc::PTR, static_cast<void*>(&proxy));
      input_->set_ioproxy(memory_.get());
    }
    OIIO::ImageSpec spec;
    if (!input_->open(name, spec, config)) {
      return input_->geterror();
    }
    if (source.on_one_thread) {
      input_->threads(1);
    }
    take(spec);
    return format == "webp" && facts.alpha != Alpha::none ? open_color(source) : std::string();
  }

  std::string read(int count, std::span<std::uint8_t> values) override {
    return read(count, OIIO::TypeDesc::UINT8, values.data());
  }
  std::string read(int count, std::span<float> values) override {
    return read(count, OIIO::TypeDesc::FLOAT, values.data());
  }

 private:
  void take(const OIIO::ImageSpec& spec) {
    format = input_->format_name();
    depth = spec.depth;
    channels = spec.nchannels;
    facts.width_px = spec.width;
    facts.height_px = spec.height;
    facts.is_deep = spec.format.size() > 1;
    facts.is_linear = spec.format.is_floating_point();
    facts.is_half = spec.format == OIIO::TypeDesc::HALF;
    facts.is_cube_map = spec.get_string_attribute("textureformat").find("CubeFace") != std::string::npos;
    const std::string transfer = spec.get_string_attribute("dpx:Transfer");
    facts.is_film_scan = transfer == "Printing density" || transfer == "Logarithmic";
    facts.orientation = spec.get_int_attribute("Orientation", 1);
    // TIFF's alone can be either; of the others it is straight, whatever their readers say.
    const bool is_straight = format != "tiff" || spec.get_int_attribute("oiio:UnassociatedAlpha", 0) != 0;
    facts.alpha = spec.alpha_channel < 0 ? Alpha::none : is_straight ? Alpha::straight : Alpha::premultiplied;
    decoded_bytes = spec.image_bytes();
    // DPX keeps the whole text in the document name only; other formats have no name, or the same text in both.
    note = spec.get_string_attribute("DocumentName");
    if (note.empty()) {
      note = spec.get_string_attribute("ImageDescription");
    }
  }

  // A WebP is multiplied by its alpha whatever is asked for, so that its colour is read of a copy that has no alpha.
  std::string open_color(const PictureSource& source) {
    opaque_ = opaque_webp(source.bytes);
    if (opaque_.empty()) {
      return "the WebP is damaged";
    }
    color_ = std::make_unique<OpenImageIoReader>();
    return color_->open({source.format, {}, opaque_, source.on_one_thread});
  }

  std::string read(int count, OIIO::TypeDesc type, void* values) {
    if (color_ == nullptr) {
      return read(0, count, type, values, OIIO::AutoStride);
    }
    const auto step = static_cast<OIIO::stride_t>(type.size()) * count;
    const int colors = std::min(count, color_->channels);
    if (const std::string problem = color_->read(0, colors, type, values, step); !problem.empty() || count == colors) {
      return problem;
    }
    return read(colors, count, type, static_cast<char*>(values) + colors * static_cast<int>(type.size()), step);
  }

  std::string read(int first, int end, OIIO::TypeDesc type, void* values, OIIO::stride_t step) {
    if (input_->read_image(0, 0, first, end, type, values, step)) {
      return {};
    }
    const std::string problem = input_->geterror();
    return problem.empty() ? "not a readable picture" : problem;
  }

  std::unique_ptr<OIIO::Filesystem::IOMemReader> memory_;  // outlives what reads it
  std::unique_ptr<OIIO::ImageInput> input_;
  std::vector<std::uint8_t> opaque_;
  std::unique_ptr<OpenImageIoReader> color_;  // of `opaque_`; empty: `input_` reads all
};

std::unique_ptr<PictureReader> open(const PictureSource& source, std::string& problem) {
  auto reader = std::make_unique<OpenImageIoReader>();
  problem = reader->open(source);
  return problem.empty() && !reader->format.empty() ? std::move(reader) : nullptr;
}

// OpenImageIO truncates the lower bits, so it gets values whose upper ten bits are already rounded.
std::vector<std::uint16_t> rounded_to_10_bits(std::span<const std::uint8_t> rgb) {
  std::vector<std::uint16_t> values(rgb.size() / 2);
  std::memcpy(values.data(), rgb.data(), rgb.size());
  for (std::uint16_t& value : values) {
    const unsigned nearest = (value * 1023U + 32767U) / 65535U;
    value = static_cast<std::uint16_t>(nearest << 6U | nearest >> 4U);
  }
  return values;
}

std::string encode(const std::string& path, int width_px, int height_px, int bits, std::span<const std::uint8_t> rgb,
                   const EncodeOptions& options, std::vector<std::uint8_t>& file_bytes) {
  const std::unique_ptr<OIIO::ImageOutput> output = OIIO::ImageOutput::create(path);
  if (!output) {
    const std::string problem = OIIO::geterror();
    return problem.empty() ? "no format of that name" : problem;
  }
  const OIIO::TypeDesc type = bits == 16 ? OIIO::TypeDesc::UINT16 : OIIO::TypeDesc::UINT8;
  OIIO::ImageSpec spec(width_px, height_px, options.has_alpha ? 4 : 3,
                       options.file_bits > 8 ? OIIO::TypeDesc::UINT16 : OIIO::TypeDesc::UINT8);
  spec.attribute("oiio:BitsPerSample", options.file_bits);
  if (options.has_alpha) {
    spec.attribute("oiio:UnassociatedAlpha", 1);
  }
  const auto add_text = [&](const char* name, const std::string& value) {
    if (!value.empty()) {  // JPEG's writer ends the process when it gets an empty text
      spec.attribute(name, value);
    }
  };
  add_text("Software", options.software);
  add_text("ImageDescription", options.note);
  add_text("DocumentName", options.note);  // DPX cuts descriptions after 100 characters, project names after 200
  // PNG's filter 64 (the mean of left and upper neighbour) leaves noise in which a search for repeats finds little: run
  // lengths and Huffman codes alone make files a tenth larger than zlib's level 1, in three quarters of its time.
  if (output->format_name() == std::string_view("png")) {
    spec.attribute("compression", "rle");
    spec.attribute("png:compressionLevel", 1);
    spec.attribute("png:filter", 64);
  }
  spec.attribute("CompressionQuality", options.quality);
  spec.attribute("jpeg:subsampling", "4:4:4");
  // TIFF would otherwise contain the time of writing, and the same frame would not give the same bytes.
  spec.attribute("DateTime", "0000:00:00 00:00:00");

  const std::vector<std::uint16_t> rounded =
      bits == 16 && options.file_bits == 10 ? rounded_to_10_bits(rgb) : std::vector<std::uint16_t>();
  const void* const pixels = rounded.empty() ? static_cast<const void*>(rgb.data()) : rounded.data();
  // Encoded in memory, because only write_bytes_atomically (core/atomic_file.cpp) reports a full disk reliably.
  OIIO::Filesystem::IOVecOutput writer(file_bytes);
  if (!output->set_ioproxy(&writer) || !output->open(path, spec) || !output->write_image(type, pixels) ||
      !output->close()) {
    const std::string problem = output->geterror();
    return problem.empty() ? "unknown reason" : problem;
  }
  return {};
}

constexpr PictureModule kModule{GAZETRACE_PICTURE_MODULE_BUILD, &open, &encode};

}  // namespace
}  // namespace gazetrace

extern "C" [[gnu::visibility("default")]] const gazetrace::PictureModule* gazetrace_picture_module() {
  return &gazetrace::kModule;
}
