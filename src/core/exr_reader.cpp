// SPDX-License-Identifier: Apache-2.0
#include "core/exr_reader.hpp"

#include <OpenEXR/Iex.h>
#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfIO.h>
#include <OpenEXR/ImfInputPart.h>
#include <OpenEXR/ImfMultiPartInputFile.h>
#include <OpenEXR/ImfPartType.h>
#include <OpenEXR/ImfPixelType.h>
#include <OpenEXR/ImfStandardAttributes.h>

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <iterator>
#include <system_error>
#include <utility>

#include "core/exr_header.hpp"
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

std::uint64_t size_of(const PictureInput& input) {
  std::error_code ignored;
  const std::uint64_t bytes = input.path.empty() ? input.bytes.size() : std::filesystem::file_size(input.path, ignored);
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

std::string joined(const std::vector<std::string>& names) {
  constexpr std::size_t kMost = 8;
  std::string text;
  for (std::size_t i = 0; i < std::min(names.size(), kMost); ++i) {
    text += (i == 0 ? "" : ", ") + bounded(names[i], 40);
  }
  return names.size() > kMost ? text + ", ..." : text;
}

Imath::Box2i overlap(const Imath::Box2i& a, const Imath::Box2i& b) {
  return {{std::max(a.min.x, b.min.x), std::max(a.min.y, b.min.y)},
          {std::min(a.max.x, b.max.x), std::min(a.max.y, b.max.y)}};
}

int width_of(const Imath::Box2i& window) {
  return window.max.x - window.min.x + 1;
}

}  // namespace

struct ExrReader::File {
  std::unique_ptr<MemoryStream> stream;
  std::unique_ptr<Imf::MultiPartInputFile> input;
};

// Channels that are the color of one picture.
struct ExrReader::Light {
  int part = 0;
  std::string layer;                  // with its dot; empty: none
  std::vector<std::string> channels;  // three or, with alpha, four; or none
};

ExrReader::ExrReader(const PictureInput& input, const std::string& place)
    : file_(std::make_unique<File>()), place_(place), file_bytes_(size_of(input)) {
  try {
    if (!input.path.empty()) {
      file_->input = std::make_unique<Imf::MultiPartInputFile>(input.path.c_str(), 0);
    } else {
      file_->stream = std::make_unique<MemoryStream>(input.bytes);
      file_->input = std::make_unique<Imf::MultiPartInputFile>(*file_->stream, 0);
    }
  } catch (const std::bad_alloc&) {
    throw Error(ErrorKind::runtime, place, "there is no memory for the EXR", "make it smaller");
  } catch (const std::exception& e) {
    throw Error(ErrorKind::input, place, std::string("cannot read the EXR: ") + e.what());
  }
  format = "openexr";
  facts.is_deep = facts.is_linear = true;
  for (int part = 0; part < parts(); ++part) {
    for (auto channel = header(part).channels().begin(); channel != header(part).channels().end(); ++channel) {
      if (!Imf::isDeepData(header(part).type())) {
        all_.push_back({part, channel.name()});
      }
    }
  }
  // Of a deep part OpenEXR would lay each pixel's samples over each other, where they have a depth.
  if (all_.empty() && Imf::isDeepData(header(0).type())) {
    throw Error(ErrorKind::input, place, "a deep EXR (" + header(0).type() + ") has several values for a pixel",
                "flatten it");
  }
}

ExrReader::~ExrReader() = default;

std::unique_ptr<ExrReader> open_exr(const PictureInput& input, const std::string& place) {
  std::error_code ignored;
  if (input.path.empty()) {
    check_exr_header(input.bytes, place);
  } else if (std::filesystem::is_regular_file(input.path, ignored)) {
    check_exr_header(input.path, place);
  } else {
    throw Error(ErrorKind::input, place, "there is no such file");
  }
  return std::unique_ptr<ExrReader>(new ExrReader(input, place));
}

int ExrReader::parts() const {
  return file_->input->parts();
}

const Imf::Header& ExrReader::header(int part) const {
  return file_->input->header(part);
}

bool ExrReader::is_whole() const {
  try {
    for (int part = 0; part < parts(); ++part) {
      if (!file_->input->partComplete(part)) {
        return false;
      }
    }
    Imf::InputPart last(*file_->input, parts() - 1);
    const char* pixels = nullptr;
    int size = 0;
    last.rawPixelData(last.header().dataWindow().max.y, pixels, size);
    return true;
  } catch (const std::exception&) {
    return false;
  }
}

ExrReader::Light ExrReader::light_of(int part, const std::string& layer) const {
  const auto has = [&](const std::string& name) {
    return std::any_of(all_.begin(), all_.end(),
                       [&](const ExrChannel& channel) { return channel.part == part && channel.name == name; });
  };
  for (const char* const letters : {"RGBA", "rgba"}) {
    Light light{part, layer, {}};
    for (const char* letter = letters; *letter != 0 && has(layer + *letter); ++letter) {
      light.channels.push_back(layer + *letter);
    }
    if (light.channels.size() >= 3) {
      return light;
    }
  }
  return {};
}

// All that are color; of several those whose name says that they are what is seen, or else those without a layer's
// name.
std::vector<ExrReader::Light> ExrReader::lights() const {
  std::vector<Light> all;
  for (const ExrChannel& channel : all_) {
    const Light light = light_of(channel.part, channel.name.substr(0, channel.name.rfind('.') + 1));
    if (!light.channels.empty() && channel.name == light.channels.front()) {
      all.push_back(light);
    }
  }
  const auto only = [&](const auto& is_wanted) {
    std::vector<Light> some;
    std::copy_if(all.begin(), all.end(), std::back_inserter(some), is_wanted);
    all = all.size() > 1 && !some.empty() ? some : all;
  };
  const auto is_root = [](const Light& light) { return light.layer.empty(); };
  if (parts() == 1) {
    only(is_root);
  }
  for (const char* const usual : {"combined", "beauty", "rgba"}) {
    only([&](const Light& light) {
      const Imf::Header& part = header(light.part);
      const std::string end = "." + std::string(usual) + ".";
      return ("." + lower(light.layer)).ends_with(end) ||
             (light.layer.empty() && part.hasName() && ("." + lower(part.name()) + ".").ends_with(end));
    });
  }
  only(is_root);
  return all;
}

// Y or R that no other color stands beside.
std::vector<ExrReader::Light> ExrReader::gray_of_one_part() const {
  std::vector<std::string> names;
  for (const ExrChannel& channel : all_) {
    names.push_back(channel.name);
  }
  const auto has = [&](const char* name) { return std::find(names.begin(), names.end(), name) != names.end(); };
  const auto alone = [&](const char* name, const std::vector<const char*>& others) {
    return has(name) && std::none_of(others.begin(), others.end(), has);
  };
  if (parts() > 1 || !(alone("Y", {"RY", "BY", "R", "G", "B", "X"}) || alone("R", {"G", "B", "Y"}))) {
    return {};
  }
  Light gray{0, "", {has("Y") ? "Y" : "R"}};
  if (has("A")) {
    gray.channels.emplace_back("A");
  }
  return {gray};
}

void ExrReader::refuse(const std::vector<Light>& lights) const {
  std::vector<std::string> names;
  for (const ExrChannel& channel : all_) {
    const Imf::Header& part = header(channel.part);
    names.push_back((parts() > 1 && part.hasName() ? part.name() + ":" : "") + channel.name);
  }
  const auto has = [&](const char* name) { return std::find(names.begin(), names.end(), name) != names.end(); };
  const std::string kind = lights.size() > 1        ? "several layers of color, and nothing tells which is its light"
                           : has("RY") && has("BY") ? "luminance and chroma, which are not read"
                                                    : "none of which are its light";
  throw Error(ErrorKind::input, place_, "the EXR has the channels " + joined(names) + ", " + kind,
              "name a picture with R, G and B, of which one layer is the only one or is called Combined, beauty or "
              "rgba, or with Y or R alone, which is grey");
}

void ExrReader::choose_light() {
  std::vector<Light> found = lights();
  if (found.empty()) {
    found = gray_of_one_part();
  }
  if (found.size() != 1) {
    refuse(found);
  }
  const std::string& layer = found.front().layer;
  facts.layer = layer.substr(0, layer.empty() ? 0 : layer.size() - 1);
  take(found.front().part, found.front().channels);
  facts.alpha = channels % 2 == 0 ? Alpha::premultiplied : Alpha::none;
}

void ExrReader::choose_channel(const std::vector<std::string>& wanted) {
  for (const std::string& name : wanted) {
    const auto found = std::find_if(all_.begin(), all_.end(), [&](const ExrChannel& c) { return c.name == name; });
    if (all_.size() > 1 && found != all_.end()) {
      take(found->part, {name});
      return;
    }
  }
  if (all_.size() != 1) {
    std::string names;
    for (std::size_t i = 0; i < wanted.size(); ++i) {
      names += (i == 0 ? "" : i + 1 < wanted.size() ? ", " : " or ") + wanted[i];
    }
    throw Error(ErrorKind::input, place_, "the EXR has several channels, and none of them is " + names,
                "write a picture of one channel");
  }
  take(all_.front().part, {all_.front().name});
}

void ExrReader::take(int part, std::vector<std::string> chosen) {
  part_ = part;
  chosen_ = std::move(chosen);
  channels = static_cast<int>(chosen_.size());
  const Imf::Header& from = header(part);
  check_exr_windows(from, file_bytes_, place_);
  const Imath::Box2i& window = from.displayWindow();
  facts.x_px = window.min.x;
  facts.y_px = window.min.y;
  facts.width_px = width_of(window);
  facts.height_px = window.max.y - window.min.y + 1;
  facts.part = from.hasName() ? from.name() : "";
  facts.is_half = from.channels()[chosen_.front()].type == Imf::HALF;
  facts.is_cube_map = Imf::hasEnvmap(from) && Imf::envmap(from) == Imf::ENVMAP_CUBE;
  if (Imf::hasChromaticities(from)) {
    const Imf::Chromaticities& c = Imf::chromaticities(from);
    const auto point = [](const Imath::V2f& v) { return Vec2d{static_cast<double>(v.x), static_cast<double>(v.y)}; };
    facts.primaries = Primaries{point(c.red), point(c.green), point(c.blue), point(c.white)};
  }
  std::uint64_t bytes = 0;
  for (auto channel = from.channels().begin(); channel != from.channels().end(); ++channel) {
    bytes += channel.channel().type == Imf::HALF ? 2U : 4U;
  }
  decoded_bytes = bytes * std::max(pixels_of(window), pixels_of(from.dataWindow()));
}

std::string ExrReader::read(int /*count*/, std::span<std::uint8_t> /*values*/) {
  return "its values have more than 8 bits";
}

std::string ExrReader::read(int count, std::span<float> values) {
  const auto step = static_cast<std::size_t>(count);
  std::vector<ExrTarget> targets;
  for (std::size_t c = 0; c < step; ++c) {
    targets.push_back({chosen_[c], values.data() + c, step});
  }
  std::fill(values.begin(), values.end(), 0.0F);
  return read(part_, header(part_).displayWindow(), targets);
}

std::string ExrReader::read(int part, const Imath::Box2i& window, std::span<const ExrTarget> targets) {
  const Imath::Box2i data = header(part).dataWindow();
  const Imath::Box2i both = overlap(data, window);
  for (const ExrTarget& target : targets) {
    const Imf::Channel& channel = header(part).channels()[target.name];
    if (channel.xSampling != 1 || channel.ySampling != 1) {
      throw Error(ErrorKind::input, place_,
                  "the EXR's channel " + bounded(target.name, 40) + " is subsampled, " +
                      std::to_string(channel.xSampling) + " x " + std::to_string(channel.ySampling) + " pixels a value",
                  "write it with a value for each pixel");
    }
  }
  // One line at a time, which all lines share; OpenEXR keeps the block that it has unpacked for the next.
  const auto width = static_cast<std::size_t>(width_of(data));
  std::vector<float> line(width * targets.size());
  try {
    Imf::InputPart input(*file_->input, part);
    Imf::FrameBuffer buffer;
    for (std::size_t c = 0; c < targets.size(); ++c) {
      char* const first = reinterpret_cast<char*>(line.data() + c * width);
      const std::ptrdiff_t to_left = std::ptrdiff_t{data.min.x} * static_cast<std::ptrdiff_t>(sizeof(float));
      buffer.insert(targets[c].name, Imf::Slice(Imf::FLOAT, first - to_left, sizeof(float), 0));
    }
    input.setFrameBuffer(buffer);
    for (int y = both.min.y; y <= both.max.y; ++y) {
      input.readPixels(y);
      const std::size_t first_pixel =
          static_cast<std::size_t>(y - window.min.y) * static_cast<std::size_t>(width_of(window)) +
          static_cast<std::size_t>(both.min.x - window.min.x);
      for (std::size_t c = 0; c < targets.size(); ++c) {
        const float* from = line.data() + c * width + (both.min.x - data.min.x);
        float* to = targets[c].first + first_pixel * targets[c].step;
        for (int x = both.min.x; x <= both.max.x; ++x, to += targets[c].step) {
          *to = *from++;
        }
      }
    }
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::exception& e) {
    return e.what();
  }
  return {};
}

}  // namespace gazetrace
