// SPDX-License-Identifier: Apache-2.0
#include "core/picture_module.hpp"

#include <dlfcn.h>

#include "gazetrace/error.hpp"

namespace gazetrace {
namespace {

constexpr const char* kFile = "libgazetrace_pictures.so";

[[noreturn]] void fail(const std::string& problem) {
  throw Error(ErrorKind::runtime, kFile, "the module that reads and writes PNG, JPEG and other pictures " + problem,
              "install gazetrace again, with its libraries");
}

// By the search path that whoever links the library has from CMake (src/CMakeLists.txt), then where it was to be
// installed.
void* open_library() {
  if (void* const found = ::dlopen(kFile, RTLD_LAZY | RTLD_LOCAL)) {
    return found;
  }
  const std::string problem = ::dlerror();
  if (void* const found = ::dlopen((std::string(GAZETRACE_LIBRARY_DIR "/") + kFile).c_str(), RTLD_LAZY | RTLD_LOCAL)) {
    return found;
  }
  fail("cannot be loaded: " + problem);
}

const PictureModule& load() {
  void* const library = open_library();
  // Of C, so that a module of any build answers.
  using Entry = const PictureModule* (*)();
  const auto entry = reinterpret_cast<Entry>(::dlsym(library, "gazetrace_picture_module"));
  if (entry == nullptr || std::string(entry()->build) != GAZETRACE_PICTURE_MODULE_BUILD) {
    fail("is that of another build of gazetrace");
  }
  return *entry();
}

}  // namespace

const PictureModule& picture_module() {
  static const PictureModule& module = load();  // where it throws, the next call tries again
  return module;
}

}  // namespace gazetrace
