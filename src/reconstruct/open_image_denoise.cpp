// SPDX-License-Identifier: Apache-2.0
// The only file that knows Open Image Denoise. It is called through the C interface that its documentation states,
// which is the same in all versions 2, so that no header is needed to build this.
#include "reconstruct/open_image_denoise.hpp"

#include <dlfcn.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <filesystem>
#include <mutex>
#include <optional>
#include <string>

#include "core/luminance.hpp"
#include "core/parallel.hpp"
#include "gazetrace/error.hpp"
#include "gazetrace/reconstruct.hpp"
#include "reconstruct/denoiser_places.hpp"

namespace gazetrace {
namespace {

namespace fs = std::filesystem;

constexpr const char* kVariable = "GAZETRACE_OIDN_LIBRARY";

using Device = struct OIDNDeviceImpl*;
using Filter = struct OIDNFilterImpl*;
constexpr int kCpuDevice = 1;    // OIDN_DEVICE_TYPE_CPU, the only one that takes memory that we have allocated
constexpr int kThreeFloats = 3;  // OIDN_FORMAT_FLOAT3

// OIDN_QUALITY_FAST, OIDN_QUALITY_BALANCED and OIDN_QUALITY_HIGH; a version is 10000 major + 100 minor + patch.
constexpr int kFirstWithFast = 20300;
int quality_of(DenoiserNetwork network, int version) {
  if (network == DenoiserNetwork::high || network == DenoiserNetwork::usual) {
    return 6;
  }
  return network == DenoiserNetwork::fast && version >= kFirstWithFast ? 4 : 5;
}

struct Library {
  Device (*new_device)(int type) = nullptr;
  void (*set_device_int)(Device device, const char* name, int value) = nullptr;
  void (*set_device_bool)(Device device, const char* name, bool value) = nullptr;
  int (*get_device_int)(Device device, const char* name) = nullptr;
  void (*commit_device)(Device device) = nullptr;
  void (*release_device)(Device device) = nullptr;
  int (*get_error)(Device device, const char** message) = nullptr;
  Filter (*new_filter)(Device device, const char* type) = nullptr;
  void (*set_image)(Filter filter, const char* name, void* pixels, int format, std::size_t width, std::size_t height,
                    std::size_t offset, std::size_t pixel_stride, std::size_t row_stride) = nullptr;
  void (*set_filter_bool)(Filter filter, const char* name, bool value) = nullptr;
  void (*set_filter_int)(Filter filter, const char* name, int value) = nullptr;
  void (*commit_filter)(Filter filter) = nullptr;
  void (*execute_filter)(Filter filter) = nullptr;
  void (*release_filter)(Filter filter) = nullptr;
};

template <class Function>
bool find(void* handle, const char* name, Function*& function) {
  function = reinterpret_cast<Function*>(::dlsym(handle, name));
  return function != nullptr;
}

bool find_all(void* handle, Library& out) {
  return find(handle, "oidnNewDevice", out.new_device) && find(handle, "oidnSetDeviceInt", out.set_device_int) &&
         find(handle, "oidnSetDeviceBool", out.set_device_bool) &&
         find(handle, "oidnGetDeviceInt", out.get_device_int) && find(handle, "oidnCommitDevice", out.commit_device) &&
         find(handle, "oidnReleaseDevice", out.release_device) && find(handle, "oidnGetDeviceError", out.get_error) &&
         find(handle, "oidnNewFilter", out.new_filter) && find(handle, "oidnSetSharedFilterImage", out.set_image) &&
         find(handle, "oidnSetFilterBool", out.set_filter_bool) &&
         find(handle, "oidnSetFilterInt", out.set_filter_int) && find(handle, "oidnCommitFilter", out.commit_filter) &&
         find(handle, "oidnExecuteFilter", out.execute_filter) && find(handle, "oidnReleaseFilter", out.release_filter);
}

// What the library says went wrong since the last call; empty: nothing.
std::string problem_of(const Library& library, Device device) {
  const char* message = nullptr;
  const int code = library.get_error(device, &message);
  return code == 0 ? "" : message != nullptr ? message : "it reports error " + std::to_string(code);
}

// The library chooses its loops by the processor when it begins, and its interface does not tell which.
std::string instruction_set_of_processor() {
#if defined(__x86_64__)
  return __builtin_cpu_supports("avx512f") != 0 ? "avx512" : __builtin_cpu_supports("avx2") != 0 ? "avx2" : "sse4.1";
#else
  return "neon";
#endif
}

// A device that works, with `threads` threads; what is wrong, or nothing.
std::string make_device(const Library& library, int threads, Device& device) {
  device = library.new_device(kCpuDevice);
  if (device == nullptr) {
    const std::string problem = problem_of(library, nullptr);
    return problem.empty() ? "it has no device for this processor" : problem;
  }
  library.set_device_int(device, "numThreads", threads);
  // Pinned threads would compete with those of the tracer.
  library.set_device_bool(device, "setAffinity", false);
  library.commit_device(device);
  return problem_of(library, device);
}

struct Found {
  Library library;
  DenoiserLibrary info;
};

// A file, or a name for the loader. `problem` says why it is not usable.
std::optional<Found> open_library(const std::string& file, std::string& problem) {
  void* const handle = ::dlopen(file.c_str(), RTLD_LAZY | RTLD_LOCAL);
  if (handle == nullptr) {
    problem = ::dlerror();
    return std::nullopt;
  }
  Found found;
  if (!find_all(handle, found.library)) {
    problem = "it lacks a function of Open Image Denoise 2";
    ::dlclose(handle);
    return std::nullopt;
  }
  Device device = nullptr;
  problem = make_device(found.library, 1, device);
  if (!problem.empty()) {
    if (device != nullptr) {
      found.library.release_device(device);
    }
    return std::nullopt;
  }
  const auto number = [&](const char* name) { return std::to_string(found.library.get_device_int(device, name)); };
  found.info.version = number("versionMajor") + '.' + number("versionMinor") + '.' + number("versionPatch");
  found.library.release_device(device);
  found.info.instruction_set = instruction_set_of_processor();
  Dl_info place{};
  std::error_code failed;
  if (::dladdr(reinterpret_cast<void*>(found.library.new_device), &place) != 0) {
    const fs::path path = fs::canonical(place.dli_fname, failed);
    found.info.path = failed ? place.dli_fname : path.string();
  }
  return found;
}

Found look_for_library() {
  std::string problem;
  if (const char* const given = std::getenv(kVariable); given != nullptr) {
    if (given[0] == '\0') {
      return {};
    }
    std::error_code failed;
    const fs::path file = fs::is_directory(given, failed) ? fs::path(given) / kDenoiserFile : fs::path(given);
    std::optional<Found> found = open_library(fs::absolute(file).string(), problem);
    if (!found) {
      throw Error(ErrorKind::usage, std::string(kVariable) + "=" + given, "cannot be used: " + problem,
                  "name the folder or the file of " + std::string(kDenoiserFile) + ", or unset the variable");
    }
    return *found;
  }
  Found none;
  for (const std::string& file : places_of_denoiser()) {
    if (const std::optional<Found> found = open_library(file, problem)) {
      return *found;
    }
    if (file != kDenoiserFile && none.info.problem.empty()) {
      none.info.problem = file + " cannot be used: " + problem;
    }
  }
  return none;
}

const Found& library() {
  static const Found found = look_for_library();  // where it throws, the next call tries again
  return found;
}

// One device serves all frames of a process, one at a time, until it is asked for another number of threads.
class SharedDevice {
 public:
  ImageRgb denoise(const ImageRgb& radiance, const DenoiserInput& input, int threads, DenoiserNetwork network) {
    const std::lock_guard<std::mutex> alone(mutex_);
    const Library& call = library().library;
    if (call.new_device == nullptr) {
      fail("Open Image Denoise was not found");
    }
    if (device_ == nullptr || threads != threads_) {
      if (device_ != nullptr) {
        call.release_device(device_);
      }
      threads_ = 0;  // which nobody asks for, until it works
      check(make_device(call, threads, device_));
      threads_ = threads;
    }
    ImageRgb result(radiance.width_px, radiance.height_px);
    const Filter filter = call.new_filter(device_, "RT");
    const auto image = [&](const char* name, const ImageRgb& picture) {
      // The interface takes pointers without const, also to what it only reads.
      call.set_image(filter, name, const_cast<Vec3f*>(picture.pixels.data()), kThreeFloats,  // NOLINT
                     static_cast<std::size_t>(picture.width_px), static_cast<std::size_t>(picture.height_px), 0,
                     sizeof(Vec3f), 0);
    };
    image("color", radiance);
    image("albedo", input.albedo);
    image("normal", input.normal);
    image("output", result);
    call.set_filter_bool(filter, "hdr", true);
    call.set_filter_bool(filter, "cleanAux", input.clean && network != DenoiserNetwork::usual);
    call.set_filter_int(filter, "quality", quality_of(network, call.get_device_int(device_, "version")));
    call.commit_filter(filter);
    call.execute_filter(filter);
    const std::string problem = problem_of(call, device_);
    call.release_filter(filter);
    check(problem);
    return result;
  }

 private:
  [[noreturn]] static void fail(const std::string& problem) {
    throw Error(ErrorKind::runtime, "filter oidn", problem, "render with another `filter`");
  }
  static void check(const std::string& problem) {
    if (!problem.empty()) {
      fail(problem);
    }
  }

  std::mutex mutex_;
  Device device_ = nullptr;  // never released at the end: the library may be gone by then
  int threads_ = 0;
};

}  // namespace

const DenoiserLibrary& denoiser_library() {
  return library().info;
}

std::string denoiser_description() {
  const DenoiserLibrary& found = denoiser_library();
  return found.path.empty() ? ""
                            : "Open Image Denoise " + found.version + ", network by the samples, built-in weights, " +
                                  found.instruction_set;
}

ImageRgb without_outliers(const ImageRgb& radiance) {
  double logarithms = 0;
  std::size_t lit = 0;
  const auto is_lit = [](float light) { return std::isfinite(light) && light > 0; };
  for (const Vec3f& pixel : radiance.pixels) {
    if (const float light = luminance(pixel); is_lit(light)) {
      logarithms += std::log(static_cast<double>(light));
      ++lit;
    }
  }
  const float mean = lit > 0 ? static_cast<float>(std::exp(logarithms / static_cast<double>(lit))) : 0;
  const auto brightest_beside = [&](int x, int y) {
    float most = 0;
    for (int j = std::max(y - 1, 0); j <= std::min(y + 1, radiance.height_px - 1); ++j) {
      for (int i = std::max(x - 1, 0); i <= std::min(x + 1, radiance.width_px - 1); ++i) {
        const float light = luminance(radiance(i, j));
        most = (i == x && j == y) || !is_lit(light) ? most : std::max(most, light);
      }
    }
    return most;
  };
  ImageRgb shown = radiance;
  for (int y = 0; y < shown.height_px; ++y) {
    for (int x = 0; x < shown.width_px; ++x) {
      Vec3f& pixel = shown(x, y);
      const float light = luminance(pixel);
      if (!std::isfinite(light)) {
        pixel = {};
      } else if (light > kMostAloneOverMean * mean) {
        const bool alone = light > kAloneOverBeside * brightest_beside(x, y);
        pixel = pixel * (std::min(light, (alone ? kMostAloneOverMean : kMostOverMean) * mean) / light);
      }
    }
  }
  return shown;
}

ImageRgb open_image_denoise(const DenoiserInput& input, int threads, DenoiserNetwork network) {
  static SharedDevice device;
  return device.denoise(without_outliers(input.radiance), input, resolve_threads(threads), network);
}

}  // namespace gazetrace
