// SPDX-License-Identifier: Apache-2.0
// Reads numbers and lines from text files whatever their encoding, line ends and number format.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace gazetrace {

// The whole file as UTF-8: a byte-order mark is dropped, and UTF-16 (either order) is converted. Without a mark, a text
// counts as UTF-16 where every second byte of its beginning is zero and no other.
// Error(input) where it cannot be read.
std::string read_text_file(const std::string& path);
// The two steps of read_text_file().
std::string read_file_bytes(const std::string& path);
std::string utf8_text(std::string text);
// Whether JSON can hold it as it is.
bool is_utf8(std::string_view text);
// A text whose lines end in \r alone gets \n for each of them.
std::string with_line_ends(std::string text);

std::string_view trim(std::string_view text);  // blanks, tabs, carriage returns, no-break spaces
std::string to_lower(std::string_view text);   // ASCII

// Walks the lines of a text, which end in \n or \r\n; the last one may lack its line break.
class LineReader {
 public:
  explicit LineReader(std::string_view text) : rest_(text) {}
  bool next(std::string_view& line);
  [[nodiscard]] std::int64_t number() const { return number_; }  // of the line last returned, counted from 1
  [[nodiscard]] std::string_view rest() const { return rest_; }

 private:
  std::string_view rest_;
  std::int64_t number_ = 0;
};

// Splits at `separator` outside double quotes. Cells keep their quotes and blanks; see `cell_text`.
// A separator of ' ' means runs of blanks and tabs.
void split_cells(std::string_view line, char separator, std::vector<std::string_view>& cells);
// A cell without blanks and quotes around it; `buffer` holds the result where there are doubled quotes.
std::string_view cell_text(std::string_view cell, std::string& buffer);

// The decimal number `text` times 10^exponent, rounded to the nearest integer (halves away from zero). It works on the
// digits, so nothing is lost in a double. Sign, decimal point or comma, and e/E exponents are understood.
enum class NumberStatus : std::uint8_t { ok, malformed, overflow };
NumberStatus scaled_integer(std::string_view text, int exponent, std::int64_t& value);

// The double nearest to a finite number with a decimal point or comma; empty where the text is anything else.
std::optional<double> number_from(std::string_view text);

// The whole number that digits alone write; empty where the text is anything else, or does not fit.
std::optional<std::size_t> count_from(std::string_view text);

// The power of ten from a unit of time to nanoseconds: "ns", "us", "μs" (either mu), "ms", "s" in their common
// spellings, and "100ns"; empty for anything else.
std::optional<int> time_exponent(std::string_view unit);

}  // namespace gazetrace
