// SPDX-License-Identifier: Apache-2.0
// An EXR file as it is put together: its channels, the buffers that they are written from, and its parts.
#pragma once

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <half.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <string>
#include <vector>

#include "gazetrace/image.hpp"
#include "gazetrace/output.hpp"

namespace gazetrace {

class ExrPicture {
 public:
  // Error(usage) for an unknown compression. With ExrParts::multi every layer becomes a part of the file.
  ExrPicture(int width_px, int height_px, const ExrSettings& settings, int threads);

  // Where the picture lies in its frame; before anything is added.
  void place(const FrameWindow& window);

  // Of the whole file. What must be the same in all parts (time code, chromaticities) is copied into each.
  Imf::Header& header() { return header_; }
  [[nodiscard]] std::uint64_t clamped() const { return clamped_; }

  // What is added from here on belongs to this layer; texts are attributes of the part that holds it.
  void begin_layer(const std::string& name);
  void add_text(const std::string& name, const std::string& value);

  // Images are kept by reference and must outlive write().
  void add_float(const std::string& name, const ImageGray& image);
  void add_constant(const std::string& name, float value);
  void add_own(const std::string& name, ImageGray image);  // kept by value
  void add_float_rgb(const std::array<std::string, 3>& names, const ImageRgb& image);
  void add_half_rgb(const std::array<std::string, 3>& names, const ImageRgb& image);
  // In ExrSettings::space.
  void add_color(const std::array<std::string, 3>& names, const ImageRgb& image, ExrPixels pixels);
  // A number from 0 to 1, as ExrSettings::pixels says.
  void add_share(const std::string& name, const ImageGray& image);

  WrittenFile write(const std::string& path, std::int32_t frame);

 private:
  struct Part {
    std::string name;
    Imf::ChannelList channels;
    Imf::FrameBuffer buffer;
    std::vector<std::array<std::string, 2>> texts;
    bool holds_numbers = false;  // other than light
  };

  // As halves, clamped to their range; they live as long as the picture.
  std::vector<half>& halves_of(const float* values, std::size_t count);
  void insert(const std::string& name, Imf::PixelType type, const char* first, std::size_t stride);
  [[nodiscard]] Imf::Header header_of(const Part& part, bool first) const;

  Imf::Header header_;
  ExrSettings settings_;
  std::vector<Part> parts_;
  std::deque<std::vector<half>> halves_;  // deques, since the buffers must not move
  std::deque<ImageGray> own_;
  std::deque<ImageRgb> own_rgb_;
  int width_px_, height_px_, threads_;
  std::uint64_t clamped_ = 0;
};

}  // namespace gazetrace
