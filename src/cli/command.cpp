// SPDX-License-Identifier: Apache-2.0
#include "cli/command.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <memory>
#include <string_view>

#include "cli/exit_codes.hpp"
#include "gazetrace/error.hpp"
#include "gazetrace/former_options.hpp"

namespace gazetrace {
namespace {

// Words of small letters and digits, joined by single hyphens; the first begins with a letter.
bool is_setting_name(std::string_view name) {
  const auto is_letter = [](char c) { return c >= 'a' && c <= 'z'; };
  const auto is_word = [&](char c) { return is_letter(c) || (c >= '0' && c <= '9'); };
  return !name.empty() && is_letter(name.front()) && name.back() != '-' && name.find("--") == std::string_view::npos &&
         std::all_of(name.begin(), name.end(), [&](char c) { return c == '-' || is_word(c); });
}

std::string joined(const std::vector<std::string>& texts) {
  std::string line;
  for (const std::string& text : texts) {
    line += (line.empty() ? "" : ",") + text;
  }
  return line;
}

std::string flags_of(const Option& flag) {
  return flag.flags + (flag.is_on_by_default() ? ",!--no-" + flag.name : "");
}

}  // namespace

void bind_options(CLI::App& app, const OptionList& options, const TakeOption& take) {
  for (const Option* const described : options) {
    const bool positional = !described->flags.starts_with('-');
    CLI::Option* option = nullptr;
    if (described->shape == OptionShape::flag) {
      option = app.add_flag_function(
          flags_of(*described),
          [take, described](std::int64_t count) { take(*described, {count > 0 ? "true" : "false"}); }, described->help);
      option->multi_option_policy(CLI::MultiOptionPolicy::TakeLast);  // CLI11 adds flags up
    } else {
      option = app.add_option(
          described->flags,
          [take, described](const CLI::results_t& results) {
            take(*described, results);
            return true;
          },
          described->help);
      option->type_name(described->unit)->default_str(joined(described->defaults));
    }
    if (described->shape == OptionShape::repeated) {
      option->expected(1, CLI::detail::expected_max_vector_size)->allow_extra_args(false);
    }
    if (!positional) {
      option->group(described->group);
    }
  }
}

// No help has them.
void bind_former_options(CLI::App& app, const OptionList& options, const TakeFormer& take,
                         const std::function<void()>& then) {
  app.callback(then);
  for (const FormerOption& former : former_options()) {
    const std::string flag = "--" + former.option;
    const auto& now = former.replacements;
    const bool is_known = std::all_of(now.begin(), now.end(),
                                      [&](const auto& one) { return find_option(options, one.first) != nullptr; });
    if (now.empty() || !is_known || find_option(options, former.option) != nullptr ||
        app.get_option_no_throw(flag) != nullptr) {
      continue;
    }
    if (former.takes_value) {
      app.add_option(flag,
                     [take, name = former.option](const CLI::results_t& results) {
                       take(name, results);
                       return true;
                     })
          ->group("");
    } else {
      app.add_flag_function(
             flag, [take, name = former.option](std::int64_t count) { take(name, {count > 0 ? "true" : "false"}); })
          ->group("");
    }
  }
}

void bind_job_options(CLI::App& app, Job& job) {
  const auto given = std::make_shared<std::vector<GivenOption>>();
  const auto take = [given](const std::string& option, const std::vector<std::string>& values) {
    given->push_back({option, values, {Origin::given, "the command line", {}, {}}, {}});
  };
  bind_former_options(app, job_schema().list(), take, [given, &job] { set_options(job, *given); });
  bind_options(app, job_schema().list(),
               [take](const Option& option, const std::vector<std::string>& values) { take(option.name, values); });
}

void read_job_config(Job& job, const std::string& command, const std::string& path) {
  add_toml(job, read_settings_file(path), path, unknown_key_remedy(command));
}

int exit_code_of(const Error& error) {
  switch (error.kind()) {
    case ErrorKind::runtime:
      return exit_failed;
    case ErrorKind::interrupted:
      return exit_interrupted;
    case ErrorKind::nothing_to_do:
      return exit_done;
    case ErrorKind::usage:
    case ErrorKind::input:
      break;
  }
  return exit_bad_input;
}

std::string unknown_key_remedy(const std::string& command) {
  const char* const help = command == "render" ? " --help-all'" : " --help'";
  return "'gazetrace " + command + help + " lists the options, whose names are the keys";
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
  std::string result;
  std::size_t copied = 0;  // so much of the text is in the result
  for (std::size_t open = text.find('`'); open != std::string::npos;) {
    const std::size_t close = text.find('`', open + 1);
    if (close == std::string::npos) {
      break;
    }
    const std::string_view name = std::string_view(text).substr(open + 1, close - open - 1);
    if (is_setting_name(name)) {
      result.append(text, copied, open - copied).append("--").append(name);
      copied = close + 1;
      open = text.find('`', copied);
    } else {
      open = close;
    }
  }
  return result.append(text, copied);
}

std::vector<std::string> with_flags(std::vector<std::string> texts) {
  for (std::string& text : texts) {
    text = with_flags(text);
  }
  return texts;
}

constexpr std::size_t kLongestWarning = 3000;

void print_warnings(const std::vector<std::string>& warnings) {
  for (const std::string& warning : warnings) {
    std::fprintf(stderr, "gazetrace: warning: %s\n", bounded(with_flags(warning), kLongestWarning).c_str());
  }
}

}  // namespace gazetrace
