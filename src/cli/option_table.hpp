// SPDX-License-Identifier: Apache-2.0
// One definition per option: how it is called, what it means, where its value goes. Command line, settings file, help,
// run record and settings digest are all read from this table.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "cli/option_codecs.hpp"

namespace gazetrace {

enum class Influence {
  none,    // does not reach into pixels: threads, paths of outputs, progress
  pixels,  // its text does
  file,    // the content of the file it names does; so does its text where it names no file
};

enum class OptionShape { flag, value, list, repeated };

struct OptionEntry {
  std::string flags;  // "-o,--output"; without dashes: positional
  std::string name;   // "output"
  std::string group;
  std::string unit;  // stands for the value in the help
  std::string help;
  OptionShape shape = OptionShape::value;
  Influence influence = Influence::none;
  // Sets the target; throws Error(usage, place, ...). The same for a default of a preset, which does not count as
  // given.
  std::function<void(const std::vector<std::string>& values, const std::string& place)> assign;
  std::function<void(const std::vector<std::string>& values, const std::string& place)> assign_default;
  std::shared_ptr<bool> given;  // by the command line or a settings file
  // The same without touching the target.
  std::function<void(const std::vector<std::string>& values, const std::string& place)> check;
  // The target's present value in canonical form; empty: not set.
  std::function<std::vector<std::string>()> values;
  std::vector<std::string> defaults;  // the value when the option was added
};

class OptionTable {
 public:
  // Heading of the options that follow.
  void group(std::string name) { group_ = std::move(name); }

  void flag(const std::string& flags, bool& target, const std::string& help, Influence influence = Influence::none) {
    OptionEntry entry = start(flags, "", help, OptionShape::flag, influence);
    entry.assign = [&target](const auto& values, const auto& place) { parse_value(values.at(0), place, target); };
    entry.check = check_of<bool>();
    entry.values = [&target] { return std::vector{format_value(target)}; };
    finish(std::move(entry));
  }

  template <class T>
  void value(const std::string& flags, T& target, const std::string& unit, const std::string& help,
             Influence influence = Influence::none) {
    OptionEntry entry = start(flags, unit, help, is_list<T>() ? OptionShape::list : OptionShape::value, influence);
    entry.assign = [&target](const auto& values, const auto& place) { parse_value(values.at(0), place, target); };
    entry.check = check_of<T>();
    entry.values = [&target] {
      std::string text = format_value(target);
      return text.empty() ? std::vector<std::string>() : std::vector{std::move(text)};
    };
    finish(std::move(entry));
  }

  template <class T>
  void value(const std::string& flags, std::optional<T>& target, const std::string& unit, const std::string& help,
             Influence influence = Influence::none) {
    OptionEntry entry = start(flags, unit, help, is_list<T>() ? OptionShape::list : OptionShape::value, influence);
    entry.assign = [&target](const auto& values, const auto& place) {
      T parsed{};
      parse_value(values.at(0), place, parsed);
      target = parsed;
    };
    entry.check = check_of<T>();
    entry.values = [&target] { return target ? std::vector{format_value(*target)} : std::vector<std::string>(); };
    finish(std::move(entry));
  }

  // May be given several times; values are taken as they are.
  void repeated(const std::string& flags, std::vector<std::string>& target, const std::string& unit,
                const std::string& help, Influence influence = Influence::none) {
    OptionEntry entry = start(flags, unit, help, OptionShape::repeated, influence);
    entry.assign = [&target](const auto& values, const auto& /*place*/) { target = values; };
    entry.check = [](const auto& /*values*/, const auto& /*place*/) {};
    entry.values = [&target] { return target; };
    finish(std::move(entry));
  }

  [[nodiscard]] const std::vector<OptionEntry>& entries() const { return entries_; }
  // The option added last, for one that does more than set a value.
  [[nodiscard]] OptionEntry& last() { return entries_.back(); }
  [[nodiscard]] const OptionEntry* find(const std::string& name) const;
  [[nodiscard]] std::vector<std::string> names() const;

 private:
  // Written as an array in a settings file.
  template <class T>
  static constexpr bool is_list() {
    return std::is_same_v<T, Vec2d> || std::is_same_v<T, Vec3d> || std::is_same_v<T, FrameRect> ||
           std::is_same_v<T, PixelIndex> || std::is_same_v<T, std::array<std::uint32_t, 3>> ||
           std::is_same_v<T, std::array<int, 2>> || std::is_same_v<T, std::array<double, 2>> ||
           std::is_same_v<T, std::vector<std::string>>;
  }
  template <class T>
  static std::function<void(const std::vector<std::string>&, const std::string&)> check_of() {
    return [](const auto& values, const auto& place) {
      T scratch{};
      parse_value(values.at(0), place, scratch);
    };
  }
  [[nodiscard]] OptionEntry start(const std::string& flags, const std::string& unit, const std::string& help,
                                  OptionShape shape, Influence influence) const;
  void finish(OptionEntry entry);

  std::string group_ = "Options";
  std::vector<OptionEntry> entries_;
};

// unknown_name_message() without the list of all that is known, where that would be a hundred: the nearest is enough.
std::string unknown_among_many(const std::string& what, const std::string& given,
                               const std::vector<std::string>& known);

}  // namespace gazetrace
