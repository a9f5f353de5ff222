// SPDX-License-Identifier: Apache-2.0
#include "core/svg.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>

namespace gazetrace {

std::vector<double> ticks(const Axis& axis, double count) {
  std::vector<double> values;
  const double step = axis.tick(count);
  const double low = std::min(axis.low, axis.high);
  const double high = std::max(axis.low, axis.high);
  for (double k = std::ceil(low / step - 1e-9); k * step <= high + 1e-9 * step && values.size() < 40; ++k) {
    values.push_back(k == 0 ? 0 : k * step);
  }
  return values;
}

std::string escaped(const std::string& text) {
  std::string out;
  for (const char c : text) {
    out += c == '<' ? "&lt;" : c == '>' ? "&gt;" : c == '&' ? "&amp;" : c == '"' ? "&quot;" : std::string(1, c);
  }
  return out;
}

std::string base64(const std::string& bytes) {
  constexpr const char* kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve(bytes.size() * 4 / 3 + 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const std::size_t count = std::min<std::size_t>(3, bytes.size() - i);
    std::uint32_t block = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      block = block << 8U | (k < count ? static_cast<std::uint32_t>(static_cast<unsigned char>(bytes[i + k])) : 0U);
    }
    for (std::size_t k = 0; k < 4; ++k) {
      text += k <= count ? kDigits[block >> (18U - 6U * k) & 63U] : '=';
    }
  }
  return text;
}

}  // namespace gazetrace
