// SPDX-License-Identifier: Apache-2.0
// The viewing transform, without OpenColorIO's types.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "gazetrace/color.hpp"

namespace gazetrace {

// Converts linear Rec.709 to display code values. May be used from several threads at once.
class OcioView {
 public:
  explicit OcioView(const ColorSettings& given);
  ~OcioView();
  OcioView(const OcioView&) = delete;
  OcioView& operator=(const OcioView&) = delete;

  // Convert `count` RGB pixels to 8 or 16 bits per value, rounded to the nearest. `rgb` may be overwritten.
  void apply_8(float* rgb, std::size_t count, std::uint8_t* out) const;
  void apply_16(float* rgb, std::size_t count, std::uint16_t* out) const;
  // Converts in place and without quantisation; 1 is the display's white.
  void apply_float(float* rgb, std::size_t count) const;

  [[nodiscard]] const std::vector<ViewInfo>& views() const;
  [[nodiscard]] const Warnings& warnings() const;
  [[nodiscard]] const std::string& description() const;
  [[nodiscard]] bool is_builtin_aces() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace gazetrace
