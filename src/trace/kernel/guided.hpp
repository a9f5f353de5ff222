// SPDX-License-Identifier: Apache-2.0
// Directions that follow the guiding field of the frame: a share of all directions is drawn from the table of
// the hit's cell, as large as the cell's own share times the probability of the diffuse lobe. The BSDF, both lobes in
// their proportion, keeps the rest, and all densities are those of the mixture.
// Taking the share from the diffuse lobe alone, and judging tables beside that lobe, was measured and not kept: more
// variance in San Miguel and Lost Empire (tests/benchmarks/book/light.md).
#pragma once

#include "trace/guiding/guiding_field.hpp"
#include "trace/kernel/path_kernel.hpp"

namespace gazetrace {

// Finds the cells of hits, and how much of the choice their tables have. Layered materials choose by themselves.
template <bool kLayers>
inline void PathKernel<kLayers>::find_cells(std::size_t count) {
  ChunkHits& chunk = work_.chunk;
  const GuidingField& field = *frame_.guiding_field;
  for (std::size_t i = 0; i < count; ++i) {
    chunk.cell[i] = field.cell_at(chunk.position.get(i), chunk.shading.get(i));
    chunk.table_share[i] = chunk.cell[i] < 0 ? 0.0F : field.share(chunk.cell[i]);
    if (has_layers()) {
      if (frame_.scene->layered.of(chunk.material[i]) != nullptr) {
        chunk.table_share[i] = 0;
      }
    }
  }
}

// Densities and weights of the mixture, after the BSDF has been evaluated towards both directions.
template <bool kLayers>
inline void PathKernel<kLayers>::mix_densities(std::size_t count, const LightSample* lights, bool bounces) {
  ChunkHits& chunk = work_.chunk;
  for (std::size_t i = 0; i < count; ++i) {
    const float share = chunk.table_share[i];
    if (!(share > 0)) {
      continue;
    }
    chunk.next_bsdf_pdf[i] = chunk.next_pdf[i];
    const DirectionTable& table = frame_.guiding_field->table(chunk.cell[i]);
    if (lights != nullptr && lights[i].valid && bounces) {
      chunk.light_pdf[i] = (1.0F - share) * chunk.light_pdf[i] + share * table.pdf(lights[i].direction);
    }
    if (chunk.next_good[i] != 0) {
      const float bsdf = chunk.next_pdf[i];
      const float mixed = (1.0F - share) * bsdf + share * table.pdf(chunk.next.get(i));
      chunk.next_pdf[i] = mixed;
      chunk.next_weight.set(i, chunk.next_weight.get(i) * (bsdf / mixed));
    }
  }
}

}  // namespace gazetrace
