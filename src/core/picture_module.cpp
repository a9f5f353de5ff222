// SPDX-License-Identifier: Apache-2.0
#include "core/picture_module.hpp"

#include <dlfcn.h>
#include <fmt/format.h>

#include <filesystem>
#include <string>
#include <system_error>
#include <vector>

#include "gazetrace/error.hpp"

namespace gazetrace {
namespace {

constexpr const char* kFile = "libgazetrace_pictures.so";

// By the search path that whoever links the library has from CMake (src/CMakeLists.txt); LD_LIBRARY_PATH, which comes
// before that path, may hold another's. So also beside the program or the Python package, in their library folder, and
// where it was to be installed.
std::vector<std::string> places() {
  std::error_code ignored;
  Dl_info info{};
  const bool is_known = ::dladdr(reinterpret_cast<void*>(&picture_module), &info) != 0;
  std::filesystem::path own = is_known ? info.dli_fname : "";
  if (!own.is_absolute()) {  // a program as it was called
    own = std::filesystem::read_symlink("/proc/self/exe", ignored);
  }
  const std::filesystem::path folder = own.parent_path();
  return {kFile, folder / kFile, folder / GAZETRACE_LIBRARY_FOLDER / kFile,
          std::string(GAZETRACE_LIBRARY_DIR "/") + kFile};
}

const PictureModule& load() {
  // Of C, so that a module of any build answers.
  using Entry = const PictureModule* (*)();
  std::vector<std::string> problems;
  for (const std::string& place : places()) {
    void* const library = ::dlopen(place.c_str(), RTLD_LAZY | RTLD_LOCAL);
    const auto entry =
        library == nullptr ? nullptr : reinterpret_cast<Entry>(::dlsym(library, "gazetrace_picture_module"));
    if (entry != nullptr && std::string(entry()->build) == GAZETRACE_PICTURE_MODULE_BUILD) {
      return *entry();
    }
    problems.push_back(library == nullptr ? ::dlerror() : place + " is that of another build of gazetrace");
  }
  throw Error(ErrorKind::runtime, kFile,
              fmt::format("the module that reads and writes PNG, JPEG and other pictures cannot be loaded: {}",
                          fmt::join(problems, "; ")),
              "install gazetrace again, with its libraries");
}

}  // namespace

const PictureModule& picture_module() {
  static const PictureModule& module = load();  // where it throws, the next call tries again
  return module;
}

}  // namespace gazetrace
