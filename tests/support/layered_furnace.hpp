// SPDX-License-Identifier: Apache-2.0
// What a surface returns of uniform light from all around.
#pragma once

#include <cstdint>

#include "material/layered_bsdf.hpp"
#include "trace/samples/sampler.hpp"

namespace gazetrace::test {

// The share of flux that a surface reflects or transmits, estimated with `count` samples. Radiance in a denser medium
// stands for eta^2 times the flux.
inline Vec3d layered_albedo(const LayeredSurface& s, const Vec3f& wo, std::uint32_t count,
                            SampleKey key = make_sample_key(13, 0, 0)) {
  const LayeredBsdf bsdf(s, wo);
  const double eta = s.solid ? (s.inside ? 1 / double{s.ior} : double{s.ior}) : 1;
  Vec3d sum;
  for (std::uint32_t i = 0; i < count; ++i) {
    const BsdfSample chosen = bsdf.sample(sample_2d(key, i, 8), sample_1d(key, i, 9));
    if (chosen.valid) {
      sum += to_double(chosen.weight) * (chosen.direction.z < 0 ? eta * eta : 1);
    }
  }
  return sum / static_cast<double>(count);
}

}  // namespace gazetrace::test
