// SPDX-License-Identifier: Apache-2.0
// How much memory a process may use.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string_view>

namespace gazetrace {

// The least limit, in bytes, of the control groups that a process is in, their parents included, of version 2
// (`memory.max`) and 1 (`memory/memory.limit_in_bytes`); 0: none. A queue puts each task into a group of its own, far
// below the root. `memberships`: the content of /proc/self/cgroup, with lines "0::/a/b" and "4:memory:/a/b", see
// cgroups(7). `mount`: where the groups are, /sys/fs/cgroup. Within a container the names can be those that the groups
// have outside, which are not there; then the root is the container's own group.
std::uint64_t control_group_limit_bytes(std::string_view memberships, const std::filesystem::path& mount);

// Physical memory, or less where a control group or the limit of addresses (RLIMIT_AS) says so.
std::uint64_t memory_of_process_bytes();

}  // namespace gazetrace
