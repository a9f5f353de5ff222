// SPDX-License-Identifier: Apache-2.0
// The albedo table of anisotropic facets against an independent quadrature and against the isotropic tables, and
// furnaces over strength, roughness, cosine and azimuth.
#include "material/lobes/anisotropic_albedo.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "support/layered_kinds.hpp"
#include "trace/samples/sampler.hpp"

namespace gazetrace::anisotropic_albedo_test {
namespace {

using test::layered;

using Model = LayeredBsdf;

constexpr SampleKey kKey = make_sample_key(13, 0, 0);
constexpr std::array kRoughness{0.0F, 1e-4F, 0.01F, 0.05F, 0.1F, 0.2F, 0.3F, 0.45F, 0.6F, 0.8F, 1.0F};
constexpr std::array kStrengths{0.01F, 0.05F, 0.1F, 0.2F, 0.3F, 0.5F, 0.7F, 0.8F, 0.9F, 1.0F};
constexpr std::array kAzimuths_deg{0.0F, 5.0F, 20.0F, 45.0F, 60.0F, 75.0F, 85.0F, 88.0F, 90.0F};

Vec3f direction(float mu, float azimuth_deg) {
  const float sine = std::sqrt(std::max(1 - mu * mu, 0.0F));
  const Vec2f circle = cos_sin_2pi(azimuth_deg / 360);
  return {sine * circle.x, sine * circle.y, mu};
}

struct Albedo {
  double e, b;
};

// Over all facets, seen or not: with D(h) h.z dh uniform over a square, the integral of
// D G2 (o.h) / o.z dh, where G2 = 1 / (1 + Lambda(o) + Lambda(i)) with Lambda = (L / cosine - 1) / 2.
Albedo by_slopes(double ax, double ay, const Vec3d& o) {
  constexpr int kRings = 600;
  constexpr int kTurns = 400;
  const auto lambda = [&](const Vec3d& v) {
    const double tan2 = (ax * ax * v.x * v.x + ay * ay * v.y * v.y) / (v.z * v.z);
    return 0.5 * (std::sqrt(1 + tan2) - 1);
  };
  Albedo sum{0, 0};
  for (int j = 0; j < kRings; ++j) {
    const double t = (j + 0.5) / kRings;
    const double rest = (1 - t) * (1 - t);  // steep facets matter
    const double slope = std::sqrt((1 - rest) / rest);
    for (int k = 0; k < kTurns; ++k) {
      const double phi = 2 * kPi * (k + 0.5) / kTurns;
      const Vec3d h = normalize(Vec3d{ax * slope * std::cos(phi), ay * slope * std::sin(phi), 1});
      const double oh = dot(o, h);
      const Vec3d i = h * (2 * oh) - o;
      if (oh <= 0 || i.z <= 0) {
        continue;
      }
      const double kept = oh / (o.z * h.z) / (1 + lambda(o) + lambda(i)) * 2 * (1 - t) / (kRings * kTurns);
      sum.e += kept;
      sum.b += kept * std::pow(1 - oh, 5);
    }
  }
  return sum;
}

TEST(AnisotropicAlbedo, AgreesWithAQuadratureOverAllSlopes) {
  double worst_e = 0;
  double worst_b = 0;
  for (const float roughness : {0.02F, 0.15F, 0.37F, 0.55F, 0.93F}) {
    for (const float strength : {0.15F, 0.44F, 0.77F, 1.0F}) {
      const auto alpha = anisotropic_alpha(roughness, strength);
      const AnisotropicTerms terms(test::anisotropic_albedo(), alpha);
      for (const float mu : {0.05F, 0.17F, 0.5F, 0.85F}) {
        for (const float azimuth_deg : {0.0F, 33.0F, 71.0F, 86.0F, 90.0F}) {
          const Vec3f o = direction(mu, azimuth_deg);
          const Albedo exact = by_slopes(double{alpha.x}, double{alpha.y}, to_double(o));
          const AlbedoTerms read = terms.at(o);
          EXPECT_NEAR(read.e, exact.e, 5e-3) << roughness << ' ' << strength << ' ' << mu << ' ' << azimuth_deg;
          EXPECT_NEAR(read.b, exact.b, 1e-2) << roughness << ' ' << strength << ' ' << mu << ' ' << azimuth_deg;
          worst_e = std::max(worst_e, std::fabs(double{read.e} - exact.e));
          worst_b = std::max(worst_b, std::fabs(double{read.b} - exact.b));
        }
      }
    }
  }
  RecordProperty("worst e", std::to_string(worst_e));
  RecordProperty("worst b", std::to_string(worst_b));
}

// Equal slopes: what the tables of isotropic facets say at their own nodes.
TEST(AnisotropicAlbedo, EqualSlopesAreIsotropic) {
  for (std::size_t row = 3; row < kAlbedoNodes; ++row) {
    const float roughness = static_cast<float>(row) / (kAlbedoNodes - 1);
    const AnisotropicTerms terms(test::anisotropic_albedo(), {roughness * roughness, roughness * roughness});
    for (std::size_t column = 4; column < kAlbedoNodes; ++column) {
      const float root = static_cast<float>(column) / (kAlbedoNodes - 1);
      const AlbedoTerms& node = kAlbedoTables.terms[row][column];
      for (const float azimuth_deg : {0.0F, 30.0F, 90.0F, 200.0F}) {
        const AlbedoTerms read = terms.at(direction(root * root, azimuth_deg));
        EXPECT_NEAR(read.e, node.e, 5e-3) << row << ' ' << column << ' ' << azimuth_deg;
        EXPECT_NEAR(read.b, node.b, 5e-3) << row << ' ' << column << ' ' << azimuth_deg;
      }
    }
    EXPECT_NEAR(terms.averages().e, kAlbedoTables.e_average[row], 3e-3) << row;
    EXPECT_NEAR(terms.averages().b, kAlbedoTables.b_average[row], 3e-3) << row;
  }
}

double albedo_of(const LayeredSurface& s, const Vec3f& wo, std::uint32_t count) {
  const Model bsdf(s, wo);
  double sum = 0;
  for (std::uint32_t i = 0; i < count; ++i) {
    const BsdfSample chosen = bsdf.sample(sample_2d(kKey, i, 8), sample_1d(kKey, i, 9));
    sum += chosen.valid ? static_cast<double>(chosen.weight.x) : 0;
  }
  return sum / count;
}

struct Extreme {
  double value;
  std::string where;
};

// White surfaces of every strength, seen from everywhere: nothing made, and little lost but at the horizon of smooth
// surfaces, where repeated scattering fades out (repeated_share): down to 0.918 at an alpha of 0.01.
TEST(AnisotropicAlbedo, WhiteSurfacesReturnWhatTheyGet) {
  for (const float metallic : {1.0F, 0.0F}) {
    Extreme most{0, ""};
    Extreme least{9, ""};
    Extreme least_steep{9, ""};
    for (const float roughness : kRoughness) {
      for (const float strength : kStrengths) {
        LayeredSurface s = layered(metallic, roughness);
        s.anisotropy = strength;
        for (const float mu : {0.02F, 0.05F, 0.1F, 0.3F, 0.6F, 1.0F}) {
          for (const float azimuth_deg : kAzimuths_deg) {
            double albedo = albedo_of(s, direction(mu, azimuth_deg), 1U << 11U);
            if (std::fabs(albedo - 1) > 0.008) {  // grazing directions of repeated scattering are rare and heavy
              albedo = albedo_of(s, direction(mu, azimuth_deg), 1U << 15U);
            }
            const auto found = [&] {
              std::string where = std::to_string(albedo) + " at roughness " + std::to_string(roughness);
              where += " strength " + std::to_string(strength) + " cosine " + std::to_string(mu);
              return Extreme{albedo, where + " azimuth " + std::to_string(azimuth_deg)};
            };
            most = albedo > most.value ? found() : most;
            least = albedo < least.value ? found() : least;
            least_steep = mu > 0.25F && albedo < least_steep.value ? found() : least_steep;
          }
        }
      }
    }
    RecordProperty("most " + std::to_string(metallic), most.where);
    RecordProperty("least " + std::to_string(metallic), least.where);
    RecordProperty("least away from the horizon " + std::to_string(metallic), least_steep.where);
    EXPECT_LE(most.value, 1.012) << most.where;
    EXPECT_GE(least.value, 0.91) << least.where;
    EXPECT_GE(least_steep.value, 0.985) << least_steep.where;
  }
}

// And hardly any is hardly another, although the diffuse light below is Lambert's, not Burley's: it leaves as much.
TEST(AnisotropicAlbedo, StrengthZeroIsTheIsotropicSurface) {
  for (const float roughness : {0.0F, 0.1F, 0.4F, 1.0F}) {
    for (const float metallic : {0.0F, 1.0F}) {
      const LayeredSurface plain = layered(metallic, roughness);
      LayeredSurface faint = plain;
      faint.anisotropy = 1e-4F;
      for (const float mu : {0.1F, 0.4F, 0.9F}) {
        for (const float azimuth_deg : {0.0F, 60.0F}) {
          const Vec3f wo = direction(mu, azimuth_deg);
          EXPECT_NEAR(albedo_of(faint, wo, 1U << 13U), albedo_of(plain, wo, 1U << 13U), 0.01)
              << roughness << ' ' << metallic << ' ' << mu << ' ' << azimuth_deg;
        }
      }
    }
  }
}

TEST(AnisotropicAlbedo, SurfacesAreReciprocal) {
  for (const float roughness : {0.05F, 0.2F, 0.6F}) {
    for (const float strength : {0.1F, 0.6F, 1.0F}) {
      for (const float metallic : {0.0F, 1.0F}) {
        LayeredSurface s = layered(metallic, roughness);
        s.anisotropy = strength;
        for (std::uint32_t i = 0; i < 2000; ++i) {
          const Vec2f a = sample_2d(kKey, i, 3);
          const Vec2f b = sample_2d(kKey, i, 4);
          const Vec3f o = direction(0.01F + 0.99F * a.x, 360 * a.y);
          const Vec3f wi = direction(0.01F + 0.99F * b.x, 360 * b.y);
          const double there = double{Model(s, o).evaluate(wi).f_cos.x} / double{wi.z};
          const double back = double{Model(s, wi).evaluate(o).f_cos.x} / double{o.z};
          EXPECT_NEAR(there, back, 1e-4 * back + 1e-6) << roughness << ' ' << strength << ' ' << i;
        }
      }
    }
  }
}

}  // namespace
}  // namespace gazetrace::anisotropic_albedo_test
