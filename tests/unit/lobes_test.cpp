// SPDX-License-Identifier: Apache-2.0
// Single lobes against closed forms, and their densities against the Jacobians of their mappings in double precision.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>

#include "material/lobes/dielectric.hpp"
#include "material/lobes/dielectric_albedo.hpp"
#include "material/lobes/dispersion.hpp"
#include "material/lobes/ggx.hpp"
#include "material/lobes/reflection.hpp"
#include "material/lobes/sheen.hpp"
#include "material/lobes/thin_film.hpp"
#include "material/lobes/volume.hpp"

namespace gazetrace {
namespace {

constexpr std::array kRoughness{0.0, 1e-4, 0.01, 0.1, 0.4, 1.0};
constexpr std::array kCosines{1e-3, 0.05, 0.3, 0.8, 0.999};
constexpr std::array kPlaces{Vec2d{0.1, 0.2}, Vec2d{0.33, 0.7}, Vec2d{0.8, 0.05}, Vec2d{0.6, 0.95}, Vec2d{0.5, 0.5}};

// Area on the sphere that the mapping gives to a unit of the sample square; 0: not defined there.
template <class Map>
double area_of(const Map& map, const Vec2d& u) {
  const double step = 1e-6;
  Vec3d a, b, c, d;
  if (!map(u.x + step, u.y, a) || !map(u.x - step, u.y, b) || !map(u.x, u.y + step, c) || !map(u.x, u.y - step, d)) {
    return 0;
  }
  return length(cross((a - b) / (2 * step), (c - d) / (2 * step)));
}

TEST(Ggx, AnisotropicDensityIsTheInverseJacobianOfItsSampling) {
  int checked = 0;
  for (const double roughness : kRoughness) {
    for (const double strength : {0.0, 0.5, 1.0}) {
      const auto alpha = anisotropic_alpha(roughness, strength);
      for (const double mu : kCosines) {
        const double sine = std::sqrt(1 - mu * mu);
        const Vec3d wo{0.8 * sine, 0.6 * sine, mu};
        for (const Vec2d& u : kPlaces) {
          const double area = area_of(
              [&](double x, double y, Vec3d& wi) {
                wi = reflect(wo, sample_visible_normal(wo, alpha, Vec2d{x, y}));
                return true;
              },
              u);
          const Vec3d h = sample_visible_normal(wo, alpha, u);
          const double pdf = visible_normal_pdf(dot(wo, h), wo.z, smith_length(wo, alpha), ggx_distribution(h, alpha)) /
                             (4 * dot(wo, h));
          EXPECT_NEAR(pdf * area, 1, 2e-4) << roughness << ' ' << strength << ' ' << mu << ' ' << u.x;
          ++checked;
        }
      }
    }
  }
  EXPECT_EQ(checked, 450);
}

TEST(Ggx, AnisotropicOfStrengthZeroIsTheIsotropicOne) {
  const auto alpha = anisotropic_alpha(0.5, 0.0);
  const Vec3d h = normalize(Vec3d{0.2, -0.1, 0.9});
  EXPECT_NEAR(ggx_distribution(h, alpha), ggx_distribution(h, 0.25), 1e-12);
  EXPECT_NEAR(smith_length(h, alpha), smith_length(h.z, 0.0625), 1e-12);
}

TEST(Dielectric, RefractedDensityIsTheInverseJacobianOfItsSampling) {
  int checked = 0;
  for (const double roughness : kRoughness) {
    for (const double strength : {0.0, 0.7}) {
      const auto alpha = anisotropic_alpha(roughness, strength);
      for (const double eta : {1.01, 1.5, 2.4, 1 / 1.5}) {
        for (const double mu : kCosines) {
          const Vec3d wo{std::sqrt(1 - mu * mu), 0, mu};
          for (const Vec2d& u : kPlaces) {
            const double area = area_of(
                [&](double x, double y, Vec3d& wi) {
                  return refract(wo, sample_visible_normal(wo, alpha, Vec2d{x, y}), eta, wi);
                },
                u);
            Vec3d wi;
            const Vec3d h = sample_visible_normal(wo, alpha, u);
            if (area == 0 || !refract(wo, h, eta, wi)) {
              continue;
            }
            const double pdf =
                visible_normal_pdf(dot(wo, h), wo.z, smith_length(wo, alpha), ggx_distribution(h, alpha)) *
                refraction_jacobian(dot(wo, h), dot(wi, h), eta);
            EXPECT_NEAR(pdf * area, 1, 1e-3) << roughness << ' ' << eta << ' ' << mu << ' ' << u.x << ' ' << u.y;
            const Vec3d back = refraction_half_vector(wo, wi, eta);
            EXPECT_NEAR(length(back - h), 0, 1e-9);
            ++checked;
          }
        }
      }
    }
  }
  EXPECT_GT(checked, 900);
}

TEST(Dielectric, FresnelHasItsClosedForms) {
  EXPECT_NEAR(fresnel_dielectric(1.0, 1.5), 0.04, 1e-15);
  const double brewster = std::cos(std::atan(1.5));  // reflects one polarisation only
  const double other = (1.5 * 1.5 - 1) / (1.5 * 1.5 + 1);
  EXPECT_NEAR(fresnel_dielectric(brewster, 1.5), 0.5 * other * other, 1e-15);
  EXPECT_EQ(fresnel_dielectric(0.7, 1 / 1.5), 1);  // beyond 41.8 degrees
  EXPECT_LT(fresnel_dielectric(0.76, 1 / 1.5), 1);
  // The same at both ends of a ray.
  for (const double cosine : {0.2, 0.5, 0.9}) {
    const double inner = std::sqrt(1 - (1 - cosine * cosine) / 2.25);
    EXPECT_NEAR(fresnel_dielectric(cosine, 1.5), fresnel_dielectric(inner, 1 / 1.5), 1e-14);
  }
}

TEST(Dielectric, RefractionObeysSnell) {
  const double angle = 0.7;
  Vec3d wi;
  ASSERT_TRUE(refract(Vec3d{std::sin(angle), 0, std::cos(angle)}, Vec3d{0, 0, 1}, 1.33, wi));
  EXPECT_NEAR(-wi.x, std::sin(angle) / 1.33, 1e-12);
  EXPECT_LT(wi.z, 0);
  EXPECT_FALSE(refract(Vec3d{std::sin(angle), 0, std::cos(angle)}, Vec3d{0, 0, 1}, 1 / 1.8, wi));
}

// On smooth surfaces nothing is lost; the average that passes follows from Fresnel's formula, and is larger from
// outside by the square of the index (what enters must be able to leave).
TEST(Dielectric, AlbedoTableHasItsLimits) {
  const DielectricAlbedo table = make_dielectric_albedo(1.5);
  for (const std::size_t side : {std::size_t{0}, std::size_t{1}}) {
    for (std::size_t k = 4; k < DielectricAlbedo::kNodes; ++k) {
      EXPECT_NEAR(table.kept[side][0][k], 1, 2e-3) << side << ' ' << k;
    }
    EXPECT_LT(kept_at(table, side, dielectric_row(1), 0.1F), 0.9F);
  }
  double from_inside = 0;
  constexpr int kSteps = 100000;
  for (int i = 0; i < kSteps; ++i) {
    const double mu = (i + 0.5) / kSteps;
    from_inside += 2 * mu * (1 - fresnel_dielectric(mu, 1 / 1.5)) / kSteps;
  }
  EXPECT_NEAR(from_inside * 2.25, table.passed_average, 1e-4);
}

TEST(Volume, TransmittanceIsTheColorAtItsDistance) {
  VolumeParameters volume;
  volume.thickness = 1;
  volume.attenuation_color = {0.5F, 0.25F, 1};
  volume.attenuation_distance_m = 2;
  const Vec3f sigma = absorption_per_m(volume);
  EXPECT_NEAR(transmittance(sigma, 2).x, 0.5, 1e-6);
  EXPECT_NEAR(transmittance(sigma, 4).y, 0.0625, 1e-6);
  EXPECT_EQ(transmittance(sigma, std::numeric_limits<float>::infinity()).x, 0);
  EXPECT_EQ(transmittance(sigma, std::numeric_limits<float>::infinity()).z, 1);
  volume.attenuation_distance_m = std::numeric_limits<float>::infinity();
  EXPECT_EQ(absorption_per_m(volume).x, 0);
  volume.attenuation_color = {0, 0, 0};
  volume.attenuation_distance_m = 1e-3F;
  EXPECT_LT(transmittance(absorption_per_m(volume), 1).x, 1e-30F);
}

// KHR_materials_dispersion: Abbe number 20 / dispersion = (n_d - 1) / (n_F - n_C).
TEST(Dispersion, SpreadFollowsTheAbbeNumber) {
  const float abbe = 30;
  const float dispersion = 20 / abbe;
  EXPECT_EQ(dispersed_ior(1.5F, dispersion, 1), 1.5F);
  EXPECT_NEAR(dispersed_ior(1.5F, dispersion, 2) - dispersed_ior(1.5F, dispersion, 0), 0.5F / abbe, 1e-6);
}

// The lobe's table against an independent quadrature in angles.
TEST(Sheen, AlbedoTableAgreesWithQuadrature) {
  for (const int row : {0, 6, 12, 20, 31}) {
    const double roughness = static_cast<double>(row) / (kAlbedoNodes - 1);
    const double alpha = std::pow(std::max(roughness, 0.07), 2);
    for (const int column : {8, 16, 24, 31}) {
      const double x = static_cast<double>(column) / (kAlbedoNodes - 1);
      const double mu = x * x;
      const Vec3d o{std::sqrt(1 - mu * mu), 0, mu};
      double sum = 0;
      constexpr int kRings = 500;
      constexpr int kAzimuths = 200;
      for (int j = 0; j < kRings; ++j) {
        const double theta = 0.5 * kPi * (j + 0.5) / kRings;
        for (int k = 0; k < kAzimuths; ++k) {
          const double phi = kPi * (k + 0.5) / kAzimuths;
          const Vec3d i{std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta)};
          sum += sheen_value(o, i, alpha) * std::cos(theta) * std::sin(theta);
        }
      }
      sum *= 0.5 * kPi / kRings * 2 * kPi / kAzimuths;
      const SheenAlbedo entry = kAlbedoTables.sheen[static_cast<std::size_t>(row)][static_cast<std::size_t>(column)];
      EXPECT_NEAR(entry.raw, sum, 2e-3 + 0.01 * sum) << row << ' ' << column;
      EXPECT_LE(entry.kept, 1.001F);
      EXPECT_LE(entry.kept, entry.raw + 1e-6F);
    }
  }
}

TEST(Sheen, UniformSamplingHasItsDensity) {
  for (const Vec2d& u : kPlaces) {
    const double area = area_of(
        [](double x, double y, Vec3d& wi) {
          wi = sample_uniform_hemisphere(Vec2d{x, y}, cos_sin_2pi(x));
          return true;
        },
        u);
    EXPECT_NEAR(area / (2 * kPi), 1, 1e-6);
  }
}

// Airy's sum for one wavelength, integrated over the paper's own Gaussians of the matching functions: the closed form
// truncates the sum at two terms.
TEST(ThinFilm, HasItsLimits) {
  // No film: the base's Schlick reflectance at normal incidence, under every index.
  for (const float ior : {1.0F, 1.3F, 2.0F}) {
    const Vec3f bare = thin_film_fresnel(1, ior, 0, {0.04F, 0.3F, 0.8F});
    EXPECT_NEAR(bare.x, 0.04F, 2e-2) << ior;
    EXPECT_NEAR(bare.y, 0.3F, 2e-2) << ior;
    EXPECT_NEAR(bare.z, 0.8F, 2e-2) << ior;
  }
  for (int step = 0; step < 24; ++step) {
    const float thickness = 50.0F * static_cast<float>(step);
    for (const float cosine : {0.0F, 0.01F, 0.5F, 1.0F}) {
      for (const float f0 : {0.0F, 0.04F, 0.5F, 1.0F}) {
        const Vec3f f = thin_film_fresnel(cosine, 1.4F, thickness, {f0, f0, f0});
        EXPECT_TRUE(is_finite(f));
        EXPECT_GE(std::min({f.x, f.y, f.z}), 0);
        EXPECT_LE(std::max({f.x, f.y, f.z}), 1);
      }
    }
  }
  // A quarter wave of index sqrt(n) on a base of index n is the classic antireflection coat: green, 550 nm, n = 2.25.
  const float base = (2.25F - 1) / (2.25F + 1);
  const Vec3f coated = thin_film_fresnel(1, 1.5F, 550.0F / (4 * 1.5F), {base * base, base * base, base * base});
  EXPECT_LT(coated.y, 0.25F * base * base);
  // A half wave of it changes nothing there.
  const Vec3f half = thin_film_fresnel(1, 1.5F, 550.0F / (2 * 1.5F), {base * base, base * base, base * base});
  EXPECT_GT(half.y, 0.6F * base * base);
}

}  // namespace
}  // namespace gazetrace
