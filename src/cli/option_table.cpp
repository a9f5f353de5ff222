// SPDX-License-Identifier: Apache-2.0
#include "cli/option_table.hpp"

#include <algorithm>

#include "gazetrace/error.hpp"

namespace gazetrace {

OptionEntry OptionTable::start(const std::string& flags, const std::string& unit, const std::string& help,
                               OptionShape shape, Influence influence) const {
  OptionEntry entry;
  entry.flags = flags;
  const std::size_t dashes = flags.find("--");
  entry.name = dashes == std::string::npos ? flags : flags.substr(dashes + 2, flags.find(',', dashes) - dashes - 2);
  entry.group = group_;
  entry.unit = unit;
  entry.help = help;
  entry.shape = shape;
  entry.influence = influence;
  return entry;
}

void OptionTable::finish(OptionEntry entry) {
  entry.defaults = entry.values();
  entry.given = std::make_shared<bool>(false);
  entry.assign_default = entry.assign;
  entry.assign = [assign = entry.assign_default, given = entry.given](const auto& values, const auto& place) {
    assign(values, place);
    *given = true;
  };
  entries_.push_back(std::move(entry));
}

const OptionEntry* OptionTable::find(const std::string& name) const {
  const auto found =
      std::find_if(entries_.begin(), entries_.end(), [&](const OptionEntry& entry) { return entry.name == name; });
  return found == entries_.end() ? nullptr : &*found;
}

std::vector<std::string> OptionTable::names() const {
  std::vector<std::string> names;
  for (const OptionEntry& entry : entries_) {
    names.push_back(entry.name);
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
