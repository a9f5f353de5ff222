// SPDX-License-Identifier: Apache-2.0
// Claims to files as locks of byte ranges that belong to an open file (F_OFD_SETLK of fcntl(2)): another process, on
// another machine too, and another run of this process meet them alike.
#include "gazetrace/output_lock.hpp"

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
#include <map>
#include <optional>
#include <sstream>
#include <system_error>
#include <utility>

#include "core/hash.hpp"

namespace gazetrace {
namespace {

namespace fs = std::filesystem;

// Positions lie far behind the text of the file, since some servers let nobody read what another has locked.
constexpr std::int64_t kFirstPosition = std::int64_t{1} << 60U;
constexpr std::int64_t kTextPosition = std::int64_t{1} << 62U;  // held by who reads and writes the text
constexpr std::size_t kNumberDigits = 9;
constexpr std::size_t kLongestText = 4U << 20U;  // that is believed of a lock's file

struct Range {
  std::int64_t begin = 0, end = 0;
};

// Where a folder's lock is held for a file of this name. The last number of the name counts positions, so that the
// frames of a sequence lie side by side; what else is in the name decides where they begin.
std::int64_t position_of(const std::string& name) {
  constexpr const char* kDigits = "0123456789";
  const std::size_t end = name.find_last_of(kDigits) + 1;  // 0 without a number
  std::size_t begin = end;
  while (begin > 0 && end - begin < kNumberDigits && name.find_first_of(kDigits, begin - 1) == begin - 1) {
    --begin;
  }
  std::int64_t number = 0;
  std::from_chars(name.data() + begin, name.data() + end, number);
  std::uint64_t hash = 0;
  for (const char letter : name.substr(0, begin) + "#" + name.substr(end)) {
    hash = hash_combine(hash, static_cast<unsigned char>(letter));
  }
  return kFirstPosition + static_cast<std::int64_t>((hash & 0xFFFFFFFU) << 30U) + number;
}

struct flock region(short type, Range range) {
  struct flock lock {};
  lock.l_type = type;
  lock.l_whence = SEEK_SET;
  lock.l_start = range.begin;
  lock.l_len = range.end - range.begin;
  return lock;
}

// 0, or the system's reason.
int set_lock(int file, short type, Range range, bool waits = false) {
  struct flock lock = region(type, range);
  int result = 0;
  do {
    result = ::fcntl(file, waits ? F_OFD_SETLKW : F_OFD_SETLK, &lock);
  } while (result != 0 && errno == EINTR);
  return result == 0 ? 0 : errno;
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

// Who holds a range: a line of the text.
struct Owner {
  Range range;
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
  std::string text;
  std::array<char, 4096> piece{};
  for (ssize_t length = 0; text.size() < kLongestText; text.append(piece.data(), static_cast<std::size_t>(length))) {
    length = ::pread(file, piece.data(), piece.size(), static_cast<off_t>(text.size()));
    if (length <= 0) {
      break;
    }
  }
  std::vector<Owner> owners;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line);
    Owner owner;
    if (words >> owner.range.begin >> owner.range.end && std::getline(words >> std::ws, owner.words)) {
      owners.push_back(std::move(owner));
    }
  }
  return owners;
}

// The text of what others hold, and of `own`. Lines of runs that were killed go with that.
void write_owners(int file, const std::vector<Owner>& own) {
  std::vector<Owner> owners = read_owners(file);
  std::erase_if(owners, [&](const Owner& owner) { return !held_by_others(file, owner.range); });
  owners.insert(owners.end(), own.begin(), own.end());
  std::string text;
  for (const Owner& owner : owners) {
    text += fmt::format("{} {} {}\n", owner.range.begin, owner.range.end, owner.words);
  }
  // It serves messages alone: a full disk ends no run here.
  static_cast<void>(::pwrite(file, text.data(), text.size(), 0));
  static_cast<void>(::ftruncate(file, static_cast<off_t>(text.size())));
}

// Files by their positions, as ranges.
std::vector<Range> ranges_of(const std::map<std::int64_t, std::string>& files) {
  std::vector<Range> ranges;
  for (const auto& [position, file] : files) {
    if (!ranges.empty() && ranges.back().end == position) {
      ++ranges.back().end;
    } else {
      ranges.push_back({position, position + 1});
    }
  }
  return ranges;
}

std::string lock_path(const std::string& folder) {
  return (fs::path(folder) / ".gazetrace.lock").string();
}

int open_lock(const std::string& path) {
  constexpr int kFlags = O_RDWR | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK;  // a pipe by that name would keep us waiting
  int file = ::open(path.c_str(), kFlags);
  if (file < 0 && errno == ENOENT) {
    file = ::open(path.c_str(), kFlags | O_CREAT, 0666);
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

[[noreturn]] void refuse(int file, Range range, const std::map<std::int64_t, std::string>& files) {
  const Range other = held_by_others(file, range).value_or(range);
  std::string who = "a run that does not say which";
  for (const Owner& owner : read_owners(file)) {
    if (owner.range.begin < other.end && other.begin < owner.range.end) {
      who = owner.words;
    }
  }
  throw Error(ErrorKind::runtime, files.lower_bound(std::max(other.begin, range.begin))->second,
              "another run is writing this file, " + bounded(who, 600), "wait for it or end it");
}

// Locks these files of a folder; false where the folder cannot be locked.
bool lock_files(int file, const std::map<std::int64_t, std::string>& files, const std::string& self) {
  int problem = set_lock(file, F_WRLCK, {kTextPosition, kTextPosition + 1}, true);
  std::vector<Owner> own;
  for (const Range& range : ranges_of(files)) {
    if (problem == 0) {
      problem = set_lock(file, F_WRLCK, range);
    }
    if (problem == EAGAIN || problem == EACCES) {
      refuse(file, range, files);
    }
    own.push_back({range, self});
  }
  if (problem != 0 && !cannot_lock(problem)) {
    throw Error(ErrorKind::runtime, files.begin()->second,
                "its folder cannot be locked: " + std::system_category().message(problem), "try again");
  }
  if (problem == 0) {
    write_owners(file, own);
  }
  set_lock(file, F_UNLCK, {kTextPosition, kTextPosition + 1});
  return problem == 0;
}

}  // namespace

OutputLock::~OutputLock() {
  release();
}

OutputLock::OutputLock(OutputLock&& other) noexcept
    : files_(std::exchange(other.files_, {})), warnings_(std::move(other.warnings_)) {}

OutputLock& OutputLock::operator=(OutputLock&& other) noexcept {
  if (this != &other) {
    release();
    files_ = std::exchange(other.files_, {});
    warnings_ = std::move(other.warnings_);
  }
  return *this;
}

void OutputLock::release() {
  for (const int file : std::exchange(files_, {})) {
    // Told to the kernel, and not by closing the file alone: children of this process may have it open.
    set_lock(file, F_UNLCK, {kFirstPosition, kTextPosition});
    if (set_lock(file, F_WRLCK, {kTextPosition, kTextPosition + 1}) == 0) {
      write_owners(file, {});
      set_lock(file, F_UNLCK, {kTextPosition, kTextPosition + 1});
    }
    ::close(file);
  }
}

OutputLock lock_outputs(const PipelineSettings& settings, const std::vector<std::int32_t>& frames) {
  std::map<std::string, std::map<std::int64_t, std::string>> folders;
  const auto claim = [&](const std::string& folder, const std::string& file) {
    folders[folder].emplace(position_of(fs::path(file).lexically_relative(folder).string()), file);
  };
  const OutputSettings& output = settings.output;
  const std::vector<std::string> files = output_files(settings, frames);
  const bool has_pictures = settings.stage != SequenceStage::trace;
  for (std::size_t i = 0; i < files.size() && (i < 2 || !has_pictures); ++i) {
    claim(folder_of_run(output.run_name), files[i]);
  }
  for (const std::string& pattern : {output.exr.pattern, output.display.pattern, output.map_pattern}) {
    for (std::size_t i = 0; !pattern.empty() && has_pictures && i < frames.size(); ++i) {
      claim(folder_of_frames(pattern), frame_file_name(pattern, frames[i]));
    }
  }
  if (!settings.checkpoint.empty()) {
    const std::string folder = fs::path(settings.checkpoint).parent_path().string();
    claim(folder.empty() ? "." : folder, settings.checkpoint);
  }
  OutputLock lock;
  const std::string self = this_process();
  for (const auto& [folder, claimed] : folders) {
    lock.files_.push_back(open_lock(lock_path(folder)));
    if (!lock_files(lock.files_.back(), claimed, self)) {
      lock.warnings_.push_back(folder +
                               ": no files can be locked in this file system, so that two runs that write the "
                               "same ones here would not notice each other");
    }
  }
  return lock;
}

bool is_locked(const std::string& path) {
  const fs::path folder = fs::path(path).parent_path();
  const std::string lock = lock_path(folder.empty() ? "." : folder.string());
  const int file = ::open(lock.c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK);
  if (file < 0) {
    return false;
  }
  const std::int64_t position = position_of(fs::path(path).filename().string());
  const bool locked = held_by_others(file, {position, position + 1}).has_value();
  ::close(file);
  return locked;
}

}  // namespace gazetrace
