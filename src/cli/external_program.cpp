// SPDX-License-Identifier: Apache-2.0
#include "cli/external_program.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cctype>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>

#include "cli/own_program.hpp"
#include "gazetrace/error.hpp"

namespace gazetrace {
namespace {

namespace fs = std::filesystem;

bool is_name(const std::string& word) {
  return !word.empty() && word.front() != '-' &&
         std::all_of(word.begin(), word.end(), [](unsigned char c) { return std::isalnum(c) != 0 || c == '-'; });
}

const CLI::App* command_within(const CLI::App& app, const std::string& name) {
  for (const CLI::App* sub : app.get_subcommands([](const CLI::App*) { return true; })) {
    if (sub->get_name() == name) {
      return sub;
    }
  }
  return nullptr;
}

}  // namespace

void add_external_command(CLI::App& above, const std::string& name, const std::string& help) {
  CLI::App* const sub = above.add_subcommand(name, help);
  sub->prefix_command();  // which tells it from those that are built in
  sub->callback([name] {
    throw Error(ErrorKind::usage, "'" + name + "'", "is a program of its own, and none of its options come before it",
                "put them behind it");
  });
}

bool can_run(const fs::path& file) {
  std::error_code ignored;
  return fs::is_regular_file(file, ignored) && access(file.c_str(), X_OK) == 0;
}

std::optional<fs::path> find_on_path(const std::string& name) {
  const char* const variable = std::getenv("PATH");
  std::string rest = variable == nullptr ? std::string() : variable;
  while (!rest.empty()) {
    const std::size_t end = std::min(rest.find(':'), rest.size());
    const fs::path file = fs::path(rest.substr(0, end)) / name;
    if (end > 0 && can_run(file)) {
      return file;
    }
    rest.erase(0, end + 1);
  }
  return std::nullopt;
}

std::optional<ExternalProgram> find_external_program(const CLI::App& program, std::vector<std::string> words) {
  const bool asks_for_help = !words.empty() && words.front() == "help";
  if (asks_for_help) {
    words.erase(words.begin());
  }
  const CLI::App* above = &program;
  std::string name = "gazetrace";
  std::size_t at = 0;
  const CLI::App* listed = nullptr;
  for (; at < words.size() && is_name(words[at]); ++at) {
    name += "-" + words[at];
    listed = command_within(*above, words[at]);
    if (listed == nullptr || listed->get_prefix_command()) {
      break;
    }
    above = listed;
  }
  const bool has_commands = !above->get_subcommands([](const CLI::App*) { return true; }).empty();
  if (at >= words.size() || !is_name(words[at]) || !has_commands) {
    return std::nullopt;
  }
  // Beside a program that does not know where it lies would be the working folder, where anybody may have put a file.
  const fs::path beside = own_program().parent_path() / name;
  const std::optional<fs::path> path =
      beside.is_absolute() && can_run(beside) ? std::optional(beside) : find_on_path(name);
  if (path) {
    const std::vector<std::string> rest(words.begin() + static_cast<std::ptrdiff_t>(at) + 1, words.end());
    return ExternalProgram{*path, asks_for_help ? std::vector<std::string>{"--help"} : rest};
  }
  if (listed != nullptr) {
    throw Error(ErrorKind::input, name, "is neither beside the program nor on the PATH",
                "install gazetrace with its Python files");
  }
  return std::nullopt;
}

int run_external_program(const ExternalProgram& external) {
  const std::string path = external.path.string();
  std::vector<char*> pointers{const_cast<char*>(path.c_str())};  // NOLINT: as execv takes them
  for (const std::string& word : external.arguments) {
    pointers.push_back(const_cast<char*>(word.c_str()));  // NOLINT
  }
  pointers.push_back(nullptr);
  std::fflush(nullptr);
  // What this program ignores, that one would ignore as well, and a closed pipe would be an error to it.
  std::signal(SIGPIPE, SIG_DFL);
  std::signal(SIGXFSZ, SIG_DFL);
  execv(path.c_str(), pointers.data());
  const int reason = errno;
  std::signal(SIGPIPE, SIG_IGN);
  std::signal(SIGXFSZ, SIG_IGN);
  throw Error(ErrorKind::runtime, path, std::string("cannot be started: ") + std::strerror(reason));
}

}  // namespace gazetrace
