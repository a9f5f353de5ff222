// SPDX-License-Identifier: Apache-2.0
#include "core/json_problem.hpp"

namespace gazetrace {
namespace {

// The text from the last occurrence of `mark` on, without it; empty: there is none.
std::string_view behind_last(std::string_view text, std::string_view mark) {
  const std::size_t at = text.rfind(mark);
  return at == std::string_view::npos ? std::string_view() : text.substr(at + mark.size());
}

// "[json.exception.parse_error.101] " and the like.
std::string_view without_name(std::string_view message) {
  const std::size_t end = message.find("] ");
  return message.starts_with("[json.exception.") && end != std::string_view::npos ? message.substr(end + 2) : message;
}

}  // namespace

std::string json_problem(std::string_view message) {
  constexpr std::string_view kParseError = "parse error at ";
  std::string_view rest = without_name(message);
  if (!rest.starts_with(kParseError)) {
    return std::string(rest);
  }
  rest.remove_prefix(kParseError.size());
  const std::size_t colon = rest.find(": ");
  if (colon == std::string_view::npos) {
    return std::string(rest);
  }
  const std::string place(rest.substr(0, colon));
  if (rest.find("unexpected end of input") != std::string_view::npos) {
    return place + ": the text ends too early";
  }
  if (rest.find("ill-formed UTF-8") != std::string_view::npos) {
    return place + ": the text is not UTF-8";
  }
  if (const std::string_view read = behind_last(rest, "last read: "); !read.empty()) {
    return place + ": it cannot go on with " + std::string(read.substr(0, read.rfind("; expected")));
  }
  return place + ": " + std::string(rest.substr(colon + 2));
}

}  // namespace gazetrace
