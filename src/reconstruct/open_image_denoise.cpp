// SPDX-License-Identifier: Apache-2.0
// The only file that knows Open Image Denoise.
#include "reconstruct/open_image_denoise.hpp"

#ifdef GAZETRACE_WITH_OIDN

#include <OpenImageDenoise/oidn.h>

#include <cstddef>
#include <memory>

#include "core/parallel.hpp"
#include "gazetrace/error.hpp"

namespace gazetrace {
namespace {

struct ReleaseDevice {
  void operator()(OIDNDevice device) const { oidnReleaseDevice(device); }
};
struct ReleaseFilter {
  void operator()(OIDNFilter filter) const { oidnReleaseFilter(filter); }
};
using Device = std::unique_ptr<OIDNDeviceImpl, ReleaseDevice>;
using Filter = std::unique_ptr<OIDNFilterImpl, ReleaseFilter>;

void check(OIDNDevice device) {
  const char* message = nullptr;
  if (oidnGetDeviceError(device, &message) != OIDN_ERROR_NONE) {
    throw Error(ErrorKind::runtime, "filter oidn", message != nullptr ? message : "the library reports an error",
                "render with another `filter`");
  }
}

}  // namespace

ImageRgb open_image_denoise(const ImageRgb& radiance, const ImageRgb& albedo, const ImageRgb& normal, int threads) {
  // Only the CPU device takes memory that we have allocated.
  const Device device(oidnNewDevice(OIDN_DEVICE_TYPE_CPU));
  check(device.get());
  oidnSetDeviceInt(device.get(), "numThreads", resolve_threads(threads));
  // Pinned threads would compete with those of the tracer.
  oidnSetDeviceBool(device.get(), "setAffinity", false);
  oidnCommitDevice(device.get());
  check(device.get());

  ImageRgb result(radiance.width_px, radiance.height_px);
  const Filter filter(oidnNewFilter(device.get(), "RT"));
  const auto image = [&](const char* name, const ImageRgb& picture) {
    // The library's interface takes pointers without const, also to what it only reads.
    oidnSetSharedFilterImage(filter.get(), name, const_cast<Vec3f*>(picture.pixels.data()),  // NOLINT
                             OIDN_FORMAT_FLOAT3, static_cast<std::size_t>(picture.width_px),
                             static_cast<std::size_t>(picture.height_px), 0, sizeof(Vec3f), 0);
  };
  image("color", radiance);
  image("albedo", albedo);
  image("normal", normal);
  image("output", result);
  oidnSetFilterBool(filter.get(), "hdr", true);
  oidnSetFilterBool(filter.get(), "cleanAux", true);
  oidnCommitFilter(filter.get());
  oidnExecuteFilter(filter.get());
  check(device.get());
  return result;
}

}  // namespace gazetrace

#endif
