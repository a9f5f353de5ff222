// SPDX-License-Identifier: Apache-2.0
// What the files that use the ray library share: its types behind ours, and rays in its layout.
#pragma once

#if GAZETRACE_EMBREE_MAJOR >= 4
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

#include <atomic>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "trace/rays/embree.hpp"

namespace gazetrace {

#if GAZETRACE_EMBREE_MAJOR >= 4
using LibraryContext = RTCRayQueryContext;
using ContextFlags = RTCRayQueryFlags;
inline constexpr ContextFlags kIncoherent = RTC_RAY_QUERY_FLAG_INCOHERENT;
inline constexpr ContextFlags kCoherent = RTC_RAY_QUERY_FLAG_COHERENT;
#else
using LibraryContext = RTCIntersectContext;
using ContextFlags = RTCIntersectContextFlags;
inline constexpr ContextFlags kIncoherent = RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;
inline constexpr ContextFlags kCoherent = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
#endif

// The library passes its context to the filter, which finds this struct around it.
struct Query {
  LibraryContext context;
  const AlphaSource* alpha = nullptr;
  const std::uint32_t* keys = nullptr;  // indexed by ray id
  bool of_camera = false;
#if GAZETRACE_EMBREE_MAJOR >= 4
  RTCIntersectArguments intersect_arguments;
  RTCOccludedArguments occluded_arguments;
#endif

  Query(const AlphaSource* source, const std::uint32_t* alpha_keys, ContextFlags flags, bool from_camera = false)
      : alpha(source), keys(alpha_keys), of_camera(from_camera) {
#if GAZETRACE_EMBREE_MAJOR >= 4
    rtcInitRayQueryContext(&context);
    rtcInitIntersectArguments(&intersect_arguments);
    intersect_arguments.context = &context;
    intersect_arguments.flags = flags;
    rtcInitOccludedArguments(&occluded_arguments);
    occluded_arguments.context = &context;
    occluded_arguments.flags = flags;
#else
    rtcInitIntersectContext(&context);
    context.flags = flags;
#endif
  }

#if GAZETRACE_EMBREE_MAJOR >= 4
  void intersect(RTCScene scene, RTCRayHit& ray) {
    rtcIntersect1(scene, &ray, &intersect_arguments);
  }
  void intersect(RTCScene scene, const int* valid, RTCRayHit16& rays) {
    rtcIntersect16(valid, scene, &rays, &intersect_arguments);
  }
  void occluded(RTCScene scene, RTCRay& ray) {
    rtcOccluded1(scene, &ray, &occluded_arguments);
  }
  void occluded(RTCScene scene, const int* valid, RTCRay16& rays) {
    rtcOccluded16(valid, scene, &rays, &occluded_arguments);
  }
#else
  void intersect(RTCScene scene, RTCRayHit& ray) {
    rtcIntersect1(scene, &context, &ray);
  }
  void intersect(RTCScene scene, const int* valid, RTCRayHit16& rays) {
    rtcIntersect16(valid, scene, &context, &rays);
  }
  void occluded(RTCScene scene, RTCRay& ray) {
    rtcOccluded1(scene, &context, &ray);
  }
  void occluded(RTCScene scene, const int* valid, RTCRay16& rays) {
    rtcOccluded16(valid, scene, &context, &rays);
  }
#endif
};
static_assert(std::is_standard_layout_v<Query>, "the filter casts a pointer to the first member back");

// NaN fails every comparison, so each test states what must hold.
inline bool acceptable(const RayBatch& rays, std::size_t i) {
  const auto within = [](float x) { return std::fabs(x) <= kLargestCoordinate; };
  const bool direction = rays.dx[i] != 0 || rays.dy[i] != 0 || rays.dz[i] != 0;
  return (static_cast<int>(within(rays.ox[i])) & static_cast<int>(within(rays.oy[i])) &
          static_cast<int>(within(rays.oz[i])) & static_cast<int>(within(rays.dx[i])) &
          static_cast<int>(within(rays.dy[i])) & static_cast<int>(within(rays.dz[i])) &
          static_cast<int>(rays.tnear[i] >= 0) & static_cast<int>(!std::isnan(rays.tfar[i])) &
          static_cast<int>(direction)) != 0;
}

inline constexpr int kPacket = 16;

// Copies 16 rays into the library's layout; lanes beyond `count` and rejected rays are masked. Returns the number of
// rejected rays.
template <bool kTimed, class Rays>
int fill_packet(const RayBatch& rays, std::size_t first, int count, Rays& packet, int* valid) {
  int refused = 0;
  for (int lane = 0; lane < kPacket; ++lane) {
    const std::size_t i = first + static_cast<std::size_t>(lane);
    packet.org_x[lane] = rays.ox[i];
    packet.org_y[lane] = rays.oy[i];
    packet.org_z[lane] = rays.oz[i];
    packet.dir_x[lane] = rays.dx[i];
    packet.dir_y[lane] = rays.dy[i];
    packet.dir_z[lane] = rays.dz[i];
    packet.tnear[lane] = rays.tnear[i];
    packet.tfar[lane] = rays.tfar[i];
    packet.time[lane] = kTimed ? rays.time[i] : 0.0F;
    packet.mask[lane] = 0xffffffffU;
    packet.id[lane] = static_cast<unsigned>(i);
    packet.flags[lane] = 0;
  }
  for (int lane = 0; lane < kPacket; ++lane) {
    const bool inside = lane < count;
    const bool good = acceptable(rays, first + static_cast<std::size_t>(lane));
    valid[lane] = inside && good ? -1 : 0;
    refused += inside && !good ? 1 : 0;
    if (!good) {
      // On processors without AVX-512 the library looks at lanes that are masked, too.
      packet.org_x[lane] = packet.org_y[lane] = packet.org_z[lane] = 0;
      packet.dir_x[lane] = packet.dir_y[lane] = 0;
      packet.dir_z[lane] = 1;
      packet.tnear[lane] = 0;
      packet.tfar[lane] = std::isnan(packet.tfar[lane]) ? 0 : packet.tfar[lane];
    }
  }
  return refused;
}

template <bool kTimed>
void fill_single(const RayBatch& rays, std::size_t i, RTCRay& ray) {
  ray.org_x = rays.ox[i];
  ray.org_y = rays.oy[i];
  ray.org_z = rays.oz[i];
  ray.tnear = rays.tnear[i];
  ray.dir_x = rays.dx[i];
  ray.dir_y = rays.dy[i];
  ray.dir_z = rays.dz[i];
  ray.time = kTimed ? rays.time[i] : 0.0F;
  ray.tfar = rays.tfar[i];
  ray.mask = 0xffffffffU;
  ray.id = static_cast<unsigned>(i);
  ray.flags = 0;
}

struct RayScene::Impl {
  std::atomic<std::int64_t> bytes{0};  // must outlive the device, whose last releases are still counted
  RTCDevice device = nullptr;
  RTCScene top = nullptr;
  std::vector<RTCScene> meshes;
  std::vector<std::size_t> steps;  // number of time steps of each mesh's vertices
  const AlphaSource* alpha = nullptr;
  bool timed = false;
  std::uint32_t next_id = 0;

  template <bool kTimed>
  int intersect(const RayBatch& rays, int count, RayShape shape, HitBatch& hits, bool of_camera) const;
  template <bool kTimed>
  int occluded(const RayBatch& rays, int count, RayShape shape, std::uint8_t* occluded) const;

  void check(const char* what) const;  // throws the error that the library reports, if any
  [[nodiscard]] RTCScene new_scene() const;
  void attach(RTCScene scene, const RayGeometry& source, std::uint32_t id,
              RTCBuildQuality quality = RTC_BUILD_QUALITY_MEDIUM) const;
  ~Impl();
};

}  // namespace gazetrace
