// SPDX-License-Identifier: Apache-2.0
// The chunks of an XDF file, separated into streams of numbers. Source of the format: github.com/sccn/xdf,
// Specifications.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>
#include <vector>

#include "gazetrace/error.hpp"

namespace gazetrace {

// A value out of the bytes of a binary recording, of which there must be enough.
template <class Value>
Value little_endian(const char* at) {
  std::array<unsigned char, sizeof(Value)> bytes{};
  std::memcpy(bytes.data(), at, sizeof(Value));
  if constexpr (std::endian::native == std::endian::big) {
    std::reverse(bytes.begin(), bytes.end());
  }
  return std::bit_cast<Value>(bytes);
}

struct XdfClockOffset {
  double time_s = 0, offset_s = 0;
};

struct XdfStream {
  std::uint32_t id = 0;
  std::string header;  // XML
  std::size_t channels = 0;
  std::string channel_format;  // "float32", ...
  double nominal_rate_hz = 0;
  std::vector<double> times_s;  // on the sender's clock
  std::vector<double> values;   // channels x samples, one sample after another
  std::vector<XdfClockOffset> offsets;
};

// `read_header` fills channels, channel_format and nominal_rate_hz from the XML. Streams of strings keep no values.
// After a damaged chunk, reading goes on at the next boundary, and `damages` tells of it.
std::vector<XdfStream> read_xdf(std::string_view bytes, const std::string& path, Warnings& damages,
                                void (*read_header)(XdfStream& stream));

// Puts the times on the common clock by adding offsets from a robust linear fit, which starts anew where the clock was
// reset by more than 5 s. For streams with a nominal rate the times are then spaced evenly between breaks of more than
// 1 s and 500 samples.
std::vector<double> synchronized_times_s(const XdfStream& stream);

}  // namespace gazetrace
