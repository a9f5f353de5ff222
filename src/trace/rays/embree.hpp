// SPDX-License-Identifier: Apache-2.0
// The only interface to the ray library (Embree 3 or 4), without any of its types.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "gazetrace/math.hpp"
#include "gazetrace/trace.hpp"
#include "trace/rays/ray_batch.hpp"

namespace gazetrace {

// Decides whether a ray passes a point of a triangle. `tag` is that of the RayGeometry.
struct AlphaSource {
  virtual ~AlphaSource() = default;
  // True where the surface lets the ray pass. `key` is different for every (ray, instance, primitive).
  [[nodiscard]] virtual bool transparent(std::uint32_t tag, std::uint32_t primitive, float u, float v,
                                         std::uint32_t key) const = 0;
  // True where a camera ray of this direction, in the space of the triangle's corners, passes the triangle's back.
  [[nodiscard]] virtual bool culled(std::uint32_t tag, std::uint32_t primitive, const Vec3f& direction) const = 0;
};

struct RayGeometry {
  std::vector<Vec3f> positions;
  std::vector<std::array<std::uint32_t, 3>> triangles;
  bool ask = false;  // the AlphaSource at every candidate hit
  std::uint32_t tag = 0;
};

// Column-major 3x4: x axis, y axis, z axis, translation.
using RayTransform = std::array<float, 12>;

// Embree 3 ends the process for rays with coordinates beyond 1.844e18 (its FLT_LARGE), and leaves out triangles there.
// This limit has a margin.
inline constexpr float kLargestCoordinate = 1e18F;

enum class RayShape : std::uint8_t { single, packet, coherent_packet };

// The geometry id of a ray that was rejected because the ray library would end the process.
inline constexpr std::uint32_t kRejected = 0xfffffffeU;

class RayScene {
 public:
  RayScene(int threads, const AlphaSource* alpha);
  ~RayScene();
  RayScene(const RayScene&) = delete;
  RayScene& operator=(const RayScene&) = delete;

  // Ids in the top scene count from 0 in the order of the calls of add_geometry and then add_instance; all geometries
  // must be added first. Geometry ids inside a mesh are indices into `geometries`.
  std::uint32_t add_mesh(const std::vector<RayGeometry>& geometries);
  // A mesh whose vertices will change.
  std::uint32_t add_deforming_mesh(const std::vector<RayGeometry>& geometries, MeshUpdate update);
  std::uint32_t add_geometry(const RayGeometry& geometry);
  std::uint32_t add_instance(std::uint32_t mesh, const RayTransform& to_world);
  // Moves an instance, from the next commit on. Several transforms are those at equal steps of the rays' time from 0 to
  // 1, interpolated linearly; without any, the instance is hidden.
  void place_instance(std::uint32_t id, std::span<const RayTransform> to_world);
  // Sets new vertices of a deforming mesh, as many as before: keys[k][g] are those of geometry g at step k of the rays'
  // time from 0 to 1, interpolated linearly. Afterwards its instances must be placed again, or refreshed with
  // `refresh_instance`.
  void deform_mesh(std::uint32_t mesh, std::span<const std::vector<std::vector<Vec3f>>> keys);
  void refresh_instance(std::uint32_t id);
  // `timed`: the rays have a time.
  void commit(bool timed = false);

  // Intersects rays [0, count), which come from the camera or from elsewhere. A rejected ray gets geometry == kRejected
  // and is otherwise a miss. Returns the number of rejected rays.
  int intersect(const RayBatch& rays, int count, RayShape shape, HitBatch& hits, bool of_camera = true) const;
  // Sets occluded[i] to 0 or 1, or to 2 for a rejected ray. Returns the number of rejected rays.
  int occluded(const RayBatch& rays, int count, RayShape shape, std::uint8_t* occluded) const;

  [[nodiscard]] std::uint64_t bytes() const;  // as the device's memory monitor counts them
  [[nodiscard]] std::string library() const;

 private:
  friend class RayRecorder;
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

// For measurements: keeps rays in the library's own layout and traces them again with nothing but the library's calls,
// which takes the least time in which these rays can be traced.
class RayRecorder {
 public:
  RayRecorder();
  ~RayRecorder();
  RayRecorder(const RayRecorder&) = delete;
  RayRecorder& operator=(const RayRecorder&) = delete;

  void record(const RayBatch& rays, int count, RayShape shape, bool occlusion);
  // Traces every recorded ray once, in the order and packets of the recording; returns how many hit something.
  [[nodiscard]] std::uint64_t replay(const RayScene& scene) const;
  [[nodiscard]] std::uint64_t size() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

// False for an instance matrix that the ray library cannot handle: it has no finite inverse, or its axes differ by more
// than float can represent.
bool can_be_instanced(const Affine& to_world);

// Flushes denormals to zero for the current thread during its lifetime; the former state is restored afterwards.
class FlushDenormals {
 public:
  FlushDenormals();
  ~FlushDenormals();
  FlushDenormals(const FlushDenormals&) = delete;
  FlushDenormals& operator=(const FlushDenormals&) = delete;

 private:
  unsigned saved_ = 0;
};

}  // namespace gazetrace
