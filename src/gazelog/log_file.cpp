// SPDX-License-Identifier: Apache-2.0
#include "gazelog/log_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <memory>

#include "core/text.hpp"

namespace gazetrace {
namespace {

constexpr std::size_t kLongestLine = std::size_t{16} << 20U;

// A folder stands for the recording in it.
std::string file_of(const std::string& path) {
  namespace fs = std::filesystem;
  std::error_code code;
  if (!fs::is_directory(path, code)) {
    return path;
  }
  for (const char* const name : {"gazedata.gz", "livedata.json.gz", "gaze ps1.raw", "gaze_positions.csv", "gaze.csv"}) {
    if (fs::exists(fs::path(path) / name, code)) {
      return (fs::path(path) / name).string();
    }
  }
  throw Error(ErrorKind::input, path, "is a folder without a recording of a known name", "name the log itself");
}

bool is_binary(const std::string& path, std::string_view bytes) {
  return path.ends_with(".raw") || bytes.starts_with("XDF:");
}

// Goes through a text piece by piece.
class LineLengths {
 public:
  explicit LineLengths(const std::string& path) : path_(path) {}

  // Lines end at either mark. Both are sought one by one: looking for any of the two takes ten times as long.
  void add(std::string_view piece) {
    for (;;) {
      const std::size_t feed = piece.find('\n');
      std::string_view line = piece.substr(0, feed);
      for (std::size_t end = line.find('\r'); end != std::string_view::npos; end = line.find('\r')) {
        count(end);
        length_ = 0;
        line.remove_prefix(end + 1);
      }
      count(line.size());
      if (feed == std::string_view::npos) {
        return;
      }
      ++line_;
      length_ = 0;
      piece.remove_prefix(feed + 1);
    }
  }

 private:
  void count(std::size_t characters) {
    length_ += characters;
    if (length_ > kLongestLine) {
      throw Error(ErrorKind::input, fmt::format("{}:{}", path_, line_),
                  fmt::format("the line is longer than {} MiB", kLongestLine >> 20U),
                  "this is no line of a gaze log: is the file damaged, or of another kind?");
    }
  }

  const std::string& path_;
  std::size_t length_ = 0;
  std::size_t line_ = 1;
};

// Piece by piece, so that a line without an end is not held whole. A reserve that is not written to costs no memory.
std::string bytes_with_short_lines(const std::string& path) {
  std::error_code code;
  if (std::filesystem::is_directory(path, code)) {
    throw Error(ErrorKind::input, path, "is a folder, not a file");
  }
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::fopen(path.c_str(), "rb"), &std::fclose);
  if (!file) {
    const int reason = errno;
    throw Error(ErrorKind::input, path, std::string("cannot be opened: ") + std::strerror(reason), "check the path");
  }
  const auto size = std::filesystem::file_size(path, code);
  std::string text;
  text.reserve(code ? 0 : static_cast<std::size_t>(size));
  LineLengths lengths(path);
  std::string piece(std::size_t{1} << 20U, '\0');
  bool is_text = true;
  for (std::size_t got = 1; got != 0;) {
    got = std::fread(piece.data(), 1, piece.size(), file.get());
    if (text.empty()) {
      is_text = !is_binary(path, piece) && !is_gzip(piece);
    }
    if (is_text) {
      lengths.add(std::string_view(piece).substr(0, got));
    }
    text.append(piece, 0, got);
  }
  if (std::ferror(file.get()) != 0) {
    throw Error(ErrorKind::input, path, "cannot be read to its end");
  }
  return text;
}

std::int64_t line_of(std::string_view text, std::size_t at) {
  return 1 + std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(at), '\n');
}

// Whether the last line's last word is shorter than that of any of the lines just before it: where a file was cut off
// in the middle of a number, it is.
bool ends_early(std::string_view text) {
  constexpr int kLookedAt = 10;
  const auto last_word = [](std::string_view line) {
    line = trim(line);
    return line.size() - std::min(line.find_last_of(",;\t ") + 1, line.size());
  };
  std::size_t begin = text.rfind('\n');
  const std::size_t length = last_word(text.substr(begin == std::string_view::npos ? 0 : begin + 1));
  for (int i = 0; i < kLookedAt && begin != std::string_view::npos && begin > 0; ++i) {
    const std::size_t end = begin;
    begin = text.rfind('\n', end - 1);
    const std::string_view line = text.substr(begin == std::string_view::npos ? 0 : begin + 1,
                                              end - (begin == std::string_view::npos ? 0 : begin + 1));
    const bool is_row = !line.empty() && ((line.front() >= '0' && line.front() <= '9') || line.front() == '-');
    if (is_row && last_word(line) > length) {
      return true;
    }
  }
  return false;
}

// Spreadsheets that are told the separator in a first line of its own, `sep=;`, write it themselves, too. It becomes a
// comment, so that the numbers of the lines stay.
void hide_separator_line(std::string& text) {
  constexpr std::size_t kLength = 5;
  const std::string_view line = trim(std::string_view(text).substr(0, text.find('\n')));
  if (line.starts_with("sep=") && line.size() <= kLength && text.starts_with("sep=")) {
    text.front() = '#';
  }
}

}  // namespace

GazeFile open_log_file(const std::string& path, std::uint64_t most_unpacked_bytes) {
  GazeFile file{file_of(path), {}};
  std::string bytes = bytes_with_short_lines(file.path);
  if (is_gzip(bytes)) {
    bytes = unpack_gzip(bytes, path, most_unpacked_bytes);
    if (!is_binary(file.path, bytes)) {
      LineLengths(path).add(bytes);
    }
  }
  // Records of numbers may begin like a byte-order mark.
  const bool is_text = !is_binary(file.path, bytes);
  file.text = is_text ? with_line_ends(utf8_text(std::move(bytes))) : std::move(bytes);
  if (is_text) {
    hide_separator_line(file.text);
  }
  return file;
}

void note_damages(const GazeFile& file, RawGaze& raw) {
  const std::string_view text = file.text;
  if (is_binary(file.path, text) || text.empty()) {
    return;
  }
  if (const std::size_t zero = text.find('\0'); zero != std::string_view::npos) {
    raw.damages.push_back(
        fmt::format("{}:{}: {} bytes of value zero stand in the text from here on, as after a crash or on a full disk; "
                    "copy the file again, or remove these lines",
                    file.path, line_of(text, zero), std::count(text.begin(), text.end(), '\0')));
  }
  const std::int64_t last_line = text.back() == '\n' ? 0 : line_of(text, text.size());
  if (last_line > 0 && !raw.rows.empty() && raw.rows.back().row == last_line && ends_early(text)) {
    raw.damages.push_back(
        fmt::format("{}:{}: the last row has no line end and is shorter than others: the file seems to be cut off in "
                    "the middle of it; remove the row, or mend it",
                    file.path, last_line));
  }
}

}  // namespace gazetrace
