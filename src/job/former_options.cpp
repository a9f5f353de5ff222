// SPDX-License-Identifier: Apache-2.0
#include "gazetrace/former_options.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <sstream>
#include <system_error>
#include <tuple>

namespace gazetrace {
namespace {

constexpr const char* kGivenValue = "*";
constexpr const char* kHalfOfGiven = "*/2";

// "--sampling density --density *" as options with their values.
std::vector<std::pair<std::string, std::string>> options_in(const std::string& text) {
  std::vector<std::pair<std::string, std::string>> options;
  std::istringstream words(text);
  for (std::string word; words >> word;) {
    if (word.starts_with("--")) {
      options.emplace_back(word.substr(2), "");
    } else {
      options.back().second = word;
    }
  }
  return options;
}

std::vector<FormerOption> table_of_this_version() {
  return {
#define GAZETRACE_RENAMED(before, now, why) former_option(FormerKind::renamed, before, now, why),
#define GAZETRACE_GONE(before, instead) former_option(FormerKind::gone, before, "", instead),
#define GAZETRACE_IMPORTED(before, now) \
  former_option(FormerKind::gone, before, "", "it is said once: gazetrace gaze import LOG -o gaze.csv " now),
#define GAZETRACE_ELSEWHERE(name, here) former_option(FormerKind::elsewhere, name, "", here),
#include "job/schema/renamed_options.def"
#undef GAZETRACE_RENAMED
#undef GAZETRACE_GONE
#undef GAZETRACE_IMPORTED
#undef GAZETRACE_ELSEWHERE
  };
}

// Of one number or several with commas between; what is none is for the option to refuse.
std::string halved(const std::string& text) {
  std::istringstream parts(text);
  std::vector<std::string> halves;
  for (std::string part; std::getline(parts, part, ',');) {
    double number = 0;
    const auto [end, code] = std::from_chars(part.data(), part.data() + part.size(), number);
    halves.push_back(code == std::errc() && end == part.data() + part.size() ? fmt::format("{}", number / 2) : part);
  }
  return fmt::format("{}", fmt::join(halves, ","));
}

// A star within a text is one part of what was given: ":inner=*,outer=*" of "5,25".
std::string filled(std::string text, const std::vector<std::string>& given) {
  std::istringstream parts(fmt::format("{}", fmt::join(given, ",")));
  std::string part;
  const bool has_star = text.find('*') != std::string::npos;
  for (std::size_t star = text.find('*'); star != std::string::npos && std::getline(parts, part, ',');) {
    text.replace(star, 1, part);
    star = text.find('*', star + part.size());
  }
  while (has_star && std::getline(parts, part, ',')) {
    text += "," + part;  // for the option to refuse
  }
  return text;
}

std::vector<std::string> now_given(const std::string& value, std::vector<std::string> given) {
  if (value == kHalfOfGiven) {
    std::transform(given.begin(), given.end(), given.begin(), halved);
  }
  return value.empty() || value == kGivenValue || value == kHalfOfGiven ? given : std::vector{filled(value, given)};
}

bool is_one_of(const std::string& value, const std::string& values) {
  return values == kGivenValue || ("|" + values + "|").find("|" + value + "|") != std::string::npos;
}

std::string first_of(const std::vector<std::string>& values) {
  return values.empty() ? std::string() : values.front();
}

// "mar" and ":slope=0.03" are one value, and so are "regions:shape=disc" and "regions:unit=pixel".
bool are_one_value(const std::string& first, const std::string& second) {
  const std::string name = second.substr(0, second.find(':'));
  return second.find(':') != std::string::npos && (name.empty() || name == first.substr(0, first.find(':')));
}

// Adds the parameters that former options of later rows give; false where one of an earlier row has it all.
bool gather_parameters(const FormerOption& former, const std::string& name, std::string& value,
                       const std::vector<OptionText>& given, const std::vector<FormerOption>& table) {
  for (const auto& [option, values] : given) {
    const FormerOption* other = find_former_option(option, first_of(values), given, table);
    if (other == nullptr || other == &former) {
      continue;
    }
    for (const auto& [also, text] : other->replacements) {
      const std::string theirs = first_of(now_given(text, values));
      if (also != name || !are_one_value(other < &former ? theirs : value, other < &former ? value : theirs)) {
        continue;
      }
      if (other < &former) {
        return false;
      }
      const std::string parameters = theirs.substr(theirs.find(':') + 1);
      value += (value.find(':') == std::string::npos ? ":" : ",") + parameters;
    }
  }
  return true;
}

// "`mode` fast"
std::string in_words(const std::string& option, const std::string& value) {
  return fmt::format("`{}`{}{}", option, value.empty() ? "" : " ", value);
}

}  // namespace

FormerOption former_option(FormerKind kind, const std::string& before, const std::string& now,
                           const std::string& reason) {
  const auto options = options_in(before);
  const auto& [option, value] = options.at(0);
  FormerOption row{kind, option, value == kGivenValue ? "" : value, !value.empty(), {}, {}, options_in(now), reason};
  if (options.size() > 1) {
    std::tie(row.beside, row.beside_values) = options[1];
  }
  return row;
}

const std::vector<FormerOption>& former_options() {
  static const std::vector<FormerOption> table = table_of_this_version();
  return table;
}

const FormerOption* find_former_option(const std::string& option, const std::string& value,
                                       const std::vector<OptionText>& given, const std::vector<FormerOption>& table) {
  const auto stands_beside = [&](const FormerOption& row) {
    return row.beside.empty() || std::any_of(given.begin(), given.end(), [&](const OptionText& other) {
             return other.first == row.beside && is_one_of(first_of(other.second), row.beside_values);
           });
  };
  const auto found = std::find_if(table.begin(), table.end(), [&](const FormerOption& row) {
    return row.option == option && (row.value.empty() || row.value == value) && stands_beside(row);
  });
  return found == table.end() ? nullptr : &*found;
}

std::optional<std::string> refusal_of(const FormerOption& former) {
  switch (former.kind) {
    case FormerKind::renamed:
      return std::nullopt;
    case FormerKind::gone:
      break;
    case FormerKind::elsewhere:
      return fmt::format("there is no such option; {}", former.reason);
  }
  return former.value.empty() ? fmt::format("this option is gone; {}", former.reason)
                              : fmt::format("'{}' is gone; {}", former.value, former.reason);
}

CurrentOptions current_options(const OptionText& option, const std::vector<OptionText>& given, ErrorKind kind,
                               const std::string& place, const std::vector<FormerOption>& table) {
  const std::vector<std::string>& values = option.second;
  const FormerOption* former = find_former_option(option.first, first_of(values), given, table);
  if (former == nullptr) {
    return {{option}, {}};
  }
  if (const std::optional<std::string> refusal = refusal_of(*former)) {
    throw Error(kind, place, *refusal);
  }
  CurrentOptions current;
  const bool is_flag_off = !former->takes_value && values == std::vector<std::string>{"false"};
  const auto is_fixed = [](const auto& row) { return !row.second.empty() && row.second != kGivenValue; };
  if (is_flag_off && std::any_of(former->replacements.begin(), former->replacements.end(), is_fixed)) {
    return current;  // a fixed value stands for the flag itself, and this one was not set
  }
  std::vector<std::string> words;
  for (const auto& [name, value] : former->replacements) {
    std::vector<std::string> now = now_given(value, values);
    if (now.size() != 1 || gather_parameters(*former, name, now.front(), given, table)) {
      current.settings.emplace_back(name, now);
    }
    words.push_back(in_words(name, value.empty() ? "" : fmt::format("{}", fmt::join(now, ","))));
  }
  current.notice = fmt::format("{} is {}{}; {}", in_words(option.first, former->value),
                               words.empty() ? "no longer said" : "now ", fmt::join(words, " "), former->reason);
  return current;
}

}  // namespace gazetrace
