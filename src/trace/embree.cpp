// SPDX-License-Identifier: Apache-2.0
#include "trace/embree.hpp"

#if GAZETRACE_EMBREE_MAJOR >= 4
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif
#if defined(__SSE__)
#include <xmmintrin.h>
#endif

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstring>
#include <limits>

#include "core/hash.hpp"
#include "core/parallel.hpp"
#include "gazetrace/error.hpp"

namespace gazetrace {
namespace {

// Embree 3 ends the process for coordinates beyond 1.844e18 (its FLT_LARGE); this is the bound with room to spare.
constexpr float kLargestCoordinate = 1e18F;

#if GAZETRACE_EMBREE_MAJOR >= 4
using LibraryContext = RTCRayQueryContext;
using ContextFlags = RTCRayQueryFlags;
constexpr ContextFlags kIncoherent = RTC_RAY_QUERY_FLAG_INCOHERENT;
constexpr ContextFlags kCoherent = RTC_RAY_QUERY_FLAG_COHERENT;
#else
using LibraryContext = RTCIntersectContext;
using ContextFlags = RTCIntersectContextFlags;
constexpr ContextFlags kIncoherent = RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;
constexpr ContextFlags kCoherent = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
#endif

// The library hands its context back to the filter, which finds ours around it.
struct Query {
  LibraryContext context;
  const AlphaSource* alpha = nullptr;
  const std::uint32_t* keys = nullptr;  // by ray id
#if GAZETRACE_EMBREE_MAJOR >= 4
  RTCIntersectArguments intersect_arguments;
  RTCOccludedArguments occluded_arguments;
#endif

  Query(const AlphaSource* source, const std::uint32_t* alpha_keys, ContextFlags flags)
      : alpha(source), keys(alpha_keys) {
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

void alpha_filter(const RTCFilterFunctionNArguments* arguments) {
  const auto* query = reinterpret_cast<const Query*>(arguments->context);
  const auto tag = static_cast<std::uint32_t>(reinterpret_cast<std::uintptr_t>(arguments->geometryUserPtr));
  const unsigned n = arguments->N;
  for (unsigned i = 0; i < n; ++i) {
    if (arguments->valid[i] != -1) {
      continue;
    }
    const std::uint32_t primitive = RTCHitN_primID(arguments->hit, n, i);
    const std::uint32_t key = query->keys[RTCRayN_id(arguments->ray, n, i)];
    const std::uint32_t geometry = RTCHitN_geomID(arguments->hit, n, i);
    const std::uint32_t instance = RTCHitN_instID(arguments->hit, n, i, 0);
    // A function of the ray and the triangle only: the library may ask twice about one triangle.
    const std::uint32_t hashed = hash32(key ^ hash32(primitive ^ hash32(geometry ^ hash32(instance))));
    if (query->alpha->transparent(tag, primitive, RTCHitN_u(arguments->hit, n, i), RTCHitN_v(arguments->hit, n, i),
                                  hashed)) {
      arguments->valid[i] = 0;
    }
  }
}

bool count_memory(void* counter, ssize_t bytes, bool /*post*/) {
  static_cast<std::atomic<std::int64_t>*>(counter)->fetch_add(bytes, std::memory_order_relaxed);
  return true;
}

// NaN fails every comparison, so each test is written as what must hold.
bool acceptable(const RayBatch& rays, std::size_t i) {
  const auto within = [](float x) { return std::fabs(x) <= kLargestCoordinate; };
  const bool direction = rays.dx[i] != 0 || rays.dy[i] != 0 || rays.dz[i] != 0;
  return (static_cast<int>(within(rays.ox[i])) & static_cast<int>(within(rays.oy[i])) &
          static_cast<int>(within(rays.oz[i])) & static_cast<int>(within(rays.dx[i])) &
          static_cast<int>(within(rays.dy[i])) & static_cast<int>(within(rays.dz[i])) &
          static_cast<int>(rays.tnear[i] >= 0) & static_cast<int>(!std::isnan(rays.tfar[i])) &
          static_cast<int>(direction)) != 0;
}

constexpr int kPacket = 16;

// Copies 16 rays into the library's layout; lanes beyond `count` and refused rays are masked. Returns the number
// refused.
template <class Rays>
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
    packet.time[lane] = 0;
    packet.mask[lane] = 0xffffffffU;
    packet.id[lane] = static_cast<unsigned>(i);
    packet.flags[lane] = 0;
  }
  for (int lane = 0; lane < kPacket; ++lane) {
    const bool inside = lane < count;
    const bool good = acceptable(rays, first + static_cast<std::size_t>(lane));
    valid[lane] = inside && good ? -1 : 0;
    refused += inside && !good ? 1 : 0;
  }
  return refused;
}

void fill_single(const RayBatch& rays, std::size_t i, RTCRay& ray) {
  ray.org_x = rays.ox[i];
  ray.org_y = rays.oy[i];
  ray.org_z = rays.oz[i];
  ray.tnear = rays.tnear[i];
  ray.dir_x = rays.dx[i];
  ray.dir_y = rays.dy[i];
  ray.dir_z = rays.dz[i];
  ray.time = 0;
  ray.tfar = rays.tfar[i];
  ray.mask = 0xffffffffU;
  ray.id = static_cast<unsigned>(i);
  ray.flags = 0;
}

}  // namespace

struct RayScene::Impl {
  std::atomic<std::int64_t> bytes{0};  // outlives the device, whose last releases are still counted
  RTCDevice device = nullptr;
  RTCScene top = nullptr;
  std::vector<RTCScene> meshes;
  const AlphaSource* alpha = nullptr;
  bool high_quality = true;
  std::uint32_t next_id = 0;

  void check(const char* what) const {
    const RTCError error = rtcGetDeviceError(device);
    if (error != RTC_ERROR_NONE) {
      throw Error(ErrorKind::runtime, "Embree",
                  std::string(what) + " failed with error code " + std::to_string(static_cast<int>(error)),
                  error == RTC_ERROR_OUT_OF_MEMORY ? "the scene needs more memory than there is" : "");
    }
  }

  [[nodiscard]] RTCScene new_scene() const {
    RTCScene scene = rtcNewScene(device);
    rtcSetSceneBuildQuality(scene, high_quality ? RTC_BUILD_QUALITY_HIGH : RTC_BUILD_QUALITY_MEDIUM);
    return scene;
  }

  void attach(RTCScene scene, const RayGeometry& source, std::uint32_t id) const {
    RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
    // Embree reads 16 bytes from the last vertex on; its own buffers are padded for that.
    void* vertices = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, sizeof(Vec3f),
                                             source.positions.size());
    void* indices = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                            sizeof(source.triangles[0]), source.triangles.size());
    if (vertices != nullptr && indices != nullptr) {
      std::memcpy(vertices, source.positions.data(), source.positions.size() * sizeof(Vec3f));
      std::memcpy(indices, source.triangles.data(), source.triangles.size() * sizeof(source.triangles[0]));
      if (source.alpha) {
        rtcSetGeometryUserData(geometry, reinterpret_cast<void*>(static_cast<std::uintptr_t>(source.tag)));
        rtcSetGeometryIntersectFilterFunction(geometry, alpha_filter);
        rtcSetGeometryOccludedFilterFunction(geometry, alpha_filter);
      }
      rtcCommitGeometry(geometry);
      rtcAttachGeometryByID(scene, geometry, id);
    }
    rtcReleaseGeometry(geometry);
    check("adding a mesh");
  }

  ~Impl() {
    for (RTCScene mesh : meshes) {
      rtcReleaseScene(mesh);
    }
    if (top != nullptr) {
      rtcReleaseScene(top);
    }
    if (device != nullptr) {
      rtcReleaseDevice(device);
    }
  }
};

RayScene::RayScene(int threads, bool high_quality, const AlphaSource* alpha) : impl_(std::make_unique<Impl>()) {
  // 0 leaves the task library's own limit alone: a number here would hold for the whole process.
  const std::string config = "threads=" + std::to_string(threads < resolve_threads(0) ? std::max(threads, 0) : 0);
  impl_->device = rtcNewDevice(config.c_str());
  if (impl_->device == nullptr) {
    throw Error(ErrorKind::runtime, "Embree", "no device could be made on this machine",
                "Embree needs a CPU with SSE2 at least");
  }
  rtcSetDeviceMemoryMonitorFunction(impl_->device, count_memory, &impl_->bytes);
  impl_->alpha = alpha;
  impl_->high_quality = high_quality;
  impl_->top = impl_->new_scene();
}

RayScene::~RayScene() = default;

std::uint32_t RayScene::add_mesh(const std::vector<RayGeometry>& geometries) {
  RTCScene scene = impl_->new_scene();
  impl_->meshes.push_back(scene);
  for (std::size_t i = 0; i < geometries.size(); ++i) {
    impl_->attach(scene, geometries[i], static_cast<std::uint32_t>(i));
  }
  rtcCommitScene(scene);
  impl_->check("building a mesh's BVH");
  return static_cast<std::uint32_t>(impl_->meshes.size() - 1);
}

std::uint32_t RayScene::add_geometry(const RayGeometry& geometry) {
  impl_->attach(impl_->top, geometry, impl_->next_id);
  return impl_->next_id++;
}

std::uint32_t RayScene::add_instance(std::uint32_t mesh, const RayTransform& to_world) {
  RTCGeometry instance = rtcNewGeometry(impl_->device, RTC_GEOMETRY_TYPE_INSTANCE);
  rtcSetGeometryInstancedScene(instance, impl_->meshes[mesh]);
  rtcSetGeometryTransform(instance, 0, RTC_FORMAT_FLOAT3X4_COLUMN_MAJOR, to_world.data());
  rtcCommitGeometry(instance);
  rtcAttachGeometryByID(impl_->top, instance, impl_->next_id);
  rtcReleaseGeometry(instance);
  impl_->check("adding an instance");
  return impl_->next_id++;
}

void RayScene::commit() {
  rtcCommitScene(impl_->top);
  impl_->check("building the scene's BVH");
}

int RayScene::intersect(const RayBatch& rays, int count, RayShape shape, HitBatch& hits) const {
  Query query(impl_->alpha, rays.alpha_key.data, shape == RayShape::coherent_packet ? kCoherent : kIncoherent);
  int refused = 0;
  if (shape == RayShape::single) {
    for (int i = 0; i < count; ++i) {
      const auto k = static_cast<std::size_t>(i);
      if (!acceptable(rays, k)) {
        ++refused;
        hits.geometry[k] = kRejected;
        continue;
      }
      RTCRayHit ray;
      fill_single(rays, k, ray.ray);
      ray.hit.geomID = RTC_INVALID_GEOMETRY_ID;
      ray.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
      query.intersect(impl_->top, ray);
      hits.t[k] = ray.ray.tfar;
      hits.u[k] = ray.hit.u;
      hits.v[k] = ray.hit.v;
      hits.primitive[k] = ray.hit.primID;
      hits.geometry[k] = ray.hit.geomID;
      hits.instance[k] = ray.hit.instID[0];
    }
    return refused;
  }
  for (int first = 0; first < count; first += kPacket) {
    const auto base = static_cast<std::size_t>(first);
    const int lanes = std::min(kPacket, count - first);
    alignas(64) int valid[kPacket];
    RTCRayHit16 packet;
    refused += fill_packet(rays, base, lanes, packet.ray, valid);
    for (int lane = 0; lane < kPacket; ++lane) {
      packet.hit.geomID[lane] = RTC_INVALID_GEOMETRY_ID;
      packet.hit.instID[0][lane] = RTC_INVALID_GEOMETRY_ID;
      packet.hit.primID[lane] = RTC_INVALID_GEOMETRY_ID;
      packet.hit.u[lane] = 0;
      packet.hit.v[lane] = 0;
    }
    query.intersect(impl_->top, valid, packet);
    for (int lane = 0; lane < kPacket; ++lane) {
      const std::size_t k = base + static_cast<std::size_t>(lane);
      hits.t[k] = packet.ray.tfar[lane];
      hits.u[k] = packet.hit.u[lane];
      hits.v[k] = packet.hit.v[lane];
      hits.primitive[k] = packet.hit.primID[lane];
      hits.geometry[k] = valid[lane] != 0 ? packet.hit.geomID[lane] : kRejected;
      hits.instance[k] = packet.hit.instID[0][lane];
    }
  }
  return refused;
}

int RayScene::occluded(const RayBatch& rays, int count, RayShape shape, std::uint8_t* occluded) const {
  Query query(impl_->alpha, rays.alpha_key.data, shape == RayShape::coherent_packet ? kCoherent : kIncoherent);
  int refused = 0;
  if (shape == RayShape::single) {
    for (int i = 0; i < count; ++i) {
      const auto k = static_cast<std::size_t>(i);
      if (!acceptable(rays, k)) {
        ++refused;
        occluded[k] = 2;
        continue;
      }
      RTCRay ray;
      fill_single(rays, k, ray);
      query.occluded(impl_->top, ray);
      occluded[k] = ray.tfar < 0 ? 1 : 0;  // the library sets -inf
    }
    return refused;
  }
  for (int first = 0; first < count; first += kPacket) {
    const auto base = static_cast<std::size_t>(first);
    const int lanes = std::min(kPacket, count - first);
    alignas(64) int valid[kPacket];
    RTCRay16 packet;
    refused += fill_packet(rays, base, lanes, packet, valid);
    query.occluded(impl_->top, valid, packet);
    for (int lane = 0; lane < lanes; ++lane) {
      occluded[base + static_cast<std::size_t>(lane)] =
          valid[lane] == 0 ? std::uint8_t{2} : static_cast<std::uint8_t>(packet.tfar[lane] < 0 ? 1 : 0);
    }
  }
  return refused;
}

std::uint64_t RayScene::bytes() const {
  return static_cast<std::uint64_t>(std::max<std::int64_t>(impl_->bytes.load(), 0));
}

std::string RayScene::library() const {
  const auto version = static_cast<int>(rtcGetDeviceProperty(impl_->device, RTC_DEVICE_PROPERTY_VERSION));
  const bool wide16 = rtcGetDeviceProperty(impl_->device, RTC_DEVICE_PROPERTY_NATIVE_RAY16_SUPPORTED) != 0;
  const bool wide8 = rtcGetDeviceProperty(impl_->device, RTC_DEVICE_PROPERTY_NATIVE_RAY8_SUPPORTED) != 0;
  const char* isa = wide16 ? "avx512" : (wide8 ? "avx" : "sse");
  return "Embree " + std::to_string(version / 10000) + "." + std::to_string(version / 100 % 100) + "." +
         std::to_string(version % 100) + " " + isa;
}

struct RayRecorder::Impl {
  struct Call {
    RayShape shape;
    bool occlusion;
    int count;
    std::size_t first;  // into singles or packets
    std::vector<std::uint32_t> keys;
  };
  std::vector<Call> calls;
  std::vector<RTCRay> singles;
  std::vector<RTCRay16> packets;
};

RayRecorder::RayRecorder() : impl_(std::make_unique<Impl>()) {}
RayRecorder::~RayRecorder() = default;

void RayRecorder::record(const RayBatch& rays, int count, RayShape shape, bool occlusion) {
  Impl::Call call{shape,
                  occlusion,
                  count,
                  shape == RayShape::single ? impl_->singles.size() : impl_->packets.size(),
                  {rays.alpha_key.data, rays.alpha_key.data + count}};
  if (shape == RayShape::single) {
    for (int i = 0; i < count; ++i) {
      fill_single(rays, static_cast<std::size_t>(i), impl_->singles.emplace_back());
    }
  } else {
    for (int first = 0; first < count; first += kPacket) {
      std::array<int, kPacket> valid{};
      fill_packet(rays, static_cast<std::size_t>(first), std::min(kPacket, count - first),
                  impl_->packets.emplace_back(), valid.data());
    }
  }
  impl_->calls.push_back(std::move(call));
}

std::uint64_t RayRecorder::replay(const RayScene& scene) const {
  std::uint64_t found = 0;
  RTCScene top = scene.impl_->top;
  for (const Impl::Call& call : impl_->calls) {
    Query query(scene.impl_->alpha, call.keys.data(),
                call.shape == RayShape::coherent_packet ? kCoherent : kIncoherent);
    if (call.shape == RayShape::single) {
      for (int i = 0; i < call.count; ++i) {
        const RTCRay& source = impl_->singles[call.first + static_cast<std::size_t>(i)];
        if (call.occlusion) {
          RTCRay ray = source;
          query.occluded(top, ray);
          found += ray.tfar < 0 ? 1 : 0;
        } else {
          RTCRayHit ray;
          ray.ray = source;
          ray.hit.geomID = RTC_INVALID_GEOMETRY_ID;
          ray.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
          query.intersect(top, ray);
          found += ray.hit.geomID != RTC_INVALID_GEOMETRY_ID ? 1 : 0;
        }
      }
      continue;
    }
    for (int first = 0; first < call.count; first += kPacket) {
      const RTCRay16& source = impl_->packets[call.first + static_cast<std::size_t>(first / kPacket)];
      alignas(64) int valid[kPacket];
      for (int lane = 0; lane < kPacket; ++lane) {
        valid[lane] = first + lane < call.count ? -1 : 0;
      }
      if (call.occlusion) {
        RTCRay16 packet = source;
        query.occluded(top, valid, packet);
        found += packet.tfar[0] < 0 ? 1 : 0;
      } else {
        RTCRayHit16 packet;
        packet.ray = source;
        for (int lane = 0; lane < kPacket; ++lane) {
          packet.hit.geomID[lane] = RTC_INVALID_GEOMETRY_ID;
          packet.hit.instID[0][lane] = RTC_INVALID_GEOMETRY_ID;
        }
        query.intersect(top, valid, packet);
        found += packet.hit.geomID[0] != RTC_INVALID_GEOMETRY_ID ? 1 : 0;
      }
    }
  }
  return found;
}

std::uint64_t RayRecorder::size() const {
  std::uint64_t count = 0;
  for (const Impl::Call& call : impl_->calls) {
    count += static_cast<std::uint64_t>(call.count);
  }
  return count;
}

bool can_be_instanced(const Affine& to_world) {
  // In float, as the library computes it: the inverse must exist and undo the matrix to three digits, and no axis may
  // come near the 1e-17 at which the library gives up.
  const auto shortest = std::min({length(to_world.x), length(to_world.y), length(to_world.z)});
  const auto longest = std::max({length(to_world.x), length(to_world.y), length(to_world.z)});
  if (!(shortest > 1e-12) || !(longest < 1e12) || !is_finite(to_world.t)) {
    return false;
  }
  const Vec3f x = to_float(to_world.x);
  const Vec3f y = to_float(to_world.y);
  const Vec3f z = to_float(to_world.z);
  const float det = dot(x, cross(y, z));
  if (!std::isfinite(det) || std::fabs(det) < std::numeric_limits<float>::min()) {
    return false;
  }
  const std::array<Vec3f, 3> rows{cross(y, z) / det, cross(z, x) / det, cross(x, y) / det};
  const std::array<Vec3f, 3> columns{x, y, z};
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) {
      const float error = dot(rows[i], columns[j]) - (i == j ? 1.0F : 0.0F);
      if (!(std::fabs(error) < 1e-3F)) {
        return false;
      }
    }
  }
  return true;
}

FlushDenormals::FlushDenormals() {
#if defined(__SSE__)
  saved_ = _mm_getcsr();
  _mm_setcsr(saved_ | 0x8040U);  // FTZ and DAZ
#endif
}

FlushDenormals::~FlushDenormals() {
#if defined(__SSE__)
  _mm_setcsr(saved_);
#endif
}

}  // namespace gazetrace
