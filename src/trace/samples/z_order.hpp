// SPDX-License-Identifier: Apache-2.0
// Error that hides: neighbouring pixels take neighbouring points of one sequence for the whole frame, in the order of a
// Z-curve over the picture (Ahmed and Wonka, "Screen-Space Blue-Noise Diffusion of Monte Carlo Sampling Error via
// Hierarchical Ordering of Pixels", ACM TOG 39(6), 2020). The points of every square of the curve then are stratified
// together, so that their errors cancel in its mean: what error there is has high spatial frequencies.
//
// The paper hashes the order of the four quarters of every square. Here each pair of dimensions does that when it
// shuffles the indices by Owen's scramble (sample_2d), which exchanges the halves of every aligned block of indices.
#pragma once

#include <cstdint>

#include "gazetrace/foveation.hpp"
#include "trace/samples/sampler.hpp"

namespace gazetrace {

// How many samples lie before those of a site on the Z-curve. It is a function of the map alone. Sites follow each
// other in the map as they do on the curve within a tile, and every tile has an aligned block of indices that is large
// enough for the samples of any tile; the tiles, too, are in Z-order. Counting samples rather than sites keeps indices
// free of gaps where sites have none, as at a fraction of a sample a pixel.
class ZOrder {
 public:
  explicit ZOrder(const SamplingMap& map);

  // Walks over the sites of the tile that come before.
  [[nodiscard]] std::uint64_t first_index(std::uint32_t site) const;

 private:
  const SamplingMap* map_;
  unsigned tile_bits_ = 0;
};

}  // namespace gazetrace
