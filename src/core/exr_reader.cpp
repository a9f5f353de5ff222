// SPDX-License-Identifier: Apache-2.0
#include "core/exr_reader.hpp"

#include <OpenEXR/Iex.h>
#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfIO.h>
#include <OpenEXR/ImfInputFile.h>
#include <OpenEXR/ImfMultiPartInputFile.h>
#include <OpenEXR/ImfPartType.h>
#include <OpenEXR/ImfPixelType.h>
#include <OpenEXR/ImfTestFile.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <filesystem>
#include <iterator>
#include <system_error>

#include "gazetrace/error.hpp"

namespace gazetrace {
namespace {

class MemoryStream final : public Imf::IStream {
 public:
  explicit MemoryStream(std::span<const std::uint8_t> bytes) : Imf::IStream("memory"), bytes_(bytes) {}

  bool read(char* to, int count) override {
    const auto wanted = static_cast<std::uint64_t>(count);
    if (count < 0 || at_ > bytes_.size() || wanted > bytes_.size() - at_) {
      throw Iex::InputExc("it ends early");
    }
    std::memcpy(to, bytes_.data() + at_, wanted);
    at_ += wanted;
    return at_ < bytes_.size();
  }
  std::uint64_t tellg() override { return at_; }
  void seekg(std::uint64_t at) override { at_ = at; }

 private:
  std::span<const std::uint8_t> bytes_;
  std::uint64_t at_ = 0;
};

std::string lower(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [](char letter) { return letter >= 'A' && letter <= 'Z' ? static_cast<char>(letter + 32) : letter; });
  return text;
}

std::uint64_t pixels_of(const Imath::Box2i& window) {
  return static_cast<std::uint64_t>(std::int64_t{window.max.x} - window.min.x + 1) *
         static_cast<std::uint64_t>(std::int64_t{window.max.y} - window.min.y + 1);
}

std::uint64_t size_of(const PictureSource& source) {
  std::error_code ignored;
  const std::uint64_t bytes =
      source.bytes.empty() ? std::filesystem::file_size(source.path, ignored) : source.bytes.size();
  return ignored ? 0 : bytes;
}

}  // namespace

void check_exr_windows(const Imf::Header& header, std::uint64_t bytes, const std::string& place) {
  constexpr std::uint64_t kMostPixels = std::uint64_t{1} << 30U;
  constexpr std::uint64_t kPixelsOfAnyFile = std::uint64_t{1} << 20U;
  const bool is_dwa = header.compression() == Imf::DWAA_COMPRESSION || header.compression() == Imf::DWAB_COMPRESSION;
  constexpr std::uint64_t kPixelsAroundACrop = std::uint64_t{1} << 25U;
  const std::uint64_t held = kPixelsOfAnyFile + (is_dwa ? 8192 : 1024) * bytes;
  for (const Imath::Box2i& window : {header.dataWindow(), header.displayWindow()}) {
    const std::uint64_t pixels = pixels_of(window);
    const bool may_be_empty = window == header.displayWindow() && window != header.dataWindow();
    if (pixels > kMostPixels || pixels > (may_be_empty ? std::max(held, kPixelsAroundACrop) : held)) {
      throw Error(ErrorKind::input, place,
                  "an EXR of " + std::to_string(window.max.x - window.min.x + 1) + " x " +
                      std::to_string(window.max.y - window.min.y + 1) + " pixels and " + std::to_string(bytes) +
                      " bytes cannot be used",
                  pixels > kMostPixels ? "make it smaller" : "it is damaged: export it again");
    }
  }
  if (!header.dataWindow().intersects(header.displayWindow())) {
    throw Error(ErrorKind::input, place, "all data of the EXR lie outside its display window", "export it again");
  }
}

namespace {

// Of a deep file OpenEXR would lay each pixel's samples over each other, where they have a depth. The first part is the
// one that is read.
template <class Source>
void refuse_deep(Source&& source, const std::string& place) {
  if (!Imf::isDeepOpenExrFile(source)) {
    return;
  }
  const Imf::MultiPartInputFile file(source, 0);
  if (Imf::isDeepData(file.header(0).type())) {
    throw Error(ErrorKind::input, place, "a deep EXR (" + file.header(0).type() + ") has several values for a pixel",
                "flatten it");
  }
}

std::string joined(const std::vector<std::string>& names) {
  constexpr std::size_t kMost = 8;
  std::string text;
  for (std::size_t i = 0; i < std::min(names.size(), kMost); ++i) {
    text += (i == 0 ? "" : ", ") + bounded(names[i], 40);
  }
  return names.size() > kMost ? text + ", ..." : text;
}

}  // namespace

struct ExrReader::File {
  std::unique_ptr<MemoryStream> stream;
  std::unique_ptr<Imf::InputFile> input;
};

ExrReader::ExrReader(const PictureSource& source, const std::string& place)
    : file_(std::make_unique<File>()), place_(place) {
  try {
    if (source.bytes.empty()) {
      refuse_deep(source.path.c_str(), place);
      file_->input = std::make_unique<Imf::InputFile>(source.path.c_str(), 0);
    } else {
      refuse_deep(MemoryStream(source.bytes), place);
      file_->stream = std::make_unique<MemoryStream>(source.bytes);
      file_->input = std::make_unique<Imf::InputFile>(*file_->stream, 0);
    }
  } catch (const Error&) {
    throw;
  } catch (const std::bad_alloc&) {
    throw Error(ErrorKind::runtime, place, "there is no memory for the EXR", "make it smaller");
  } catch (const std::exception& e) {
    throw Error(ErrorKind::input, place, std::string("cannot read the EXR: ") + e.what());
  }
  const Imf::Header& header = file_->input->header();
  check_exr_windows(header, size_of(source), place);
  const Imath::Box2i& window = header.displayWindow();
  format = "openexr";
  width_px = window.max.x - window.min.x + 1;
  height_px = window.max.y - window.min.y + 1;
  is_deep = true;
  is_linear = true;
  std::uint64_t bytes = 0;
  for (auto channel = header.channels().begin(); channel != header.channels().end(); ++channel) {
    names.emplace_back(channel.name());
    bytes += channel.channel().type == Imf::HALF ? 2 : 4;
  }
  channels = static_cast<int>(names.size());
  decoded_bytes = bytes * std::max(pixels_of(window), pixels_of(header.dataWindow()));
}

ExrReader::~ExrReader() = default;

bool ExrReader::has(const std::string& name) const {
  return std::find(names.begin(), names.end(), name) != names.end();
}

std::vector<std::string> ExrReader::color_of(const std::string& layer) const {
  for (const char* const letters : {"RGBA", "rgba"}) {
    std::vector<std::string> color;
    for (const char* letter = letters; *letter != 0 && has(layer + *letter); ++letter) {
      color.push_back(layer + *letter);
    }
    if (color.size() >= 3) {
      return color;
    }
  }
  return {};
}

// With their dots: the only one that has color, or of several those that their name says are what is seen.
std::vector<std::string> ExrReader::layers_of_color() const {
  std::vector<std::string> layers;
  for (const std::string& name : names) {
    const std::string layer = name.substr(0, name.rfind('.') + 1);
    if (!layer.empty() && !color_of(layer).empty() && name == color_of(layer).front()) {
      layers.push_back(layer);
    }
  }
  for (const char* const usual : {"combined", "beauty", "rgba"}) {
    std::vector<std::string> seen;
    std::copy_if(layers.begin(), layers.end(), std::back_inserter(seen), [&](const std::string& layer) {
      return ("." + lower(layer)).ends_with("." + std::string(usual) + ".");
    });
    if (layers.size() > 1 && !seen.empty()) {
      return seen;
    }
  }
  return layers;
}

void ExrReader::choose_light() {
  const auto alone = [&](const char* name, const std::vector<const char*>& others) {
    return has(name) && std::none_of(others.begin(), others.end(), [&](const char* other) { return has(other); });
  };
  const std::vector<std::string> layers = layers_of_color();
  light_ = color_of("");
  if (light_.empty() && (alone("Y", {"RY", "BY", "R", "G", "B", "X"}) || alone("R", {"G", "B", "Y"}))) {
    light_ = {has("Y") ? "Y" : "R"};
    if (has("A")) {
      light_.emplace_back("A");
    }
  } else if (light_.empty() && layers.size() == 1) {
    light_ = color_of(layers.front());
  }
  if (light_.empty()) {
    throw Error(ErrorKind::input, place_, "the EXR has the channels " + joined(names) + ", none of which are its light",
                "name a picture with R, G and B, of which one layer is the only one or is called Combined, beauty or "
                "rgba, or with Y or R alone, which is grey");
  }
  channels = static_cast<int>(light_.size());
}

std::string ExrReader::read(int /*count*/, std::span<std::uint8_t> /*values*/) {
  return "its values have more than 8 bits";
}

std::string ExrReader::read(int count, std::span<float> values) {
  return read(std::span<const std::string>(light_).first(static_cast<std::size_t>(count)), values);
}

std::string ExrReader::read(std::span<const std::string> wanted, std::span<float> values) {
  const Imath::Box2i data = file_->input->header().dataWindow();
  const Imath::Box2i picture = file_->input->header().displayWindow();
  const Imath::Box2i both({std::max(data.min.x, picture.min.x), std::max(data.min.y, picture.min.y)},
                          {std::min(data.max.x, picture.max.x), std::min(data.max.y, picture.max.y)});
  const std::size_t step = wanted.size();
  // One line at a time, which all lines share; OpenEXR keeps the block that it has unpacked for the next.
  std::vector<float> line(static_cast<std::size_t>(data.max.x - data.min.x + 1) * step);
  std::fill(values.begin(), values.end(), 0.0F);
  for (const std::string& name : wanted) {
    const Imf::Channel& channel = file_->input->header().channels()[name];
    if (channel.xSampling != 1 || channel.ySampling != 1) {
      throw Error(ErrorKind::input, place_,
                  "the EXR's channel " + bounded(name, 40) + " is subsampled, " + std::to_string(channel.xSampling) +
                      " x " + std::to_string(channel.ySampling) + " pixels a value",
                  "write it with a value for each pixel");
    }
  }
  try {
    Imf::FrameBuffer buffer;
    for (std::size_t c = 0; c < step; ++c) {
      char* const first = reinterpret_cast<char*>(line.data() + c);
      const std::ptrdiff_t to_left = std::ptrdiff_t{data.min.x} * static_cast<std::ptrdiff_t>(step * sizeof(float));
      buffer.insert(wanted[c], Imf::Slice(Imf::FLOAT, first - to_left, step * sizeof(float), 0));
    }
    file_->input->setFrameBuffer(buffer);
    const auto offset = [step](int pixels) { return static_cast<std::size_t>(pixels) * step; };
    for (int y = both.min.y; y <= both.max.y; ++y) {
      file_->input->readPixels(y);
      const float* const from = line.data() + offset(both.min.x - data.min.x);
      const std::size_t row = static_cast<std::size_t>(y - picture.min.y) * static_cast<std::size_t>(width_px);
      std::copy(from, from + offset(both.max.x - both.min.x + 1),
                values.data() + row * step + offset(both.min.x - picture.min.x));
    }
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::exception& e) {
    return e.what();
  }
  return {};
}

}  // namespace gazetrace
