// SPDX-License-Identifier: Apache-2.0
// Claims to files as locks of byte ranges that belong to an open file (F_OFD_SETLK of fcntl(2)): another process, on
// another machine too, and another run of this process meet them alike.
#include "pipeline/folder_lock.hpp"

#include <fcntl.h>
#include <fmt/chrono.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <sstream>
#include <system_error>
#include <utility>
#include <vector>

#include "core/hash.hpp"
#include "gazetrace/error.hpp"

namespace gazetrace {
namespace {

namespace fs = std::filesystem;

// Positions lie far behind the text of the file, since some servers let nobody read what another has locked.
constexpr std::int64_t kFirstPosition = std::int64_t{1} << 60U;
constexpr std::int64_t kTextPosition = std::int64_t{1} << 62U;  // held by who reads and writes the text
constexpr int kFlags = O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK;     // a pipe by that name would keep us waiting
constexpr std::size_t kNumberDigits = 9;
constexpr int kNumberBits = 30;  // of a position; the others are made of the rest of the name
constexpr std::int64_t kNumbersOfName = std::int64_t{1} << static_cast<unsigned>(kNumberBits);
constexpr std::size_t kLongestText = 4U << 20U;  // that is believed of a lock's file
// Of one folder and run: the kernel looks through all ranges of a file for each that is added.
constexpr std::size_t kMostRanges = 2000;
// For who else reads and writes the text, which takes milliseconds. It serves messages alone: a run that was stopped
// while it was at it holds up nobody.
constexpr int kTextTries = 100;
constexpr useconds_t kBetweenTries_us = 20000;

struct Range {
  std::int64_t begin = 0, end = 0;
};
constexpr Range kText{kTextPosition, kTextPosition + 1};

struct flock region(short type, Range range) {
  return {.l_type = type, .l_whence = SEEK_SET, .l_start = range.begin, .l_len = range.end - range.begin, .l_pid = 0};
}

// 0, or the system's reason.
int set_lock(int file, short type, Range range) {
  struct flock lock = region(type, range);
  return ::fcntl(file, F_OFD_SETLK, &lock) == 0 ? 0 : errno;
}

bool is_held(int problem) {
  return problem == EAGAIN || problem == EACCES;
}

// As set_lock(); waits for a while.
int lock_text(int file) {
  int problem = set_lock(file, F_WRLCK, kText);
  for (int i = 0; is_held(problem) && i < kTextTries; ++i, problem = set_lock(file, F_WRLCK, kText)) {
    ::usleep(kBetweenTries_us);
  }
  return problem;
}

// The first part of the range that others hold.
std::optional<Range> held_by_others(int file, Range range) {
  struct flock lock = region(F_WRLCK, range);
  if (::fcntl(file, F_OFD_GETLK, &lock) != 0 || lock.l_type == F_UNLCK) {
    return std::nullopt;
  }
  return Range{lock.l_start, lock.l_start + lock.l_len};
}

// By file systems and kernels without such locks, and by servers that give none.
bool cannot_lock(int problem) {
  return problem == ENOLCK || problem == EOPNOTSUPP || problem == ENOSYS || problem == EINVAL;
}

// Who holds ranges: a line of the text.
struct Owner {
  std::vector<Range> ranges;
  std::string words;
};

std::string this_process() {
  std::array<char, 256> host{};
  ::gethostname(host.data(), host.size() - 1);
  std::ifstream file("/proc/self/cmdline", std::ios::binary);
  std::string command{std::istreambuf_iterator<char>(file), {}};
  for (char& letter : command) {
    letter = static_cast<unsigned char>(letter) < ' ' || letter == 127 ? ' ' : letter;
  }
  return fmt::format("process {} on {} since {:%Y-%m-%d %H:%M:%S} UTC: {}", ::getpid(), host.data(),
                     fmt::gmtime(std::time(nullptr)), bounded(command, 200));
}

std::vector<Owner> read_owners(int file) {
  std::string text(kLongestText, '\0');
  text.resize(static_cast<std::size_t>(std::max<ssize_t>(::pread(file, text.data(), text.size(), 0), 0)));
  std::vector<Owner> owners;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line);
    Owner owner;
    for (Range range; words >> range.begin >> range.end;) {
      owner.ranges.push_back(range);
    }
    words.clear();
    if (std::getline(words >> std::ws, owner.words) && !owner.ranges.empty()) {
      owners.push_back(std::move(owner));
    }
  }
  return owners;
}

// The text of what others hold, and of `own`. Lines of runs that were killed go with that.
void write_owners(int file, const Owner& own) {
  std::vector<Owner> owners = read_owners(file);
  std::erase_if(owners, [&](const Owner& owner) { return !held_by_others(file, owner.ranges.front()); });
  owners.push_back(own);
  std::string text;
  for (const Owner& owner : owners) {
    for (const Range& range : owner.ranges) {
      text += fmt::format("{} {} ", range.begin, range.end);
    }
    text += owner.ranges.empty() ? "" : owner.words + "\n";
  }
  // It serves messages alone: a full disk ends no run here.
  static_cast<void>(::pwrite(file, text.data(), text.size(), 0));
  static_cast<void>(::ftruncate(file, static_cast<off_t>(text.size())));
}

// Files by their positions, as ranges. Of more than can be held the nearest are held as one, with what is between them:
// nothing but files whose names differ from theirs in the number that counts, so that other sequences stay free.
std::vector<Range> ranges_of(const FolderLock::Files& files) {
  std::vector<Range> ranges;
  const auto add = [&](std::int64_t begin, std::int64_t end, std::int64_t gap) {
    if (!ranges.empty() && begin - ranges.back().end <= gap) {
      ranges.back().end = end;
    } else {
      ranges.push_back({begin, end});
    }
  };
  for (const auto& [position, file] : files) {
    add(position, position + 1, 0);
  }
  for (std::int64_t gap = 1; ranges.size() > kMostRanges && gap < kNumbersOfName / 2; gap *= 2) {
    for (const Range& range : std::exchange(ranges, {})) {
      add(range.begin, range.end, gap);
    }
  }
  return ranges;
}

int open_lock(const std::string& path) {
  int file = ::open(path.c_str(), kFlags | O_RDWR);
  if (file < 0 && errno == ENOENT) {
    file = ::open(path.c_str(), kFlags | O_RDWR | O_CREAT, 0666);
  }
  struct stat state {};
  if (file < 0 || ::fstat(file, &state) != 0 || !S_ISREG(state.st_mode)) {
    const std::string reason = file < 0 ? std::system_category().message(errno) : "it is no regular file";
    if (file >= 0) {
      ::close(file);
    }
    throw Error(ErrorKind::input, path, "the lock of this folder cannot be opened: " + reason,
                "remove it where no run uses it, or choose another folder");
  }
  // Whoever may write into the folder may lock it.
  struct stat folder {};
  if (::stat(fs::path(path).parent_path().c_str(), &folder) == 0 && state.st_uid == ::geteuid()) {
    ::fchmod(file, (state.st_mode | folder.st_mode) & 0666U);
  }
  return file;
}

[[noreturn]] void refuse(int file, Range other, const FolderLock::Files& files) {
  std::string who = "a run that does not say which";
  for (const Owner& owner : read_owners(file)) {
    if (std::any_of(owner.ranges.begin(), owner.ranges.end(),
                    [&](const Range& range) { return range.begin < other.end && other.begin < range.end; })) {
      who = owner.words;
    }
  }
  const auto named = files.lower_bound(other.begin);
  throw Error(ErrorKind::runtime, (named == files.end() ? files.begin() : named)->second,
              "another run is writing this file, " + bounded(who, 600), "wait for it or end it");
}

}  // namespace

std::int64_t lock_position(const std::string& name) {
  constexpr const char* kDigits = "0123456789";
  // The longest number of the file's own name, the last of several, counts: frames are padded, cameras are not.
  const std::size_t file = name.find_last_of('/') + 1;
  std::size_t begin = 0;
  std::size_t end = 0;
  for (std::size_t from =
           name.find_first_of(kDigits, name.find_first_of(kDigits, file) == std::string::npos ? 0 : file);
       from != std::string::npos;) {
    const std::size_t to = std::min(name.find_first_not_of(kDigits, from), name.size());
    if (to - from >= end - begin) {
      begin = from;
      end = to;
    }
    from = name.find_first_of(kDigits, to);
  }
  begin = std::max(begin, end - std::min(end, kNumberDigits));
  const auto number_at = [&](std::size_t from, std::size_t to) {
    std::int64_t number = -1;
    std::from_chars(name.data() + from, name.data() + to, number);
    return number;
  };
  const std::int64_t number = std::max<std::int64_t>(number_at(begin, end), 0);
  std::uint64_t hash = 0;
  const auto add = [&](const std::string& text) {
    for (const char letter : text) {
      hash = hash_combine(hash, static_cast<unsigned char>(letter));
    }
  };
  for (std::size_t at = 0; at < begin;) {
    const bool is_digit = name.find_first_of(kDigits, at) == at;
    const std::size_t next = is_digit ? std::min(name.find_first_not_of(kDigits, at), begin)
                                      : std::min(name.find_first_of(kDigits, at), begin);
    add(is_digit && number_at(at, next) == number ? "#" : name.substr(at, next - at));
    at = next;
  }
  add("#" + name.substr(end));
  return kFirstPosition + static_cast<std::int64_t>((hash & 0xFFFFFFFU) << static_cast<unsigned>(kNumberBits)) + number;
}

std::string lock_path(const std::string& folder) {
  return (fs::path(folder) / ".gazetrace.lock").string();
}

FolderLock::FolderLock(const std::string& folder, Use use)
    : file_(use == Use::claim ? open_lock(lock_path(folder)) : ::open(lock_path(folder).c_str(), kFlags | O_RDONLY)),
      is_claim_(use == Use::claim),
      problem_(file_ < 0 ? errno : 0) {}

FolderLock::~FolderLock() {
  if (is_claim_) {
    // Told to the kernel, and not by closing the file alone: children of this process may have it open.
    set_lock(file_, F_UNLCK, {kFirstPosition, kTextPosition});
    if (lock_text(file_) == 0) {
      write_owners(file_, {});
      set_lock(file_, F_UNLCK, kText);
    }
  }
  if (file_ >= 0) {
    ::close(file_);
  }
}

bool FolderLock::claim(const Files& files) const {
  const auto check = [&](int problem) {
    if (problem != 0 && !is_held(problem)) {
      throw Error(ErrorKind::runtime, files.begin()->second,
                  "its folder cannot be locked: " + std::system_category().message(problem), "try again");
    }
  };
  const int text = lock_text(file_);
  if (cannot_lock(text)) {
    return false;
  }
  check(text);
  const Owner own{ranges_of(files), this_process()};
  for (const Range& range : own.ranges) {
    const int problem = set_lock(file_, F_WRLCK, range);
    check(problem);
    if (problem != 0) {
      refuse(file_, held_by_others(file_, range).value_or(range), files);
    }
  }
  if (text == 0) {
    write_owners(file_, own);
    set_lock(file_, F_UNLCK, kText);
  }
  return true;
}

void FolderLock::check(const Files& files) const {
  for (const Range& range : file_ < 0 ? std::vector<Range>() : ranges_of(files)) {
    if (const auto other = held_by_others(file_, range)) {
      refuse(file_, *other, files);
    }
  }
}

std::optional<bool> FolderLock::holds(const std::string& name) const {
  if (file_ < 0) {
    return problem_ == ENOENT ? std::optional(false) : std::nullopt;
  }
  const std::int64_t position = lock_position(name);
  struct flock held = region(F_WRLCK, {position, position + 1});
  return ::fcntl(file_, F_OFD_GETLK, &held) == 0 ? std::optional(held.l_type != F_UNLCK) : std::nullopt;
}

}  // namespace gazetrace
