// SPDX-License-Identifier: Apache-2.0
#include "gazetrace/option_schema.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "gazetrace/error.hpp"

namespace gazetrace {

std::vector<std::string> touch_names(Touches touches) {
  static constexpr std::array<std::pair<Touch, const char*>, 14> kNames{{{Touch::scene, "scene"},
                                                                         {Touch::camera, "camera"},
                                                                         {Touch::light, "light"},
                                                                         {Touch::gaze, "gaze"},
                                                                         {Touch::screen, "screen"},
                                                                         {Touch::frames, "frames"},
                                                                         {Touch::sampling, "sampling"},
                                                                         {Touch::tracing, "tracing"},
                                                                         {Touch::filter, "filter"},
                                                                         {Touch::window, "window"},
                                                                         {Touch::color, "colour"},
                                                                         {Touch::output, "output"},
                                                                         {Touch::speed, "speed"},
                                                                         {Touch::talk, "talk"}}};
  std::vector<std::string> names;
  for (const auto& [touch, name] : kNames) {
    if (touches.has(touch)) {
      names.emplace_back(name);
    }
  }
  return names;
}

bool OptionRange::holds(double value) const {
  const bool is_high = !least || (above ? value > *least : value >= *least);
  const bool is_low = !most || value <= *most;
  return std::isfinite(value) && is_high && is_low;
}

std::string OptionRange::words() const {
  if (least && most) {
    return above ? fmt::format("above {}, up to {}", *least, *most) : fmt::format("{}..{}", *least, *most);
  }
  return least ? fmt::format("{} {}", above ? "above" : "at least", *least) : fmt::format("at most {}", *most);
}

bool Option::is(Trait trait) const {
  return std::find(traits.begin(), traits.end(), trait) != traits.end();
}

bool Option::is_on_by_default() const {
  return shape == OptionShape::flag && defaults == std::vector<std::string>{"true"};
}

Option make_option(const std::string& flags, const OptionType& type, std::size_t offset) {
  Option option;
  option.flags = flags;
  const std::size_t dashes = flags.find("--");
  option.name = dashes == std::string::npos ? flags : flags.substr(dashes + 2, flags.find(',', dashes) - dashes - 2);
  option.type = &type;
  option.offset = offset;
  option.shape = type.shape;
  return option;
}

const OptionType& repeated_type() {
  using Texts = std::vector<std::string>;
  static constexpr OptionType kType{
      OptionShape::repeated,
      [](const Texts& texts, const std::string& /*place*/, void* value) { *static_cast<Texts*>(value) = texts; },
      [](const Texts& /*texts*/, const std::string& /*place*/) {},
      [](const void* value) { return *static_cast<const Texts*>(value); },
      [](const void* /*value*/) { return std::vector<double>(); }};
  return kType;
}

const Option* find_option(const OptionList& options, const std::string& name) {
  const auto found =
      std::find_if(options.begin(), options.end(), [&](const Option* option) { return option->name == name; });
  return found == options.end() ? nullptr : *found;
}

std::vector<std::string> names_of(const OptionList& options) {
  std::vector<std::string> names;
  for (const Option* option : options) {
    names.push_back(option->name);
  }
  return names;
}

std::string unknown_among_many(const std::string& what, const std::string& given,
                               const std::vector<std::string>& known) {
  std::string text = unknown_name_message(what, given, known);
  for (const char* list : {"; Known:", " Known:"}) {
    text.resize(std::min(text.size(), text.find(list)));
  }
  return text;
}

}  // namespace gazetrace
