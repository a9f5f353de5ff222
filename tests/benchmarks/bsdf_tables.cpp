// SPDX-License-Identifier: Apache-2.0
// Furnace and reciprocity tables of every kind of material: what a white surface returns of even light from all around,
// and how far f(a, b) and f(b, a) differ.
//   gazetrace_bsdf_tables [--samples N]
// Furnace: directional albedo from N samples (weights f cos / pdf), the least and the most over cosines 0.02 .. 1,
// azimuths 0 .. 90 deg and over metalness 0, 0.5, 1, of the red channel (every kind is white there); power, where light
// passes into a body. Reciprocity: largest |f(a, b) - f(b, a)| / (f(a, b) + f(b, a) + 1e-3) over 2000 pairs of
// directions a cell, radiance over squared index where light passes into a body.
#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <limits>
#include <string_view>

#include "core/fast_math.hpp"
#include "material/layered_bsdf.hpp"
#include "support/layered_kinds.hpp"
#include "trace/samples/sampler.hpp"

namespace {

using namespace gazetrace;

using Model = LayeredBsdf;

constexpr std::array kRoughness{0.0F, 1e-4F, 0.01F, 0.1F, 0.3F, 0.6F, 1.0F};
constexpr std::array kMetalness{0.0F, 0.5F, 1.0F};
constexpr std::array kCosines{0.02F, 0.1F, 0.3F, 0.6F, 1.0F};
constexpr std::array kTurns{0.0F, 0.1F, 0.2F, 0.25F};  // of the view about the normal
constexpr SampleKey kKey = make_sample_key(12, 0, 0);

Vec3f direction(float mu, float turns) {
  const float sine = std::sqrt(std::max(1 - mu * mu, 0.0F));
  const Vec2f circle = cos_sin_2pi(turns);
  return {sine * circle.x, sine * circle.y, mu};
}

double furnace(const LayeredSurface& surface, float mu, float turns, std::uint32_t samples) {
  const Model model(surface, direction(mu, turns));
  double sum = 0;
  for (std::uint32_t i = 0; i < samples; ++i) {
    const BsdfSample chosen = model.sample(sample_2d(kKey, i, 0), sample_2d(kKey, i, 1).x);
    if (chosen.valid) {
      // Radiance thins out by the squared index on its way out of a body: what counts here is power.
      const bool bent = surface.solid && chosen.direction.z < 0;
      const double n2 = double{surface.ior} * double{surface.ior};
      sum += static_cast<double>(chosen.weight.x) * (!bent ? 1.0 : surface.inside ? 1 / n2 : n2);
    }
  }
  return sum / samples;
}

double reciprocity(const LayeredSurface& surface) {
  double worst = 0;
  for (std::uint32_t i = 0; i < 2000; ++i) {
    const Vec2f a = sample_2d(kKey, i, 3);
    const Vec2f b = sample_2d(kKey, i, 4);
    const bool through = i % 2 == 1;
    const Vec3f o = direction(0.01F + 0.99F * a.x, a.y);
    Vec3f wi = direction(0.01F + 0.99F * b.x, b.y);
    wi.z = through ? -wi.z : wi.z;
    LayeredSurface behind = surface;
    behind.inside = surface.solid && through ? !surface.inside : surface.inside;
    const Vec3f o_back = through ? Vec3f{wi.x, wi.y, -wi.z} : wi;
    const Vec3f i_back = through ? Vec3f{o.x, o.y, -o.z} : o;
    const auto n2 = [](const LayeredSurface& s) { return s.solid && s.inside ? double{s.ior} * double{s.ior} : 1.0; };
    const double there = double{Model(surface, o).evaluate(wi).f_cos.x} / std::fabs(double{wi.z}) / n2(surface);
    const double back = double{Model(behind, o_back).evaluate(i_back).f_cos.x} / double{o.z} / n2(behind);
    worst = std::max(worst, std::fabs(there - back) / (there + back + 1e-3));
  }
  return worst;
}

void print_header(const char* title) {
  fmt::print("\n{}\n{:<24}", title, "roughness");
  for (const float roughness : kRoughness) {
    fmt::print("{:>16}", roughness);
  }
  fmt::print("\n");
}

}  // namespace

int main(int argc, char** argv) {
  std::uint32_t samples = 1U << 14U;
  if (argc == 3 && std::string_view(argv[1]) == "--samples") {
    samples = static_cast<std::uint32_t>(std::strtoul(argv[2], nullptr, 10));
  }
  const std::size_t kinds = test::layered_kinds(0.5F, 0).size();
  print_header("Furnace: albedo of white surfaces, least and most");
  for (std::size_t kind = 0; kind < kinds; ++kind) {
    fmt::print("{:<24}", test::layered_kinds(0.5F, 0)[kind].name);
    for (const float roughness : kRoughness) {
      double least = std::numeric_limits<double>::infinity();
      double most = 0;
      for (const float metallic : kMetalness) {
        for (const float mu : kCosines) {
          for (const float turns : kTurns) {
            const double albedo = furnace(test::layered_kinds(roughness, metallic)[kind].surface, mu, turns, samples);
            least = std::min(least, albedo);
            most = std::max(most, albedo);
          }
        }
      }
      fmt::print("{:>16}", fmt::format("{:.3f} {:.3f}", least, most));
    }
    fmt::print("\n");
  }
  print_header("Reciprocity: largest relative difference");
  for (std::size_t kind = 0; kind < kinds; ++kind) {
    fmt::print("{:<24}", test::layered_kinds(0.5F, 0)[kind].name);
    for (const float roughness : kRoughness) {
      double worst = 0;
      for (const float metallic : kMetalness) {
        worst = std::max(worst, reciprocity(test::layered_kinds(roughness, metallic)[kind].surface));
      }
      fmt::print("{:>16.1e}", worst);
    }
    fmt::print("\n");
  }
  return 0;
}
