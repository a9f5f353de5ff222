// SPDX-License-Identifier: Apache-2.0
#include "material/layered_bsdf.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "support/layered_kinds.hpp"
#include "trace/samples/sampler.hpp"

namespace gazetrace::layered_bsdf_test {
namespace {

using test::layered;
using test::layered_kinds;
using test::LayeredKind;

using Model = LayeredBsdf;

constexpr SampleKey kKey = make_sample_key(11, 0, 0);
constexpr std::array kRoughness{0.0F, 1e-4F, 0.01F, 0.1F, 0.3F, 0.6F, 1.0F};
constexpr std::array kMetalness{0.0F, 0.5F, 1.0F};

Vec3f direction(float mu, float turns) {
  const float sine = std::sqrt(std::max(1 - mu * mu, 0.0F));
  const Vec2f circle = cos_sin_2pi(turns);
  return {sine * circle.x, sine * circle.y, mu};
}

TEST(LayeredBsdf, WithoutExtensionsIsTheBaseModel) {
  for (std::uint32_t i = 0; i < 20000; ++i) {
    const Vec2f a = sample_2d(kKey, i, 0);
    const Vec2f b = sample_2d(kKey, i, 1);
    const Vec2f c = sample_2d(kKey, i, 2);
    const LayeredSurface s = layered(c.x, 0.05F + 0.95F * c.y, {0.9F, 0.4F, 0.1F});
    const Vec3f wo = direction(0.01F + 0.99F * a.x, a.y);
    const Vec3f wi = direction(0.01F + 0.99F * b.x, b.y);
    const BsdfEval base = evaluate_bsdf<DiffuseModel::burley>(s.base, wo, wi);
    const BsdfEval same = Model(s, wo).evaluate(wi);
    EXPECT_NEAR(same.f_cos.x, base.f_cos.x, 1e-4F * base.f_cos.x + 1e-6F);
    EXPECT_NEAR(same.f_cos.z, base.f_cos.z, 1e-4F * base.f_cos.z + 1e-6F);
  }
}

// f / (index on o's side)^2 both ways. Light that goes through is looked at from the other side, where z points the
// other way.
TEST(LayeredBsdf, IsReciprocal) {
  double worst = 0;
  for (const float roughness : {0.1F, 0.3F, 0.6F, 1.0F}) {
    for (const float metallic : kMetalness) {
      for (const LayeredKind& kind : layered_kinds(roughness, metallic)) {
        for (std::uint32_t i = 0; i < 500; ++i) {
          const Vec2f a = sample_2d(kKey, i, 3);
          const Vec2f b = sample_2d(kKey, i, 4);
          const bool through = i % 2 == 1;
          const Vec3f o = direction(0.01F + 0.99F * a.x, a.y);
          Vec3f wi = direction(0.01F + 0.99F * b.x, b.y);
          wi.z = through ? -wi.z : wi.z;
          LayeredSurface behind = kind.surface;
          behind.inside = behind.solid && through ? !behind.inside : behind.inside;
          const Vec3f o_back = through ? Vec3f{wi.x, wi.y, -wi.z} : wi;
          const Vec3f i_back = through ? Vec3f{o.x, o.y, -o.z} : o;
          const auto n2 = [](const LayeredSurface& s) { return s.solid && s.inside ? s.ior * s.ior : 1.0F; };
          const Vec3f there = Model(kind.surface, o).evaluate(wi).f_cos * (1 / std::fabs(wi.z) / n2(kind.surface));
          const Vec3f back = Model(behind, o_back).evaluate(i_back).f_cos * (1 / o.z / n2(behind));
          EXPECT_NEAR(there.x, back.x, 1e-3F * back.x + 1e-6F) << kind.name << ' ' << roughness << ' ' << through;
          EXPECT_NEAR(there.z, back.z, 1e-3F * back.z + 1e-6F) << kind.name << ' ' << roughness << ' ' << through;
          worst = std::max(worst, std::fabs(double{there.x} - back.x) / (std::fabs(double{back.x}) + 1e-3));
        }
      }
    }
  }
  RecordProperty("worst relative difference", std::to_string(worst));
}

TEST(LayeredBsdf, SampleWeightIsValueOverDensity) {
  for (const float roughness : {0.2F, 0.5F, 1.0F}) {
    for (const float metallic : kMetalness) {
      for (const LayeredKind& kind : layered_kinds(roughness, metallic)) {
        for (std::uint32_t i = 0; i < 1000; ++i) {
          const Vec2f a = sample_2d(kKey, i, 5);
          const Model bsdf(kind.surface, direction(0.02F + 0.98F * a.x, 0.3F));
          const BsdfSample chosen = bsdf.sample(sample_2d(kKey, i, 6), a.y);
          if (!chosen.valid) {
            continue;
          }
          EXPECT_NEAR(length(chosen.direction), 1, 1e-5) << kind.name;
          const BsdfEval eval = bsdf.evaluate(chosen.direction);
          EXPECT_EQ(eval.pdf, chosen.pdf);
          EXPECT_NEAR(eval.f_cos.x, chosen.weight.x * eval.pdf, 1e-4F * eval.f_cos.x) << kind.name;
        }
      }
    }
  }
}

TEST(LayeredBsdf, ExtremesStayFinite) {
  const float last = 0x1.fffffep-1F;
  for (const float roughness : {0.0F, 1e-20F, 1e-4F, 0.01F, 0.5F, 1.0F}) {
    for (const float metallic : kMetalness) {
      for (const LayeredKind& kind : layered_kinds(roughness, metallic)) {
        for (const float mu : {1e-20F, 1e-7F, 1e-3F, 0.5F, last, 1.0F}) {
          const Model bsdf(kind.surface, direction(mu, 0.1F));
          for (const float ux : {0.0F, 0.25F, 0.7F, last}) {
            for (const float uy : {0.0F, 0.5F, last}) {
              for (const float lobe : {0.0F, 0.3F, 0.6F, last}) {
                const BsdfSample chosen = bsdf.sample({ux, uy}, lobe);
                if (chosen.valid) {
                  EXPECT_TRUE(is_finite(chosen.direction) && is_finite(chosen.weight) && std::isfinite(chosen.pdf))
                      << kind.name << ' ' << roughness << ' ' << mu;
                  EXPECT_LT(chosen.weight.x, 100)
                      << kind.name << ' ' << roughness << ' ' << mu << ' ' << ux << ' ' << uy;
                }
              }
              for (const float side : {1.0F, -1.0F}) {
                const BsdfEval eval = bsdf.evaluate(direction(std::max(uy, 1e-20F), ux) * side);
                EXPECT_TRUE(is_finite(eval.f_cos) && std::isfinite(eval.pdf)) << kind.name << ' ' << roughness;
                EXPECT_GE(std::min({eval.f_cos.x, eval.f_cos.y, eval.f_cos.z, eval.pdf}), 0) << kind.name;
              }
            }
          }
        }
      }
    }
  }
}

}  // namespace
}  // namespace gazetrace::layered_bsdf_test
