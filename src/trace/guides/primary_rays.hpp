// SPDX-License-Identifier: Apache-2.0
// Batches of camera rays for passes that need first hits only.
#pragma once

#include <cstddef>
#include <cstdint>

#include "gazetrace/foveation.hpp"
#include "trace/rays/camera_rays.hpp"
#include "trace/rays/ray_batch.hpp"

namespace gazetrace {

// The position of ray `i` in a square tile whose side is a power of two. Rays follow a Z-curve, so that a packet of
// sixteen rays is a square of pixels.
inline PixelIndex place_on_curve(std::uint32_t i) {
  const auto even_bits = [](std::uint32_t v) {
    v &= 0x55555555U;
    v = (v | (v >> 1U)) & 0x33333333U;
    v = (v | (v >> 2U)) & 0x0f0f0f0fU;
    return static_cast<std::uint16_t>((v | (v >> 4U)) & 0xffU);
  };
  return {even_bits(i), even_bits(i >> 1U)};
}

// Stores the ray as the k-th of the batch, at the middle of the shutter's time.
inline void put_camera_ray(const CameraRays::Ray& ray, std::uint32_t alpha_key, std::size_t k, RayBatch& rays) {
  rays.ox[k] = ray.origin.x;
  rays.oy[k] = ray.origin.y;
  rays.oz[k] = ray.origin.z;
  rays.dx[k] = ray.direction.x;
  rays.dy[k] = ray.direction.y;
  rays.dz[k] = ray.direction.z;
  rays.tnear[k] = ray.tnear;
  rays.tfar[k] = ray.tfar;
  rays.time[k] = 0.5F;
  rays.alpha_key[k] = alpha_key;
}

// A thread's rays, and what they hit.
struct FirstHitBatch {
  RayBatch rays;
  HitBatch hits;
};

}  // namespace gazetrace
