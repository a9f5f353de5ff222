// SPDX-License-Identifier: Apache-2.0
// Names of a sequence's files. The place of the number is in the last part of the path. Folders keep their # and %, but
// where the last part has the number, %04d and <frame> stand for it in folders as well.
#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <system_error>
#include <vector>

#include "core/list_folder.hpp"
#include "gazetrace/output.hpp"

namespace gazetrace {
namespace {

namespace fs = std::filesystem;

constexpr const char* kDigits = "0123456789";

struct Placeholder {
  std::size_t length = 0;  // of the placeholder in the pattern, in characters
  int min_digits = 0;      // the number is padded with zeros to this many digits
};

// %d, %04d, and %4d, which means the same as %04d since file names should not contain spaces.
std::optional<Placeholder> printf_placeholder(const std::string& pattern, std::size_t at) {
  std::size_t end = at + 1;
  int digits = 0;
  while (end < pattern.size() && std::isdigit(static_cast<unsigned char>(pattern[end])) != 0 && digits < 100) {
    digits = digits * 10 + (pattern[end] - '0');
    ++end;
  }
  if (end == pattern.size() || pattern[end] != 'd' || digits > 20) {
    return std::nullopt;
  }
  return Placeholder{end + 1 - at, digits};
}

std::optional<Placeholder> placeholder_at(const std::string& pattern, std::size_t at) {
  constexpr std::string_view kFrame = "<frame>";
  if (pattern[at] == '#') {
    const std::size_t end = std::min(pattern.find_first_not_of('#', at), pattern.size());
    return Placeholder{end - at, static_cast<int>(end - at)};
  }
  if (pattern.compare(at, kFrame.size(), kFrame) == 0) {
    return Placeholder{kFrame.size(), 0};
  }
  return pattern[at] == '%' ? printf_placeholder(pattern, at) : std::nullopt;
}

struct Expanded {
  std::string name;
  int numbers = 0;
};

// The placeholder of a folder's name that begins here.
std::optional<Placeholder> folder_placeholder_at(const std::string& folders, std::size_t at) {
  return folders[at] == '#' ? std::nullopt : placeholder_at(folders, at);
}

std::string expand_folders(const std::string& folders, std::int32_t frame) {
  std::string result;
  for (std::size_t at = 0; at < folders.size();) {
    if (const auto placeholder = folder_placeholder_at(folders, at)) {
      result += fmt::format("{:0{}}", frame, placeholder->min_digits);
      at += placeholder->length;
    } else {
      result += folders[at++];
    }
  }
  return result;
}

Expanded expand(const std::string& pattern, std::int32_t frame) {
  const std::size_t slash = pattern.find_last_of('/');
  std::size_t at = slash == std::string::npos ? 0 : slash + 1;
  const std::string folders = pattern.substr(0, at);
  Expanded result;
  while (at < pattern.size()) {
    if (pattern.compare(at, 2, "%%") == 0) {
      result.name += '%';
      at += 2;
    } else if (const auto placeholder = placeholder_at(pattern, at)) {
      result.name += fmt::format("{:0{}}", frame, placeholder->min_digits);
      ++result.numbers;
      at += placeholder->length;
    } else if (pattern[at] == '%') {
      throw Error(ErrorKind::usage, pattern, "a % is followed by something that is not a frame number",
                  "write %04d, ####, <frame>, or %% for a percent sign");
    } else {
      result.name += pattern[at++];
    }
  }
  result.name.insert(0, result.numbers == 0 ? folders : expand_folders(folders, frame));
  return result;
}

// The frame number with which the pattern gives `path`, if there is one: one of the runs of digits in its name.
std::optional<std::int32_t> frame_of(const std::string& pattern, const std::string& path) {
  const std::size_t name = path.find_last_of('/') == std::string::npos ? 0 : path.find_last_of('/') + 1;
  for (std::size_t at = path.find_first_of("0123456789", name); at != std::string::npos;
       at = path.find_first_of("0123456789", at)) {
    const std::size_t end = std::min(path.find_first_not_of("0123456789", at), path.size());
    std::int32_t frame = 0;
    const auto [rest, problem] = std::from_chars(&path[at], path.data() + end, frame);
    if (problem == std::errc() && rest == path.data() + end && frame_file_name(pattern, frame) == path) {
      return frame;
    }
    at = end;
  }
  return std::nullopt;
}

// Of a pattern whose folders have the number, too: the numbers in the names of the first such folders whose files
// exist.
std::vector<std::int32_t> frames_in_folders(const std::string& pattern, const fs::path& folder) {
  std::vector<std::int32_t> frames;
  std::error_code problem;
  for (const fs::path& path : list_folder_if_there(folder)) {
    const std::string name = path.filename().string();
    for (std::size_t at = name.find_first_of(kDigits); at != std::string::npos; at = name.find_first_of(kDigits, at)) {
      const std::size_t end = std::min(name.find_first_not_of(kDigits, at), name.size());
      std::int32_t frame = 0;
      const auto [rest, bad] = std::from_chars(&name[at], name.data() + end, frame);
      if (bad == std::errc() && fs::is_regular_file(frame_file_name(pattern, frame), problem)) {
        frames.push_back(frame);
      }
      at = end;
    }
  }
  std::sort(frames.begin(), frames.end());
  frames.erase(std::unique(frames.begin(), frames.end()), frames.end());
  return frames;
}

}  // namespace

std::string frame_file_name(const std::string& pattern, std::int32_t frame, bool require_number) {
  if (frame < 0) {
    throw Error(ErrorKind::usage, pattern, fmt::format("frame {} is negative", frame), "number frames from 1");
  }
  Expanded expanded = expand(pattern, frame);
  if (expanded.numbers > 1) {
    throw Error(ErrorKind::usage, pattern, "the name has more than one place for the frame number", "keep one");
  }
  if (require_number && expanded.numbers == 0) {
    throw Error(ErrorKind::usage, pattern, "every frame would be written to the same file",
                "put ####, %04d or <frame> into the file name");
  }
  return std::move(expanded.name);
}

bool has_frame_number(const std::string& pattern) {
  return expand(pattern, 1).numbers > 0;
}

std::string folder_of_frames(const std::string& pattern) {
  std::string folder = fs::path(pattern).parent_path().string();
  for (std::size_t at = 0; has_frame_number(pattern) && at < folder.size(); ++at) {
    if (folder_placeholder_at(folder, at)) {
      const std::size_t slash = folder.find_last_of('/', at);
      folder = slash == std::string::npos ? std::string() : folder.substr(0, std::max<std::size_t>(slash, 1));
    }
  }
  return folder.empty() ? "." : folder;
}

std::string run_name_of(const std::string& pattern) {
  constexpr std::string_view kBetween = "._- ";
  std::string before;
  std::string after;  // the number
  bool has_number = false;
  const std::string file = fs::path(pattern).filename().string();
  for (std::size_t at = 0; at < file.size();) {
    const bool is_percent = file.compare(at, 2, "%%") == 0;
    const auto placeholder = is_percent ? std::nullopt : placeholder_at(file, at);
    if (placeholder) {
      has_number = true;
    } else {
      (has_number ? after : before) += file[at];
    }
    at += placeholder ? placeholder->length : is_percent ? 2 : 1;
  }
  std::string& end = has_number ? after : before;
  end.resize(std::min(end.rfind('.'), end.size()));
  if (has_number) {
    before.resize(before.find_last_not_of(kBetween) + 1);
  }
  const std::size_t begin = before.empty() ? std::min(after.find_first_not_of(kBetween), after.size()) : 0;
  return (fs::path(folder_of_frames(pattern)) / (before + after.substr(begin))).string();
}

std::vector<std::int32_t> find_frames(const std::string& pattern) {
  if (!has_frame_number(pattern)) {
    if (std::error_code ignored; !fs::is_regular_file(pattern, ignored)) {
      throw Error(ErrorKind::input, pattern, "there is no such picture",
                  "name a picture, or a sequence as name.####.exr");
    }
    return {0};
  }
  const fs::path folder = fs::path(pattern).parent_path();
  std::vector<std::int32_t> frames;
  if (const fs::path all = folder_of_frames(pattern); all != (folder.empty() ? fs::path(".") : folder)) {
    frames = frames_in_folders(pattern, all);
  }
  for (const fs::path& found : list_folder_if_there(folder)) {
    const std::string path = (folder / found.filename()).string();
    if (const auto frame = frame_of((folder / fs::path(pattern).filename()).string(), path)) {
      frames.push_back(*frame);
    }
  }
  if (frames.empty()) {
    throw Error(ErrorKind::input, pattern, "there are no such pictures", "check the folder and the name");
  }
  std::sort(frames.begin(), frames.end());
  return frames;
}

}  // namespace gazetrace
