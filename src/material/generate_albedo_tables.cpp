// SPDX-License-Identifier: Apache-2.0
// A build-time program that writes the tables of albedo_tables.hpp as a C++ source to the file named on its command
// line.
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <vector>

#include "material/albedo_tables.hpp"
#include "material/lobes/sheen.hpp"
#include "material/microfacet.hpp"

namespace gazetrace {
namespace {

constexpr std::size_t kNodes = kAlbedoNodes;
using Row = std::array<double, kNodes>;

struct Quadrature {
  std::vector<double> x, w;
};

double node_mu(std::size_t k) {
  const double x = static_cast<double>(k) / (kNodes - 1);
  return x * x;
}

// Averages of G2 / G1 and of G2 / G1 (1 - v.h)^5 over visible normals, by the midpoint rule over half of the unit
// square (the other half of the azimuth is a mirror image). A quintic crowds points at both ends of u.y: the centre of
// the lobe, and its tail of steep facets, which lies within alpha^2 of 1.
void lobe_albedo(double mu, double roughness, double& e, double& b) {
  constexpr int kAzimuths = 48;
  constexpr int kRings = 256;
  const double alpha = alpha_of_roughness(roughness);
  const Vec3d wo{std::sqrt(1 - mu * mu), 0, mu};
  const double smith_o = smith_length(wo.z, alpha * alpha);
  e = 0;
  b = 0;
  for (int i = 0; i < kAzimuths; ++i) {
    for (int j = 0; j < kRings; ++j) {
      const double t = (j + 0.5) / kRings;
      const double ring = t * t * t * (10 - 15 * t + 6 * t * t);
      const Vec3d h = sample_visible_normal(wo, alpha, Vec2d{0.5 * (i + 0.5) / kAzimuths, ring});
      const Vec3d wi = reflect(wo, h);
      if (wi.z <= 0) {
        continue;
      }
      const double smith_i = smith_length(wi.z, alpha * alpha);
      const double g = wi.z * (wo.z + smith_o) / (wo.z * smith_i + wi.z * smith_o) * 30 * t * t * (1 - t) * (1 - t);
      e += g;
      b += g * schlick_weight(dot(wo, h));
    }
  }
  e /= kAzimuths * kRings;
  b /= kAzimuths * kRings;
}

// Points and weights for 2 * integral of f(mu) mu dmu, for each interval between nodes of x = sqrt(mu); exact for f
// linear in x (Gauss-Legendre with four points; the integrand is 4 f x^3 dx).
Quadrature cosine_quadrature() {
  constexpr std::array<double, 4> kX{-0.861136311594052575, -0.339981043584856265, 0.339981043584856265,
                                     0.861136311594052575};
  constexpr std::array<double, 4> kW{0.347854845137453857, 0.652145154862546143, 0.652145154862546143,
                                     0.347854845137453857};
  Quadrature q;
  const double step = 1.0 / (kNodes - 1);
  for (std::size_t k = 0; k + 1 < kNodes; ++k) {
    for (std::size_t i = 0; i < kX.size(); ++i) {
      const double x = (static_cast<double>(k) + 0.5 * (1 + kX[i])) * step;
      q.x.push_back(x);
      q.w.push_back(0.5 * step * kW[i] * 4 * x * x * x);
    }
  }
  return q;
}

double interpolate(const Row& row, double x) {
  const double at = x * (kNodes - 1);
  const auto k = static_cast<std::size_t>(std::min(std::floor(at), kNodes - 2.0));
  const double f = at - static_cast<double>(k);
  return row[k] * (1 - f) + row[k + 1] * f;
}

double cosine_average(const Quadrature& q, const Row& row) {
  double sum = 0;
  for (std::size_t i = 0; i < q.x.size(); ++i) {
    sum += q.w[i] * interpolate(row, q.x[i]);
  }
  return sum;
}

// Burley's shape averaged over azimuth: with t = p + q cos(phi), the mean of (1 + t a) (1 + t c) is
// 1 + p (a + c) + a c (p^2 + q^2 / 2).
double burley_azimuth_mean(double roughness, double mu_o, double mu_i) {
  const double p = roughness * (1 + mu_o * mu_i) - 0.5;
  const double q2 = roughness * roughness * (1 - mu_o * mu_o) * (1 - mu_i * mu_i);
  const double a = schlick_weight(mu_o);
  const double c = schlick_weight(mu_i);
  return 1 + p * (a + c) + a * c * (p * p + 0.5 * q2);
}

// Finds s with s(o) * integral s(i) kernel(o, i) = target(o) at the nodes: symmetric Sinkhorn balancing (Knight, Ruiz
// and Ucar 2014). Converges geometrically for a positive kernel.
Row balance_burley(const Quadrature& q, double roughness, const Row& target) {
  Row s;
  s.fill(1);
  for (int iteration = 0; iteration < 200; ++iteration) {
    Row next{};
    for (std::size_t k = 0; k < kNodes; ++k) {
      double integral = 0;
      for (std::size_t i = 0; i < q.x.size(); ++i) {
        integral += q.w[i] * interpolate(s, q.x[i]) * burley_azimuth_mean(roughness, node_mu(k), q.x[i] * q.x[i]);
      }
      next[k] = std::sqrt(s[k] * target[k] / integral);
    }
    s = next;
  }
  return s;
}

// Integral of the sheen lobe times cosine, by the midpoint rule over the hemisphere with nodes crowded at the horizon.
// `raw` is the same integral without any gain; nullptr to compute that one.
double sheen_lobe_albedo(double mu, double roughness, const Row* raw) {
  constexpr int kRings = 96;
  constexpr int kAzimuths = 96;
  const double alpha = sheen_alpha(roughness);
  const double z = std::max(mu, 1e-4);
  const Vec3d wo{std::sqrt(1 - z * z), 0, z};
  const double raw_o = raw == nullptr ? 1 : interpolate(*raw, std::sqrt(mu));
  double sum = 0;
  for (int j = 0; j < kRings; ++j) {
    const double t = (j + 0.5) / kRings;
    const double cosine = t * t;
    const double gain = raw == nullptr ? 1 : sheen_gain(raw_o, interpolate(*raw, t));
    for (int i = 0; i < kAzimuths; ++i) {
      const double phi = kPi * (i + 0.5) / kAzimuths;
      const double sine = std::sqrt(1 - cosine * cosine);
      const Vec3d wi{sine * std::cos(phi), sine * std::sin(phi), cosine};
      sum += gain * sheen_value(wo, wi, alpha) * cosine * 2 * t;
    }
  }
  return sum * 2 * kPi / (kRings * kAzimuths);
}

void write_row(std::FILE* out, const Row& row) {
  std::fputs("{", out);
  for (const double value : row) {
    std::fprintf(out, "%.9eF, ", value);
  }
  std::fputs("}", out);
}

bool write_tables(std::FILE* out) {
  const Quadrature q = cosine_quadrature();
  Row averages{};
  Row b_averages{};
  Row sheen_averages{};
  std::fputs("// Written by generate_albedo_tables.\n#include \"material/albedo_tables.hpp\"\n\n", out);
  std::fputs("namespace gazetrace {\n\nconst AlbedoTables kAlbedoTables{{{\n", out);
  for (std::size_t j = 0; j < kNodes; ++j) {
    const double roughness = static_cast<double>(j) / (kNodes - 1);
    Row e{};
    Row b{};
    for (std::size_t k = 0; k < kNodes; ++k) {
      lobe_albedo(node_mu(k), roughness, e[k], b[k]);
    }
    averages[j] = cosine_average(q, e);
    b_averages[j] = cosine_average(q, b);
    const double f0 = kDielectricF0;
    const double f = f0 + (1 - f0) / 21;
    const double repeats = repeated_share(1 - averages[j]) * f * f * averages[j] / (1 - f * (1 - averages[j]));
    Row passed{};  // what the specular lobes of a dielectric leave for the diffuse lobe
    for (std::size_t k = 0; k < kNodes; ++k) {
      passed[k] = 1 - (f0 * (e[k] - b[k]) + b[k] + (1 - e[k]) * repeats);
      passed[k] = std::max(passed[k], 0.0);
    }
    const double lambert_scale = 1 / std::sqrt(cosine_average(q, passed));
    const Row burley = balance_burley(q, roughness, passed);
    std::fputs("    {{", out);
    for (std::size_t k = 0; k < kNodes; ++k) {
      std::fprintf(out, "{%.9eF, %.9eF, %.9eF, %.9eF},\n      ", e[k], b[k], passed[k] * lambert_scale, burley[k]);
    }
    std::fputs("}},\n", out);
  }
  std::fputs("}},\n  {", out);
  write_row(out, averages);
  std::fputs("},\n  {", out);
  write_row(out, b_averages);
  std::fputs("},\n  {{\n", out);
  for (std::size_t j = 0; j < kNodes; ++j) {
    const double roughness = static_cast<double>(j) / (kNodes - 1);
    Row raw{};
    for (std::size_t k = 0; k < kNodes; ++k) {
      raw[k] = sheen_lobe_albedo(node_mu(k), roughness, nullptr);
    }
    Row kept{};
    std::fputs("    {{", out);
    for (std::size_t k = 0; k < kNodes; ++k) {
      kept[k] = sheen_lobe_albedo(node_mu(k), roughness, &raw);
      std::fprintf(out, "{%.9eF, %.9eF}, ", raw[k], kept[k]);
    }
    std::fputs("}},\n", out);
    sheen_averages[j] = cosine_average(q, kept);
  }
  std::fputs("  }},\n  {", out);
  write_row(out, sheen_averages);
  std::fputs("}};\n\n}  // namespace gazetrace\n", out);
  return std::ferror(out) == 0;
}

}  // namespace
}  // namespace gazetrace

int main(int argc, char** argv) {
  std::FILE* out = argc == 2 ? std::fopen(argv[1], "w") : nullptr;
  if (out == nullptr) {
    std::fputs("usage: generate_albedo_tables OUTPUT.cpp\n", stderr);
    return 2;
  }
  const bool written = gazetrace::write_tables(out);
  return std::fclose(out) == 0 && written ? 0 : 3;
}
