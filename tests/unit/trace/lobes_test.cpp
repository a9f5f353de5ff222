// SPDX-License-Identifier: Apache-2.0
// Single lobes against closed forms, and their densities against the Jacobians of their mappings in double precision.
#include <gtest/gtest.h>

#include <algorithm>
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

namespace gazetrace::lobes_test {
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

// A film's reflectance by Airy's formula, |r12 + r23 e^(i d)|^2 / |1 + r12 r23 e^(i d)|^2 with d = 2 pi path / lambda,
// in double precision: its top by Fresnel's laws of sines and tangents, its bottom by Schlick's formula.
struct AiryFilm {
  double r12, r23, path_nm;  // amplitudes: the sign tells a phase of pi

  AiryFilm(double cosine, double film_ior, double thickness_nm, double f0) {
    const double inside = std::sqrt(1 - (1 - cosine * cosine) / (film_ior * film_ior));
    const double base = (1 + std::sqrt(f0)) / (1 - std::sqrt(f0));
    r12 = (film_ior - 1) / (film_ior + 1);
    if (cosine < 1) {
      const double a = std::atan2(std::sqrt(1 - cosine * cosine), cosine);
      const double b = std::atan2(std::sqrt(1 - inside * inside), inside);
      const double s = std::sin(a - b) / std::sin(a + b);
      const double p = std::tan(a - b) / std::tan(a + b);
      r12 = std::sqrt(0.5 * (s * s + p * p));
    }
    const double r = std::pow((base - film_ior) / (base + film_ior), 2);
    r23 = std::copysign(std::sqrt(r + (1 - r) * std::pow(1 - inside, 5)), base - film_ior);
    path_nm = 2 * film_ior * thickness_nm * inside;
  }
  [[nodiscard]] double reflectance(double phase) const {
    const double cross = 2 * r12 * r23 * std::cos(phase);
    return (r12 * r12 + r23 * r23 + cross) / (1 + r12 * r12 * r23 * r23 + cross);
  }
  // Over all phases.
  [[nodiscard]] double mean() const {
    constexpr int kPhases = 4000;
    double sum = 0;
    for (int i = 0; i < kPhases; ++i) {
      sum += reflectance(2 * kPi * (i + 0.5) / kPhases) / kPhases;
    }
    return sum;
  }
  // What the mean leaves, under a Gaussian over wave numbers in 1/m, whose weight and width the paper's fit gives.
  [[nodiscard]] double under(double value, double position, double variance) const {
    constexpr int kSteps = 20000;
    const double sigma = std::sqrt(2 * variance);
    const double flat = mean();
    double sum = 0;
    for (int i = 0; i < kSteps; ++i) {
      const double x = -8 + 16 * (i + 0.5) / kSteps;
      const double phase = 2 * kPi * path_nm * 1e-9 * (position + x * sigma);
      sum += std::exp(-0.5 * x * x) * (reflectance(phase) - flat);
    }
    return value * std::sqrt(2 * kPi * variance) / 1.0685e-7 * sum * 16 / kSteps / std::sqrt(2 * kPi);
  }
  [[nodiscard]] Vec3d rgb() const {
    const double x = under(5.4856e-13, 1.6810e6, 4.3278e9) + under(9.7470e-14, 2.2399e6, 4.5282e9);
    const double y = under(4.4201e-13, 1.7953e6, 9.3046e9);
    const double z = under(5.2481e-13, 2.2084e6, 6.6121e9);
    const double flat = mean();
    return {flat + 3.2404542 * x - 1.5371385 * y - 0.4985314 * z, flat - 0.9692660 * x + 1.8760108 * y + 0.0415560 * z,
            flat + 0.0556434 * x - 0.2040259 * y + 1.0572252 * z};
  }
  // Most that the terms beyond the second add to a channel: the largest row of the matrix sums to 5.3.
  [[nodiscard]] double truncated() const {
    const double ratio = std::fabs(r12 * r23);
    const double pass = 1 - r12 * r12;
    const double first = std::fabs(pass * pass * r23 * r23 / (1 - ratio * ratio) - pass);
    return 5.3 * 2 * first * std::pow(ratio, 3) / (1 - ratio);
  }
};

TEST(ThinFilm, IsAirysSumOverThePapersGaussians) {
  int exact = 0;
  for (const double ior : {1.2, 1.33, 1.8, 2.5}) {
    for (const double thickness_nm : {60.0, 200.0, 437.0, 900.0}) {
      for (const double cosine : {1.0, 0.7, 0.3}) {
        for (const double f0 : {0.0, 0.04, 0.3, 0.8}) {
          const AiryFilm airy(cosine, ior, thickness_nm, f0);
          const Vec3d sum = airy.rgb();
          const auto base = static_cast<float>(f0);
          const Vec3f shown = thin_film_fresnel(static_cast<float>(cosine), static_cast<float>(ior),
                                                static_cast<float>(thickness_nm), {base, base, base});
          const double bound = 2e-4 + airy.truncated();
          exact += bound < 1e-3 ? 1 : 0;
          EXPECT_NEAR(shown.x, std::clamp(sum.x, 0.0, 1.0), bound)
              << ior << ' ' << thickness_nm << ' ' << cosine << ' ' << f0;
          EXPECT_NEAR(shown.y, std::clamp(sum.y, 0.0, 1.0), bound)
              << ior << ' ' << thickness_nm << ' ' << cosine << ' ' << f0;
          EXPECT_NEAR(shown.z, std::clamp(sum.z, 0.0, 1.0), bound)
              << ior << ' ' << thickness_nm << ' ' << cosine << ' ' << f0;
        }
      }
    }
  }
  EXPECT_GT(exact, 40);
}

// A film without thickness, and one of air, show the base's own Schlick reflectance.
TEST(ThinFilm, VanishesWithItsThicknessAndItsIndex) {
  const Vec3f base{0.04F, 0.3F, 0.8F};
  for (const float cosine : {1.0F, 0.6F, 0.2F}) {
    const float rise = schlick_weight(cosine);
    const Vec3f expected = base + (Vec3f{1, 1, 1} - base) * rise;
    for (const Vec2f& film :
         {Vec2f{1, 0}, Vec2f{1.3F, 0}, Vec2f{2, 0}, Vec2f{2.5F, 0}, Vec2f{1, 100}, Vec2f{1, 400}, Vec2f{1, 1200}}) {
      const Vec3f bare = thin_film_fresnel(cosine, film.x, film.y, base);
      EXPECT_NEAR(bare.x, expected.x, 1e-5F) << film.x << ' ' << film.y << ' ' << cosine;
      EXPECT_NEAR(bare.y, expected.y, 1e-5F) << film.x << ' ' << film.y << ' ' << cosine;
      EXPECT_NEAR(bare.z, expected.z, 1e-5F) << film.x << ' ' << film.y << ' ' << cosine;
    }
  }
}

TEST(ThinFilm, HasItsLimits) {
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
}  // namespace gazetrace::lobes_test
