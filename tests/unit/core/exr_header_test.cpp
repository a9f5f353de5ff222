// SPDX-License-Identifier: Apache-2.0
// Headers by the layout of openexr.com ("OpenEXR File Layout"), made by hand.
#include "core/exr_header.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>
#include <string>
#include <vector>

#include "gazetrace/error.hpp"

namespace gazetrace::exr_header_test {
namespace {

using ::testing::HasSubstr;

template <class T>
std::string bytes_of(T value) {
  std::string bytes(sizeof value, '\0');
  std::memcpy(bytes.data(), &value, sizeof value);
  return bytes;
}

std::string attribute(const std::string& name, const std::string& type, const std::string& value, int stated_more = 0) {
  const auto size = static_cast<std::int32_t>(value.size()) + stated_more;
  return name + '\0' + type + '\0' + bytes_of(size) + value;
}

std::string channel(const std::string& name) {
  return name + '\0' + bytes_of(std::int32_t{1}) + std::string(4, '\0') + bytes_of(std::int32_t{1}) +
         bytes_of(std::int32_t{1});
}

std::string box(int width, int height) {
  return bytes_of(std::int32_t{0}) + bytes_of(std::int32_t{0}) + bytes_of(width - 1) + bytes_of(height - 1);
}

const std::string kChannels = channel("B") + channel("G") + channel("R") + '\0';

// What is said of a file with these attributes, and something behind them.
std::string problem(const std::string& attributes) {
  const std::string file =
      bytes_of(std::uint32_t{20000630}) + bytes_of(std::uint32_t{2}) + attributes + '\0' + std::string(4000, 'x');
  const std::vector<std::uint8_t> bytes(file.begin(), file.end());
  try {
    check_exr_header(bytes, "a.exr");
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

TEST(ExrHeader, WhatOpenExrWritesIsTaken) {
  EXPECT_EQ(problem(attribute("channels", "chlist", kChannels) + attribute("compression", "compression", "\3") +
                    attribute("dataWindow", "box2i", box(640, 360)) + attribute("capDate", "string", "2026:01:01") +
                    attribute("views", "stringvector",
                              bytes_of(std::int32_t{4}) + "left" + bytes_of(std::int32_t{5}) + "right") +
                    attribute("preview", "preview",
                              bytes_of(std::int32_t{3}) + bytes_of(std::int32_t{2}) + std::string(24, 'p')) +
                    attribute("expTime", "float", bytes_of(0.5F)) + attribute("other", "ofOurOwn", "anything")),
            "");
}

// OpenEXR reads such values by what they are, not by the size that is stated, and takes what stands behind them for the
// next attribute, whose size may then be any bytes.
TEST(ExrHeader, AValueOfAnotherSizeThanIsStatedIsRefused) {
  const std::string tail(40, 'y');
  EXPECT_THAT(problem(attribute("channels", "chlist", kChannels + tail)), HasSubstr("'channels' states"));
  EXPECT_THAT(problem(attribute("channels", "chlist", kChannels, -5)), HasSubstr("'channels' states"));
  EXPECT_THAT(problem(attribute("expTime", "float", bytes_of(0.5F) + tail)), HasSubstr("'expTime' states 44 bytes"));
  EXPECT_THAT(problem(attribute("dataWindow", "box2i", box(640, 360) + tail)), HasSubstr("'dataWindow' states"));
  EXPECT_THAT(problem(attribute("aim", "v2d", bytes_of(1.0) + bytes_of(2.0) + tail)), HasSubstr("'aim' states"));
  EXPECT_THAT(problem(attribute("curve", "floatvector", bytes_of(1.0F) + "ab")), HasSubstr("'curve' states"));
  EXPECT_THAT(problem(attribute("views", "stringvector", bytes_of(std::uint32_t{0x7fffffff}) + "left")),
              HasSubstr("longer than its attribute"));
  EXPECT_THAT(
      problem(attribute("preview", "preview", bytes_of(std::uint32_t{60000}) + bytes_of(std::uint32_t{60000}) + tail)),
      HasSubstr("'preview' states"));
  EXPECT_THAT(problem(attribute("dataWindow", "box2i", box(1 << 20, 360))), HasSubstr("a window of 1048576 x 360"));
}

}  // namespace
}  // namespace gazetrace::exr_header_test
