// SPDX-License-Identifier: Apache-2.0
#include "material/lobes/dielectric_albedo.hpp"

#include "gazetrace/math.hpp"
#include "material/lobes/dielectric.hpp"
#include "material/microfacet.hpp"

namespace gazetrace {
namespace {

constexpr std::size_t kNodes = DielectricAlbedo::kNodes;

// Midpoint rule over the sample square of visible normals, as in generate_albedo_tables.cpp.
double single_scattering(double mu, double roughness, double eta) {
  constexpr int kAzimuths = 12;
  constexpr int kRings = 48;
  const double alpha = alpha_of_roughness(roughness);
  const double z = std::max(mu, 1e-4);
  const Vec3d wo{std::sqrt(1 - z * z), 0, z};
  const double smith_o = smith_length(wo.z, alpha * alpha);
  double kept = 0;
  for (int i = 0; i < kAzimuths; ++i) {
    for (int j = 0; j < kRings; ++j) {
      const double t = (j + 0.5) / kRings;
      const double ring = t * t * t * (10 - 15 * t + 6 * t * t);
      const double weight = 30 * t * t * (1 - t) * (1 - t);
      const Vec3d h = sample_visible_normal(wo, alpha, Vec2d{0.5 * (i + 0.5) / kAzimuths, ring});
      const double cosine = dot(wo, h);
      const double fresnel = fresnel_dielectric(std::min(cosine, 1.0), eta);
      const auto passes = [&](double cos_i) {
        const double smith_i = smith_length(cos_i, alpha * alpha);
        return cos_i * (wo.z + smith_o) / (wo.z * smith_i + cos_i * smith_o);
      };
      const Vec3d mirrored = reflect(wo, h);
      if (mirrored.z > 0) {
        kept += weight * fresnel * passes(mirrored.z);
      }
      Vec3d through;
      if (refract(wo, h, eta, through) && through.z < 0) {
        kept += weight * (1 - fresnel) * passes(-through.z);
      }
    }
  }
  return std::min(kept / (kAzimuths * kRings), 1.0);
}

// 2 * integral of f(mu) mu dmu, with f linear in x = sqrt(mu) between nodes, by Simpson's rule with many steps.
double cosine_average(const DielectricAlbedo::Row& row) {
  constexpr int kSteps = 8 * (kNodes - 1);
  double sum = 0;
  for (int i = 0; i <= kSteps; ++i) {
    const double x = static_cast<double>(i) / kSteps;
    const double at = x * (kNodes - 1);
    const auto k = std::min(static_cast<std::size_t>(at), kNodes - 2);
    const double f = at - static_cast<double>(k);
    const double value = row[k] * (1 - f) + row[k + 1] * f;
    const double weight = i == 0 || i == kSteps ? 1 : (i % 2 == 1 ? 4 : 2);
    sum += weight * 4 * x * x * x * value;
  }
  return sum / (3 * kSteps);
}

}  // namespace

DielectricAlbedo make_dielectric_albedo(double ior) {
  DielectricAlbedo table{};
  table.ior = static_cast<float>(ior);
  for (std::size_t side = 0; side < 2; ++side) {
    const double eta = side == 0 ? ior : 1 / ior;
    for (std::size_t j = 0; j < kNodes; ++j) {
      for (std::size_t k = 0; k < kNodes; ++k) {
        const double x = static_cast<double>(k) / (kNodes - 1);
        table.kept[side][j][k] =
            static_cast<float>(single_scattering(x * x, static_cast<double>(j) / (kNodes - 1), eta));
      }
      table.kept_average[side][j] = static_cast<float>(cosine_average(table.kept[side][j]));
    }
  }
  constexpr int kSteps = 4096;
  double passed = 0;
  for (int i = 0; i < kSteps; ++i) {
    const double mu = (i + 0.5) / kSteps;
    passed += 2 * mu * (1 - fresnel_dielectric(mu, ior)) / kSteps;
  }
  table.passed_average = static_cast<float>(passed);
  return table;
}

}  // namespace gazetrace
