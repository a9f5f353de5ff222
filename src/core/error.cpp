// SPDX-License-Identifier: Apache-2.0
#include "gazetrace/error.hpp"

#include <algorithm>
#include <cstddef>
#include <numeric>

namespace gazetrace {
namespace {

// Lists of known names are long; what files say need not be.
constexpr std::size_t kMostOfProblem = 1500;

std::string one_line(std::string_view place, std::string_view problem, std::string_view remedy) {
  std::string line;
  if (!place.empty()) {
    line.append(bounded(place, 600)).append(": ");
  }
  line.append(bounded(problem, kMostOfProblem));
  if (!remedy.empty()) {
    line.append("; ").append(bounded(remedy, 600));
  }
  return line;
}

bool is_inside_character(char c) {
  return (static_cast<unsigned char>(c) & 0xC0U) == 0x80U;  // of UTF-8
}

// Levenshtein distance, one row at a time.
// Of long texts only the beginnings, which is enough to tell that they are no names of ours.
std::size_t edit_distance(std::string_view a, std::string_view b) {
  constexpr std::size_t kMostLetters = 100;
  a = a.substr(0, kMostLetters);
  b = b.substr(0, kMostLetters);
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 0; i < a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i + 1;
    for (std::size_t j = 0; j < b.size(); ++j) {
      const std::size_t substitute = diagonal + (a[i] == b[j] ? 0 : 1);
      diagonal = row[j + 1];
      row[j + 1] = std::min({row[j] + 1, row[j + 1] + 1, substitute});
    }
  }
  return row.back();
}

}  // namespace

std::string bounded(std::string_view text, std::size_t most) {
  std::string line(text);
  if (text.size() > most) {
    std::size_t head = most * 2 / 3;
    std::size_t tail = text.size() - most / 3;
    while (head > 0 && is_inside_character(text[head])) {
      --head;
    }
    while (tail < text.size() && is_inside_character(text[tail])) {
      ++tail;
    }
    line.assign(text.substr(0, head)).append("... (").append(std::to_string(tail - head));
    line.append(" more bytes) ...").append(text.substr(tail));
  }
  std::replace_if(
      line.begin(), line.end(), [](char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7F; }, ' ');
  return line;
}

Error::Error(ErrorKind kind, std::string_view place, std::string_view problem, std::string_view remedy)
    : std::runtime_error(one_line(place, problem, remedy)), kind_(kind) {}

std::string unknown_name_message(std::string_view what, std::string_view given, const std::vector<std::string>& known) {
  std::string text = "unknown " + std::string(what) + " '" + std::string(given) + "'";
  const auto nearest = std::min_element(known.begin(), known.end(), [&](const auto& a, const auto& b) {
    return edit_distance(given, a) < edit_distance(given, b);
  });
  if (nearest != known.end() && edit_distance(given, *nearest) <= 1 + given.size() / 4) {
    text += "; did you mean '" + *nearest + "'? Known:";
  } else {
    text += "; Known:";
  }
  for (std::size_t i = 0; i < known.size(); ++i) {
    text += (i == 0 ? " " : ", ") + known[i];
  }
  return text;
}

}  // namespace gazetrace
