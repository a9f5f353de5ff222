// SPDX-License-Identifier: Apache-2.0
// The surface model of src/material written a second time, in double precision and by other methods: Lambda functions
// instead of Smith lengths, and quadrature over the normal distribution instead of visible normals. It shares nothing
// with the library except the positions of the table's nodes, which are part of the model.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

#include "gazetrace/material.hpp"
#include "gazetrace/math.hpp"

namespace gazetrace::test {

inline constexpr std::size_t kReferenceNodes = 32;
inline constexpr double kReferenceAlphaMin = 5e-4;

struct ReferenceSurface {
  Vec3d base_color;
  double metallic = 0;
  double roughness = 0;
  DiffuseModel diffuse = DiffuseModel::burley;
};

inline double pow5(double x) {
  return x * x * x * x * x;
}

struct ReferenceGgx {
  double alpha;
  explicit ReferenceGgx(double roughness) : alpha(std::max(roughness * roughness, kReferenceAlphaMin)) {}

  // Walter et al. 2007, eq. 33.
  [[nodiscard]] double distribution(const Vec3d& h) const {
    const double tan2 = (h.x * h.x + h.y * h.y) / (h.z * h.z);
    const double base = 1 + tan2 / (alpha * alpha);
    return 1 / (kPi * alpha * alpha * std::pow(h.z, 4) * base * base);
  }
  [[nodiscard]] double lambda(double cosine) const {
    const double tan2 = std::max(1 - cosine * cosine, 0.0) / (cosine * cosine);
    return 0.5 * (std::sqrt(1 + alpha * alpha * tan2) - 1);
  }
  [[nodiscard]] double masking(double o, double i) const { return 1 / (1 + lambda(o) + lambda(i)); }
  [[nodiscard]] double lobe(const Vec3d& o, const Vec3d& i) const {
    return distribution(normalize(o + i)) * masking(o.z, i.z) / (4 * o.z * i.z);
  }

  // The half-vector for a point (xi, turns) of the unit square, over which D h.z times solid angle is uniform; `odds`
  // is xi / (1 - xi).
  [[nodiscard]] Vec3d normal_at(double odds, double turns) const {
    const double tan2 = alpha * alpha * odds;
    const double z = 1 / std::sqrt(1 + tan2);
    const double r = std::sqrt(tan2) * z;
    return {r * std::cos(2 * kPi * turns), r * std::sin(2 * kPi * turns), z};
  }

  // Integrals of the lobe times cosine without Fresnel, and with (1 - v.h)^5. xi = t^3 (10 - 15 t + 6 t^2) crowds nodes
  // at both ends of the distribution.
  [[nodiscard]] std::array<double, 2> albedo(double mu, int rings = 400, int azimuths = 32) const {
    if (mu < 1e-9) {
      mu = 1e-9;  // the limit, where everything is masked except forward reflection
    }
    const Vec3d o{std::sqrt(1 - mu * mu), 0, mu};
    double e = 0;
    double b = 0;
    for (int j = 0; j < rings; ++j) {
      const double t = (j + 0.5) / rings;
      const double xi = t * t * t * (10 - 15 * t + 6 * t * t);
      const double weight = 30 * t * t * (1 - t) * (1 - t);
      for (int k = 0; k < azimuths; ++k) {
        const Vec3d h = normal_at(xi / (1 - xi), 0.5 * (k + 0.5) / azimuths);
        const double oh = dot(o, h);
        const Vec3d i = h * (2 * oh) - o;
        if (oh <= 0 || i.z <= 0) {
          continue;
        }
        const double value = weight * masking(o.z, i.z) * oh / (o.z * h.z);
        e += value;
        b += value * pow5(1 - oh);
      }
    }
    const double n = static_cast<double>(rings) * azimuths;
    return {e / n, b / n};
  }
};

// One row of the tables of the model.
struct ReferenceRow {
  std::array<double, kReferenceNodes> e{}, b{}, lambert{}, burley{};
  double e_average = 0;

  static double node(std::size_t k) {
    const double x = static_cast<double>(k) / (kReferenceNodes - 1);
    return x * x;
  }
  static double at(const std::array<double, kReferenceNodes>& values, double mu) {
    const double x = std::sqrt(mu) * (kReferenceNodes - 1);
    const auto k = std::min(static_cast<std::size_t>(x), kReferenceNodes - 2);
    const double f = x - static_cast<double>(k);
    return values[k] + (values[k + 1] - values[k]) * f;
  }
  // 2 * integral of f(mu) mu dmu by Simpson's rule in x = sqrt(mu), with the nodes of the table among its points.
  template <class F>
  static double cosine_mean(const F& f) {
    constexpr int kSteps = 8 * (kReferenceNodes - 1);
    double sum = 0;
    for (int i = 0; i <= kSteps; ++i) {
      const double x = static_cast<double>(i) / kSteps;
      const double w = i == 0 || i == kSteps ? 1 : (i % 2 == 1 ? 4 : 2);
      sum += w * 4 * x * x * x * f(x * x);
    }
    return sum / (3 * kSteps);
  }
  static double repeated(double f0, double e_mean) {
    const double f = f0 + (1 - f0) / 21;
    const double lost = 1 - e_mean;
    return f * f * e_mean / (1 - f * lost) / (1 + 1e-6 / (lost * lost));
  }
  [[nodiscard]] double passed(std::size_t k) const {
    return 1 - (0.04 * (e[k] - b[k]) + b[k] + (1 - e[k]) * repeated(0.04, e_average));
  }
  // The mean of Burley's product over the azimuth, by brute force.
  static double burley_mean(double roughness, double mu_o, double mu_i) {
    constexpr int kAzimuths = 16;  // which is exact for a trigonometric polynomial of degree 2
    const double sines = std::sqrt((1 - mu_o * mu_o) * (1 - mu_i * mu_i));
    double sum = 0;
    for (int k = 0; k < kAzimuths; ++k) {
      const double o_dot_i = mu_o * mu_i + sines * std::cos(2 * kPi * k / kAzimuths);
      const double fd90 = 0.5 + 2 * roughness * (0.5 * (1 + o_dot_i));
      sum += (1 + (fd90 - 1) * pow5(1 - mu_o)) * (1 + (fd90 - 1) * pow5(1 - mu_i));
    }
    return sum / kAzimuths;
  }

  explicit ReferenceRow(double roughness, bool with_burley = true) {
    const ReferenceGgx ggx(roughness);
    for (std::size_t k = 0; k < kReferenceNodes; ++k) {
      const auto [ek, bk] = ggx.albedo(node(k));
      e[k] = ek;
      b[k] = bk;
    }
    e_average = cosine_mean([&](double mu) { return at(e, mu); });
    std::array<double, kReferenceNodes> rest{};
    for (std::size_t k = 0; k < kReferenceNodes; ++k) {
      rest[k] = std::max(passed(k), 0.0);
    }
    const double mean = cosine_mean([&](double mu) { return at(rest, mu); });
    for (std::size_t k = 0; k < kReferenceNodes; ++k) {
      lambert[k] = rest[k] / std::sqrt(mean);
    }
    burley = lambert;
    for (int iteration = 0; with_burley && iteration < 60; ++iteration) {
      const auto last = burley;
      for (std::size_t k = 0; k < kReferenceNodes; ++k) {
        const double integral =
            cosine_mean([&](double mu) { return at(last, mu) * burley_mean(roughness, node(k), mu); });
        burley[k] = std::sqrt(last[k] * rest[k] / integral);
      }
    }
  }
};

// The model at one surface, blended from the two rows around its roughness.
class ReferenceBsdf {
 public:
  explicit ReferenceBsdf(const ReferenceSurface& surface) : surface_(surface), ggx_(surface.roughness) {
    const double y = surface.roughness * (kReferenceNodes - 1);
    const double row = std::min(std::floor(y), kReferenceNodes - 2.0);
    fraction_ = y - row;
    const bool burley = surface.diffuse == DiffuseModel::burley;
    low_.emplace_back(row / (kReferenceNodes - 1), burley);
    high_.emplace_back((row + 1) / (kReferenceNodes - 1), burley);
  }

  // f without the cosine.
  [[nodiscard]] Vec3d value(const Vec3d& o, const Vec3d& i) const {
    const double oh = dot(o, normalize(o + i));
    const double d = 1 - surface_.metallic;
    const Vec3d f0 = Vec3d{0.04, 0.04, 0.04} * d + surface_.base_color * surface_.metallic;
    const Vec3d single = (f0 + (Vec3d{1, 1, 1} - f0) * pow5(1 - oh)) * ggx_.lobe(o, i);
    const double em = mean();
    const Vec3d multiple = repeats(em) * ((1 - e(o.z)) * (1 - e(i.z)) / (kPi * (1 - em)));
    double shape = 1;
    if (surface_.diffuse == DiffuseModel::burley) {
      const double cos_d = dot(i, normalize(o + i));
      const double t = 0.5 + 2 * surface_.roughness * cos_d * cos_d - 1;
      shape = (1 + t * pow5(1 - o.z)) * (1 + t * pow5(1 - i.z));
    }
    return single + multiple + surface_.base_color * (d / kPi * scale(o.z) * scale(i.z) * shape);
  }

  // The reflected share of uniform light, by quadrature.
  [[nodiscard]] Vec3d albedo(double mu) const {
    const auto [e1, b1] = ggx_.albedo(mu, 1200, 128);
    const double d = 1 - surface_.metallic;
    const Vec3d f0 = Vec3d{0.04, 0.04, 0.04} * d + surface_.base_color * surface_.metallic;
    const double em = mean();
    const double spread = ReferenceRow::cosine_mean([&](double m) { return 1 - e(m); });
    const double diffuse = scale(mu) * ReferenceRow::cosine_mean([&](double m) {
                             return scale(m) * (surface_.diffuse == DiffuseModel::burley
                                                    ? ReferenceRow::burley_mean(surface_.roughness, mu, m)
                                                    : 1.0);
                           });
    return f0 * (e1 - b1) + Vec3d{b1, b1, b1} + repeats(em) * ((1 - e(mu)) * spread / (1 - em)) +
           surface_.base_color * (d * diffuse);
  }

  [[nodiscard]] const ReferenceGgx& ggx() const { return ggx_; }

 private:
  [[nodiscard]] double blend(double a, double b) const { return a + (b - a) * fraction_; }
  [[nodiscard]] double e(double mu) const {
    return blend(ReferenceRow::at(low_[0].e, mu), ReferenceRow::at(high_[0].e, mu));
  }
  [[nodiscard]] double mean() const { return blend(low_[0].e_average, high_[0].e_average); }
  [[nodiscard]] double scale(double mu) const {
    return surface_.diffuse == DiffuseModel::burley
               ? blend(ReferenceRow::at(low_[0].burley, mu), ReferenceRow::at(high_[0].burley, mu))
               : blend(ReferenceRow::at(low_[0].lambert, mu), ReferenceRow::at(high_[0].lambert, mu));
  }
  [[nodiscard]] Vec3d repeats(double em) const {
    const double dielectric = ReferenceRow::repeated(0.04, em) * (1 - surface_.metallic);
    const Vec3d& c = surface_.base_color;
    const double m = surface_.metallic;
    return {m * ReferenceRow::repeated(c.x, em) + dielectric, m * ReferenceRow::repeated(c.y, em) + dielectric,
            m * ReferenceRow::repeated(c.z, em) + dielectric};
  }

  ReferenceSurface surface_;
  ReferenceGgx ggx_;
  double fraction_ = 0;
  std::vector<ReferenceRow> low_, high_;
};

}  // namespace gazetrace::test
