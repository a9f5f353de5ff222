// SPDX-License-Identifier: Apache-2.0
// Furnaces over the parameters of one extension, and over pairs of extensions: what white surfaces return of even light
// from all around. layered_albedo_test has one point of each; the bounds here are the extremes of the sweeps, rounded
// outwards, and say how far the model is from exact.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include "support/layered_furnace.hpp"
#include "support/layered_kinds.hpp"

namespace gazetrace::layered_furnace_test {
namespace {

using test::layered;
using test::layered_albedo;

constexpr std::array kRoughness{0.0F, 0.1F, 0.3F, 0.5F, 1.0F};
constexpr std::array kCosines{0.02F, 0.1F, 0.3F, 1.0F};

// The least and the most of three channels, over dielectric and metal, roughness and cosine.
struct Extremes {
  double least = 9, most = 0;
  std::string least_at, most_at;

  // Seen from the side (x, y), of length 1.
  void sweep(const std::string& name, const std::function<void(LayeredSurface&)>& dress, float x = 0.8F,
             float y = 0.6F) {
    for (const float metallic : {0.0F, 1.0F}) {
      for (const float roughness : kRoughness) {
        LayeredSurface s = layered(metallic, roughness);
        dress(s);
        for (const float cosine : kCosines) {
          const float sine = std::sqrt(1 - cosine * cosine);
          const Vec3f wo{x * sine, y * sine, cosine};
          Vec3d albedo = layered_albedo(s, wo, 1U << 11U);
          if (std::max({albedo.x, albedo.y, albedo.z}) > 1.008) {  // rare heavy weights, or true?
            albedo = layered_albedo(s, wo, 1U << 14U);
          }
          std::string at = name + " roughness " + std::to_string(roughness);
          at += " metallic " + std::to_string(metallic) + " cosine " + std::to_string(cosine);
          add(albedo, at);
        }
      }
    }
  }
  void add(const Vec3d& albedo, const std::string& at) {
    const double low = std::min({albedo.x, albedo.y, albedo.z});
    const double high = std::max({albedo.x, albedo.y, albedo.z});
    least_at = low < least ? at : least_at;
    least = std::min(least, low);
    most_at = high > most ? at : most_at;
    most = std::max(most, high);
  }
  void expect(double at_least, double at_most) const {
    testing::Test::RecordProperty("least " + least_at, std::to_string(least));
    testing::Test::RecordProperty("most " + most_at, std::to_string(most));
    EXPECT_GE(least, at_least) << least_at;
    EXPECT_LE(most, at_most) << most_at;
  }
};

// One Schlick reflectance stands in for a film when the diffuse light below is scaled: with a film of a high index over
// a dielectric up to 40 % of one channel is lost, and 5.5 % made.
TEST(LayeredFurnaces, FilmsOfEveryIndexAndThickness) {
  Extremes moderate;
  Extremes all;
  for (const float ior : {1.0F, 1.3F, 1.8F, 2.5F}) {
    for (const float thickness_nm : {0.0F, 100.0F, 250.0F, 400.0F, 700.0F}) {
      const std::string name = std::to_string(ior) + " of " + std::to_string(thickness_nm) + " nm";
      const auto dress = [&](LayeredSurface& s) {
        s.film = 1;
        s.film_ior = ior;
        s.film_thickness_nm = thickness_nm;
      };
      all.sweep(name, dress);
      if (ior < 1.5F) {
        moderate.sweep(name, dress);
      }
    }
  }
  moderate.expect(0.82, 1.02);
  all.expect(0.60, 1.06);
}

TEST(LayeredFurnaces, CoatsOfEveryRoughness) {
  Extremes found;
  for (const float factor : {0.3F, 1.0F}) {
    for (const float roughness : {0.0F, 0.03F, 0.1F, 0.3F, 1.0F}) {
      found.sweep(std::to_string(factor) + " of " + std::to_string(roughness), [&](LayeredSurface& s) {
        s.clearcoat = factor;
        s.clearcoat_roughness = roughness;
      });
    }
  }
  found.expect(0.93, 1.015);
}

TEST(LayeredFurnaces, SheenOfEveryRoughness) {
  Extremes found;
  for (const float color : {0.3F, 1.0F}) {
    for (const float roughness : {0.0F, 0.1F, 0.2F, 0.3F, 0.6F, 1.0F}) {
      found.sweep(std::to_string(color) + " of " + std::to_string(roughness), [&](LayeredSurface& s) {
        s.sheen_color = {color, color, color};
        s.sheen_roughness = roughness;
      });
    }
  }
  found.expect(0.92, 1.018);
}

// Their repeated scattering reads the isotropic table at the mean of both slopes: near the horizon it returns too
// little along one of them and too much along the other.
TEST(LayeredFurnaces, AnisotropicBodies) {
  for (const bool inside : {false, true}) {
    Extremes found;
    for (const float anisotropy : {0.3F, 0.8F, 1.0F}) {
      for (const float azimuth : {0.0F, 0.7F, 1.571F}) {
        const auto dress = [&](LayeredSurface& s) {
          s.transmission = 1;
          s.solid = true;
          s.inside = inside;
          s.dielectric = &test::glass_albedo();
          s.anisotropy = anisotropy;
        };
        found.sweep(std::to_string(anisotropy) + " from " + std::to_string(azimuth), dress, std::cos(azimuth),
                    std::sin(azimuth));
      }
    }
    found.expect(inside ? 0.70 : 0.62, inside ? 1.20 : 1.07);
  }
}

struct Dress {
  std::string name;
  std::function<void(LayeredSurface&)> put_on;
};

void smooth_coat(LayeredSurface& s) {
  s.clearcoat = 1;
}
void rougher_coat(LayeredSurface& s) {
  s.clearcoat = 1;
  s.clearcoat_roughness = 0.2F;
}
void narrow_cloth(LayeredSurface& s) {
  s.sheen_color = {1, 1, 1};
  s.sheen_roughness = 0.3F;
}
void cloth(LayeredSurface& s) {
  s.sheen_color = {1, 1, 1};
  s.sheen_roughness = 0.6F;
}

void sweep_pairs(Extremes& found, const std::vector<Dress>& first, const std::vector<Dress>& second) {
  for (const Dress& a : first) {
    for (const Dress& b : second) {
      found.sweep(a.name + " and " + b.name, [&](LayeredSurface& s) {
        a.put_on(s);
        b.put_on(s);
      });
    }
  }
}

// Two layers each share out what is left as if the other's base were white and Lambertian.
TEST(LayeredFurnaces, CoatOverCloth) {
  Extremes found;
  sweep_pairs(found, {{"smooth coat", smooth_coat}, {"coat", rougher_coat}},
              {{"narrow cloth", narrow_cloth}, {"cloth", cloth}});
  found.expect(0.90, 1.035);
}

TEST(LayeredFurnaces, LayersOverEveryBase) {
  Extremes found;
  sweep_pairs(found,
              {{"smooth coat", smooth_coat}, {"coat", rougher_coat}, {"narrow cloth", narrow_cloth}, {"cloth", cloth}},
              {{"anisotropy", [](LayeredSurface& s) { s.anisotropy = 0.8F; }},
               {"film", [](LayeredSurface& s) { s.film = 1; }},
               {"diffuse transmission", [](LayeredSurface& s) { s.diffuse_transmission = 0.6F; }},
               {"sheet", [](LayeredSurface& s) { s.transmission = 0.7F; }},
               {"f0 of 0.2", [](LayeredSurface& s) {
                  s.f0 = {0.2F, 0.2F, 0.2F};
                }}});
  found.expect(0.90, 1.022);
}

}  // namespace
}  // namespace gazetrace::layered_furnace_test
