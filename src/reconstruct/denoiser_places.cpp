// SPDX-License-Identifier: Apache-2.0
#include "reconstruct/denoiser_places.hpp"

#include <dlfcn.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <sstream>

namespace gazetrace {
namespace {

namespace fs = std::filesystem;

void add_file(const fs::path& folder, std::vector<std::string>& out) {
  std::error_code failed;
  if (fs::exists(folder / kDenoiserFile, failed)) {
    out.push_back((folder / kDenoiserFile).string());
  }
}

// Where pyoidn's wheel has the library, in every Python 3 of a folder such as /usr/local or a virtual environment.
void add_pythons(const fs::path& prefix, std::vector<std::string>& out) {
  std::vector<fs::path> versions;
  std::error_code failed;
  for (const fs::directory_entry& entry : fs::directory_iterator(prefix / "lib", failed)) {
    if (entry.path().filename().string().starts_with("python3")) {
      versions.push_back(entry.path());
    }
  }
  std::sort(versions.begin(), versions.end());
  for (const fs::path& version : versions) {
    add_file(version / "site-packages/pyoidn/oidn/lib", out);
    add_file(version / "dist-packages/pyoidn/oidn/lib", out);
  }
}

// The first program of that name on the PATH; empty: none. Relative folders are left out: they are whoever's the
// working folder is.
fs::path program_on_path(const char* name) {
  const char* const path = std::getenv("PATH");
  std::istringstream folders(path != nullptr ? path : "");
  for (std::string folder; std::getline(folders, folder, ':');) {
    std::error_code failed;
    if (folder.starts_with('/') && fs::exists(fs::path(folder) / name, failed)) {
      return fs::path(folder) / name;
    }
  }
  return {};
}

// The program, or the module of the Python package, that holds this library.
fs::path own_file() {
  std::error_code failed;
  Dl_info own{};
  if (::dladdr(reinterpret_cast<void*>(&places_of_denoiser), &own) != 0 && own.dli_fname[0] == '/') {
    return fs::canonical(own.dli_fname, failed);
  }
  return fs::canonical("/proc/self/exe", failed);
}

}  // namespace

std::vector<std::string> places_of_denoiser() {
  std::vector<std::string> files{kDenoiserFile};
  if (const fs::path own = own_file(); !own.empty()) {
    const fs::path above = own.parent_path().parent_path();
    add_file(above / "lib", files);
    add_pythons(above / "denoiser", files);
    add_file(above / "pyoidn/oidn/lib", files);
  }
  if (const fs::path python = program_on_path("python3"); !python.empty()) {
    add_pythons(python.parent_path().parent_path(), files);
  }
  add_pythons("/usr/local", files);
  if (const char* const home = std::getenv("HOME"); home != nullptr && home[0] == '/') {
    add_pythons(fs::path(home) / ".local", files);
  }
  std::error_code failed;
  if (const fs::path blender = fs::canonical(program_on_path("blender"), failed); !failed) {
    add_file(blender.parent_path() / "lib", files);
  }
  return files;
}

}  // namespace gazetrace
