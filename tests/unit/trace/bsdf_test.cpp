// SPDX-License-Identifier: Apache-2.0
#include "material/bsdf.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <vector>

#include "support/reference_bsdf.hpp"
#include "trace/samples/sampler.hpp"

namespace gazetrace::bsdf_test {
namespace {

using test::ReferenceBsdf;

constexpr SampleKey kKey = make_sample_key(7, 0, 0);

Vec3f direction(float mu, float turns) {
  const float sine = std::sqrt(std::max(1 - mu * mu, 0.0F));
  const Vec2f circle = cos_sin_2pi(turns);
  return {sine * circle.x, sine * circle.y, mu};
}

BsdfEval evaluate(DiffuseModel diffuse, const Surface& s, const Vec3f& wo, const Vec3f& wi) {
  return diffuse == DiffuseModel::burley ? evaluate_bsdf<DiffuseModel::burley>(s, wo, wi)
                                         : evaluate_bsdf<DiffuseModel::lambert>(s, wo, wi);
}

BsdfSample sample(DiffuseModel diffuse, const Surface& s, const Vec3f& wo, const Vec2f& u, float lobe) {
  return diffuse == DiffuseModel::burley ? sample_bsdf<DiffuseModel::burley>(s, wo, u, lobe)
                                         : sample_bsdf<DiffuseModel::lambert>(s, wo, u, lobe);
}

constexpr std::array kModels{DiffuseModel::burley, DiffuseModel::lambert};

TEST(AlbedoTables, LookupReturnsNodesAndStaysInside) {
  for (const std::size_t row : {std::size_t{0}, std::size_t{17}, std::size_t{kAlbedoNodes - 1}}) {
    for (std::size_t k = 0; k < kAlbedoNodes; ++k) {
      const auto x = static_cast<float>(k) / (kAlbedoNodes - 1);
      const auto at = albedo_row(static_cast<float>(row) / (kAlbedoNodes - 1));
      EXPECT_NEAR(albedo_terms(at, x * x).e, kAlbedoTables.terms[row][k].e, 2e-5);
    }
  }
}

TEST(Bsdf, EqualsTheReferenceModelPointwise) {
  std::uint32_t index = 0;
  for (const float roughness : {0.05F, 0.45F, 1.0F}) {
    for (const float metallic : {0.0F, 0.3F, 1.0F}) {
      for (const DiffuseModel diffuse : kModels) {
        const Surface s{{0.9F, 0.4F, 0.05F}, metallic, roughness};
        const ReferenceBsdf reference({to_double(s.base_color), metallic, roughness, diffuse});
        for (int i = 0; i < 200; ++i, ++index) {
          const Vec2f a = sample_2d(kKey, index, 0);
          const Vec2f b = sample_2d(kKey, index, 1);
          const Vec3f wo = direction(0.01F + 0.99F * a.x, a.y);
          // Half of the pairs near the mirror direction, where the lobe is.
          Vec3f wi = direction(0.01F + 0.99F * b.x, b.y);
          if (i % 2 == 0) {
            wi = reflect(wo, sample_visible_normal(wo, alpha_of_roughness(roughness), b));
          }
          if (!(wi.z > 0.002F)) {
            continue;
          }
          const Vec3d expected = reference.value(normalize(to_double(wo)), normalize(to_double(wi))) * double{wi.z};
          const Vec3f actual = evaluate(diffuse, s, wo, wi).f_cos;
          // The tables' own error is absolute, and small beside the lobes.
          EXPECT_NEAR(actual.x, expected.x, 2e-3 * expected.x + 2e-4) << roughness << ' ' << metallic;
          EXPECT_NEAR(actual.y, expected.y, 2e-3 * expected.y + 2e-4) << roughness << ' ' << metallic;
          EXPECT_NEAR(actual.z, expected.z, 2e-3 * expected.z + 2e-4) << roughness << ' ' << metallic;
        }
      }
    }
  }
}

TEST(Bsdf, IsReciprocal) {
  for (std::uint32_t i = 0; i < 20000; ++i) {
    const Vec2f a = sample_2d(kKey, i, 2);
    const Vec2f b = sample_2d(kKey, i, 3);
    const Vec2f c = sample_2d(kKey, i, 4);
    const Surface s{{0.8F, 0.5F, 0.2F}, c.x, c.y};
    const Vec3f wo = direction(0.001F + 0.999F * a.x, a.y);
    const Vec3f wi = direction(0.001F + 0.999F * b.x, b.y);
    for (const DiffuseModel diffuse : kModels) {
      const Vec3f there = evaluate(diffuse, s, wo, wi).f_cos * (1 / wi.z);
      const Vec3f back = evaluate(diffuse, s, wi, wo).f_cos * (1 / wo.z);
      EXPECT_NEAR(there.x, back.x, 2e-5F * back.x + 1e-7F) << i;
      EXPECT_NEAR(there.z, back.z, 2e-5F * back.z + 1e-7F) << i;
    }
  }
}

TEST(Bsdf, SampleWeightIsValueOverDensity) {
  for (std::uint32_t i = 0; i < 50000; ++i) {
    const Vec2f a = sample_2d(kKey, i, 5);
    const Vec2f b = sample_2d(kKey, i, 6);
    const Vec2f c = sample_2d(kKey, i, 7);
    const Surface s{{0.8F, 0.5F, 0.2F}, c.x, 0.2F + 0.8F * c.y};
    const Vec3f wo = direction(0.01F + 0.99F * a.x, 0.3F);
    for (const DiffuseModel diffuse : kModels) {
      const BsdfSample chosen = sample(diffuse, s, wo, b, a.y);
      if (!chosen.valid) {
        continue;
      }
      EXPECT_NEAR(length(chosen.direction), 1, 1e-5);
      const BsdfEval eval = evaluate(diffuse, s, wo, chosen.direction);
      // Rounding of the direction moves a narrow lobe's value.
      EXPECT_NEAR(eval.pdf / chosen.pdf, 1, 2e-3) << i;
      EXPECT_NEAR(eval.f_cos.x / eval.pdf / chosen.weight.x, 1, 1e-3) << i;
    }
  }
}

// 1 / pdf is the area that the mapping gives to a unit of the sample square.
TEST(Microfacet, DensityIsTheInverseJacobianOfItsSampling) {
  const double step = 1e-6;
  for (const double roughness : {0.0, 0.01, 0.1, 0.3, 0.6, 1.0}) {
    const double alpha = alpha_of_roughness(roughness);
    for (const double mu : {1e-3, 0.05, 0.3, 0.8, 0.999}) {
      const Vec3d wo{std::sqrt(1 - mu * mu), 0, mu};
      for (const Vec2d u : {Vec2d{0.1, 0.2}, Vec2d{0.33, 0.7}, Vec2d{0.8, 0.05}, Vec2d{0.6, 0.95}, Vec2d{0.5, 0.5}}) {
        const auto map = [&](double x, double y) { return reflect(wo, sample_visible_normal(wo, alpha, Vec2d{x, y})); };
        const Vec3d dx = (map(u.x + step, u.y) - map(u.x - step, u.y)) / (2 * step);
        const Vec3d dy = (map(u.x, u.y + step) - map(u.x, u.y - step)) / (2 * step);
        const double area = length(cross(dx, dy));
        const Vec3d half = sample_visible_normal(wo, alpha, u);
        const double pdf =
            visible_reflection_pdf(wo.z, smith_length(wo.z, alpha * alpha), ggx_distribution(half, alpha));
        EXPECT_NEAR(pdf * area, 1, 1e-4) << roughness << ' ' << mu << ' ' << u.x << ' ' << u.y;
      }
    }
  }
}

TEST(Microfacet, CosineSamplingHasItsDensity) {
  const double step = 1e-6;
  for (const Vec2d u : {Vec2d{0.1, 0.2}, Vec2d{0.33, 0.7}, Vec2d{0.8, 0.05}}) {
    const Vec3d dx =
        (sample_cosine_hemisphere(Vec2d{u.x + step, u.y}) - sample_cosine_hemisphere(Vec2d{u.x - step, u.y})) /
        (2 * step);
    const Vec3d dy =
        (sample_cosine_hemisphere(Vec2d{u.x, u.y + step}) - sample_cosine_hemisphere(Vec2d{u.x, u.y - step})) /
        (2 * step);
    EXPECT_NEAR(length(cross(dx, dy)) * sample_cosine_hemisphere(u).z / kPi, 1, 1e-6);
  }
}

TEST(Bsdf, ExtremesStayFinite) {
  const float last = 0x1.fffffep-1F;
  for (const float roughness : {0.0F, 1e-20F, 0.01F, 0.5F, 1.0F}) {
    for (const float metallic : {0.0F, 1.0F}) {
      for (const float color : {0.0F, 1e-30F, 1.0F}) {
        for (const float mu : {1e-20F, 1e-7F, 1e-3F, 0.5F, last, 1.0F}) {
          const Surface s{{color, color, color}, metallic, roughness};
          const Vec3f wo = direction(mu, 0.1F);
          for (const DiffuseModel diffuse : kModels) {
            for (const float ux : {0.0F, 0.25F, 0.7F, last}) {
              for (const float uy : {0.0F, 0.5F, last}) {
                for (const float lobe : {0.0F, last}) {
                  const BsdfSample chosen = sample(diffuse, s, wo, {ux, uy}, lobe);
                  if (chosen.valid) {
                    EXPECT_TRUE(is_finite(chosen.direction) && is_finite(chosen.weight) && std::isfinite(chosen.pdf))
                        << roughness << ' ' << mu << ' ' << ux << ' ' << uy;
                    EXPECT_GT(chosen.direction.z, 0);
                    EXPECT_LT(chosen.weight.x, 100) << roughness << ' ' << mu << ' ' << ux << ' ' << uy;
                  }
                  const BsdfEval eval = evaluate(diffuse, s, wo, direction(std::max(uy, 1e-20F), ux));
                  EXPECT_TRUE(is_finite(eval.f_cos) && std::isfinite(eval.pdf)) << roughness << ' ' << mu;
                }
              }
            }
          }
        }
      }
    }
  }
}

TEST(Bsdf, NothingComesFromBelow) {
  const Surface s{{1, 1, 1}, 0.5F, 0.5F};
  const Vec3f up{0, 0, 1};
  const Vec3f down{0, 0, -1};
  EXPECT_EQ(evaluate_bsdf<DiffuseModel::burley>(s, up, down).pdf, 0);
  EXPECT_EQ(evaluate_bsdf<DiffuseModel::burley>(s, down, up).pdf, 0);
  EXPECT_FALSE((sample_bsdf<DiffuseModel::burley>(s, down, {0.5F, 0.5F}, 0.5F).valid));
}

}  // namespace
}  // namespace gazetrace::bsdf_test
