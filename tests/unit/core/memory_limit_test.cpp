// SPDX-License-Identifier: Apache-2.0
#include "core/memory_limit.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "support/temporary_folder.hpp"

namespace gazetrace::memory_limit_test {
namespace {

namespace fs = std::filesystem;

void write(const fs::path& path, const std::string& text) {
  fs::create_directories(path.parent_path());
  std::ofstream(path) << text;
}

TEST(MemoryLimit, GroupFarBelowTheRoot) {
  const TemporaryFolder folder;
  const fs::path mount(folder.path());
  EXPECT_EQ(control_group_limit_bytes("0::/system.slice/job_1\n", mount), 0U);
  write(mount / "memory.max", "max\n");
  write(mount / "system.slice/memory.max", "max\n");
  write(mount / "system.slice/job_1/memory.max", "536870912\n");
  write(mount / "system.slice/job_1/step_0/memory.max", "max\n");
  EXPECT_EQ(control_group_limit_bytes("0::/system.slice/job_1/step_0\n", mount), 536870912U);
  EXPECT_EQ(control_group_limit_bytes("0::/system.slice/job_2\n", mount), 0U);  // another task's limit is not ours
  EXPECT_EQ(control_group_limit_bytes("0::/\n", mount), 0U);
  write(mount / "system.slice/memory.max", "268435456\n");  // a parent's limit holds for its children
  EXPECT_EQ(control_group_limit_bytes("0::/system.slice/job_1/step_0", mount), 268435456U);
}

TEST(MemoryLimit, GroupsOfVersion1) {
  const TemporaryFolder folder;
  const fs::path mount(folder.path());
  write(mount / "memory/memory.limit_in_bytes", "9223372036854771712\n");
  write(mount / "memory/slurm/uid_0/job_7/memory.limit_in_bytes", "1073741824\n");
  const std::string memberships = "9:name=systemd:/slurm\n4:cpu,memory:/slurm/uid_0/job_7/step_1\n0::/\n";
  EXPECT_EQ(control_group_limit_bytes(memberships, mount), 1073741824U);
  EXPECT_EQ(control_group_limit_bytes("4:cpu,memorable:/slurm/uid_0/job_7\n", mount), 9223372036854771712U);
}

TEST(MemoryLimit, NamesThatOnlyTheOutsideOfAContainerKnows) {
  const TemporaryFolder folder;
  const fs::path mount(folder.path());
  write(mount / "memory/memory.limit_in_bytes", "2147483648\n");
  EXPECT_EQ(control_group_limit_bytes("4:memory:/docker/0123\nno line of this kind\n:\n", mount), 2147483648U);
}

TEST(MemoryLimit, AtMostWhatTheMachineHas) {
  const auto machine =
      static_cast<std::uint64_t>(::sysconf(_SC_PHYS_PAGES)) * static_cast<std::uint64_t>(::sysconf(_SC_PAGE_SIZE));
  EXPECT_GT(memory_of_process_bytes(), 0U);
  EXPECT_LE(memory_of_process_bytes(), machine);
}

}  // namespace
}  // namespace gazetrace::memory_limit_test
