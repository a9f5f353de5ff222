// SPDX-License-Identifier: Apache-2.0
#include "cli/command.hpp"

#include <CLI/CLI.hpp>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <regex>

#include "gazetrace/error.hpp"

namespace gazetrace {
namespace {

std::string joined(const std::vector<std::string>& texts) {
  std::string line;
  for (const std::string& text : texts) {
    line += (line.empty() ? "" : ",") + text;
  }
  return line;
}

}  // namespace

void bind_options(CLI::App& app, const OptionTable& table) {
  for (const OptionEntry& entry : table.entries()) {
    const bool positional = !entry.flags.starts_with('-');
    const std::string place = positional ? entry.name : "--" + entry.name;
    CLI::Option* option = nullptr;
    if (entry.shape == OptionShape::flag) {
      option = app.add_flag_function(
          entry.flags,
          [assign = entry.assign, place](std::int64_t count) { assign({count > 0 ? "true" : "false"}, place); },
          entry.help);
    } else {
      option = app.add_option(
          entry.flags,
          [assign = entry.assign, place](const CLI::results_t& results) {
            assign(results, place);
            return true;
          },
          entry.help);
      option->type_name(entry.unit)->default_str(joined(entry.defaults));
    }
    if (entry.shape == OptionShape::repeated) {
      option->expected(1, CLI::detail::expected_max_vector_size)->allow_extra_args(false);
    }
    if (!positional) {
      option->group(entry.group);
    }
  }
}

void check_output_file(const std::string& path, bool overwrite) {
  if (!overwrite && std::filesystem::exists(path)) {
    throw Error(ErrorKind::input, path, "this output exists already", "give --overwrite or another name");
  }
  if (const auto folder = std::filesystem::path(path).parent_path();
      !folder.empty() && !std::filesystem::is_directory(folder)) {
    throw Error(ErrorKind::input, path, "there is no folder " + folder.string(), "make it first");
  }
}

void print_result(const std::string& text) {
  errno = 0;
  if (std::fwrite(text.data(), 1, text.size(), stdout) != text.size() || std::fflush(stdout) != 0) {
    if (errno != EPIPE) {
      throw Error(ErrorKind::runtime, "stdout", std::string("writing failed: ") + std::strerror(errno));
    }
  }
}

std::string with_flags(const std::string& text) {
  static const std::regex kSetting("`([a-z][a-z0-9]*(?:-[a-z0-9]+)*)`");
  return std::regex_replace(text, kSetting, "--$1");
}

std::vector<std::string> with_flags(std::vector<std::string> texts) {
  for (std::string& text : texts) {
    text = with_flags(text);
  }
  return texts;
}

void print_warnings(const std::vector<std::string>& warnings) {
  for (const std::string& warning : warnings) {
    std::fprintf(stderr, "gazetrace: warning: %s\n", with_flags(warning).c_str());
  }
}

}  // namespace gazetrace
