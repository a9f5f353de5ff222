// SPDX-License-Identifier: Apache-2.0
// Keeps two runs from making the same files at the same time, on one machine or on several that share a folder.
#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <condition_variable>
#include <csignal>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <mutex>
#include <nlohmann/json.hpp>
#include <optional>
#include <sstream>
#include <system_error>
#include <thread>
#include <utility>

#include "core/list_folder.hpp"
#include "gazetrace/run_lock.hpp"
#include "pipeline/lock_state.hpp"

namespace gazetrace {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;
using std::chrono::seconds;

constexpr seconds kBeat{10};     // how often a living run renews its lock
constexpr seconds kSilence{60};  // after so long without, a run on another machine counts as dead

fs::path folder_of(const std::string& path) {
  const fs::path folder = fs::path(path).parent_path();
  return folder.empty() ? fs::path(".") : folder;
}

std::string first_line(const std::string& path) {
  std::ifstream file(path);
  std::string line;
  std::getline(file, line);
  return line;
}

// Of a process, by proc(5), whose fields are counted behind the name, which may hold anything.
struct ProcessFacts {
  std::string began;     // in the ticks of its machine's clock, which tells it from a later one of the same number
  bool is_dead = false;  // nobody has asked yet how it ended
};

// Empty where there is no such process.
std::optional<ProcessFacts> process_facts(std::int64_t process) {
  const std::string line = first_line(fmt::format("/proc/{}/stat", process));
  const std::size_t name_end = line.rfind(')');
  if (name_end == std::string::npos) {
    return std::nullopt;
  }
  std::istringstream fields(line.substr(name_end + 1));
  ProcessFacts facts;
  fields >> facts.began;  // field 3, the state
  facts.is_dead = facts.began == "Z" || facts.began == "X";
  for (int i = 4; i <= 22; ++i) {
    fields >> facts.began;
  }
  return facts;
}

std::string begin_of_process(std::int64_t process) {
  return process_facts(process).value_or(ProcessFacts()).began;
}

// Who holds a lock.
struct Holder {
  std::string host;
  std::string machine;  // what one list of processes belongs to: this boot of the kernel, and the container
  std::int64_t process = 0;
  std::string began;  // ProcessFacts::began
  std::int64_t since_s = 0;
  std::string frames, samples;

  friend bool operator==(const Holder&, const Holder&) = default;
};

std::string this_machine() {
  std::array<char, 128> space{};
  const ssize_t length = ::readlink("/proc/self/ns/pid", space.data(), space.size() - 1);
  const std::string boot = first_line("/proc/sys/kernel/random/boot_id");
  return boot.empty() || length < 0 ? std::string() : boot + " " + space.data();
}

std::string this_host() {
  std::array<char, 256> name{};
  return ::gethostname(name.data(), name.size() - 1) == 0 ? std::string(name.data()) : std::string("unknown");
}

Holder this_run(const RunRecord& record) {
  return {this_host(),        this_machine(), ::getpid(),    begin_of_process(::getpid()),
          std::time(nullptr), record.frames,  record.samples};
}

std::string text_of(const Holder& holder) {
  return Json{{"host", holder.host},      {"machine", holder.machine}, {"process", holder.process},
              {"began", holder.began},    {"since_s", holder.since_s}, {"frames", holder.frames},
              {"samples", holder.samples}}
             .dump(2, ' ', false, Json::error_handler_t::replace) +
         "\n";
}

// Empty where there is no such lock any more. One that cannot be read has no host.
std::optional<Holder> read_lock(const std::string& path) {
  std::error_code failed;
  const fs::file_status status = fs::status(path, failed);
  if (!fs::exists(status)) {
    return std::nullopt;
  }
  Holder holder;
  if (!fs::is_regular_file(status)) {  // to open a pipe would take for ever
    return holder;
  }
  std::ifstream file(path);
  if (!file) {
    return std::nullopt;
  }
  const Json json = Json::parse(file, nullptr, false);
  if (json.is_object()) {
    try {
      holder = {json.at("host"),    json.at("machine"), json.at("process"), json.at("began"),
                json.at("since_s"), json.at("frames"),  json.at("samples")};
      parse_frame_list(holder.frames);
    } catch (const std::exception&) {
      holder = {};
    }
  }
  return holder;
}

// Opened, since file systems that are shared look at the file anew only then.
std::optional<std::int64_t> time_of(const std::string& path) {
  const int file = ::open(path.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC);
  struct stat state {};
  const bool known = file >= 0 && ::fstat(file, &state) == 0;
  if (file >= 0) {
    ::close(file);
  }
  return known ? std::optional<std::int64_t>(state.st_mtime) : std::nullopt;
}

// The time by the clock of the file system, which all machines share: that of a file which is written now.
std::int64_t folder_time(const std::string& own_file) {
  ::utimensat(AT_FDCWD, own_file.c_str(), nullptr, 0);
  return time_of(own_file).value_or(std::time(nullptr));
}

bool process_lives(const Holder& holder) {
  if (const std::optional<ProcessFacts> facts = process_facts(holder.process); facts && !holder.began.empty()) {
    return !facts->is_dead && facts->began == holder.began;
  }
  // Nothing is known of when it began: /proc may hide the processes of others.
  return ::kill(static_cast<pid_t>(holder.process), 0) == 0 || errno == EPERM;
}

std::string age_text(std::int64_t age_s) {
  return age_s < 120    ? fmt::format("{} s", age_s)
         : age_s < 7200 ? fmt::format("{} min", age_s / 60)
                        : fmt::format("{} h", age_s / 3600);
}

std::string words(const Holder& holder, std::int64_t now_s) {
  if (holder.host.empty()) {
    return "a run that does not say which";
  }
  return fmt::format("process {} on {}, which makes frames {} since {} ago", holder.process, bounded(holder.host, 80),
                     bounded(holder.frames, 80), age_text(std::max<std::int64_t>(now_s - holder.since_s, 0)));
}

struct Looking {
  const std::string& own_file;
  const Holder& self;
  const std::function<void(const std::string& text)>& waiting;
};

// Whether the run that holds a lock lives. Of another machine nothing is known but whether the lock is renewed, so it
// may take kSilence to find out.
bool holder_lives(const std::string& path, const Holder& holder, const Looking& looking) {
  const bool same_machine = holder.machine.empty() ? holder.host == looking.self.host && holder.began.empty()
                                                   : holder.machine == looking.self.machine;
  if (same_machine && !holder.host.empty()) {
    return process_lives(holder);
  }
  const std::optional<std::int64_t> first = time_of(path);
  const auto begin = std::chrono::steady_clock::now();
  bool told = false;
  for (;;) {
    const std::optional<std::int64_t> renewed = time_of(path);
    if (!renewed) {
      std::error_code failed;
      return fs::exists(path, failed) || failed;  // what cannot be looked at may well live
    }
    if (!first || *renewed != *first) {
      return true;
    }
    // A lock whose time lies ahead, by a clock that is fast, is watched for as long.
    if (folder_time(looking.own_file) - *renewed > kSilence.count() ||
        std::chrono::steady_clock::now() - begin > kSilence) {
      return false;
    }
    if (!told && looking.waiting) {
      looking.waiting(fmt::format("{}: held by {}; waiting up to {} s to see whether it lives", path,
                                  words(holder, looking.self.since_s), kSilence.count()));
    }
    told = true;
    std::this_thread::sleep_for(seconds(1));
  }
}

[[noreturn]] void refuse(const std::string& path, const Holder& holder, const Holder& self) {
  throw Error(ErrorKind::runtime, path, "held by " + words(holder, self.since_s),
              "wait for it or end it; where it does not run any more, remove this file");
}

// Takes the lock away from a run that is dead; false where another run was faster. Several runs may find the same dead
// one, so that its file is removed only by who has locked it, and while it still has its name: whoever comes later has
// locked a file without a name, and leaves the one that another run has made since alone.
bool remove_dead(const std::string& path, const Holder& dead) {
  int file = ::open(path.c_str(), O_RDWR | O_CLOEXEC);  // NFS locks only what may be written
  if (file < 0) {
    file = ::open(path.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC);  // another user's
  }
  if (file < 0) {
    return false;
  }
  int locked = 0;
  do {
    locked = ::flock(file, LOCK_EX);
  } while (locked != 0 && errno == EINTR);
  // Where the file system has no such locks, a moment is left in which two runs could take over at once.
  struct stat opened {};
  struct stat named {};
  const bool right = ::fstat(file, &opened) == 0 && ::stat(path.c_str(), &named) == 0 &&
                     opened.st_dev == named.st_dev && opened.st_ino == named.st_ino &&
                     read_lock(path) == std::optional(dead) && ::unlink(path.c_str()) == 0;
  ::close(file);
  return right;
}

// Runs that ended before they had a lock have left the file that was to become one. Those of this machine's processes
// that are dead are removed.
void sweep_up(const std::string& lock_path, const Holder& self) {
  const std::string begin = fmt::format("{}.{}.", fs::path(lock_path).filename().string(), self.host);
  std::error_code ignored;
  for (const fs::path& found : list_folder(folder_of(lock_path), ignored)) {
    const std::string path = found.string();
    if (found.filename().string().starts_with(begin)) {
      const std::optional<Holder> holder = read_lock(path);
      if (holder && !holder->machine.empty() && holder->machine == self.machine && !process_lives(*holder)) {
        ::unlink(path.c_str());
      }
    }
  }
}

bool overlap(const std::string& a, const std::string& b) {
  const std::vector<std::int32_t> first = parse_frame_list(a);
  std::vector<std::int32_t> second = parse_frame_list(b);
  std::sort(second.begin(), second.end());
  return std::any_of(first.begin(), first.end(),
                     [&](std::int32_t frame) { return std::binary_search(second.begin(), second.end(), frame); });
}

// A file that is removed again.
struct OwnFile {
  explicit OwnFile(std::string name, const std::string& text) : path(std::move(name)) {
    write_text_atomically(path, text);
  }
  ~OwnFile() { ::unlink(path.c_str()); }
  OwnFile(const OwnFile&) = delete;
  OwnFile& operator=(const OwnFile&) = delete;
  std::string path;
};

// 0, or the system's reason. A link is whole from the beginning; file systems without links get a file that grows.
int make_lock(const OwnFile& own, const std::string& path, const std::string& text) {
  if (::link(own.path.c_str(), path.c_str()) == 0) {
    return 0;
  }
  if (errno == EEXIST) {
    return EEXIST;
  }
  const int file = ::open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
  if (file < 0) {
    return errno;
  }
  const bool written = ::write(file, text.data(), text.size()) == static_cast<ssize_t>(text.size());
  ::close(file);
  return written ? 0 : EIO;
}

}  // namespace

// Renews the lock while the run lives, and removes it at the end.
struct RunLock::Heart {
  Heart(std::string lock_path, Holder own)
      : path(std::move(lock_path)), self(std::move(own)), beat([this] { run(); }) {}
  ~Heart() {
    {
      const std::lock_guard guard(mutex);
      ended = true;
    }
    end.notify_all();
    beat.join();
    if (is_held()) {
      ::unlink(path.c_str());
    }
  }
  Heart(const Heart&) = delete;
  Heart& operator=(const Heart&) = delete;

  void run() {
    std::unique_lock guard(mutex);
    while (!end.wait_for(guard, kBeat, [this] { return ended; })) {
      if (is_held()) {
        ::utimensat(AT_FDCWD, path.c_str(), nullptr, 0);
      }
    }
  }

  // A run that was stopped for long may have been taken for dead; the lock is then another's.
  [[nodiscard]] bool is_held() const { return read_lock(path) == std::optional(self); }

  std::string path;
  Holder self;
  std::mutex mutex;
  std::condition_variable end;
  bool ended = false;
  std::thread beat;
};

RunLock::RunLock(const RunRecord& record, const std::string& record_path,
                 const std::function<void(const std::string& text)>& waiting, const std::string& family) {
  const fs::path folder = folder_of(record_path);
  const std::string path = (folder / (family + fs::path(record_path).filename().string() + ".lock")).string();
  const Holder self = this_run(record);
  sweep_up(path, self);
  const OwnFile own(fmt::format("{}.{}.{}", path, self.host, self.process), text_of(self));
  const Looking looking{own.path, self, waiting};
  const auto remove = [&](const std::string& lock, const Holder& holder) {
    if (remove_dead(lock, holder)) {
      taken_over_.push_back(fmt::format("{}: left behind by {}; that run is dead, and its frames are taken up", lock,
                                        words(holder, self.since_s)));
    }
  };
  constexpr int kAttempts = 20;
  for (int attempt = 0;; ++attempt) {
    const int problem = make_lock(own, path, text_of(self));
    if (problem == 0) {
      break;
    }
    if (problem != EEXIST || attempt == kAttempts) {
      throw Error(ErrorKind::runtime, path, std::string("the lock cannot be made: ") + std::strerror(problem),
                  "check the folder");
    }
    if (const std::optional<Holder> holder = read_lock(path)) {
      if (holder_lives(path, *holder, looking)) {
        refuse(path, *holder, self);
      }
      remove(path, *holder);
    }
  }
  heart_ = std::make_unique<Heart>(path, self);
  if (!self.samples.empty()) {
    return;
  }
  std::error_code ignored;
  for (const fs::path& found : list_folder(folder, ignored)) {
    const std::string other = found.string();
    if (!found.filename().string().starts_with(family + "run.") || !other.ends_with(".json.lock") ||
        found.filename() == fs::path(path).filename()) {
      continue;
    }
    const std::optional<Holder> holder = read_lock(other);
    if (!holder || holder->host.empty() || !holder->samples.empty() || !overlap(holder->frames, self.frames)) {
      continue;
    }
    if (holder_lives(other, *holder, looking)) {
      refuse(other, *holder, self);
    }
    remove(other, *holder);
  }
}

RunLock::~RunLock() = default;

bool is_locked(const std::string& record_path) {
  const std::string path = record_path + ".lock";
  const std::optional<Holder> holder = read_lock(path);
  if (!holder) {
    return false;
  }
  if (!holder->host.empty() && holder->machine == this_machine()) {
    return process_lives(*holder);
  }
  // By the clock of the file system, where a file can be written there.
  const std::string clock = fmt::format("{}.{}.clock", path, this_host());
  std::int64_t now_s = std::time(nullptr);
  if (const int file = ::open(clock.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC, 0666); file >= 0) {
    ::close(file);
    now_s = folder_time(clock);
    ::unlink(clock.c_str());
  }
  // One whose time lies far ahead is left to a run that begins, which watches it.
  const std::optional<std::int64_t> renewed = time_of(path);
  return renewed && std::abs(now_s - *renewed) <= kSilence.count();
}

}  // namespace gazetrace
