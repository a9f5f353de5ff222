// SPDX-License-Identifier: Apache-2.0
// Reads the pixels of EXR files. The picture is the display window: of an overscan its rim is cut off, and where a crop
// has no data it is black and transparent.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "core/picture_module.hpp"

namespace gazetrace {

class ExrReader final : public PictureReader {
 public:
  // The header, which check_exr_header() has passed. `place` is that of errors.
  ExrReader(const PictureSource& source, const std::string& place);
  ~ExrReader() override;

  std::vector<std::string> names;  // of all channels

  // Finds the channels that are light, and counts them as `channels`: R, G and B, without a layer's name or of the only
  // layer that has them; else Y or R where it is alone, which is gray (X and Y are no color); behind them A, where
  // there is one. Error(input) where there are none: of depth alone, say.
  void choose_light();

  std::string read(int count, std::span<std::uint8_t> values) override;  // never: EXRs are deep
  std::string read(int count, std::span<float> values) override;         // of the channels that are light
  // The channels of these names.
  std::string read(std::span<const std::string> wanted, std::span<float> values);

 private:
  [[nodiscard]] bool has(const std::string& name) const;

  struct File;
  std::unique_ptr<File> file_;
  std::vector<std::string> light_;
  std::string place_;
};

}  // namespace gazetrace
