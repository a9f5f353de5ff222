// SPDX-License-Identifier: Apache-2.0
// Builds the scene of the ray library: device, geometry and instances.
#include "trace/rays/embree.hpp"

#if defined(__SSE__)
#include <xmmintrin.h>
#endif

#include <algorithm>
#include <cstring>
#include <limits>

#include "core/hash.hpp"
#include "core/parallel.hpp"
#include "gazetrace/error.hpp"
#include "trace/rays/embree_types.hpp"

namespace gazetrace {
namespace {

void alpha_filter(const RTCFilterFunctionNArguments* arguments) {
  const auto* query = reinterpret_cast<const Query*>(arguments->context);
  const auto tag = static_cast<std::uint32_t>(reinterpret_cast<std::uintptr_t>(arguments->geometryUserPtr));
  const unsigned n = arguments->N;
  for (unsigned i = 0; i < n; ++i) {
    if (arguments->valid[i] != -1) {
      continue;
    }
    const std::uint32_t primitive = RTCHitN_primID(arguments->hit, n, i);
    // Of an instanced mesh, the ray is in the mesh's own space here, where no transform turns a winding round.
    if (query->of_camera &&
        query->alpha->culled(tag, primitive,
                             {RTCRayN_dir_x(arguments->ray, n, i), RTCRayN_dir_y(arguments->ray, n, i),
                              RTCRayN_dir_z(arguments->ray, n, i)})) {
      arguments->valid[i] = 0;
      continue;
    }
    const std::uint32_t key = query->keys[RTCRayN_id(arguments->ray, n, i)];
    const std::uint32_t geometry = RTCHitN_geomID(arguments->hit, n, i);
    const std::uint32_t instance = RTCHitN_instID(arguments->hit, n, i, 0);
    // Depends on the ray and the triangle only, since the library may ask twice about one triangle.
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

}  // namespace

void RayScene::Impl::check(const char* what) const {
  const RTCError error = rtcGetDeviceError(device);
  if (error != RTC_ERROR_NONE) {
    throw Error(ErrorKind::runtime, "Embree",
                std::string(what) + " failed with error code " + std::to_string(static_cast<int>(error)),
                error == RTC_ERROR_OUT_OF_MEMORY ? "the scene needs more memory than there is" : "");
  }
}

RTCScene RayScene::Impl::new_scene() const {
  RTCScene scene = rtcNewScene(device);
  // Without this flag, rays slip between triangles that share an edge.
  rtcSetSceneFlags(scene, RTC_SCENE_FLAG_ROBUST);
  rtcSetSceneBuildQuality(scene, RTC_BUILD_QUALITY_HIGH);
  return scene;
}

void RayScene::Impl::attach(RTCScene scene, const RayGeometry& source, std::uint32_t id,
                            RTCBuildQuality quality) const {
  RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
  // Embree reads 16 bytes from the last vertex on, and pads its own buffers for that.
  void* vertices = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, sizeof(Vec3f),
                                           source.positions.size());
  void* indices = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                          sizeof(source.triangles[0]), source.triangles.size());
  if (vertices != nullptr && indices != nullptr) {
    std::memcpy(vertices, source.positions.data(), source.positions.size() * sizeof(Vec3f));
    std::memcpy(indices, source.triangles.data(), source.triangles.size() * sizeof(source.triangles[0]));
    if (source.ask) {
      rtcSetGeometryUserData(geometry, reinterpret_cast<void*>(static_cast<std::uintptr_t>(source.tag)));
      rtcSetGeometryIntersectFilterFunction(geometry, alpha_filter);
      rtcSetGeometryOccludedFilterFunction(geometry, alpha_filter);
    }
    if (quality != RTC_BUILD_QUALITY_MEDIUM) {  // the library's default
      rtcSetGeometryBuildQuality(geometry, quality);
    }
    rtcCommitGeometry(geometry);
    rtcAttachGeometryByID(scene, geometry, id);
  }
  rtcReleaseGeometry(geometry);
  check("adding a mesh");
}

RayScene::Impl::~Impl() {
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

RayScene::RayScene(int threads, const AlphaSource* alpha) : impl_(std::make_unique<Impl>()) {
  // 0 keeps the task library's own limit; any other number would apply to the whole process.
  const std::string config = "threads=" + std::to_string(threads < resolve_threads(0) ? std::max(threads, 0) : 0);
  impl_->device = rtcNewDevice(config.c_str());
  if (impl_->device == nullptr) {
    throw Error(ErrorKind::runtime, "Embree", "no device could be made on this machine",
                "Embree needs a CPU with SSE2 at least");
  }
  rtcSetDeviceMemoryMonitorFunction(impl_->device, count_memory, &impl_->bytes);
  impl_->alpha = alpha;
  impl_->top = impl_->new_scene();
}

RayScene::~RayScene() = default;

std::uint32_t RayScene::add_mesh(const std::vector<RayGeometry>& geometries) {
  RTCScene scene = impl_->new_scene();
  impl_->meshes.push_back(scene);
  impl_->steps.push_back(1);
  for (std::size_t i = 0; i < geometries.size(); ++i) {
    impl_->attach(scene, geometries[i], static_cast<std::uint32_t>(i));
  }
  rtcCommitScene(scene);
  impl_->check("building a mesh's BVH");
  return static_cast<std::uint32_t>(impl_->meshes.size() - 1);
}

std::uint32_t RayScene::add_deforming_mesh(const std::vector<RayGeometry>& geometries, MeshUpdate update) {
  RTCScene scene = impl_->new_scene();
  impl_->meshes.push_back(scene);
  impl_->steps.push_back(1);
  const bool refit = update == MeshUpdate::refit;
  rtcSetSceneFlags(scene, RTC_SCENE_FLAG_ROBUST | RTC_SCENE_FLAG_DYNAMIC);  // a BVH for each geometry, one above them
  rtcSetSceneBuildQuality(scene, update == MeshUpdate::rebuild_high  ? RTC_BUILD_QUALITY_HIGH
                                 : update == MeshUpdate::rebuild_low ? RTC_BUILD_QUALITY_LOW
                                                                     : RTC_BUILD_QUALITY_MEDIUM);
  if (!refit) {
    rtcSetSceneFlags(scene, RTC_SCENE_FLAG_ROBUST);
  }
  for (std::size_t i = 0; i < geometries.size(); ++i) {
    impl_->attach(scene, geometries[i], static_cast<std::uint32_t>(i),
                  refit ? RTC_BUILD_QUALITY_REFIT : RTC_BUILD_QUALITY_MEDIUM);
  }
  rtcCommitScene(scene);
  impl_->check("building a mesh's BVH");
  return static_cast<std::uint32_t>(impl_->meshes.size() - 1);
}

void RayScene::deform_mesh(std::uint32_t mesh, std::span<const std::vector<std::vector<Vec3f>>> keys) {
  RTCScene scene = impl_->meshes[mesh];
  const bool as_before = impl_->steps[mesh] == keys.size();
  impl_->steps[mesh] = keys.size();
  for (std::size_t g = 0; g < keys.front().size(); ++g) {
    RTCGeometry geometry = rtcGetGeometry(scene, static_cast<unsigned>(g));
    if (!as_before) {
      rtcSetGeometryTimeStepCount(geometry, static_cast<unsigned>(keys.size()));
    }
    for (std::size_t k = 0; k < keys.size(); ++k) {
      const std::vector<Vec3f>& positions = keys[k][g];
      const auto slot = static_cast<unsigned>(k);
      void* vertices = as_before ? rtcGetGeometryBufferData(geometry, RTC_BUFFER_TYPE_VERTEX, slot)
                                 : rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, slot, RTC_FORMAT_FLOAT3,
                                                           sizeof(Vec3f), positions.size());
      impl_->check("deforming a mesh");
      std::memcpy(vertices, positions.data(), positions.size() * sizeof(Vec3f));
      rtcUpdateGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, slot);
    }
    rtcCommitGeometry(geometry);
  }
  rtcCommitScene(scene);
  impl_->check("deforming a mesh");
}

void RayScene::refresh_instance(std::uint32_t id) {
  rtcCommitGeometry(rtcGetGeometry(impl_->top, id));
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

void RayScene::place_instance(std::uint32_t id, std::span<const RayTransform> to_world) {
  RTCGeometry instance = rtcGetGeometry(impl_->top, id);
  if (to_world.empty()) {
    rtcDisableGeometry(instance);
    return;
  }
  rtcSetGeometryTimeStepCount(instance, static_cast<unsigned>(to_world.size()));
  for (std::size_t i = 0; i < to_world.size(); ++i) {
    rtcSetGeometryTransform(instance, static_cast<unsigned>(i), RTC_FORMAT_FLOAT3X4_COLUMN_MAJOR, to_world[i].data());
  }
  rtcEnableGeometry(instance);
  rtcCommitGeometry(instance);
  impl_->check("moving an instance");
}

void RayScene::commit(bool timed) {
  impl_->timed = timed;
  rtcCommitScene(impl_->top);
  impl_->check("building the scene's BVH");
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

bool can_be_instanced(const Affine& to_world) {
  // Tested in float, as the library computes: the inverse must exist and invert the matrix to three digits, and no axis
  // may come near the 1e-17 at which the library fails.
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
