// SPDX-License-Identifier: Apache-2.0
#include "core/memory_limit.hpp"

#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <limits>
#include <string>

namespace gazetrace {
namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t kNone = std::numeric_limits<std::uint64_t>::max();

// The number that the file begins with; where it says "max", or is not there, none.
std::uint64_t limit_in(const fs::path& path) {
  std::ifstream file(path);
  std::uint64_t number = 0;
  return file >> number && number > 0 ? number : kNone;
}

std::uint64_t least_upwards(const fs::path& mount, fs::path group, const char* name) {
  std::uint64_t least = limit_in(mount / name);
  for (group = group.relative_path(); !group.empty(); group = group.parent_path()) {
    least = std::min(least, limit_in(mount / group / name));
  }
  return least;
}

bool names_memory(std::string_view controllers) {
  for (std::size_t begin = 0; begin <= controllers.size();) {
    const std::size_t end = std::min(controllers.find(',', begin), controllers.size());
    if (controllers.substr(begin, end - begin) == "memory") {
      return true;
    }
    begin = end + 1;
  }
  return false;
}

}  // namespace

std::uint64_t control_group_limit_bytes(std::string_view memberships, const fs::path& mount) {
  std::uint64_t least =
      std::min(least_upwards(mount, {}, "memory.max"), least_upwards(mount / "memory", {}, "memory.limit_in_bytes"));
  while (!memberships.empty()) {
    const std::size_t length = std::min(memberships.find('\n'), memberships.size());
    const std::string_view line = memberships.substr(0, length);
    memberships.remove_prefix(std::min(length + 1, memberships.size()));
    const std::size_t first = line.find(':');
    const std::size_t second = first == std::string_view::npos ? first : line.find(':', first + 1);
    if (second == std::string_view::npos) {
      continue;
    }
    const std::string_view controllers = line.substr(first + 1, second - first - 1);
    const fs::path group(line.substr(second + 1));
    if (controllers.empty()) {
      least = std::min(least, least_upwards(mount, group, "memory.max"));
    } else if (names_memory(controllers)) {
      least = std::min(least, least_upwards(mount / "memory", group, "memory.limit_in_bytes"));
    }
  }
  return least == kNone ? 0 : least;
}

std::uint64_t memory_of_process_bytes() {
  const long pages = ::sysconf(_SC_PHYS_PAGES);
  const long page = ::sysconf(_SC_PAGE_SIZE);
  std::uint64_t bytes = pages > 0 && page > 0 ? static_cast<std::uint64_t>(pages) * static_cast<std::uint64_t>(page)
                                              : std::uint64_t{8} << 30U;
  std::ifstream file("/proc/self/cgroup");
  const std::string memberships(std::istreambuf_iterator<char>(file), {});
  if (const std::uint64_t most = control_group_limit_bytes(memberships, "/sys/fs/cgroup"); most > 0) {
    bytes = std::min(bytes, most);
  }
  rlimit addresses{};
  if (::getrlimit(RLIMIT_AS, &addresses) == 0 && addresses.rlim_cur != RLIM_INFINITY) {
    bytes = std::min(bytes, static_cast<std::uint64_t>(addresses.rlim_cur));
  }
  return bytes;
}

}  // namespace gazetrace
