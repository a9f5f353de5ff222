// SPDX-License-Identifier: Apache-2.0
// What the base model returns of even light: its albedo tables and its samples beside independent quadratures, and
// white surfaces in a furnace. Millions of samples: single directions are bsdf_test's, under the sanitizers.
#include <gtest/gtest.h>

#include "material/bsdf.hpp"
#include "support/reference_bsdf.hpp"
#include "trace/samples/sampler.hpp"

namespace gazetrace::bsdf_furnace_test {
namespace {

using test::ReferenceBsdf;
using test::ReferenceRow;

constexpr SampleKey kKey = make_sample_key(7, 0, 0);
constexpr std::array kModels{DiffuseModel::burley, DiffuseModel::lambert};

TEST(AlbedoTables, AgreeWithIndependentQuadrature) {
  for (const int row : {0, 1, 3, 7, 12, 20, 31}) {
    const ReferenceRow reference(static_cast<double>(row) / (kAlbedoNodes - 1));
    EXPECT_NEAR(kAlbedoTables.e_average[static_cast<std::size_t>(row)], reference.e_average, 2e-4) << row;
    for (std::size_t k = 0; k < kAlbedoNodes; ++k) {
      const AlbedoTerms& t = kAlbedoTables.terms[static_cast<std::size_t>(row)][k];
      EXPECT_NEAR(t.e, reference.e[k], 5e-4) << row << ' ' << k;
      EXPECT_NEAR(t.b, reference.b[k], 5e-4) << row << ' ' << k;
      EXPECT_NEAR(t.lambert, reference.lambert[k], 1e-3) << row << ' ' << k;
      EXPECT_NEAR(t.burley, reference.burley[k], 2e-3) << row << ' ' << k;
    }
  }
}

// Reflected share of uniform light: cosine-weighted lobes by their own coordinates, so that no lobe is too narrow.
double albedo_of(DiffuseModel diffuse, const Surface& s, float mu) {
  constexpr std::uint32_t kCount = 1U << 16U;
  const Vec3f wo{std::sqrt(std::max(1 - mu * mu, 0.0F)), 0, mu};
  double sum = 0;
  for (std::uint32_t i = 0; i < kCount; ++i) {
    const Vec2f u = sample_2d(kKey, i, 8);
    const float lobe = sample_1d(kKey, i, 9);
    const BsdfSample chosen = diffuse == DiffuseModel::burley ? sample_bsdf<DiffuseModel::burley>(s, wo, u, lobe)
                                                              : sample_bsdf<DiffuseModel::lambert>(s, wo, u, lobe);
    sum += chosen.valid ? static_cast<double>(chosen.weight.y) : 0;
  }
  return sum / kCount;
}

// The stated bound: within 0.5 % of 1, but for smooth surfaces within 6 degrees of grazing, which may gain or lose 2 %
// (lose 12 % or gain 3 % below 3 degrees, where their multiple scattering is faded out and the tables' nodes are
// sparse).
TEST(BsdfFurnace, WhiteSurfacesKeepAllLight) {
  for (const float roughness : {0.0F, 0.01F, 0.1F, 0.17F, 0.25F, 0.4F, 0.55F, 0.7F, 0.85F, 1.0F}) {
    for (const float mu : {0.003F, 0.01F, 0.05F, 0.1F, 0.3F, 0.6F, 1.0F}) {
      const double loss = roughness > 0.2F || mu > 0.1F ? 0.005 : (mu < 0.05F ? 0.12 : 0.02);
      const double gain = roughness > 0.2F || mu > 0.01F ? 0.005 : 0.03;
      for (const DiffuseModel diffuse : kModels) {
        for (const float metallic : {0.0F, 1.0F}) {
          const double albedo = albedo_of(diffuse, {{1, 1, 1}, metallic, roughness}, mu);
          EXPECT_GE(albedo, 1 - loss) << "roughness " << roughness << " metallic " << metallic << " cosine " << mu;
          EXPECT_LE(albedo, 1 + gain) << "roughness " << roughness << " metallic " << metallic << " cosine " << mu;
        }
      }
    }
  }
}

TEST(BsdfFurnace, NeverReflectsMoreThanItReceives) {
  for (const float roughness : {0.0F, 0.05F, 0.3F, 0.6F, 1.0F}) {
    for (const float metallic : {0.0F, 0.5F, 1.0F}) {
      for (const float color : {0.0F, 0.3F, 0.9F}) {
        for (const float mu : {0.05F, 0.3F, 1.0F}) {
          EXPECT_LE(albedo_of(DiffuseModel::burley, {{color, color, color}, metallic, roughness}, mu), 1.004);
        }
      }
    }
  }
}

TEST(BsdfFurnace, AlbedoEqualsReferenceQuadrature) {
  for (const float roughness : {0.03F, 0.3F, 0.66F, 1.0F}) {
    for (const float metallic : {0.0F, 0.5F, 1.0F}) {
      for (const DiffuseModel diffuse : kModels) {
        const Surface s{{0.2F, 0.7F, 0.9F}, metallic, roughness};
        const ReferenceBsdf reference({to_double(s.base_color), metallic, roughness, diffuse});
        for (const float mu : {0.1F, 0.5F, 0.95F}) {
          EXPECT_NEAR(albedo_of(diffuse, s, mu), reference.albedo(mu).y, 2e-3)
              << roughness << ' ' << metallic << ' ' << mu;
        }
      }
    }
  }
}

}  // namespace
}  // namespace gazetrace::bsdf_furnace_test
