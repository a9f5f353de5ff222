// SPDX-License-Identifier: Apache-2.0
#include "core/text.hpp"

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <memory>

#include "gazetrace/error.hpp"

namespace gazetrace {
namespace {

void append_utf8(std::string& out, std::uint32_t code) {
  const auto put = [&](std::uint32_t byte) { out += static_cast<char>(static_cast<unsigned char>(byte)); };
  if (code < 0x80U) {
    put(code);
  } else if (code < 0x800U) {
    put(0xC0U | (code >> 6U));
    put(0x80U | (code & 0x3FU));
  } else if (code < 0x10000U) {
    put(0xE0U | (code >> 12U));
    put(0x80U | ((code >> 6U) & 0x3FU));
    put(0x80U | (code & 0x3FU));
  } else {
    put(0xF0U | (code >> 18U));
    put(0x80U | ((code >> 12U) & 0x3FU));
    put(0x80U | ((code >> 6U) & 0x3FU));
    put(0x80U | (code & 0x3FU));
  }
}

std::string utf8_from_utf16(std::string_view bytes, bool little_endian) {
  const auto unit = [&](std::size_t i) {
    const auto first = static_cast<std::uint32_t>(static_cast<unsigned char>(bytes[i]));
    const auto second = static_cast<std::uint32_t>(static_cast<unsigned char>(bytes[i + 1]));
    return little_endian ? first | (second << 8U) : second | (first << 8U);
  };
  std::string out;
  out.reserve(bytes.size() / 2);
  for (std::size_t i = 0; i + 1 < bytes.size(); i += 2) {
    std::uint32_t code = unit(i);
    if (code >= 0xD800U && code < 0xDC00U && i + 3 < bytes.size()) {
      const std::uint32_t low = unit(i + 2);
      if (low >= 0xDC00U && low < 0xE000U) {
        code = 0x10000U + ((code - 0xD800U) << 10U) + (low - 0xDC00U);
        i += 2;
      }
    }
    if (code >= 0xD800U && code < 0xE000U) {
      code = 0xFFFDU;  // half a surrogate pair
    }
    append_utf8(out, code);
  }
  return out;
}

// Which byte order a text of Latin letters and digits has that is UTF-16; empty: it is none.
std::optional<bool> utf16_without_mark(std::string_view text) {
  constexpr std::size_t kLeast = 8;
  constexpr std::size_t kMost = 256;
  const std::size_t count = std::min(text.size(), kMost) / 2 * 2;
  std::size_t even = 0;
  std::size_t odd = 0;
  for (std::size_t i = 0; i < count; ++i) {
    (i % 2 == 0 ? even : odd) += text[i] == '\0' ? 1 : 0;
  }
  // A few characters may be others, such as a Greek mu.
  const std::size_t nearly_all = count / 2 - count / 32;
  if (count < kLeast || std::min(even, odd) > 0 || std::max(even, odd) < nearly_all) {
    return std::nullopt;
  }
  return odd > even;
}

}  // namespace

std::string read_file_bytes(const std::string& path) {
  std::error_code code;
  if (std::filesystem::is_directory(path, code)) {
    throw Error(ErrorKind::input, path, "is a folder, not a file");
  }
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::fopen(path.c_str(), "rb"), &std::fclose);
  if (!file) {
    const int reason = errno;
    throw Error(ErrorKind::input, path, std::string("cannot be opened: ") + std::strerror(reason), "check the path");
  }
  std::string text;
  const auto size = std::filesystem::file_size(path, code);
  std::size_t used = 0;
  // One byte more than the size, so that a file that has not grown needs no second allocation. Pipes have no size.
  text.resize((code ? 0 : static_cast<std::size_t>(size)) + 1);
  for (std::size_t got = 1; got != 0; used += got) {
    if (used == text.size()) {
      text.resize(text.size() + 65536);
    }
    got = std::fread(text.data() + used, 1, text.size() - used, file.get());
  }
  if (std::ferror(file.get()) != 0) {
    throw Error(ErrorKind::input, path, "cannot be read to its end");
  }
  text.resize(used);
  return text;
}

std::string utf8_text(std::string text) {
  if (text.starts_with("\xEF\xBB\xBF")) {
    text.erase(0, 3);
  } else if (text.starts_with("\xFF\xFE")) {
    return utf8_from_utf16(std::string_view(text).substr(2), true);
  } else if (text.starts_with("\xFE\xFF")) {
    return utf8_from_utf16(std::string_view(text).substr(2), false);
  } else if (const std::optional<bool> little_endian = utf16_without_mark(text)) {
    return utf8_from_utf16(text, *little_endian);
  }
  return text;
}

std::string with_line_ends(std::string text) {
  if (text.find('\n') == std::string::npos) {
    std::replace(text.begin(), text.end(), '\r', '\n');
  }
  return text;
}

std::string read_text_file(const std::string& path) {
  return utf8_text(read_file_bytes(path));
}

std::string_view trim(std::string_view text) {
  constexpr std::string_view kBlanks = " \t\r\n";
  constexpr std::string_view kNoBreakSpace = "\xC2\xA0";
  const auto plain = [](char c) { return static_cast<signed char>(c) > ' '; };
  if (!text.empty() && plain(text.front()) && plain(text.back())) {
    return text;  // the usual case
  }
  for (;;) {
    if (!text.empty() && kBlanks.find(text.front()) != std::string_view::npos) {
      text.remove_prefix(1);
    } else if (!text.empty() && kBlanks.find(text.back()) != std::string_view::npos) {
      text.remove_suffix(1);
    } else if (text.starts_with(kNoBreakSpace)) {
      text.remove_prefix(2);
    } else if (text.ends_with(kNoBreakSpace)) {
      text.remove_suffix(2);
    } else {
      return text;
    }
  }
}

std::string to_lower(std::string_view text) {
  std::string lower(text);
  std::transform(lower.begin(), lower.end(), lower.begin(),
                 [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; });
  return lower;
}

bool LineReader::next(std::string_view& line) {
  if (rest_.empty()) {
    return false;
  }
  const std::size_t end = rest_.find('\n');
  line = rest_.substr(0, end);
  rest_.remove_prefix(end == std::string_view::npos ? rest_.size() : end + 1);
  if (!line.empty() && line.back() == '\r') {
    line.remove_suffix(1);
  }
  ++number_;
  return true;
}

void split_cells(std::string_view line, char separator, std::vector<std::string_view>& cells) {
  cells.clear();
  if (separator == ' ') {
    const auto is_blank = [](char c) { return c == ' ' || c == '\t'; };
    const char* at = line.data();
    const char* const end = at + line.size();
    for (;;) {
      while (at != end && is_blank(*at)) {
        ++at;
      }
      if (at == end) {
        return;
      }
      const char* const begin = at;
      while (at != end && !is_blank(*at)) {
        ++at;
      }
      cells.emplace_back(begin, static_cast<std::size_t>(at - begin));
    }
  }
  bool quoted = false;
  std::size_t begin = 0;
  for (std::size_t i = 0; i < line.size(); ++i) {
    const char c = line[i];
    if (c == '"') {
      quoted = !quoted;
    } else if (c == separator && !quoted) {
      cells.push_back(line.substr(begin, i - begin));
      begin = i + 1;
    }
  }
  cells.push_back(line.substr(begin));
}

std::string_view cell_text(std::string_view cell, std::string& buffer) {
  cell = trim(cell);
  if (cell.size() >= 2 && cell.front() == '"' && cell.back() == '"') {
    cell = cell.substr(1, cell.size() - 2);
    if (cell.find("\"\"") != std::string_view::npos) {
      buffer.clear();
      for (std::size_t i = 0; i < cell.size(); ++i) {
        buffer += cell[i];
        if (cell[i] == '"' && i + 1 < cell.size() && cell[i + 1] == '"') {
          ++i;
        }
      }
      cell = buffer;
    }
    cell = trim(cell);
  }
  return cell;
}

// The bytes that a character of several begins and goes on with: The Unicode Standard 15.0, table 3-7.
bool is_utf8(std::string_view text) {
  for (std::size_t i = 0; i < text.size();) {
    const auto byte = [&](std::size_t k) { return k < text.size() ? static_cast<unsigned char>(text[k]) : 0U; };
    const unsigned first = byte(i);
    const std::size_t more = first < 0x80   ? 0
                             : first < 0xc2 ? 4
                             : first < 0xe0 ? 1
                             : first < 0xf0 ? 2
                             : first < 0xf5 ? 3
                                            : 4;
    if (more == 4) {
      return false;
    }
    const unsigned least = first == 0xe0 ? 0xa0 : first == 0xf0 ? 0x90 : 0x80;
    const unsigned most = first == 0xed ? 0x9f : first == 0xf4 ? 0x8f : 0xbf;
    for (std::size_t k = 1; k <= more; ++k) {
      const unsigned next = byte(i + k);
      if (next < (k == 1 ? least : 0x80U) || next > (k == 1 ? most : 0xbfU)) {
        return false;
      }
    }
    i += more + 1;
  }
  return true;
}

}  // namespace gazetrace
