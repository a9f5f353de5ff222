// SPDX-License-Identifier: Apache-2.0
#include "output/exr_picture.hpp"

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfIO.h>
#include <OpenEXR/ImfMultiPartOutputFile.h>
#include <OpenEXR/ImfOutputFile.h>
#include <OpenEXR/ImfOutputPart.h>
#include <OpenEXR/ImfPartType.h>
#include <OpenEXR/ImfStandardAttributes.h>
#include <OpenEXR/ImfStringAttribute.h>
#include <OpenEXR/ImfThreading.h>
#include <OpenEXR/OpenEXRConfig.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstring>
#include <mutex>
#include <span>

#include "core/parallel.hpp"
#include "gazetrace/error.hpp"
#include "output/exr.hpp"
#include "output/exr_describe.hpp"
#include "output/exr_seal.hpp"
#include "output/written_file.hpp"

namespace gazetrace {
namespace {

struct Compression {
  const char* name;
  Imf::Compression value;
  bool is_lossy = false;
};
constexpr std::array kCompressions {
  Compression{"none", Imf::NO_COMPRESSION}, Compression{"rle", Imf::RLE_COMPRESSION},
      Compression{"zips", Imf::ZIPS_COMPRESSION}, Compression{"zip", Imf::ZIP_COMPRESSION},
      Compression{"piz", Imf::PIZ_COMPRESSION}, Compression{"pxr24", Imf::PXR24_COMPRESSION, true},
      Compression{"b44", Imf::B44_COMPRESSION, true}, Compression{"b44a", Imf::B44A_COMPRESSION, true},
      Compression{"dwaa", Imf::DWAA_COMPRESSION, true}, Compression{"dwab", Imf::DWAB_COMPRESSION, true},
#if OPENEXR_VERSION_MAJOR > 3 || (OPENEXR_VERSION_MAJOR == 3 && OPENEXR_VERSION_MINOR >= 4)
      Compression{"htj2k32", Imf::HTJ2K32_COMPRESSION}, Compression{"htj2k256", Imf::HTJ2K256_COMPRESSION},
#endif
};

const Compression& compression_by_name(const std::string& name) {
  for (const Compression& compression : kCompressions) {
    if (name == compression.name) {
      return compression;
    }
  }
  throw Error(ErrorKind::usage, "", unknown_name_message("EXR compression", name, exr_compression_names()));
}

// Collects a whole file in memory. OpenEXR's own file stream loses the error where its last buffer meets a full disk,
// so write_bytes_atomically writes the bytes.
class MemoryStream : public Imf::OStream {
 public:
  explicit MemoryStream(const std::string& name) : Imf::OStream(name.c_str()) {}
  void write(const char* data, int count) override {
    const auto size = static_cast<std::size_t>(count);
    if (at_ + size > bytes_.size()) {
      bytes_.resize(at_ + size);
    }
    std::memcpy(&bytes_[at_], data, size);
    at_ += size;
  }
  std::uint64_t tellp() override { return at_; }
  void seekp(std::uint64_t position) override { at_ = position; }
  [[nodiscard]] std::span<std::byte> bytes() { return std::as_writable_bytes(std::span(bytes_)); }

 private:
  std::vector<char> bytes_;
  std::size_t at_ = 0;
};

// OpenEXR has one pool of worker threads for the process; it is only ever enlarged here.
void want_exr_threads(int threads) {
  static std::mutex mutex;
  const std::lock_guard lock(mutex);
  if (threads > 1 && Imf::globalThreadCount() < threads) {
    Imf::setGlobalThreadCount(threads);
  }
}

}  // namespace

const std::vector<std::string>& exr_compression_names() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> all;
    all.reserve(kCompressions.size());
    for (const Compression& compression : kCompressions) {
      all.emplace_back(compression.name);
    }
    return all;
  }();
  return names;
}

bool is_lossy_compression(const std::string& name) {
  return compression_by_name(name).is_lossy;
}

ExrPicture::ExrPicture(int width_px, int height_px, const ExrSettings& settings, int threads)
    : header_(width_px, height_px), settings_(settings), width_px_(width_px), height_px_(height_px), threads_(threads) {
  header_.compression() = compression_by_name(settings.compression).value;
  header_.zipCompressionLevel() = settings.zip_level;
}

void ExrPicture::place(const FrameWindow& window) {
  if (window.is_part()) {
    const Imath::V2i first(window.x_px, window.y_px);
    header_.dataWindow() = {first, first + Imath::V2i(width_px_ - 1, height_px_ - 1)};
    header_.displayWindow() = {{0, 0}, {window.frame_width_px - 1, window.frame_height_px - 1}};
  }
}

void ExrPicture::begin_layer(const std::string& name) {
  if (parts_.empty() || settings_.parts == ExrParts::multi) {
    parts_.emplace_back().name = name;
  }
}

void ExrPicture::add_text(const std::string& name, const std::string& value) {
  parts_.back().texts.push_back({name, value});
}

void ExrPicture::add_float(const std::string& name, const ImageGray& image) {
  insert(name, Imf::FLOAT, reinterpret_cast<const char*>(image.pixels.data()), sizeof(float));
  parts_.back().holds_numbers = true;
}

void ExrPicture::add_constant(const std::string& name, float value) {
  add_own(name, ImageGray(width_px_, height_px_, value));
}

void ExrPicture::add_own(const std::string& name, ImageGray image) {
  add_float(name, own_.emplace_back(std::move(image)));
}

void ExrPicture::add_float_rgb(const std::array<std::string, 3>& names, const ImageRgb& image) {
  for (std::size_t c = 0; c < 3; ++c) {
    insert(names[c], Imf::FLOAT, reinterpret_cast<const char*>(image.pixels.data()) + c * sizeof(float), sizeof(Vec3f));
  }
}

std::vector<half>& ExrPicture::halves_of(const float* values, std::size_t count) {
  constexpr std::size_t kRun = 16384;
  std::vector<half>& halves = halves_.emplace_back(count);
  std::atomic<std::uint64_t> clamped{0};
  parallel_for((count + kRun - 1) / kRun, threads_, [&](std::size_t run) {
    const std::size_t end = std::min(count, (run + 1) * kRun);
    std::uint64_t here = 0;
    for (std::size_t i = run * kRun; i < end; ++i) {
      const float limited = std::clamp(values[i], -static_cast<float>(HALF_MAX), static_cast<float>(HALF_MAX));
      here += limited != values[i] && !std::isnan(values[i]) ? 1U : 0U;
      halves[i] = half(limited);
    }
    clamped += here;
  });
  clamped_ += clamped;
  return halves;
}

void ExrPicture::add_half_rgb(const std::array<std::string, 3>& names, const ImageRgb& image) {
  const std::vector<half>& halves = halves_of(&image.pixels.data()->x, image.pixels.size() * 3);
  for (std::size_t c = 0; c < 3; ++c) {
    insert(names[c], Imf::HALF, reinterpret_cast<const char*>(&halves[c]), 3 * sizeof(half));
  }
}

void ExrPicture::add_color(const std::array<std::string, 3>& names, const ImageRgb& image, ExrPixels pixels) {
  const ImageRgb* shown = &image;
  if (const auto matrix = matrix_to(settings_.space)) {
    ImageRgb& converted = own_rgb_.emplace_back(image);
    for (Vec3f& pixel : converted.pixels) {
      pixel = {dot((*matrix)[0], pixel), dot((*matrix)[1], pixel), dot((*matrix)[2], pixel)};
    }
    shown = &converted;
  }
  if (pixels == ExrPixels::half) {
    add_half_rgb(names, *shown);
  } else {
    add_float_rgb(names, *shown);
  }
}

void ExrPicture::add_share(const std::string& name, const ImageGray& image) {
  if (settings_.pixels == ExrPixels::half) {
    const std::vector<half>& halves = halves_of(image.pixels.data(), image.pixels.size());
    insert(name, Imf::HALF, reinterpret_cast<const char*>(halves.data()), sizeof(half));
  } else {
    insert(name, Imf::FLOAT, reinterpret_cast<const char*>(image.pixels.data()), sizeof(float));
  }
}

// All of a part's own, and of the whole file's header all of it in the first part, elsewhere what readers need there.
Imf::Header ExrPicture::header_of(const Part& part, bool first) const {
  Imf::Header header = first ? header_ : Imf::Header(header_.displayWindow(), header_.dataWindow());
  if (first) {
    add_room_for_seal(header);
  } else {
    header.compression() = header_.compression();
    header.zipCompressionLevel() = settings_.zip_level;
    if (Imf::hasChromaticities(header_)) {
      Imf::addChromaticities(header, Imf::chromaticities(header_));
    }
    if (Imf::hasTimeCode(header_)) {
      Imf::addTimeCode(header, Imf::timeCode(header_));
    }
  }
  if (settings_.parts == ExrParts::multi) {
    header.setName(part.name);
    header.setType(Imf::SCANLINEIMAGE);
    if (part.holds_numbers && is_lossy_compression(settings_.compression)) {
      header.compression() = Imf::ZIP_COMPRESSION;
    }
  }
  header.channels() = part.channels;
  for (const auto& [name, value] : part.texts) {
    header.insert(name, Imf::StringAttribute(value));
  }
  return header;
}

WrittenFile ExrPicture::write(const std::string& path, std::int32_t frame) {
  want_exr_threads(threads_);
  MemoryStream stream(path);
  const int threads = threads_ > 1 ? threads_ : 0;
  try {
    if (settings_.parts == ExrParts::single) {
      Imf::OutputFile file(stream, header_of(parts_.front(), true), threads);
      file.setFrameBuffer(parts_.front().buffer);
      file.writePixels(height_px_);
    } else {
      std::vector<Imf::Header> headers;
      for (const Part& part : parts_) {
        headers.push_back(header_of(part, headers.empty()));
      }
      Imf::MultiPartOutputFile file(stream, headers.data(), static_cast<int>(headers.size()), false, threads);
      for (std::size_t i = 0; i < parts_.size(); ++i) {
        Imf::OutputPart part(file, static_cast<int>(i));
        part.setFrameBuffer(parts_[i].buffer);
        part.writePixels(height_px_);
      }
    }
  } catch (const std::exception& e) {
    throw Error(ErrorKind::runtime, path, std::string("cannot encode the EXR: ") + e.what());
  }
  seal_exr(stream.bytes());
  return write_frame_file(path, frame, stream.bytes());
}

void ExrPicture::insert(const std::string& name, Imf::PixelType type, const char* first, std::size_t stride) {
  parts_.back().channels.insert(name, Imf::Channel(type));
  // OpenEXR only reads through this pointer, although its type is char*. It counts pixels from the frame's corner.
  const std::size_t row = stride * static_cast<std::size_t>(width_px_);
  const Imath::V2i corner = header_.dataWindow().min;
  const auto before = static_cast<std::ptrdiff_t>(corner.x) * static_cast<std::ptrdiff_t>(stride) +
                      static_cast<std::ptrdiff_t>(corner.y) * static_cast<std::ptrdiff_t>(row);
  parts_.back().buffer.insert(name, Imf::Slice(type, const_cast<char*>(first) - before, stride, row));
}

}  // namespace gazetrace
