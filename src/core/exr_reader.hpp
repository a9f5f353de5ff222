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

// A channel of a part.
struct ExrChannel {
  int part = 0;
  std::string name;
};

// Where a channel's values go: the one of pixel (x, y) of a window to first[(y * width + x) * step].
struct ExrTarget {
  std::string name;
  float* first = nullptr;
  std::size_t step = 1;
};

class ExrReader final : public PictureReader {
 public:
  ~ExrReader() override;

  // Finds the channels that are light, and counts them as `channels`: R, G and B, or r, g and b, without a layer's
  // name, else Y or R where it is alone in a file of one part, which is gray (X and Y are no color), else those of the
  // only layer that has them or of the one that is called Combined, beauty or rgba; behind them A, where there is one.
  // A part is a layer, and its name counts as one. Error(input) where there are none: of depth alone, say.
  void choose_light();
  // Makes a channel of one of these names the picture; where there is but one channel, that one.
  void choose_channel(const std::vector<std::string>& wanted);

  std::string read(int count, std::span<std::uint8_t> values) override;  // never: EXRs are deep
  std::string read(int count, std::span<float> values) override;         // of the channels that were chosen

  [[nodiscard]] int parts() const;
  // Whether all blocks are there: a copy that was cut still has its table of them, so the last one is read.
  [[nodiscard]] bool is_whole() const;
  [[nodiscard]] const Imf::Header& header(int part) const;
  // Those of the window's values for which the part has data. Error(input) for channels that have no value of their own
  // for each pixel; what is wrong with the file, or nothing.
  std::string read(int part, const Imath::Box2i& window, std::span<const ExrTarget> targets);

 private:
  friend std::unique_ptr<ExrReader> open_exr(const PictureInput& input, const std::string& place);
  ExrReader(const PictureInput& input, const std::string& place);

  struct Light;
  [[nodiscard]] Light light_of(int part, const std::string& layer) const;
  [[nodiscard]] std::vector<Light> lights() const;
  [[nodiscard]] std::vector<Light> gray_of_one_part() const;
  [[noreturn]] void refuse(const std::vector<Light>& lights) const;
  void take(int part, std::vector<std::string> chosen);

  struct File;
  std::unique_ptr<File> file_;
  std::vector<ExrChannel> all_;  // of the parts that are not deep
  int part_ = 0;
  std::vector<std::string> chosen_;
  std::string place_;
  std::uint64_t file_bytes_ = 0;
};

// The only way to a reader, and so to what an EXR holds: its header is looked at before OpenEXR sees it. `place` is
// that of errors, Error(input) for what is no EXR, and for deep ones.
std::unique_ptr<ExrReader> open_exr(const PictureInput& input, const std::string& place);

}  // namespace gazetrace
