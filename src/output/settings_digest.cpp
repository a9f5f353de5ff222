// SPDX-License-Identifier: Apache-2.0
#include <charconv>
#include <string_view>
#include <system_error>

#include "core/hash.hpp"
#include "core/image_io.hpp"
#include "gazetrace/output.hpp"
#include "output/exr.hpp"

namespace gazetrace {
namespace {

// The text from behind `key` to the next space; empty where there is no such key.
std::string word_after(const std::string& text, std::string_view key) {
  const std::size_t at = text.find(key);
  if (at == std::string::npos) {
    return {};
  }
  const std::size_t begin = at + key.size();
  return text.substr(begin, text.find(' ', begin) - begin);
}

template <class T>
std::optional<T> number_in(const std::string& text) {
  T value{};
  const auto [end, problem] = std::from_chars(text.data(), text.data() + text.size(), value);
  return problem == std::errc() && end == text.data() + text.size() ? std::optional<T>(value) : std::nullopt;
}

}  // namespace

FrameStamp read_frame_stamp(const std::string& path) {
  FrameStamp stamp;
  if (path.ends_with(".exr")) {
    stamp.settings_digest = read_exr_text(path, "gazetrace:settings_digest");
    if (!stamp.settings_digest.empty()) {
      stamp.frame = read_exr_integer(path, "gazetrace:frame");
      stamp.exposure_ev = read_exr_number(path, "gazetrace:exposure_ev");
    }
    return stamp;
  }
  const std::string note = read_image_note(path);
  stamp.settings_digest = word_after(note, "gazetrace:settings_digest=");
  stamp.frame = number_in<std::int32_t>(word_after(note, " frame="));
  stamp.exposure_ev = number_in<double>(word_after(note, " exposure_ev="));
  return stamp;
}

std::string read_settings_digest(const std::string& path) {
  return path.ends_with(".exr") ? read_exr_text(path, "gazetrace:settings_digest")
                                : word_after(read_image_note(path), "gazetrace:settings_digest=");
}

std::string digest_settings(const std::vector<std::pair<std::string, std::string>>& settings) {
  Digest digest;
  for (const auto& [name, value] : settings) {
    // The lengths make ("ab", "c") and ("a", "bc") different.
    digest.add(std::to_string(name.size()) + ":" + name + std::to_string(value.size()) + ":" + value);
  }
  return digest.hex();
}

}  // namespace gazetrace
