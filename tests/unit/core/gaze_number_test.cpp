// SPDX-License-Identifier: Apache-2.0
// Numbers from text: times to int64 without a double in between.
#include <gtest/gtest.h>

#include <limits>
#include <random>

#include "core/text.hpp"
#include "support/text_file.hpp"

namespace gazetrace::gaze_number_test {
namespace {

constexpr std::int64_t kMax = std::numeric_limits<std::int64_t>::max();
constexpr std::int64_t kMin = std::numeric_limits<std::int64_t>::min();

TEST(ScaledInteger, IsExact) {
  struct Case {
    std::string_view text;
    int exponent;
    std::int64_t value;
  };
  for (const Case& c : {
           Case{"0", 0, 0},
           {"-0", 9, 0},
           {"1.5", 9, 1'500'000'000},
           {"+2", 3, 2000},
           {"-0.000000001", 9, -1},
           {"1305031102.175304301", 9, 1'305'031'102'175'304'301},
           {"1305031102,175304301", 9, 1'305'031'102'175'304'301},
           {"0.0190000000000000012", 9, 19'000'000},
           {".25", 6, 250'000},
           {"7.", 6, 7'000'000},
           {"0.5", 0, 1},  // halves away from zero
           {"-0.5", 0, -1},
           {"0.4999999999999999999999", 0, 0},
           {"0.05", 0, 0},
           {"9223372036854775807", 0, kMax},
           {"-9223372036854775808", 0, kMin},
           {"9223372036.854775807", 9, kMax},
           {"-9223372036.854775808", 9, kMin},
           {"9223372036.8547758074999", 9, kMax},
           {"638342802882596202", 2, 0},  // overflow, see below
           {"5.88E+12", 2, 588'000'000'000'000},
           {"1e-3", 9, 1'000'000},
           {"123456789e-9", 9, 123'456'789},
           {"0e99999999999", 9, 0},
           {"1e-99999999999", 9, 0},
           {"000000000000000000000000000001", 0, 1},
       }) {
    std::int64_t value = 77;
    const NumberStatus status = scaled_integer(c.text, c.exponent, value);
    if (c.text == "638342802882596202") {
      EXPECT_EQ(status, NumberStatus::overflow);
      continue;
    }
    EXPECT_EQ(status, NumberStatus::ok) << c.text;
    EXPECT_EQ(value, c.value) << c.text;
  }
}

TEST(ScaledInteger, RefusesOverflowAndNonsense) {
  std::int64_t value = 0;
  for (const std::string_view text : {"9223372036854775808", "-9223372036854775809", "9223372036854775807.5", "1e19",
                                      "1e99999999999", "99999999999999999999999999"}) {
    EXPECT_EQ(scaled_integer(text, 0, value), NumberStatus::overflow) << text;
  }
  EXPECT_EQ(scaled_integer("9223372036.854775808", 9, value), NumberStatus::overflow);
  for (const std::string_view text : {"", "-", "+", ".", "1.2.3", "1,234.5", "0x10", "1e", "1e+", "12:30", "nan", " 1",
                                      "1 ", "--1", "1e5.5", "inf"}) {
    EXPECT_EQ(scaled_integer(text, 9, value), NumberStatus::malformed) << text;
  }
}

// Against an independent way: 128-bit arithmetic on random digits split by a point.
TEST(ScaledInteger, AgreesWithWideArithmetic) {
  std::mt19937_64 random(7);
  for (int i = 0; i < 20000; ++i) {
    const auto whole = random() % 9'000'000'000ULL;
    const auto fraction = random() % 1'000'000'000'000ULL;  // twelve digits
    std::string digits = std::to_string(fraction);
    digits.insert(0, 12 - digits.size(), '0');
    std::int64_t value = 0;
    ASSERT_EQ(scaled_integer(std::to_string(whole) + "." + digits, 9, value), NumberStatus::ok);
    ASSERT_EQ(value, static_cast<std::int64_t>(whole * 1'000'000'000ULL + (fraction + 500) / 1000));
  }
}

TEST(Number, HasAPointOrACommaAndIsFinite) {
  EXPECT_EQ(number_from("0.1"), 0.1);
  EXPECT_EQ(number_from("0,1"), 0.1);
  EXPECT_EQ(number_from("+3e-2"), 3e-2);
  EXPECT_EQ(number_from("-7"), -7.0);
  for (const std::string_view text : {"", "nan", "inf", "1e999", "1,2,3", "1,234.5", "+-1", "1x", "0x1p3", "1 "}) {
    EXPECT_FALSE(number_from(text).has_value()) << text;
  }
}

TEST(Cells, QuotesBlanksAndTrailingSeparators) {
  std::vector<std::string_view> cells;
  std::string buffer;
  split_cells(R"("a,b", 2 ,"say ""x""",)", ',', cells);
  ASSERT_EQ(cells.size(), 4U);
  EXPECT_EQ(cell_text(cells[0], buffer), "a,b");
  EXPECT_EQ(cell_text(cells[1], buffer), "2");
  EXPECT_EQ(cell_text(cells[2], buffer), R"(say "x")");
  EXPECT_EQ(cell_text(cells[3], buffer), "");
  EXPECT_EQ(cell_text("\xC2\xA0t [ns]\xC2\xA0", buffer), "t [ns]");
}

TEST(TimeUnits, BothMusAndCommonSpellings) {
  EXPECT_EQ(time_exponent("\xC2\xB5s"), 3);
  EXPECT_EQ(time_exponent("\xCE\xBCs"), 3);
  EXPECT_EQ(time_exponent(" MS "), 6);
  EXPECT_EQ(time_exponent("100ns"), 2);
  EXPECT_EQ(time_exponent("secs"), 9);
  EXPECT_FALSE(time_exponent("px").has_value());
  EXPECT_FALSE(time_exponent("").has_value());
}

TEST(TextFile, ByteOrderMarksAndUtf16) {
  const TextFiles files;
  using namespace std::string_literals;
  EXPECT_EQ(read_text_file(files.write("bom", "\xEF\xBB\xBFt,x")), "t,x");
  EXPECT_EQ(read_text_file(files.write("le", "\xFF\xFEt\0,\0\xBC\x03"s)), "t,\xCE\xBC");
  EXPECT_EQ(read_text_file(files.write("be", "\xFE\xFF\0t\0\xB5"s)), "t\xC2\xB5");
  EXPECT_EQ(read_text_file(files.write("pair", "\xFF\xFE\x3D\xD8\x41\xDC\x00\xD8"s)), "\xF0\x9F\x91\x81\xEF\xBF\xBD");
  EXPECT_EQ(read_text_file(files.write("none", "")), "");
  EXPECT_THROW(read_text_file(files.path("")), std::exception);  // a folder
}

}  // namespace
}  // namespace gazetrace::gaze_number_test
