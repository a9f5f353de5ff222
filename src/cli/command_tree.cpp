// SPDX-License-Identifier: Apache-2.0
#include "cli/command_tree.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cctype>

namespace gazetrace {
namespace {

OptionWords words_of(const CLI::Option& option) {
  OptionWords words;
  for (const std::string& name : option.get_snames()) {
    words.names.push_back("-" + name);
  }
  for (const std::string& name : option.get_lnames()) {
    words.names.push_back("--" + name);
  }
  if (words.names.empty()) {
    words.names.push_back(option.get_name(true));
  }
  words.value = option.get_type_name();
  words.help = option.get_description();
  words.group = option.get_group();
  words.default_text = option.get_default_str();
  return words;
}

// `program` has --config, which every command that takes it reads.
CommandWords words_of(const CLI::App& app, const std::vector<std::string>& above, const CLI::App& program) {
  CommandWords words;
  words.path = above;
  words.path.push_back(app.get_name());
  words.summary = app.get_description();
  for (const CLI::Option* option : app.get_options()) {
    if (!option->get_group().empty()) {  // those without are hidden
      words.options.push_back(words_of(*option));
    }
  }
  if (&app != &program && app.get_footer().find("--config") != std::string::npos) {
    words.options.push_back(words_of(*program.get_option("--config")));
  }
  for (const CLI::App* sub : app.get_subcommands([](const CLI::App*) { return true; })) {
    if (!sub->get_group().empty()) {
      words.commands.push_back(words_of(*sub, words.path, program));
    }
  }
  return words;
}

bool is_plain_word(const std::string& text) {
  return !text.empty() && std::all_of(text.begin(), text.end(), [](unsigned char c) {
    return std::islower(c) != 0 || std::isdigit(c) != 0 || c == '-' || c == '_';
  });
}

}  // namespace

CommandWords command_tree(const CLI::App& program) {
  return words_of(program, {}, program);
}

std::vector<const CommandWords*> all_commands(const CommandWords& root) {
  std::vector<const CommandWords*> all{&root};
  for (const CommandWords& command : root.commands) {
    const std::vector<const CommandWords*> within = all_commands(command);
    all.insert(all.end(), within.begin(), within.end());
  }
  return all;
}

ValueWords values_of(const OptionWords& option) {
  ValueWords values;
  for (const std::string& name : option.names) {
    const std::vector<std::string> listed = names_of_option(name);
    values.names.insert(values.names.end(), listed.begin(), listed.end());
  }
  std::size_t at = 0;
  while (at <= option.value.size()) {
    const std::size_t end = std::min(option.value.find('|', at), option.value.size());
    const std::string part = option.value.substr(at, end - at);
    const bool is_new = std::find(values.names.begin(), values.names.end(), part) == values.names.end();
    if (is_new && is_plain_word(part) && option.value.find('|') != std::string::npos) {
      values.names.push_back(part);
    }
    for (const char* file : {"FILE", "PATTERN", "DIR", "FOLDER", "PATH", "OUT", "PLAN", "JOB", "MAP", "PROGRAM"}) {
      values.is_file = values.is_file || part.find(file) != std::string::npos;
    }
    at = end + 1;
  }
  return values;
}

}  // namespace gazetrace
