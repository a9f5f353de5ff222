// SPDX-License-Identifier: Apache-2.0
// Rays and hits as structures of arrays, which the tracer and the ray library exchange.
#pragma once

#include <cstddef>
#include <cstdint>

namespace gazetrace {

// The number of paths that are traced together. All arrays of a batch (about 160 bytes per path with its shadow ray)
// stay in a 1 MiB L2 cache.
inline constexpr int kBatchSize = 1024;
inline constexpr std::uint32_t kNoId = 0xffffffffU;

// Sixteen entries longer than needed, since arrays whose distance is a power of two compete for the same cache sets.
template <class T>
struct alignas(64) BatchArray {
  T data[kBatchSize + 16];
  T& operator[](std::size_t i) { return data[i]; }
  const T& operator[](std::size_t i) const { return data[i]; }
};

struct RayBatch {
  BatchArray<float> ox, oy, oz, dx, dy, dz;
  BatchArray<float> tnear, tfar;
  BatchArray<std::uint32_t> alpha_key;  // hash of (seed, frame, pixel, sample, vertex): the stochastic alpha test
  BatchArray<float> time;               // 0..1 while the shutter is open; set only where something moves meanwhile
};

// `instance` is kNoId for triangles of the top scene; `geometry` is then the top scene's id, else the mesh's.
// A miss has geometry == kNoId.
struct HitBatch {
  BatchArray<float> t, u, v;
  BatchArray<std::uint32_t> primitive, geometry, instance;
};

}  // namespace gazetrace
