// SPDX-License-Identifier: Apache-2.0
// For hits on materials with extensions: computes the material's values and the frame that its BSDF needs.
#pragma once

#include <cmath>

#include "material/layered_surface.hpp"
#include "material/lobes/dielectric.hpp"
#include "material/local_frame.hpp"
#include "trace/kernel/shading_frame.hpp"
#include "trace/kernel/surface_hit.hpp"
#include "trace/scene/layered_material.hpp"

namespace gazetrace {

struct LayeredHit {
  LayeredSurface surface;
  LocalFrame frame;
};

inline Vec4f read_layer(const RenderScene& scene, const ChunkHits& chunk, std::size_t i,
                        const ShadingTexture& texture) {
  if (texture.texture == nullptr) {
    return {1, 1, 1, 1};
  }
  const Vec2f at = coordinates_at(scene, chunk, i, texture);
  return read_texture(*texture.texture, at.x, at.y, level_at(scene, chunk, i, texture));
}

// The coat's normal on the viewer's side: the interpolated normal, bumped by the coat's own normal map if it has one.
inline Vec3f coat_normal(const RenderScene& scene, const ChunkHits& chunk, std::size_t i,
                         const LayeredMaterial& material) {
  Vec3f normal = chunk.smooth.get(i);
  if (material.clearcoat_normal.texture != nullptr) {
    const Vec4f texel = read_layer(scene, chunk, i, material.clearcoat_normal);
    const float scale = material.source->clearcoat.normal_scale;
    const LocalFrame frame = LocalFrame::along(normal, chunk.tangent.get(i));
    const Vec3f across = cross(normal, frame.s) * chunk.bitangent_sign[i];
    const Vec3f bumped = frame.s * ((2.0F * texel.x - 1.0F) * scale) + across * ((2.0F * texel.y - 1.0F) * scale) +
                         normal * (2.0F * texel.z - 1.0F);
    const float len2 = dot(bumped, bumped);
    normal = len2 > 1e-12F ? bumped * (1.0F / std::sqrt(len2)) : normal;
  }
  return bend_normal(normal * chunk.side[i], chunk.geometric.get(i), -chunk.direction.get(i));
}

// `channel` is the one whose index of refraction is used.
inline LayeredHit read_layered_hit(const RenderScene& scene, const ChunkHits& chunk, std::size_t i,
                                   const LayeredMaterial& material, std::size_t channel) {
  const Material& from = *material.source;
  const auto read = [&](const ShadingTexture& texture) { return read_layer(scene, chunk, i, texture); };
  const auto rgb = [](const Vec4f& c) { return Vec3f{c.x, c.y, c.z}; };
  const Vec3f shading = chunk.shading.get(i);
  LayeredHit hit{{}, LocalFrame(shading)};
  LayeredSurface& s = hit.surface;
  s.base = {chunk.base_color.get(i), chunk.metallic[i], chunk.roughness[i]};

  const Vec4f tint = read(material.specular_color);
  s.f90 = from.specular.factor * read(material.specular).w;
  s.f0 = tinted_f0(material.f0, from.specular.color * rgb(tint), s.f90);
  if (from.specular.color_texture_has_glossiness) {
    s.base.roughness = 1.0F - (1.0F - from.roughness) * tint.w;
  }
  if (material.layers.transmission) {
    s.transmission = from.transmission.factor * read(material.transmission).x;
  }
  if (material.layers.diffuse_transmission) {
    s.diffuse_transmission = from.diffuse_transmission.factor * read(material.diffuse_transmission).w;
    s.diffuse_transmission_color = from.diffuse_transmission.color * rgb(read(material.diffuse_transmission_color));
  }
  s.solid = material.solid;
  s.inside = material.solid && chunk.side[i] < 0;
  s.ior = material.ior[channel];
  if (s.solid && s.transmission > 0) {
    s.base.roughness = roughness_of_body(s.base.roughness, s.ior);
  }
  s.dielectric = material.albedo[channel];
  if (material.layers.iridescence) {
    const IridescenceParameters& film = from.iridescence;
    s.film = film.factor * read(material.film).x;
    s.film_ior = film.ior;
    s.film_thickness_nm =
        film.thickness_min_nm + (film.thickness_max_nm - film.thickness_min_nm) * read(material.film_thickness).y;
  }
  if (material.layers.sheen) {
    s.sheen_color = from.sheen.color * rgb(read(material.sheen_color));
    s.sheen_roughness = from.sheen.roughness * read(material.sheen_roughness).w;
  }
  if (material.layers.anisotropy) {
    const Vec4f texel = read(material.anisotropy);
    const bool textured = material.anisotropy.texture != nullptr;
    const float x = textured ? 2.0F * texel.x - 1.0F : 1.0F;
    const float y = textured ? 2.0F * texel.y - 1.0F : 0.0F;
    const float c = std::cos(from.anisotropy.rotation_rad);
    const float n = std::sin(from.anisotropy.rotation_rad);
    s.anisotropy = from.anisotropy.strength * texel.z;
    s.anisotropic = material.anisotropic;
    const LocalFrame tangent = LocalFrame::along(shading, chunk.tangent.get(i));
    const Vec3f across = cross(shading * chunk.side[i], tangent.s) * chunk.bitangent_sign[i];
    hit.frame = LocalFrame::along(shading, tangent.s * (c * x - n * y) + across * (n * x + c * y));
  }
  if (material.layers.clearcoat) {
    s.clearcoat = from.clearcoat.factor * read(material.clearcoat).x;
    s.clearcoat_roughness = from.clearcoat.roughness * read(material.clearcoat_roughness).y;
    if (material.coat_is_apart && s.clearcoat > 0) {
      const Vec3f local = hit.frame.to_local(coat_normal(scene, chunk, i, material));
      const bool seen = dot(hit.frame.to_world(local), chunk.direction.get(i)) < 0;
      s.clearcoat_normal = seen ? local : s.clearcoat_normal;
    }
  }
  return hit;
}

}  // namespace gazetrace
