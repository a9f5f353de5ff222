// SPDX-License-Identifier: Apache-2.0
// Pixels and header values of EXR files.
#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfDoubleAttribute.h>
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
#include <string>
#include <system_error>
#include <vector>

#include "core/exr_header.hpp"
#include "core/exr_reader.hpp"
#include "core/image_io.hpp"
#include "gazetrace/output.hpp"
#include "output/exr.hpp"
#include "output/exr_layers.hpp"

namespace gazetrace {

ImageRgb read_exr_rgb(const std::string& path) {
  return read_picture(path).rgb;
}

std::vector<ExrLayers> read_exr_layers(const std::string& path) {
  if (!std::filesystem::exists(path)) {
    throw Error(ErrorKind::input, path, "there is no such file");
  }
  check_exr_header(path, path);
  ExrReader reader({"openexr", path, {}, false}, path);
  std::vector<ExrLayers> parts;
  for (int i = 0; i < reader.parts(); ++i) {
    ExrLayers& part = parts.emplace_back();
    part.header = reader.header(i);
    check_exr_windows(part.header, std::filesystem::file_size(path), path);
    const Imath::Box2i window = part.header.dataWindow();
    std::vector<ExrTarget> targets;
    const Imf::ChannelList& channels = part.header.channels();
    for (auto channel = channels.begin(); channel != channels.end(); ++channel) {
      ImageGray& image = part.channels[channel.name()] =
          ImageGray(window.max.x - window.min.x + 1, window.max.y - window.min.y + 1);
      targets.push_back({channel.name(), image.pixels.data()});
    }
    if (const std::string problem = reader.read(i, window, targets); !problem.empty()) {
      throw Error(ErrorKind::input, path, "cannot read the EXR: " + problem);
    }
  }
  return parts;
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
