// SPDX-License-Identifier: Apache-2.0
// The only door to the ray library (Embree 3 or 4). No type of it appears here.
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

// Opacity at a point of a triangle; `geometry` is the tag the geometry was added with.
struct AlphaSource {
  virtual ~AlphaSource() = default;
  // True when the surface lets the ray pass. `key` differs for every (ray, instance, primitive).
  [[nodiscard]] virtual bool transparent(std::uint32_t tag, std::uint32_t primitive, float u, float v,
                                         std::uint32_t key) const = 0;
};

struct RayGeometry {
  std::vector<Vec3f> positions;
  std::vector<std::array<std::uint32_t, 3>> triangles;
  bool alpha = false;  // ask the AlphaSource at every candidate hit
  std::uint32_t tag = 0;
};

// Column-major 3x4: x axis, y axis, z axis, translation.
using RayTransform = std::array<float, 12>;

// Embree 3 ends the process for rays with coordinates beyond 1.844e18 (its FLT_LARGE), and leaves out triangles there;
// this is the bound with room to spare.
inline constexpr float kLargestCoordinate = 1e18F;

enum class RayShape : std::uint8_t { single, packet, coherent_packet };

// One ray that was refused because the ray library would end the process over it.
inline constexpr std::uint32_t kRejected = 0xfffffffeU;

class RayScene {
 public:
  RayScene(int threads, bool high_quality, const AlphaSource* alpha);
  ~RayScene();
  RayScene(const RayScene&) = delete;
  RayScene& operator=(const RayScene&) = delete;

  // Geometry ids of the top scene count up from 0 in the order of add_geometry, then add_instance; geometries come
  // first. Geometry ids inside a mesh are the index into `geometries`.
  std::uint32_t add_mesh(const std::vector<RayGeometry>& geometries);
  // A mesh whose vertices will change.
  std::uint32_t add_deforming_mesh(const std::vector<RayGeometry>& geometries, MeshUpdate update);
  std::uint32_t add_geometry(const RayGeometry& geometry);
  std::uint32_t add_instance(std::uint32_t mesh, const RayTransform& to_world);
  // Moves an instance, for the next commit. Several transforms are at equal steps of the rays' time from 0 to 1, linear
  // between; none: the instance is not there.
  void place_instance(std::uint32_t id, std::span<const RayTransform> to_world);
  // New vertices of a deforming mesh, as many as before: keys[k][g] are those of geometry g at step k of the rays' time
  // from 0 to 1, linear between. Its instances must be placed again, or `refresh_instance` be called.
  void deform_mesh(std::uint32_t mesh, std::span<const std::vector<std::vector<Vec3f>>> keys);
  void refresh_instance(std::uint32_t id);
  // timed: rays carry a time.
  void commit(bool timed = false);

  // Rays [0, count). A refused ray gets geometry == kRejected (a miss otherwise); the number refused is returned.
  int intersect(const RayBatch& rays, int count, RayShape shape, HitBatch& hits) const;
  // occluded[i]: 0 or 1, or 2 for a refused ray.
  int occluded(const RayBatch& rays, int count, RayShape shape, std::uint8_t* occluded) const;

  [[nodiscard]] std::uint64_t bytes() const;  // as the device's memory monitor counts them
  [[nodiscard]] std::string library() const;

 private:
  friend class RayRecorder;
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

// Keeps rays in the library's own layout and shoots them again with nothing but the library's calls: the time that a
// tracer of these rays cannot go below. For measurements.
class RayRecorder {
 public:
  RayRecorder();
  ~RayRecorder();
  RayRecorder(const RayRecorder&) = delete;
  RayRecorder& operator=(const RayRecorder&) = delete;

  void record(const RayBatch& rays, int count, RayShape shape, bool occlusion);
  // Every recorded ray once, in the order and packets of the recording; returns how many hit something.
  [[nodiscard]] std::uint64_t replay(const RayScene& scene) const;
  [[nodiscard]] std::uint64_t size() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

// False for an instance matrix the ray library cannot take: no finite inverse, or axes beyond what float keeps apart.
bool can_be_instanced(const Affine& to_world);

// Flushes denormals to zero for the current thread while it lives; the former state comes back afterwards.
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
