// SPDX-License-Identifier: Apache-2.0
#include "report/fill.hpp"

namespace gazetrace {

std::string fill_template(std::string_view text, const std::map<std::string, std::string>& values) {
  std::string filled;
  for (std::size_t begin = text.find("{{"); begin != std::string_view::npos; begin = text.find("{{")) {
    const std::size_t end = text.find("}}", begin);
    filled += text.substr(0, begin);
    filled += values.at(std::string(text.substr(begin + 2, end - begin - 2)));
    text.remove_prefix(end + 2);
  }
  return filled.append(text);
}

std::string script_safe(const std::string& json) {
  std::string safe;
  safe.reserve(json.size());
  for (const char c : json) {
    if (c == '<') {
      safe += "\\u003c";
    } else {
      safe += c;
    }
  }
  return safe;
}

}  // namespace gazetrace
