// SPDX-License-Identifier: Apache-2.0
// The random numbers of a path are a pure function of (seed, frame, place, sample, dimension): Owen-scrambled Sobol
// points by hashing (Burley, "Practical Hash-based Owen Scrambling", JCGT 9(4), 2020). Every pair of dimensions is the
// two-dimensional Sobol sequence with its own shuffle of the sample order and its own scramble per axis, so that pairs
// are independent of each other while each is stratified by itself.
#pragma once

#include <cstdint>

#include "core/hash.hpp"
#include "gazetrace/math.hpp"

namespace gazetrace {

// The numbers of dimensions are fixed, so that switching a feature off does not change the random numbers of others.
enum class PathDimension : std::uint32_t { pixel = 0, lens = 1, time = 2, first_bounce = 8 };
// Dimensions of each scattering event. `select` is used for two unrelated decisions: x chooses the light, y the lobe.
enum class BounceDimension : std::uint32_t {
  select = 0,
  light_uv = 1,
  bsdf_uv = 2,
  roulette = 3,
  channel = 4,
  count = 8
};

constexpr std::uint32_t dimension_of(PathDimension d) noexcept {
  return static_cast<std::uint32_t>(d);
}
constexpr std::uint32_t dimension_of(int bounce, BounceDimension d) noexcept {
  return static_cast<std::uint32_t>(PathDimension::first_bounce) +
         static_cast<std::uint32_t>(bounce) * static_cast<std::uint32_t>(BounceDimension::count) +
         static_cast<std::uint32_t>(d);
}

// Identifies the sequence of points of a place (pixel or site) in a frame. Make it once and keep it in the path's
// state.
struct SampleKey {
  std::uint64_t value = 0;
};

// `place` must differ between what shall be independent, such as the first pixels of sites.
constexpr SampleKey make_sample_key(std::uint64_t seed, std::int32_t frame, std::uint64_t place) noexcept {
  return {hash_combine(hash_combine(seed, static_cast<std::uint32_t>(frame)), place)};
}

// The point of a sequence that a sample takes.
struct SamplePoint {
  SampleKey key;
  std::uint32_t index = 0;
  std::uint8_t half = 0;
};

// Where the samples of a site are in the sequences of random numbers.
struct SiteSequence {
  SampleKey key;
  // As TraceSettings: samples belong to two halves in turn, the first of a site to half `odd`, so that sites of a
  // single sample are in both. Each half has a sequence of its own where they are independent.
  bool halves = false, independent_halves = true;
  std::uint8_t odd = 0;
};

[[gnu::always_inline]] inline constexpr SamplePoint sample_point(const SiteSequence& site,
                                                                 std::uint32_t sample) noexcept {
  std::uint32_t at = sample;
  std::uint8_t half = 0;
  SampleKey key = site.key;
  if (site.halves) {
    half = static_cast<std::uint8_t>((at + site.odd) & 1U);
    if (site.independent_halves) {
      at >>= 1U;
      key = half == 0 ? key : SampleKey{hash64(key.value + 0x68616c66ULL)};
    }
  }
  return {key, at, half};
}

namespace sampler_detail {

[[gnu::always_inline]] inline constexpr std::uint32_t reverse_bits(std::uint32_t x) noexcept {
  x = ((x >> 1U) & 0x55555555U) | ((x & 0x55555555U) << 1U);
  x = ((x >> 2U) & 0x33333333U) | ((x & 0x33333333U) << 2U);
  x = ((x >> 4U) & 0x0f0f0f0fU) | ((x & 0x0f0f0f0fU) << 4U);
  return __builtin_bswap32(x);
}

// Owen scrambling of a bit-reversed number: each bit is flipped by a hash of the bits below it (Laine and Karras 2011,
// with the constants of Vegdahl, "Building a Better LK Hash", 2021).
[[gnu::always_inline]] inline constexpr std::uint32_t scramble_reversed(std::uint32_t x, std::uint32_t seed) noexcept {
  x ^= x * 0x3d20adeaU;
  x += seed;
  x *= (seed >> 16U) | 1U;
  x ^= x * 0x05526c56U;
  x ^= x * 0x53a22864U;
  return x;
}

// The generator matrix of the second Sobol dimension is Pascal's triangle modulo 2, a Kronecker power of [1 1; 0 1], so
// five butterfly steps compute it. The result is bit-reversed, as scramble_reversed needs it.
[[gnu::always_inline]] inline constexpr std::uint32_t sobol_second_reversed(std::uint32_t index) noexcept {
  index ^= (index & 0xaaaaaaaaU) >> 1U;
  index ^= (index & 0xccccccccU) >> 2U;
  index ^= (index & 0xf0f0f0f0U) >> 4U;
  index ^= (index & 0xff00ff00U) >> 8U;
  index ^= (index & 0xffff0000U) >> 16U;
  return index;
}

// Uses 24 bits, so that the result is exact and strictly below 1.
[[gnu::always_inline]] inline constexpr float to_unit_float(std::uint32_t x) noexcept {
  return static_cast<float>(x >> 8U) * 0x1p-24F;
}

struct DimensionSeeds {
  std::uint32_t shuffle, x, y;
};
[[gnu::always_inline]] inline constexpr DimensionSeeds seeds_of(SampleKey key, std::uint32_t dimension) noexcept {
  const std::uint64_t h = hash64(key.value + dimension * 0xd1342543de82ef95ULL);
  const auto low = static_cast<std::uint32_t>(h);
  const auto high = static_cast<std::uint32_t>(h >> 32U);
  const std::uint32_t mixed = (low ^ (high >> 15U)) * 0x9e3779b1U + high;
  return {low, high, mixed ^ (mixed >> 16U)};
}

}  // namespace sampler_detail

// Two stratified numbers in [0, 1). Any block of 2^m consecutive sample indices that starts at a multiple of its length
// is a (0, m, 2)-net.
[[gnu::always_inline]] inline constexpr Vec2f sample_2d(SampleKey key, std::uint32_t sample_index,
                                                        std::uint32_t dimension) noexcept {
  using namespace sampler_detail;
  const DimensionSeeds seeds = seeds_of(key, dimension);
  const std::uint32_t index = reverse_bits(scramble_reversed(reverse_bits(sample_index), seeds.shuffle));
  return {to_unit_float(reverse_bits(scramble_reversed(index, seeds.x))),
          to_unit_float(reverse_bits(scramble_reversed(sobol_second_reversed(index), seeds.y)))};
}

// The first coordinate of sample_2d, at less cost.
constexpr float sample_1d(SampleKey key, std::uint32_t sample_index, std::uint32_t dimension) noexcept {
  using namespace sampler_detail;
  const DimensionSeeds seeds = seeds_of(key, dimension);
  const std::uint32_t index = reverse_bits(scramble_reversed(reverse_bits(sample_index), seeds.shuffle));
  return to_unit_float(reverse_bits(scramble_reversed(index, seeds.x)));
}

}  // namespace gazetrace
