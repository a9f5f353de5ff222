// SPDX-License-Identifier: Apache-2.0
// One definition for each option: its name, its meaning, where its value lies in a structure of settings, and the
// stages that it touches. The command line, settings files, help, run records, digests, warnings and the reference page
// are all made from these definitions.
//
// A schema is not bound to any settings: an option knows the place of its value in them and the type of that value, and
// takes the settings as an argument. Settings are therefore plain values that can be copied, and any number of them can
// exist at the same time. All that parses, prints and measures a value exists once for each type, not for each option.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "gazetrace/option_values.hpp"

namespace gazetrace {

// Which part of an option affects pixels.
enum class Decides : std::uint8_t {
  nothing,  // threads, names of outputs, progress
  text,     // its value
  file,     // the content of the file that it names, or its value where it names no file
};

// flag: true or false. value: one value. list: one value of several parts, which is an array in a settings file.
// repeated: the option may be given several times.
enum class OptionShape : std::uint8_t { flag, value, list, repeated };

// The stages that an option touches. Touches is a set of these, because some options touch several things.
enum class Touch : std::uint16_t {
  scene = 1U << 0U,     // the scene's file and its animation
  camera = 1U << 1U,    // from where it is rendered, lens and shutter included
  light = 1U << 2U,     // the environment
  gaze = 1U << 3U,      // where the viewer looked, and when
  screen = 1U << 4U,    // where the viewer sat
  frames = 1U << 5U,    // the list of pictures, and their size
  sampling = 1U << 6U,  // how samples are distributed; a uniform frame ignores it
  tracing = 1U << 7U,   // how a path is traced
  filter = 1U << 8U,    // how pixels are reconstructed from samples
  window = 1U << 9U,    // samples from the frames around
  color = 1U << 10U,    // exposure and view
  output = 1U << 11U,   // files
  speed = 1U << 12U,    // how fast it goes, and nothing else
  talk = 1U << 13U,     // messages of the program
};

class Touches {
 public:
  constexpr Touches() = default;
  constexpr Touches(Touch touch) : bits_(static_cast<std::uint16_t>(touch)) {}  // NOLINT: a set of one
  [[nodiscard]] constexpr bool has(Touch touch) const { return (bits_ & static_cast<std::uint16_t>(touch)) != 0; }
  [[nodiscard]] constexpr bool any() const { return bits_ != 0; }
  [[nodiscard]] constexpr Touches without(Touch touch) const {
    Touches rest = *this;
    rest.bits_ = static_cast<std::uint16_t>(rest.bits_ & ~static_cast<unsigned>(touch));
    return rest;
  }
  friend constexpr Touches operator|(Touches a, Touches b) {
    Touches both;
    both.bits_ = static_cast<std::uint16_t>(a.bits_ | b.bits_);
    return both;
  }
  friend constexpr bool operator==(Touches, Touches) = default;

 private:
  std::uint16_t bits_ = 0;
};
constexpr Touches operator|(Touch a, Touch b) {
  return Touches(a) | Touches(b);
}
std::vector<std::string> touch_names(Touches touches);  // "sampling", "filter"

// The meaning of an option beside its value: to a sweep, which measures many settings against one reference
// (sweep.hpp), and to readers.
enum class Trait : std::uint8_t {
  trade_off,      // makes rendering cheaper and less accurate: a reference never takes its value from a row
  needs_truth,    // a trade-off without a value that is right by itself: the plan must state that of the reference
  own_seed,       // every row and every reference has its own value
  clock,          // decides where a camera that follows the head is at a given time
  gaze_source,    // decides whose gaze is used
  one_run,        // has a meaning for a single run only, such as the names of its files
  everyday,       // options that most people set: help shows these unless asked for all
  always_stated,  // stated in a paragraph on methods even where it has its default
};

// Bounds of a number, or of each number of a value with several. The bounds themselves belong to the range, except that
// the lower one does not where `above` is set.
struct OptionRange {
  std::optional<double> least, most;
  bool above = false;
  std::string remedy;  // the remedy for a value outside the range; may be empty

  [[nodiscard]] bool holds(double value) const;
  [[nodiscard]] std::string words() const;  // "0..1000", "above 0"
};

// The common part of all options of one type of value, in any settings. `value` points to one of that type.
struct OptionType {
  OptionShape shape = OptionShape::value;
  // Sets the value. Throws Error(usage, place, ...) for texts that the type does not take.
  void (*parse)(const std::vector<std::string>& texts, const std::string& place, void* value) = nullptr;
  void (*check)(const std::vector<std::string>& texts, const std::string& place) = nullptr;  // parses and forgets
  // The value in canonical form; empty: not set.
  std::vector<std::string> (*format)(const void* value) = nullptr;
  // The numbers of the value, which are checked against the option's range.
  std::vector<double> (*numbers)(const void* value) = nullptr;
};

// The properties of an option without any settings.
struct Option {
  std::string flags;  // "-o,--output"; without dashes: the command line takes it by its position
  std::string name;   // "output"
  std::string group;  // a heading for people, which affects nothing else
  std::string unit;   // stands for the value in the help: "DEG", "a|b|c"
  std::string help;
  const OptionType* type = nullptr;
  std::size_t offset = 0;  // of the value within the settings, in bytes
  OptionShape shape = OptionShape::value;
  Decides decides = Decides::text;
  Touches touches;
  std::vector<Trait> traits;
  std::optional<OptionRange> range;
  std::vector<std::string> needs;       // options that must be given with it, in words with settings in back quotes
  std::vector<std::string> idle_words;  // when it has no effect, in the same kind of words
  std::vector<std::string> defaults;    // its values in default settings; empty: not set
  // Another option and the value that it gets with this one; empty: none.
  std::pair<std::string, std::string> implies;

  // Throws Error(usage, place, ...) for a value that its type takes, and the option does not; may be empty.
  void (*refuse)(const std::string& value, const std::string& place) = nullptr;

  // Throws Error(usage, place, ...) unless the option takes these values.
  void check(const std::vector<std::string>& values, const std::string& place) const {
    refuse_each(values, place);
    type->check(values, place);
  }
  void refuse_each(const std::vector<std::string>& values, const std::string& place) const {
    for (std::size_t i = 0; refuse != nullptr && i < values.size(); ++i) {
      refuse(values[i], place);
    }
  }
  [[nodiscard]] bool is(Trait trait) const;
  // A flag that is set unless it is turned off. The command line takes --no-NAME for it.
  [[nodiscard]] bool is_on_by_default() const;
};
using OptionList = std::vector<const Option*>;
[[nodiscard]] const Option* find_option(const OptionList& options, const std::string& name);
[[nodiscard]] std::vector<std::string> names_of(const OptionList& options);
// An option as its flags name it.
[[nodiscard]] Option make_option(const std::string& flags, const OptionType& type, std::size_t offset);

// A condition under which an option has no effect because of the other settings.
template <class S>
struct IdleRule {
  std::string words;                               // for the reference page: "without gaze"
  std::function<bool(const S&)> holds;             // whether the condition holds for these settings
  std::function<std::string(const S&)> said = {};  // the words of a warning, where they differ from `words`
};

// An option of settings of the type S.
template <class S>
struct OptionOf : Option {
  std::vector<IdleRule<S>> idle;

  // Sets the value. Throws Error(usage, place, ...) for values that the option does not take.
  void assign(S& settings, const std::vector<std::string>& values, const std::string& place) const {
    refuse_each(values, place);
    type->parse(values, place, reinterpret_cast<std::byte*>(&settings) + offset);
  }
  // The present value in canonical form; empty: not set.
  [[nodiscard]] std::vector<std::string> values(const S& settings) const { return type->format(value_in(settings)); }
  // The numbers of its value, which are checked against the range.
  [[nodiscard]] std::vector<double> numbers(const S& settings) const { return type->numbers(value_in(settings)); }

  OptionOf& decides_nothing() {
    decides = Decides::nothing;
    return *this;
  }
  OptionOf& decides_by_file() {
    decides = Decides::file;
    return *this;
  }
  // Refuses values of its type that it does not take as soon as they are given.
  OptionOf& checked_by(void (*names)(const std::string& value, const std::string& place)) {
    refuse = names;
    return *this;
  }
  OptionOf& with(Trait trait) {
    traits.push_back(trait);
    return *this;
  }
  OptionOf& within(double least, double most, std::string remedy = {}) {
    range = OptionRange{least, most, false, std::move(remedy)};
    return *this;
  }
  OptionOf& at_least(double least, std::string remedy = {}) {
    range = OptionRange{least, std::nullopt, false, std::move(remedy)};
    return *this;
  }
  OptionOf& above(double least, std::optional<double> most = std::nullopt) {
    range = OptionRange{least, most, true, {}};
    return *this;
  }
  OptionOf& need(std::string_view words) {
    needs.emplace_back(words);
    return *this;
  }
  OptionOf& idle_when(const std::vector<IdleRule<S>>& rules) {
    for (const IdleRule<S>& rule : rules) {
      idle_words.push_back(rule.words);
      idle.push_back(rule);
    }
    return *this;
  }

 private:
  const void* value_in(const S& settings) const { return reinterpret_cast<const std::byte*>(&settings) + offset; }
};

// Where a value of the type T lies in settings of the type S: its distance from their beginning, in bytes.
template <class S, class T>
struct Place {
  std::size_t offset = 0;
};

namespace option_detail {

// Settings as they are by default, in which places are measured.
template <class S>
const S& defaults() {
  static const S settings{};
  return settings;
}

template <class S, class T>
Place<S, T> place_of(const T& value) {
  const auto* begin = reinterpret_cast<const std::byte*>(&defaults<S>());
  return {static_cast<std::size_t>(reinterpret_cast<const std::byte*>(&value) - begin)};
}

template <class T>
struct Bare {
  using Type = T;
};
template <class T>
struct Bare<std::optional<T>> {
  using Type = T;
};

// Whether a value has several parts, and is therefore an array in a settings file.
template <class T>
constexpr bool is_list() {
  return std::is_same_v<T, Vec2d> || std::is_same_v<T, Vec3d> || std::is_same_v<T, FrameRect> ||
         std::is_same_v<T, FrameCrop> || std::is_same_v<T, PixelIndex> ||
         std::is_same_v<T, std::array<std::uint32_t, 3>> || std::is_same_v<T, std::array<int, 2>> ||
         std::is_same_v<T, std::array<double, 2>> || std::is_same_v<T, std::vector<std::string>>;
}

template <class T>
std::vector<double> numbers_in(const T& value) {
  if constexpr (std::is_arithmetic_v<T> && !std::is_same_v<T, bool>) {
    return {static_cast<double>(value)};
  } else if constexpr (std::is_same_v<T, DurationNs>) {
    return {static_cast<double>(value.ns)};
  } else if constexpr (std::is_same_v<T, Vec2d>) {
    return {value.x, value.y};
  } else if constexpr (std::is_same_v<T, ExposureSettings>) {
    return {value.ev};
  } else if constexpr (std::is_same_v<T, std::array<std::uint32_t, 3>> || std::is_same_v<T, std::array<int, 2>> ||
                       std::is_same_v<T, std::array<double, 2>>) {
    return {value.begin(), value.end()};
  } else {
    return {};
  }
}

template <class Held>
struct Ops {
  using T = typename Bare<Held>::Type;
  static constexpr bool kIsOptional = !std::is_same_v<Held, T>;

  static void parse(const std::vector<std::string>& texts, const std::string& place, void* value) {
    if constexpr (kIsOptional) {  // stays as it was where the text is wrong
      T parsed{};
      parse_value(texts.at(0), place, parsed);
      *static_cast<Held*>(value) = std::move(parsed);
    } else {
      parse_value(texts.at(0), place, *static_cast<Held*>(value));
    }
  }
  static void check(const std::vector<std::string>& texts, const std::string& place) {
    T scratch{};
    parse_value(texts.at(0), place, scratch);
  }
  static std::vector<std::string> format(const void* value) {
    const Held& held = *static_cast<const Held*>(value);
    if constexpr (kIsOptional) {
      return held ? std::vector{format_value(*held)} : std::vector<std::string>();
    } else {
      std::string text = format_value(held);
      return text.empty() ? std::vector<std::string>() : std::vector{std::move(text)};
    }
  }
  static std::vector<double> numbers(const void* value) {
    const Held& held = *static_cast<const Held*>(value);
    if constexpr (kIsOptional) {
      return held ? numbers_in(*held) : std::vector<double>();
    } else {
      return numbers_in(held);
    }
  }
};

}  // namespace option_detail

// at(&JobSettings::foveation, &FoveationSettings::spp)
template <class S, class First, class... Rest>
auto at(First S::*first, Rest... rest) {
  const auto& value = ((option_detail::defaults<S>().*first).*....*rest);
  return option_detail::place_of<S, std::remove_cvref_t<decltype(value)>>(value);
}
// The settings themselves, or those that they are derived from.
template <class S, class Base>
Place<S, Base> whole() {
  return option_detail::place_of<S, Base>(option_detail::defaults<S>());
}

template <class Held>
const OptionType& option_type() {
  using Ops = option_detail::Ops<Held>;
  static constexpr OptionType kType{std::is_same_v<typename Ops::T, bool>       ? OptionShape::flag
                                    : option_detail::is_list<typename Ops::T>() ? OptionShape::list
                                                                                : OptionShape::value,
                                    Ops::parse, Ops::check, Ops::format, Ops::numbers};
  return kType;
}
// Of options that may be given several times; their values are taken as they are.
const OptionType& repeated_type();

template <class S>
class OptionSchema {
 public:
  // Heading of the options that follow.
  void group(std::string heading) { group_ = std::move(heading); }

  // `place`: where the value lies, as at() says it, or a pointer to the member.
  template <class Where>
  OptionOf<S>& value(const std::string& flags, Where place, const std::string& unit, Touches touches,
                     const std::string& help) {
    return value_of(flags, place_in_settings(place), unit, touches, help);
  }
  template <class Where>
  OptionOf<S>& flag(const std::string& flags, Where place, Touches touches, const std::string& help) {
    return value(flags, place, "", touches, help);
  }
  // An option that may be given several times; its values are taken as they are.
  template <class Where>
  OptionOf<S>& repeated(const std::string& flags, Where place, const std::string& unit, Touches touches,
                        const std::string& help) {
    const Place<S, std::vector<std::string>> values = place_in_settings(place);
    return add(flags, repeated_type(), values.offset, unit, touches, help);
  }
  // For settings outside of jobs, where the stages of an option do not matter.
  template <class Where>
  OptionOf<S>& flag(const std::string& flags, Where place, const std::string& help) {
    return value(flags, place, "", Touches(), help);
  }
  template <class Where>
  OptionOf<S>& value(const std::string& flags, Where place, const std::string& unit, const std::string& help) {
    return value(flags, place, unit, Touches(), help);
  }
  template <class Where>
  OptionOf<S>& repeated(const std::string& flags, Where place, const std::string& unit, const std::string& help) {
    return repeated(flags, place, unit, Touches(), help);
  }

  // An option as it is, under its own heading.
  OptionOf<S>& add(OptionOf<S> option) {
    options_.push_back(std::move(option));
    options_.back().defaults = options_.back().values(option_detail::defaults<S>());
    return options_.back();
  }

  // Adds all options of a part of these settings, with their headings; returns the last of them.
  template <class Part, class Where>
  OptionOf<S>& include(const OptionSchema<Part>& part, Where place) {
    const Place<S, Part> whole_part = place_in_settings(place);
    const std::size_t begin = whole_part.offset;
    for (const OptionOf<Part>& inner : part.options()) {
      OptionOf<S> option;
      static_cast<Option&>(option) = inner;
      option.offset += begin;
      for (const IdleRule<Part>& rule : inner.idle) {
        const auto part_of = [begin](const S& settings) -> const Part& {
          return *reinterpret_cast<const Part*>(reinterpret_cast<const std::byte*>(&settings) + begin);
        };
        IdleRule<S> of_whole{rule.words, [=, holds = rule.holds](const S& s) { return holds(part_of(s)); }};
        if (rule.said) {
          of_whole.said = [=, said = rule.said](const S& s) { return said(part_of(s)); };
        }
        option.idle.push_back(std::move(of_whole));
      }
      add(std::move(option));
    }
    return options_.back();
  }

  [[nodiscard]] const std::vector<OptionOf<S>>& options() const { return options_; }
  [[nodiscard]] const OptionOf<S>* find(const std::string& name) const {
    for (const OptionOf<S>& option : options_) {
      if (option.name == name) {
        return &option;
      }
    }
    return nullptr;
  }
  [[nodiscard]] OptionList list() const {
    OptionList list;
    for (const OptionOf<S>& option : options_) {
      list.push_back(&option);
    }
    return list;
  }
  // The same options under other headings, in the same order.
  [[nodiscard]] OptionSchema with_headings(const std::function<std::string(const Option&)>& heading) const {
    OptionSchema other = *this;
    for (OptionOf<S>& option : other.options_) {
      option.group = heading(option);
    }
    return other;
  }

 private:
  template <class Base, class T>
  static Place<S, T> place_in_settings(Place<Base, T> place) {
    return {whole<S, Base>().offset + place.offset};
  }
  template <class Base, class T>
  static Place<S, T> place_in_settings(T Base::*member) {
    return place_in_settings(at(member));
  }
  template <class T>
  OptionOf<S>& value_of(const std::string& flags, Place<S, T> place, const std::string& unit, Touches touches,
                        const std::string& help) {
    return add(flags, option_type<T>(), place.offset, unit, touches, help);
  }
  OptionOf<S>& add(const std::string& flags, const OptionType& type, std::size_t offset, const std::string& unit,
                   Touches touches, const std::string& help) {
    OptionOf<S> option;
    static_cast<Option&>(option) = make_option(flags, type, offset);
    option.group = group_;
    option.unit = unit;
    option.help = help;
    option.touches = touches;
    return add(std::move(option));
  }

  std::string group_ = "Options";
  std::vector<OptionOf<S>> options_;
};

// unknown_name_message() without the list of all known names, for cases where that list would have a hundred entries:
// it suggests the nearest one only.
std::string unknown_among_many(const std::string& what, const std::string& given,
                               const std::vector<std::string>& known);

// An option of a settings file, as the command line would carry its values.
struct TomlSetting {
  std::string name;
  std::vector<std::string> values;
  std::string place;    // path:line
  std::string warning;  // of a file that was found in another place than the settings say; empty: none
  std::string former;   // the former option that stands there; empty: none
};
// Where relative paths in a settings file begin. In the file's folder; where only the working folder has the file, it
// is taken from there with a warning. The settings in a run's record begin in the working folder, as those of the run
// did.
enum class PathsBegin : std::uint8_t { beside_settings, working_folder };

// The settings in a TOML text, with every value checked by its option. Throws Error(input) with path:line for a syntax
// error, for an unknown key (naming the nearest known one) and for a value that its option does not take. `remedy` says
// the remedy for an unknown key. An empty array sets nothing.
std::vector<TomlSetting> read_toml_settings(const std::string& text, const std::string& path, const OptionList& options,
                                            const std::string& remedy, PathsBegin paths = PathsBegin::beside_settings);
// Every option with its value, as TOML with the help as comments; options that are not set are commented out.
// `values_of` returns an option's values in canonical form.
std::string settings_as_toml(const OptionList& options,
                             const std::function<std::vector<std::string>(const Option&)>& values_of,
                             const std::string& title);

}  // namespace gazetrace
