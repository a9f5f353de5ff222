// SPDX-License-Identifier: Apache-2.0
#include <string_view>

#include "core/hash.hpp"
#include "core/image_io.hpp"
#include "gazetrace/output.hpp"
#include "output/exr.hpp"

namespace gazetrace {

std::string read_settings_digest(const std::string& path) {
  if (path.ends_with(".exr")) {
    return read_exr_text(path, "gazetrace:settings_digest");
  }
  constexpr std::string_view kKey = "gazetrace:settings_digest=";
  const std::string text = read_image_note(path);
  const std::size_t key = text.find(kKey);
  if (key == std::string::npos) {
    return {};
  }
  const std::size_t begin = key + kKey.size();
  return text.substr(begin, text.find(' ', begin) - begin);
}

std::string digest_settings(const std::vector<std::pair<std::string, std::string>>& settings) {
  Digest digest;
  for (const auto& [name, value] : settings) {
    // The lengths make ("ab", "c") and ("a", "bc") different.
    digest.add(std::to_string(name.size()) + ":" + name + std::to_string(value.size()) + ":" + value);
  }
  return digest.hex();
}

std::string digest_of_sequence(const std::string& settings_digest, const std::string& frames, std::int32_t preroll,
                               const std::string& checkpoint) {
  return digest_settings({{"settings", settings_digest},
                          {"frames", frames},
                          {"preroll", std::to_string(preroll)},
                          {"history", checkpoint}});
}

}  // namespace gazetrace
