// SPDX-License-Identifier: Apache-2.0
// Pixels and header values of EXR files.
#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfDoubleAttribute.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfInputFile.h>
#include <OpenEXR/ImfInputPart.h>
#include <OpenEXR/ImfIntAttribute.h>
#include <OpenEXR/ImfMultiPartInputFile.h>
#include <OpenEXR/ImfRationalAttribute.h>
#include <OpenEXR/ImfStringAttribute.h>
#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <new>
#include <string>
#include <system_error>
#include <vector>

#include "core/exr_header.hpp"
#include "core/exr_reader.hpp"
#include "gazetrace/output.hpp"
#include "output/exr.hpp"
#include "output/exr_layers.hpp"

namespace gazetrace {
namespace {

// What `read` makes of an EXR; what OpenEXR throws becomes Error(input).
template <class Read>
auto read_exr(const std::string& path, const Read& read) {
  if (!std::filesystem::exists(path)) {
    throw Error(ErrorKind::input, path, "there is no such file");
  }
  try {
    check_exr_header(path, path);
    return read();
  } catch (const Error&) {
    throw;
  } catch (const std::bad_alloc&) {
    throw Error(ErrorKind::runtime, path, "there is no memory for the EXR", "make it smaller");
  } catch (const std::exception& e) {
    throw Error(ErrorKind::input, path, std::string("cannot read the EXR: ") + e.what());
  }
}

std::string gray_channel(const std::vector<std::string>& names) {
  if (names.size() == 1) {
    return names.front();
  }
  for (const char* name : {"Y", "samples_per_pixel", "R"}) {
    if (std::find(names.begin(), names.end(), name) != names.end()) {
      return name;
    }
  }
  return {};
}

}  // namespace

ImageRgb read_exr_rgb(const std::string& path) {
  return read_exr(path, [&] {
    ExrReader reader({"openexr", path, {}, false, false}, path);
    reader.choose_light();
    return read_rgb(reader, path);
  });
}

ImageGray read_exr_gray(const std::string& path) {
  return read_exr(path, [&] {
    ExrReader reader({"openexr", path, {}, false, false}, path);
    const std::string name = gray_channel(reader.names);
    if (name.empty()) {
      throw Error(ErrorKind::input, path, "the EXR has several channels, and none of them is Y, samples_per_pixel or R",
                  "write a picture of one channel");
    }
    ImageGray image(reader.width_px, reader.height_px);
    if (const std::string problem = reader.read({&name, 1}, image.pixels); !problem.empty()) {
      throw Error(ErrorKind::input, path, "cannot read the EXR: " + problem);
    }
    return image;
  });
}

std::vector<ExrLayers> read_exr_layers(const std::string& path) {
  return read_exr(path, [&] {
    Imf::MultiPartInputFile file(path.c_str(), 0);
    std::vector<ExrLayers> parts;
    for (int i = 0; i < file.parts(); ++i) {
      ExrLayers& part = parts.emplace_back();
      part.header = file.header(i);
      check_exr_windows(part.header, std::filesystem::file_size(path), path);
      const Imath::Box2i window = part.header.dataWindow();
      const int width = window.max.x - window.min.x + 1;
      const int height = window.max.y - window.min.y + 1;
      Imf::FrameBuffer buffer;
      const Imf::ChannelList& channels = part.header.channels();
      for (auto channel = channels.begin(); channel != channels.end(); ++channel) {
        ImageGray& image = part.channels[channel.name()] = ImageGray(width, height);
        buffer.insert(channel.name(), Imf::Slice::Make(Imf::FLOAT, image.pixels.data(), window, sizeof(float),
                                                       sizeof(float) * static_cast<std::size_t>(width)));
      }
      Imf::InputPart input(file, i);
      input.setFrameBuffer(buffer);
      input.readPixels(window.min.y, window.max.y);
    }
    return parts;
  });
}

std::string read_exr_text(const std::string& path, const std::string& attribute) {
  try {
    check_exr_header(path, path);
    Imf::MultiPartInputFile file(path.c_str(), 0);
    const auto* text = file.header(0).findTypedAttribute<Imf::StringAttribute>(attribute);
    for (int i = 0; i < file.parts(); ++i) {
      if (text == nullptr || !file.partComplete(i)) {
        return {};
      }
    }
    // A truncated copy still has its table of offsets, so the last block, at the end of the file, is read.
    Imf::InputPart last(file, file.parts() - 1);
    const char* pixels = nullptr;
    int size = 0;
    last.rawPixelData(last.header().dataWindow().max.y, pixels, size);
    return text->value();
  } catch (const std::exception&) {
    return {};
  }
}

std::optional<double> read_exr_number(const std::string& path, const std::string& attribute) {
  try {
    check_exr_header(path, path);
    Imf::InputFile file(path.c_str(), 0);
    if (const auto* number = file.header().findTypedAttribute<Imf::DoubleAttribute>(attribute)) {
      return number->value();
    }
    if (const auto* fraction = file.header().findTypedAttribute<Imf::RationalAttribute>(attribute)) {
      return static_cast<double>(fraction->value());
    }
  } catch (const std::exception&) {
    return std::nullopt;
  }
  return std::nullopt;
}

std::optional<std::int32_t> read_exr_integer(const std::string& path, const std::string& attribute) {
  try {
    check_exr_header(path, path);
    Imf::InputFile file(path.c_str(), 0);
    if (const auto* number = file.header().findTypedAttribute<Imf::IntAttribute>(attribute)) {
      return number->value();
    }
  } catch (const std::exception&) {
    return std::nullopt;
  }
  return std::nullopt;
}

}  // namespace gazetrace
