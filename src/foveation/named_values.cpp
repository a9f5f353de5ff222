// SPDX-License-Identifier: Apache-2.0
#include "foveation/named_values.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <optional>

#include "core/text.hpp"

namespace gazetrace {
namespace {

std::string range_of(const NamedParameter& parameter) {
  return !parameter.words.empty() ? fmt::format("give one of {}", fmt::join(parameter.words, ", "))
         : parameter.above_low    ? fmt::format("give more than {}, up to {}", parameter.low, parameter.high)
                                  : fmt::format("give {} to {}", parameter.low, parameter.high);
}

double parse_value(std::string_view text, const NamedParameter& parameter, const std::string& place) {
  const auto word = std::find(parameter.words.begin(), parameter.words.end(), text);
  if (word != parameter.words.end()) {
    return static_cast<double>(word - parameter.words.begin());
  }
  const std::optional<double> number = parameter.words.empty() ? number_from(text) : std::nullopt;
  if (!number || *number > parameter.high || *number < parameter.low ||
      (parameter.above_low && *number == parameter.low)) {
    throw Error(ErrorKind::usage, place, fmt::format("'{}' is not possible for {}", text, parameter.name),
                range_of(parameter));
  }
  return *number;
}

}  // namespace

NamedText split_named_text(std::string_view text) {
  const std::size_t colon = text.find(':');
  return {trim(text.substr(0, colon)), colon == std::string_view::npos ? std::string_view() : text.substr(colon + 1)};
}

std::vector<double> parse_values(std::string_view text, const std::vector<NamedParameter>& parameters,
                                 const std::string& place) {
  if (parameters.empty() && !text.empty()) {
    throw Error(ErrorKind::usage, place, fmt::format("there are no parameters such as '{}'", text), "leave it out");
  }
  std::vector<double> values;
  for (const NamedParameter& parameter : parameters) {
    values.push_back(parameter.value);
  }
  std::vector<std::string_view> pairs;
  split_cells(text, ',', pairs);
  for (const std::string_view pair : text.empty() ? std::vector<std::string_view>() : pairs) {
    const std::size_t equals = std::min(pair.find('='), pair.size());
    const std::string_view name = trim(pair.substr(0, equals));
    const NamedParameter& parameter = find_named(parameters, name, "parameter", place);
    if (equals == pair.size()) {
      throw Error(ErrorKind::usage, place, fmt::format("'{}' has no value; write {}=...", pair, name));
    }
    values.at(static_cast<std::size_t>(&parameter - parameters.data())) =
        parse_value(trim(pair.substr(equals + 1)), parameter, place);
  }
  return values;
}

std::string values_text(const std::vector<double>& values, const std::vector<NamedParameter>& parameters) {
  std::string text;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const NamedParameter& parameter = parameters.at(i);
    if (values[i] != parameter.value) {
      text += fmt::format("{}{}={}", text.empty() ? ':' : ',', parameter.name,
                          parameter.words.empty() ? fmt::format("{}", values[i])
                                                  : parameter.words.at(static_cast<std::size_t>(values[i])));
    }
  }
  return text;
}

}  // namespace gazetrace
