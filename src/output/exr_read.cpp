// SPDX-License-Identifier: Apache-2.0
// Pixels and header values of EXR files.
#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfDoubleAttribute.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfIntAttribute.h>
#include <OpenEXR/ImfRationalAttribute.h>
#include <OpenEXR/ImfStringAttribute.h>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <utility>
#include <vector>

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
  const std::unique_ptr<ExrReader> reader = open_exr(path, path);
  std::vector<ExrLayers> parts;
  for (int i = 0; i < reader->parts(); ++i) {
    ExrLayers& part = parts.emplace_back();
    part.header = reader->header(i);
    check_exr_windows(part.header, std::filesystem::file_size(path), path);
    const Imath::Box2i window = part.header.dataWindow();
    std::vector<ExrTarget> targets;
    const Imf::ChannelList& channels = part.header.channels();
    for (auto channel = channels.begin(); channel != channels.end(); ++channel) {
      ImageGray& image = part.channels[channel.name()] =
          ImageGray(window.max.x - window.min.x + 1, window.max.y - window.min.y + 1);
      targets.push_back({channel.name(), image.pixels.data()});
    }
    if (const std::string problem = reader->read(i, window, targets); !problem.empty()) {
      throw Error(ErrorKind::input, path, "cannot read the EXR: " + problem);
    }
  }
  return parts;
}

namespace {

// What `read` finds in the header of the file's first part; nothing where there is no such file, or it is damaged.
template <class Read>
auto from_header(const std::string& path, const Read& read) -> decltype(read(std::declval<const ExrReader&>())) {
  try {
    return read(*open_exr(path, path));
  } catch (const std::exception&) {
    return {};
  }
}

}  // namespace

std::string read_exr_text(const std::string& path, const std::string& attribute) {
  return from_header(path, [&](const ExrReader& file) {
    const auto* text = file.header(0).findTypedAttribute<Imf::StringAttribute>(attribute);
    return text == nullptr || !file.is_whole() ? std::string() : text->value();
  });
}

std::optional<double> read_exr_number(const std::string& path, const std::string& attribute) {
  return from_header(path, [&](const ExrReader& file) -> std::optional<double> {
    if (const auto* number = file.header(0).findTypedAttribute<Imf::DoubleAttribute>(attribute)) {
      return number->value();
    }
    if (const auto* fraction = file.header(0).findTypedAttribute<Imf::RationalAttribute>(attribute)) {
      return static_cast<double>(fraction->value());
    }
    return std::nullopt;
  });
}

std::optional<std::int32_t> read_exr_integer(const std::string& path, const std::string& attribute) {
  return from_header(path, [&](const ExrReader& file) -> std::optional<std::int32_t> {
    const auto* number = file.header(0).findTypedAttribute<Imf::IntAttribute>(attribute);
    return number == nullptr ? std::nullopt : std::optional(number->value());
  });
}

}  // namespace gazetrace
