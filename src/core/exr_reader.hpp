// SPDX-License-Identifier: Apache-2.0
// Reads the pixels of EXR files. The picture is the display window: of an overscan its rim is cut off, and where a crop
// has no data it is black and transparent. Deep files, which have several values for a pixel, are refused.
#pragma once

#include <OpenEXR/ImfHeader.h>

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "core/picture_module.hpp"

namespace gazetrace {

// Error(input) where the windows of a picture are too large or its file of `bytes` bytes cannot hold them: the pixels
// are only the claim of a header of a few bytes. Of black pictures a byte holds up to 170 pixels where the compression
// is lossless, and up to 2700 where it is dwaa or dwab. A crop may be of any size within its picture.
void check_exr_windows(const Imf::Header& header, std::uint64_t bytes, const std::string& place);

class ExrReader final : public PictureReader {
 public:
  // The header, which check_exr_header() has passed. `place` is that of errors.
  ExrReader(const PictureSource& source, const std::string& place);
  ~ExrReader() override;

  std::vector<std::string> names;  // of all channels

  // Finds the channels that are light, and counts them as `channels`: R, G and B, or r, g and b, without a layer's
  // name, else Y or R where it is alone, which is gray (X and Y are no color), else those of the only layer that has
  // them or of the one that is called Combined, beauty or rgba; behind them A, where there is one. Error(input) where
  // there are none: of depth alone, say.
  void choose_light();

  std::string read(int count, std::span<std::uint8_t> values) override;  // never: EXRs are deep
  std::string read(int count, std::span<float> values) override;         // of the channels that are light
  // The channels of these names. Error(input) for those that have no value of their own for each pixel.
  std::string read(std::span<const std::string> wanted, std::span<float> values);

 private:
  [[nodiscard]] bool has(const std::string& name) const;
  // Of a layer, with its dot: three channels or, with alpha, four; or none.
  [[nodiscard]] std::vector<std::string> color_of(const std::string& layer) const;
  [[nodiscard]] std::vector<std::string> layers_of_color() const;

  struct File;
  std::unique_ptr<File> file_;
  std::vector<std::string> light_;
  std::string place_;
};

}  // namespace gazetrace
