// SPDX-License-Identifier: Apache-2.0
// The content of an EXR file, as OpenEXR itself reads it.
#pragma once

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfChromaticitiesAttribute.h>
#include <OpenEXR/ImfDoubleAttribute.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfInputFile.h>
#include <OpenEXR/ImfIntAttribute.h>
#include <OpenEXR/ImfMatrixAttribute.h>
#include <OpenEXR/ImfRationalAttribute.h>
#include <OpenEXR/ImfStringAttribute.h>
#include <fmt/format.h>

#include <array>
#include <map>
#include <string>
#include <vector>

// "R half", "depth.Z float".
inline std::vector<std::string> exr_channels(const std::string& path) {
  const Imf::InputFile file(path.c_str(), 0);
  std::vector<std::string> channels;
  for (auto it = file.header().channels().begin(); it != file.header().channels().end(); ++it) {
    const Imf::PixelType type = it.channel().type;
    channels.push_back(std::string(it.name()) + (type == Imf::HALF    ? " half"
                                                 : type == Imf::FLOAT ? " float"
                                                                      : " uint"));
  }
  return channels;
}

inline float exr_value(const std::string& path, const std::string& channel, int x, int y) {
  Imf::InputFile file(path.c_str(), 0);
  const Imath::Box2i window = file.header().dataWindow();
  const auto width = static_cast<std::size_t>(window.max.x + 1);
  std::vector<float> values(width * static_cast<std::size_t>(window.max.y + 1));
  Imf::FrameBuffer buffer;
  buffer.insert(channel, Imf::Slice::Make(Imf::FLOAT, values.data(), window));
  file.setFrameBuffer(buffer);
  file.readPixels(0, window.max.y);
  return values[static_cast<std::size_t>(y) * width + static_cast<std::size_t>(x)];
}

// The attributes whose types are text or numbers, as text.
inline std::map<std::string, std::string> exr_attributes(const std::string& path) {
  const Imf::InputFile file(path.c_str(), 0);
  std::map<std::string, std::string> texts;
  for (auto it = file.header().begin(); it != file.header().end(); ++it) {
    const Imf::Attribute* attribute = &it.attribute();
    std::string text = attribute->typeName();
    if (const auto* string = dynamic_cast<const Imf::StringAttribute*>(attribute)) {
      text = string->value();
    } else if (const auto* integer = dynamic_cast<const Imf::IntAttribute*>(attribute)) {
      text = std::to_string(integer->value());
    } else if (const auto* number = dynamic_cast<const Imf::DoubleAttribute*>(attribute)) {
      text = fmt::format("{}", number->value());
    } else if (const auto* rational = dynamic_cast<const Imf::RationalAttribute*>(attribute)) {
      text = fmt::format("{}/{}", rational->value().n, rational->value().d);
    } else if (const auto* c = dynamic_cast<const Imf::ChromaticitiesAttribute*>(attribute)) {
      const Imf::Chromaticities& v = c->value();
      text = fmt::format("{} {} {} {} {} {} {} {}", v.red.x, v.red.y, v.green.x, v.green.y, v.blue.x, v.blue.y,
                         v.white.x, v.white.y);
    }
    texts[it.name()] = text;
  }
  return texts;
}

inline std::array<float, 3> exr_transform(const std::string& path, const std::string& matrix, const Imath::V3f& point) {
  const Imf::InputFile file(path.c_str(), 0);
  const Imath::V3f out = point * file.header().typedAttribute<Imf::M44fAttribute>(matrix).value();
  return {out.x, out.y, out.z};
}
