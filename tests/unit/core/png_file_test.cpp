// SPDX-License-Identifier: Apache-2.0
// PNG files that are damaged, or that carry chunks of no use: read or refused with one line, and nothing printed.
#include "core/png_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <string_view>

#include "core/image_io.hpp"
#include "gazetrace/error.hpp"
#include "support/picture_leaks.hpp"
#include "support/png_bytes.hpp"
#include "support/temporary_folder.hpp"

namespace gazetrace::png_file_test {
namespace {

using Bytes = std::vector<std::uint8_t>;
using ::testing::HasSubstr;
using ::testing::Not;

constexpr std::size_t kAfterHeader = 8 + 25;  // where a PNG's second chunk begins

void put32(Bytes& to, std::uint32_t value) {
  for (const unsigned shift : {24U, 16U, 8U, 0U}) {
    to.push_back(static_cast<std::uint8_t>(value >> shift & 0xFFU));
  }
}

// Bit by bit, as ISO/IEC 15948 defines it.
std::uint32_t checksum(const Bytes& bytes) {
  std::uint32_t crc = 0xFFFFFFFFU;
  for (const std::uint8_t byte : bytes) {
    crc ^= byte;
    for (int k = 0; k < 8; ++k) {
      crc = (crc & 1U) != 0 ? 0xEDB88320U ^ (crc >> 1U) : crc >> 1U;
    }
  }
  return ~crc;
}

Bytes chunk(std::string_view type, const Bytes& data) {
  Bytes body(type.begin(), type.end());
  body.insert(body.end(), data.begin(), data.end());
  Bytes bytes;
  put32(bytes, static_cast<std::uint32_t>(data.size()));
  bytes.insert(bytes.end(), body.begin(), body.end());
  put32(bytes, checksum(body));
  return bytes;
}

Bytes header(std::uint32_t width, std::uint32_t height, std::uint8_t depth, std::uint8_t color,
             const Bytes& methods = {0, 0, 0}) {
  Bytes data;
  put32(data, width);
  put32(data, height);
  data.insert(data.end(), {depth, color});
  data.insert(data.end(), methods.begin(), methods.end());
  return chunk("IHDR", data);
}

Bytes joined(const std::vector<Bytes>& parts) {
  Bytes all;
  for (const Bytes& part : parts) {
    all.insert(all.end(), part.begin(), part.end());
  }
  return all;
}

// 9 x 3 pixels of 8 bits, every one different.
Bytes good_png() {
  std::vector<std::uint16_t> samples;
  for (std::uint16_t i = 0; i < 9 * 3 * 3; ++i) {
    samples.push_back(static_cast<std::uint16_t>(3 * i));
  }
  return test::png_bytes(9, 3, test::PngColor::rgb, 8, samples);
}

Bytes signature() {
  Bytes png = good_png();
  png.resize(8);
  return png;
}

Bytes after_header(const Bytes& png) {
  return {png.begin() + kAfterHeader, png.end()};
}

// What reading says, and what is printed meanwhile.
struct Outcome {
  std::string error, printed;
  ImageRgba image;
};

Outcome read(const std::function<ImageRgba()>& reader) {
  Outcome outcome;
  ::testing::internal::CaptureStderr();
  try {
    outcome.image = reader();
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::input);
    outcome.error = error.what();
  }
  outcome.printed = ::testing::internal::GetCapturedStderr();
  return outcome;
}

Outcome read_bytes(const Bytes& png) {
  return read([&] { return read_image_rgba(png, "place"); });
}

Outcome read_file(const Bytes& png) {
  const TemporaryFolder folder;
  const std::string path = folder / "picture.png";
  std::ofstream(path, std::ios::binary)
      .write(reinterpret_cast<const char*>(png.data()), static_cast<std::streamsize>(png.size()));
  return read([&] { return read_image_rgba(path, "place"); });
}

TEST(DamagedPng, CutAnywhereIsRefusedInSilence) {
  const Bytes good = good_png();
  ASSERT_EQ(read_bytes(good).error, "");
  for (std::size_t size = 8; size < good.size(); ++size) {
    const Bytes cut(good.begin(), good.begin() + static_cast<std::ptrdiff_t>(size));
    for (const Outcome& outcome : {read_bytes(cut), read_file(cut)}) {
      EXPECT_THAT(outcome.error, HasSubstr("the picture is damaged: the file ends")) << size;
      EXPECT_EQ(outcome.printed, "") << size;
    }
  }
}

TEST(DamagedPng, AnyChangedByteIsRefusedInSilence) {
  const Bytes good = good_png();
  for (std::size_t at = 8; at < good.size(); ++at) {
    for (const unsigned flip : {0x01U, 0x20U, 0xFFU}) {
      Bytes bad = good;
      bad[at] = static_cast<std::uint8_t>(bad[at] ^ flip);
      const Outcome outcome = read_bytes(bad);
      EXPECT_THAT(outcome.error, HasSubstr("place: the picture is damaged")) << at;
      EXPECT_THAT(outcome.error, Not(HasSubstr("\n"))) << at;
      EXPECT_EQ(outcome.printed, "") << at;
    }
  }
}

// The library that reads them has words of its own for a signature that a transfer as text has changed.
TEST(DamagedPng, AChangedSignatureIsNoPictureAndRefusedInSilence) {
  const Bytes good = good_png();
  for (std::size_t at = 0; at < 8; ++at) {
    Bytes bad = good;
    bad[at] ^= 1U;
    for (const Outcome& outcome : {read_bytes(bad), read_file(bad)}) {
      EXPECT_THAT(outcome.error, HasSubstr("no picture of a known kind")) << at;
      EXPECT_EQ(outcome.printed, "") << at;
    }
  }
}

struct WrongPng {
  const char* name;
  std::function<Bytes()> bytes;
  const char* message;
};

class WrongPngs : public ::testing::TestWithParam<WrongPng> {};

TEST_P(WrongPngs, AreRefusedInSilence) {
  const Outcome outcome = read_bytes(GetParam().bytes());
  EXPECT_THAT(outcome.error, HasSubstr(GetParam().message));
  EXPECT_EQ(outcome.printed, "");
}

Bytes with_header(const Bytes& chunk) {
  return joined({signature(), chunk, after_header(good_png())});
}
Bytes with_second(const Bytes& chunk) {
  const Bytes good = good_png();
  return joined({{good.begin(), good.begin() + kAfterHeader}, chunk, after_header(good)});
}

const WrongPng kWrong[] = {
    {"NoHeader", [] { return with_header({}); }, "does not begin with a header"},
    {"NoPixels", [] { return with_header(header(0, 3, 8, 2)); }, "0 x 3 pixels"},
    {"MillionsWide", [] { return with_header(header(2000000, 3, 8, 2)); }, "2000000 x 3 pixels"},
    {"Depth", [] { return with_header(header(9, 3, 3, 0)); }, "colour type 0 with 3 bits"},
    {"ShallowColor", [] { return with_header(header(9, 3, 4, 2)); }, "colour type 2 with 4 bits"},
    {"DeepPalette", [] { return with_header(header(9, 3, 16, 3)); }, "colour type 3 with 16 bits"},
    {"ColorType", [] { return with_header(header(9, 3, 8, 5)); }, "colour type 5"},
    {"Compression",
     [] {
       return with_header(header(9, 3, 8, 2, {1, 0, 0}));
     },
     "a compression"},
    {"Filter",
     [] {
       return with_header(header(9, 3, 8, 2, {0, 1, 0}));
     },
     "a compression, filter"},
    {"Rows",
     [] {
       return with_header(header(9, 3, 8, 2, {0, 0, 2}));
     },
     "order of rows"},
    {"NoPalette", [] { return with_header(header(9, 3, 8, 3)); }, "no palette"},
    {"SecondHeader", [] { return with_second(header(9, 3, 8, 2)); }, "second header"},
    {"UnknownCritical", [] { return with_second(chunk("QQQQ", {1})); }, "unknown to PNG"},
    {"Transparency",
     [] {
       return with_second(chunk("tRNS", {0, 1}));
     },
     "tRNS"},
    {"NoData",
     [] {
       return joined({signature(), header(9, 3, 8, 2), chunk("IEND", {})});
     },
     "no IDAT"},
    {"DividedData",
     [] {
       const Bytes end = chunk("IEND", {});
       Bytes png = good_png();
       png.resize(png.size() - end.size());
       return joined({png, chunk("tEXt", {'a', 0}), chunk("IDAT", {}), end});
     },
     "consecutive"},
    // Nothing is asked for that the file cannot fill: 14 GB, and a quarter of one.
    {"HugeHeader", [] { return with_header(header(60000, 60000, 8, 2)); }, "60000 x 60000 pixels is too large"},
    {"LargeHeader", [] { return with_header(header(8192, 8192, 8, 2)); }, "bytes cannot hold 8192 x 8192 pixels"},
};

INSTANTIATE_TEST_SUITE_P(Table, WrongPngs, ::testing::ValuesIn(kWrong),
                         [](const auto& test) { return std::string(test.param.name); });

// A broken profile, text with a wrong checksum, what a viewer's background is: nothing that the pixels need.
TEST(UsablePng, NeedlessChunksAreLeftOut) {
  Bytes text = chunk("tEXt", {'a', 0, 'b'});
  text.back() ^= 1U;
  const Outcome plain = read_bytes(good_png());
  const Bytes png = with_second(joined({chunk("iCCP", {'x', 0, 0, 1, 2, 3}), chunk("gAMA", {0, 0, 0, 0}), text}));
  for (const Outcome& outcome : {read_bytes(png), read_file(png)}) {
    EXPECT_EQ(outcome.error, "");
    EXPECT_EQ(outcome.printed, "");
    EXPECT_EQ(outcome.image.bytes, plain.image.bytes);
  }
}

// One row of four pixels: indices 0 to 3 into colours, of which the second is half transparent.
TEST(UsablePng, PalettesKeepTheirTransparency) {
  const Bytes stored{0x78, 0x01, 1, 5, 0, 0xFA, 0xFF, 0, 0, 1, 2, 3, 0x00, 0x0F, 0x00, 0x07};
  const Bytes png = joined({signature(), header(4, 1, 8, 3), chunk("PLTE", {1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12}),
                            chunk("tRNS", {255, 128}), chunk("IDAT", stored), chunk("IEND", {})});
  const Outcome outcome = read_bytes(png);
  EXPECT_EQ(outcome.error, "");
  EXPECT_EQ(outcome.printed, "");
  EXPECT_EQ(outcome.image.bytes, (Bytes{1, 2, 3, 255, 4, 5, 6, 128, 7, 8, 9, 255, 10, 11, 12, 255}));
}

// A large picture of one colour in few bytes is no damage: 4096 x 4096 times black, one bit a pixel, takes 2 KB.
TEST(UsablePng, LargeEmptyPicturesAreRead) {
  Bytes stream{0x78, 0x9C};
  // Deflate, fixed codes: one zero, then 258 of them by each pair of length and distance, until 4096 rows of 1 + 512
  // bytes are there.
  std::uint32_t held = 0;
  unsigned bits = 0;
  const auto put = [&](std::uint32_t value, unsigned count) {  // lowest bit first
    for (unsigned k = 0; k < count; ++k) {
      held |= (value >> k & 1U) << bits;
      if (++bits == 8) {
        stream.push_back(static_cast<std::uint8_t>(held));
        held = bits = 0;
      }
    }
  };
  const auto put_code = [&](std::uint32_t code, unsigned count) {  // highest bit first
    for (unsigned k = count; k-- > 0;) {
      put(code >> k & 1U, 1);
    }
  };
  put(1, 1);          // the last block
  put(1, 2);          // fixed codes
  put_code(0x30, 8);  // the byte 0
  std::uint32_t left = 4096 * 513 - 1;
  for (; left >= 258; left -= 258) {
    put_code(0xC5, 8);  // 258 bytes
    put_code(0, 5);     // from 1 back
  }
  for (; left > 0; --left) {
    put_code(0x30, 8);
  }
  put_code(0, 7);  // the end
  put(0, 7);
  const std::uint32_t rows = 4096 * 513 % 65521;  // Adler-32 of zeros
  put32(stream, rows << 16U | 1U);
  const Bytes png = joined({signature(), header(4096, 4096, 1, 0), chunk("IDAT", stream), chunk("IEND", {})});
  const Outcome outcome = read_bytes(png);
  EXPECT_EQ(outcome.error, "");
  EXPECT_EQ(outcome.image.width_px, 4096);
}

}  // namespace
}  // namespace gazetrace::png_file_test
