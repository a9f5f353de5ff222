// SPDX-License-Identifier: Apache-2.0
#include <string_view>

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

}  // namespace gazetrace
