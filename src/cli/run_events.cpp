// SPDX-License-Identifier: Apache-2.0
#include "cli/run_events.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <charconv>
#include <cstring>
#include <nlohmann/json.hpp>
#include <optional>
#include <string_view>

#include "cli/command.hpp"
#include "gazetrace/error.hpp"
#include "gazetrace/output.hpp"

namespace gazetrace {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::string_view kJson = "json";

std::optional<int> descriptor_of(std::string_view progress) {
  if (progress == kJson) {
    return STDERR_FILENO;
  }
  if (!progress.starts_with("json:")) {
    return std::nullopt;
  }
  progress.remove_prefix(kJson.size() + 1);
  int number = -1;
  const auto [end, code] = std::from_chars(progress.data(), progress.data() + progress.size(), number);
  return code == std::errc() && end == progress.data() + progress.size() && number >= 0 ? std::optional(number)
                                                                                        : std::nullopt;
}

std::string line_of(const Json& event) {
  return event.dump(-1, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace

RunEvents::RunEvents(const std::string& progress) {
  const std::optional<int> descriptor = descriptor_of(progress);
  if (!descriptor) {
    return;
  }
  if (fcntl(*descriptor, F_GETFD) < 0) {
    throw Error(ErrorKind::usage, "`progress`", "the file descriptor " + std::to_string(*descriptor) + " is not open",
                "open it, as in 3>events.jsonl");
  }
  descriptor_ = *descriptor;
}

bool RunEvents::on_stderr() const {
  return descriptor_ == STDERR_FILENO;
}

void RunEvents::begin(const std::string& scene, const std::string& frames, std::size_t count,
                      const std::string& digest) {
  frames_ = count;
  start_ = std::chrono::steady_clock::now();
  write(line_of(
      {{"event", "begin"}, {"scene", scene}, {"frames", frames}, {"count", count}, {"settings_digest", digest}}));
}

void RunEvents::frame_done(std::int32_t frame, double ms, bool skipped) {
  ++done_;
  const double elapsed_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
  write(line_of({{"event", "frame"},
                 {"frame", frame},
                 {"ms", ms},
                 {"skipped", skipped},
                 {"done", done_},
                 {"count", frames_},
                 {"elapsed_s", elapsed_s}}));
}

void RunEvents::warnings(const std::vector<std::string>& texts) {
  for (const std::string& text : texts) {
    write(line_of({{"event", "warning"}, {"text", with_flags(text)}}));
  }
}

void RunEvents::end(int exit_code, const SequenceResult& result) {
  const double elapsed_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
  write(line_of({{"event", "end"},
                 {"exit_code", exit_code},
                 {"rendered", result.rows.size()},
                 {"skipped", result.skipped.size()},
                 {"left", result.left.empty() ? std::string() : format_frame_list(result.left)},
                 {"elapsed_s", elapsed_s}}));
  ended_ = true;
}

void RunEvents::end(int exit_code, const std::string& error) {
  if (!ended_) {
    write(line_of({{"event", "end"}, {"exit_code", exit_code}, {"error", with_flags(error)}}));
    ended_ = true;
  }
}

// A reader that has gone away does not end the run.
void RunEvents::write(const std::string& line) {
  std::size_t at = 0;
  while (active() && at < line.size()) {
    const ssize_t count = ::write(descriptor_, line.data() + at, line.size() - at);
    if (count < 0 && errno != EINTR) {
      descriptor_ = -1;
    }
    at += count > 0 ? static_cast<std::size_t>(count) : 0;
  }
}

}  // namespace gazetrace
