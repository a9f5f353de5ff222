// SPDX-License-Identifier: Apache-2.0
// Surface materials as glTF 2.0 states them: plain data without any evaluation.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <string>

#include "gazetrace/math.hpp"

namespace gazetrace {

// Shape of the diffuse lobe. burley and lambert are balanced with the specular lobe so that a white surface loses no
// light. matte: every surface is ideally Lambertian, base colour / pi, without any specular lobe; this is for
// closed-form tests and for comparison with renderers that have nothing else.
enum class DiffuseModel : std::uint8_t { burley, lambert, matte };

enum class AlphaMode : std::uint8_t { opaque, mask, blend };

// A texture, and the coordinates at which it is read: uv' = (a u + b v + tx, c u + d v + ty) (KHR_texture_transform).
struct TextureRef {
  std::int32_t texture = -1;  // index into Scene::textures; -1: none
  std::uint8_t uv_set = 0;    // 0 or 1
  bool has_transform = false;
  std::array<float, 6> transform{1, 0, 0, 0, 1, 0};  // a, b, tx, c, d, ty

  [[nodiscard]] bool present() const { return texture >= 0; }
  friend bool operator==(const TextureRef&, const TextureRef&) = default;
};

// KHR_materials_clearcoat: a clear varnish with index of refraction 1.5 over everything else.
struct ClearcoatLayer {
  float factor = 0;     // 0..1: share of the surface that is coated
  float roughness = 0;  // 0..1, perceptual
  float normal_scale = 1.0F;
  TextureRef texture;            // R
  TextureRef roughness_texture;  // G
  TextureRef normal_texture;     // linear, tangent space; without it the coat is smooth even where the base is bumped
};

// KHR_materials_sheen: fibres over the base, under a clearcoat.
struct SheenLayer {
  Vec3f color{0, 0, 0};          // linear; black: none
  float roughness = 0;           // 0..1, perceptual
  TextureRef color_texture;      // sRGB
  TextureRef roughness_texture;  // A
};

// KHR_materials_specular: strength and colour of the dielectric part's specular reflection.
struct SpecularParameters {
  float factor = 1.0F;   // 0..1, scales the reflection at every angle
  Vec3f color{1, 1, 1};  // linear, >= 0: tints it at normal incidence; its product with that reflectance is at most 1
  TextureRef texture;    // A
  TextureRef color_texture;  // sRGB
  // KHR_materials_pbrSpecularGlossiness: the colour texture's A holds glossiness, 1 - roughness, and takes the place of
  // the metallic-roughness texture.
  bool color_texture_has_glossiness = false;
};

// KHR_materials_transmission: light passes through the surface instead of being reflected by a diffuse base.
struct TransmissionParameters {
  float factor = 0;    // 0..1
  TextureRef texture;  // R
};

// KHR_materials_volume: the surface bounds a solid body. Without this extension a transmitting surface is a thin sheet.
struct VolumeParameters {
  float thickness = 0;               // 0: thin. Only zero or not matters, since the way through the body is traced
  Vec3f attenuation_color{1, 1, 1};  // linear: the rest of white light after the distance below
  float attenuation_distance_m = std::numeric_limits<float>::infinity();
  [[nodiscard]] bool present() const { return thickness > 0; }
};

// KHR_materials_anisotropy: rougher along one direction in the surface, that of the tangent turned by `rotation_rad`.
struct AnisotropyParameters {
  float strength = 0;  // 0..1
  float rotation_rad = 0;
  TextureRef texture;  // RG: direction in tangent space, -1..1; B: strength
};

// KHR_materials_iridescence: a thin film on the base.
struct IridescenceParameters {
  float factor = 0;  // 0..1: share of the surface that has the film
  float ior = 1.3F;
  float thickness_min_nm = 100, thickness_max_nm = 400;  // at texture values 0 and 1; max without a texture
  TextureRef texture;                                    // R
  TextureRef thickness_texture;                          // G
};

// KHR_materials_diffuse_transmission (paper, leaves): a share of the diffuse light leaves on the other side.
struct DiffuseTransmissionParameters {
  float factor = 0;  // 0..1
  Vec3f color{1, 1, 1};
  TextureRef texture;        // A
  TextureRef color_texture;  // sRGB
};

// The metallic-roughness material of glTF 2.0, section 3.9, and its extensions. Factors multiply textures.
struct Material {
  std::string name;
  Vec4f base_color{1, 1, 1, 1};  // linear Rec.709, alpha last
  float metallic = 1.0F;         // 0..1, texture channel B
  float roughness = 1.0F;        // 0..1, perceptual: alpha = roughness^2; texture channel G
  // Radiance: emissiveFactor * KHR_materials_emissive_strength. Pictures are right to float's precision from 1e-30 to
  // 1e30, since light weights come from ratios of densities and sums are double. The limits are those of a float: below
  // 1.2e-38 values are flushed to zero, and above, the sum over a pixel's samples must not pass 3.4e38 (non-finite
  // samples are counted). The sum of squares behind the variance saturates from a radiance of 1.8e19 on and is zero
  // below about 1e-19.
  Vec3f emission{0, 0, 0};
  float normal_scale = 1.0F;
  AlphaMode alpha_mode = AlphaMode::opaque;  // loading makes mask and blend opaque where nothing is transparent
  float alpha_cutoff = 0.5F;
  bool double_sided = false;
  bool unlit = false;  // KHR_materials_unlit: base colour is the outgoing radiance

  TextureRef base_color_texture;          // sRGB
  TextureRef metallic_roughness_texture;  // linear
  TextureRef normal_texture;              // linear, tangent space
  TextureRef emissive_texture;            // sRGB

  float ior = 1.5F;  // KHR_materials_ior; 0: the dielectric part reflects everything at normal incidence
  ClearcoatLayer clearcoat;
  SheenLayer sheen;
  SpecularParameters specular;
  TransmissionParameters transmission;
  VolumeParameters volume;
  AnisotropyParameters anisotropy;
  IridescenceParameters iridescence;
  DiffuseTransmissionParameters diffuse_transmission;
  float dispersion = 0;  // KHR_materials_dispersion: 20 / Abbe number; has an effect in solid bodies only
};

// Visible features of a material beyond metallic-roughness: a clearcoat of factor 0 does not count. A scene
// has the features of all materials in use.
struct MaterialLayers {
  bool clearcoat = false, sheen = false, specular = false, ior = false, transmission = false, volume = false,
       anisotropy = false, iridescence = false, diffuse_transmission = false, dispersion = false;

  [[nodiscard]] bool any() const {
    return clearcoat || sheen || specular || ior || transmission || volume || anisotropy || iridescence ||
           diffuse_transmission || dispersion;
  }
  friend bool operator==(const MaterialLayers&, const MaterialLayers&) = default;
};
MaterialLayers layers_of(const Material& material);
MaterialLayers operator|(const MaterialLayers& a, const MaterialLayers& b);

// All texture slots of the extensions, whether they hold a texture or not.
std::array<const TextureRef*, 13> layer_textures(const Material& material);

}  // namespace gazetrace
