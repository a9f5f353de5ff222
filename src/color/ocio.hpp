// SPDX-License-Identifier: Apache-2.0
// The viewing transform, with no OpenColorIO types in sight.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "gazetrace/color.hpp"

namespace gazetrace {

// Linear Rec.709 -> display code values. Thread-safe once built.
class OcioView {
 public:
  explicit OcioView(const ColorSettings& settings);
  ~OcioView();
  OcioView(const OcioView&) = delete;
  OcioView& operator=(const OcioView&) = delete;

  // `count` RGB pixels. `out`: 8 or 16 bits a value, rounded to nearest. `rgb` may serve as work space.
  void apply_8(float* rgb, std::size_t count, std::uint8_t* out) const;
  void apply_16(float* rgb, std::size_t count, std::uint16_t* out) const;
  // In place, no quantisation: 1 is the display's white.
  void apply_float(float* rgb, std::size_t count) const;

  [[nodiscard]] const std::vector<ViewInfo>& views() const;
  [[nodiscard]] const std::string& description() const;
  [[nodiscard]] bool is_builtin_aces() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace gazetrace
