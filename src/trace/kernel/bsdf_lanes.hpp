// SPDX-License-Identifier: Apache-2.0
// The metallic-roughness BSDF over the lanes of a chunk.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "core/instruction_sets.hpp"
#include "material/bsdf.hpp"
#include "material/local_frame.hpp"
#include "trace/guiding/guiding_field.hpp"
#include "trace/kernel/chunk.hpp"
#include "trace/samples/sampler.hpp"

namespace gazetrace {

// Random numbers of two dimensions for every lane.
GAZETRACE_CLONES inline void fill_2d(const std::array<SampleKey, kChunk>& key,
                                     const std::array<std::uint32_t, kChunk>& index, std::size_t count,
                                     std::uint32_t dimension, std::array<Vec2f, kChunk>& out) {
  // Separate arrays, so that the compiler vectorises.
  alignas(64) std::array<float, kChunk> x;
  alignas(64) std::array<float, kChunk> y;
  for_lanes(
      count, [&](std::size_t i) __attribute__((always_inline)) {
        const Vec2f u = sample_2d(key[i], index[i], dimension);
        x[i] = u.x;
        y[i] = u.y;
      });
  for (std::size_t i = 0; i < count; ++i) {
    out[i] = {x[i], y[i]};
  }
}

inline AlbedoTerms terms_of(const std::array<ChunkArray<float>, 4>& terms, std::size_t i) {
  return {terms[0][i], terms[1][i], terms[2][i], terms[3][i]};
}

// Table reads do not vectorise; everything around them does.
inline void read_terms(const ChunkHits& chunk, std::size_t count, const ChunkArray<float>& cosine,
                       std::array<ChunkArray<float>, 4>& out) {
  for (std::size_t i = 0; i < count; ++i) {
    const AlbedoTerms terms =
        albedo_terms({chunk.table_row[i], chunk.table_fraction[i]}, std::clamp(cosine[i], 0.0F, 1.0F));
    out[0][i] = terms.e;
    out[1][i] = terms.b;
    out[2][i] = terms.lambert;
    out[3][i] = terms.burley;
  }
}

inline Surface surface_of(const ChunkHits& chunk, std::size_t i) {
  return {chunk.base_color.get(i), chunk.metallic[i], chunk.roughness[i]};
}

template <DiffuseModel kDiffuse>
Bsdf<kDiffuse> bsdf_of(const ChunkHits& chunk, std::size_t i) {
  return {surface_of(chunk, i), chunk.view.get(i), AlbedoRow{chunk.table_row[i], chunk.table_fraction[i]},
          terms_of(chunk.view_terms, i), chunk.e_average[i]};
}

// Takes the number that chooses a lobe as the choice between table and BSDF first, and replaces the BSDF's direction,
// in the local frame, where the table was chosen. Call it between finding the share of the diffuse lobe and sampling.
inline void choose_tables(ChunkHits& chunk, std::size_t count) {
  for (std::size_t i = 0; i < count; ++i) {
    const float share = chunk.table_share[i];
    const float u = chunk.random_lobe[i];
    chunk.by_table[i] = u < share ? 1 : 0;
    if (share > 0 && !(u < share)) {
      chunk.random_lobe[i] = std::min((u - share) / (1.0F - share), 0x1.fffffep-1F);
    }
  }
}

inline void take_directions_of_tables(ChunkHits& chunk, std::size_t count, const GuidingField& field) {
  for (std::size_t i = 0; i < count; ++i) {
    if (chunk.by_table[i] != 0) {
      const Vec3f world = field.table(chunk.cell[i]).sample(chunk.random.get(i)).direction;
      const Vec3f direction = LocalFrame(chunk.shading.get(i)).to_local(world);
      const Vec3f middle = chunk.view.get(i) + direction;
      chunk.next.set(i, direction);
      chunk.half.set(i, middle * (1.0F / std::sqrt(std::max(dot(middle, middle), 1e-20F))));
    }
  }
}

template <DiffuseModel kDiffuse>
struct BsdfLanes {
  GAZETRACE_CLONES [[gnu::flatten, gnu::noinline]] static void evaluate(ChunkHits& chunk, std::size_t count, bool lit,
                                                                        bool bounces, const GuidingField* field);
};

template <DiffuseModel kDiffuse>
void BsdfLanes<kDiffuse>::evaluate(ChunkHits& chunk, std::size_t count, bool lit, bool bounces,
                                   const GuidingField* field) {
  for_lanes(
      count, [&](std::size_t i) __attribute__((always_inline)) {
        const LocalFrame local(chunk.shading.get(i));
        chunk.view.set(i, local.to_local(-chunk.direction.get(i)));
        chunk.light.set(i, local.to_local(chunk.light.get(i)));
        const AlbedoRow row = Bsdf<kDiffuse>::table_row(surface_of(chunk, i));
        chunk.table_row[i] = row.row;
        chunk.table_fraction[i] = row.fraction;
      });
  for (std::size_t i = 0; i < count; ++i) {
    chunk.e_average[i] = albedo_average({chunk.table_row[i], chunk.table_fraction[i]});
  }
  read_terms(chunk, count, chunk.view.z, chunk.view_terms);
  if (lit) {
    read_terms(chunk, count, chunk.light.z, chunk.light_terms);
    for_lanes(
        count, [&](std::size_t i) __attribute__((always_inline)) {
          const BsdfEval eval =
              bsdf_of<kDiffuse>(chunk, i).evaluate(chunk.light.get(i), terms_of(chunk.light_terms, i));
          chunk.light_f_cos.set(i, eval.f_cos);
          chunk.light_pdf[i] = eval.pdf;
        });
  }
  if (field != nullptr) {
    for_lanes(
        count, [&](std::size_t i) __attribute__((always_inline)) {
          chunk.table_share[i] *= 1.0F - bsdf_of<kDiffuse>(chunk, i).specular_probability();
        });
    choose_tables(chunk, count);
  }
  if (bounces) {
    for_lanes(
        count, [&](std::size_t i) __attribute__((always_inline)) {
          const auto chosen = bsdf_of<kDiffuse>(chunk, i).sample_direction(chunk.random.get(i), chunk.random_lobe[i]);
          chunk.next.set(i, chosen.direction);
          chunk.half.set(i, chosen.half);
        });
    if (field != nullptr) {
      take_directions_of_tables(chunk, count, *field);
    }
    read_terms(chunk, count, chunk.next.z, chunk.next_terms);
    for_lanes(
        count, [&](std::size_t i) __attribute__((always_inline)) {
          const BsdfSample sample =
              bsdf_of<kDiffuse>(chunk, i).weigh({chunk.next.get(i), chunk.half.get(i)}, terms_of(chunk.next_terms, i));
          const Vec3f next = LocalFrame(chunk.shading.get(i)).to_world(sample.direction);
          const Vec3f unit = next * (1.0F / std::sqrt(std::max(dot(next, next), 1e-20F)));
          const bool above = dot(unit, chunk.geometric.get(i)) > 0;
          chunk.next.set(i, unit);
          chunk.next_weight.set(i, sample.weight);
          chunk.next_pdf[i] = sample.pdf;
          chunk.next_good[i] = (static_cast<int>(sample.valid) & static_cast<int>(above)) != 0 ? 1.0F : 0.0F;
        });
  }
}

// Calls function.operator()<model>().
template <class Function>
auto with_model(DiffuseModel model, const Function& function) {
  switch (model) {
    case DiffuseModel::burley:
      return function.template operator()<DiffuseModel::burley>();
    case DiffuseModel::lambert:
      return function.template operator()<DiffuseModel::lambert>();
    case DiffuseModel::matte:
      break;
  }
  return function.template operator()<DiffuseModel::matte>();
}

// Evaluates the BSDF of every lane towards its light sample where it is `lit`, and samples it where it `bounces`, with
// the tables of `field` unless there are none.
inline void evaluate_lanes(DiffuseModel diffuse, ChunkHits& chunk, std::size_t count, bool lit, bool bounces,
                           const GuidingField* field) {
  with_model(diffuse,
             [&]<DiffuseModel kDiffuse>() { BsdfLanes<kDiffuse>::evaluate(chunk, count, lit, bounces, field); });
}

// What one surface sends from `wi` to `wo`, both in the local frame: f times the cosine, of the diffuse lobe and of
// all.
struct BsdfParts {
  Vec3f diffuse, all;
};
inline BsdfParts bsdf_parts(DiffuseModel diffuse, const Surface& surface, const Vec3f& wo, const Vec3f& wi) {
  return with_model(diffuse, [&]<DiffuseModel kDiffuse>() {
    const Bsdf<kDiffuse> bsdf(surface, wo);
    return BsdfParts{bsdf.diffuse_f_cos(wi), bsdf.evaluate(wi).f_cos};
  });
}

}  // namespace gazetrace
