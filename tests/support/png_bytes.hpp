// SPDX-License-Identifier: Apache-2.0
// Makes the bytes of a PNG file from the format's specification, so that reading is tested against something other than
// the library that reads.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <string_view>
#include <vector>

namespace gazetrace::test {

enum class PngColor : std::uint8_t { gray = 0, rgb = 2, gray_alpha = 4, rgba = 6 };

// `samples`: rows from the top, interleaved; 8 or 16 bits each. Uncompressed (stored) deflate blocks.
inline std::vector<std::uint8_t> png_bytes(int width, int height, PngColor color, int bits,
                                           const std::vector<std::uint16_t>& samples) {
  std::vector<std::uint8_t> file{0x89, 'P', 'N', 'G', 13, 10, 26, 10};
  const auto put32 = [](std::vector<std::uint8_t>& to, std::uint32_t value) {
    for (const unsigned shift : {24U, 16U, 8U, 0U}) {
      to.push_back(static_cast<std::uint8_t>(value >> shift & 0xFFU));
    }
  };
  const auto chunk = [&](std::string_view type, const std::vector<std::uint8_t>& data) {
    put32(file, static_cast<std::uint32_t>(data.size()));
    std::vector<std::uint8_t> body(type.begin(), type.end());
    body.insert(body.end(), data.begin(), data.end());
    std::uint32_t crc = 0xFFFFFFFFU;
    for (const std::uint8_t byte : body) {
      crc ^= byte;
      for (int k = 0; k < 8; ++k) {
        crc = (crc & 1U) != 0 ? 0xEDB88320U ^ (crc >> 1U) : crc >> 1U;
      }
    }
    file.insert(file.end(), body.begin(), body.end());
    put32(file, ~crc);
  };
  std::vector<std::uint8_t> header;
  put32(header, static_cast<std::uint32_t>(width));
  put32(header, static_cast<std::uint32_t>(height));
  header.insert(header.end(), {static_cast<std::uint8_t>(bits), static_cast<std::uint8_t>(color), 0, 0, 0});
  chunk("IHDR", header);

  std::vector<std::uint8_t> raw;
  const std::size_t row = samples.size() / static_cast<std::size_t>(height);
  for (std::size_t i = 0; i < samples.size(); ++i) {
    if (i % row == 0) {
      raw.push_back(0);  // no filter
    }
    if (bits == 16) {
      raw.push_back(static_cast<std::uint8_t>(samples[i] >> 8U));
    }
    raw.push_back(static_cast<std::uint8_t>(samples[i] & 0xFFU));
  }
  std::vector<std::uint8_t> zlib{0x78, 0x01};
  for (std::size_t at = 0; at < raw.size(); at += 65535) {
    const std::size_t length = std::min<std::size_t>(65535, raw.size() - at);
    zlib.push_back(at + length == raw.size() ? 1 : 0);
    for (const std::size_t word : {length, ~length}) {
      zlib.push_back(static_cast<std::uint8_t>(word & 0xFFU));
      zlib.push_back(static_cast<std::uint8_t>(word >> 8U & 0xFFU));
    }
    zlib.insert(zlib.end(), raw.begin() + static_cast<std::ptrdiff_t>(at),
                raw.begin() + static_cast<std::ptrdiff_t>(at + length));
  }
  std::uint32_t a = 1;
  std::uint32_t b = 0;
  for (const std::uint8_t byte : raw) {
    a = (a + byte) % 65521U;
    b = (b + a) % 65521U;
  }
  put32(zlib, b << 16U | a);
  chunk("IDAT", zlib);
  chunk("IEND", {});
  return file;
}

}  // namespace gazetrace::test
