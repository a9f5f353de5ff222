// SPDX-License-Identifier: Apache-2.0
// What a folder holds, also where reading it fails after it has begun.
#include "core/list_folder.hpp"

#include <dirent.h>
#include <dlfcn.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cerrno>
#include <string>

#include "gazetrace/error.hpp"
#include "gazetrace/output.hpp"
#include "support/temporary_folder.hpp"

namespace {

int entries_until_failure = -1;  // of the folder that is being listed; -1: none fails

}  // namespace

// Stands in for the system's: a network file system that goes away while a folder is read.
extern "C" dirent* readdir(DIR* folder) {
  if (entries_until_failure == 0) {
    errno = EIO;
    return nullptr;
  }
  entries_until_failure -= entries_until_failure > 0 ? 1 : 0;
  static void* const system_function = ::dlsym(RTLD_NEXT, "readdir");
  return reinterpret_cast<dirent* (*)(DIR*)>(system_function)(folder);
}

namespace gazetrace::list_folder_test {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

// A folder of five files whose reading fails after so many entries; "." and ".." count.
class ListFolder : public testing::Test {
 protected:
  ListFolder() {
    for (const char* name : {"f.0003.exr", "f.0001.exr", "other", "f.0002.exr", "timing.a.csv"}) {
      write_text_atomically(folder_ / name, "x");
    }
  }
  ~ListFolder() override { entries_until_failure = -1; }
  ListFolder(const ListFolder&) = delete;
  ListFolder& operator=(const ListFolder&) = delete;

  template <class Call>
  static void expect_error(const Call& call, const std::string& text) {
    try {
      call();
      FAIL() << "went well";
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::input);
      EXPECT_THAT(error.what(), HasSubstr(text));
    }
    entries_until_failure = -1;
  }

  TemporaryFolder folder_;
};

TEST_F(ListFolder, NamesComeInTheirOrder) {
  std::error_code failed = std::make_error_code(std::errc::io_error);
  const std::vector<fs::path> expected{folder_ / "f.0001.exr", folder_ / "f.0002.exr", folder_ / "f.0003.exr",
                                       folder_ / "other", folder_ / "timing.a.csv"};
  EXPECT_EQ(list_folder(folder_.path(), failed), expected);
  EXPECT_FALSE(failed);
  EXPECT_EQ(list_folder(folder_.path()), expected);
}

TEST_F(ListFolder, WhatIsNotThereIsAnErrorUnlessItMayBeMissing) {
  for (const std::string& path : {folder_ / "nowhere", folder_ / "other"}) {
    std::error_code failed;
    EXPECT_TRUE(list_folder(path, failed).empty());
    EXPECT_TRUE(failed);
    expect_error([&] { (void)list_folder(path); }, path + ": cannot be listed: ");
    EXPECT_TRUE(list_folder_if_there(path).empty());
  }
}

TEST_F(ListFolder, AFailureOnTheWayIsTold) {
  std::error_code failed;
  entries_until_failure = 4;
  EXPECT_LE(list_folder(folder_.path(), failed).size(), 4U);
  EXPECT_EQ(failed, std::errc::io_error);
  for (const int entries : {0, 4, 7}) {
    entries_until_failure = entries;
    expect_error([&] { (void)list_folder_if_there(folder_.path()); }, "cannot be listed: Input/output error");
  }
}

// Those that read folders tell of it by the library's own exception.
TEST_F(ListFolder, ReadersOfFoldersTellOfAFailure) {
  entries_until_failure = 4;
  expect_error([&] { (void)find_frames(folder_ / "f.####.exr"); }, "cannot be listed: Input/output error");
  entries_until_failure = 4;
  expect_error([&] { (void)read_run_parts(folder_.path()); }, "cannot be listed: Input/output error");
}

}  // namespace
}  // namespace gazetrace::list_folder_test
