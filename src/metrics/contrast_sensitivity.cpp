// SPDX-License-Identifier: Apache-2.0
#include "metrics/contrast_sensitivity.hpp"

#include <algorithm>
#include <cmath>

#include "gazetrace/math.hpp"

namespace gazetrace {
namespace {

constexpr double kSustainedHz = 0;
constexpr double kTransientHz = 5;

// Spatio-velocity sensitivity (Daly 1998; constants of Laird et al. 2006).
double spatio_velocity(double r_cpd, double omega_hz) {
  constexpr double kC0 = 0.6329;
  constexpr double kC1 = 0.8404;
  constexpr double kC2 = 0.7986;
  constexpr double kLeastVelocity = 0.1;  // drift of the eye, deg/s
  const double v = std::max(omega_hz / r_cpd, kLeastVelocity);
  const double k = 6.1 + 7.3 * std::pow(std::fabs(std::log10(kC2 * v / 3)), 3);
  const double r_max = 45.9 / (kC2 * v + 2);
  const double angular = 2 * kPi * kC1 * r_cpd;
  return k * kC0 * kC1 * kC2 * v * angular * angular * std::exp(-2 * angular / r_max);
}

// One mechanism of the spatio-chromatic sensitivity (Wuerger et al. 2020), with the stimulus-size model of Rovamo et
// al. 1993.
struct Mechanism {
  double peak, peak_cpd, bandwidth, gamma, c;
  bool low_pass;
};

double mechanism_response(const Mechanism& m, double r_cpd, double area) {
  const double distance = std::log10(r_cpd) - std::log10(m.peak_cpd);
  const bool plateau = m.low_pass && r_cpd < m.peak_cpd;
  const double parabola = plateau ? 1 : std::pow(10, -distance * distance / (0.5 * std::exp2(m.bandwidth)));
  const double a = std::pow(area, m.gamma) * r_cpd * r_cpd;
  return m.peak * parabola * std::sqrt(a / (m.c + 0.65 * area + a));
}

}  // namespace

double contrast_sensitivity(double rho_cpd, double omega_hz, double luminance_cd_m2, double eccentricity_deg) {
  // Relative cortical magnification (Dougherty et al. 2003) converts frequency and size to their foveal equivalents.
  constexpr double kHalfDeg = 3.67;
  const double magnification = std::pow(kHalfDeg / (eccentricity_deg + kHalfDeg), 0.604562);
  const double r = rho_cpd / magnification;
  const double radius_deg = 1.5 / rho_cpd * magnification;
  const double area = kPi * radius_deg * radius_deg;
  const double temporal = spatio_velocity(r, omega_hz) / (spatio_velocity(r, 0) + 1e-5);

  const double cones = 1.05102777 * luminance_cd_m2;  // L + M response to D65
  const auto rise = [cones](double p1, double p2, double p3) { return p1 * std::pow(1 + p2 / cones, -p3); };
  const auto fall = [cones](double p4, double p5) { return 1 - std::pow(1 + p4 / cones, -p5); };
  const Mechanism achromatic{rise(356404, 6.2726, 0.320031) * fall(895943, 7.77919e-5),
                             rise(2.3021, 3317.45, 0.186215),
                             1.07516,
                             1.1107,
                             52.9768,
                             false};
  const Mechanism red_green{rise(423.978, 15.4032, 0.50343), 0.122699, 2.70669, 1.72903, 1.38437, true};
  const Mechanism blue_yellow{rise(11811.9, 196.342, 0.339396), 7.1099e-8, 5.3416, 1.47263, 0.282573, true};
  // The response of each mechanism to an achromatic contrast of D65.
  const double s1 = 1.25886094 * mechanism_response(achromatic, r, area);
  const double s2 = 0.06546161 * mechanism_response(red_green, r, area);
  const double s3 = 0.16614262 * mechanism_response(blue_yellow, r, area);
  const double spatial = std::sqrt(s1 * s1 + s2 * s2 + s3 * s3);
  return std::max(spatial * temporal, 1e-4);
}

namespace {

constexpr double kLeastLog2Rho = -4;
constexpr double kMostLog2Rho = 6;
constexpr double kLeastLuminance = 1e-3;
constexpr double kMostLuminance = 1e4;
constexpr double kMostEccentricityDeg = 120;

}  // namespace

const SensitivityTable& SensitivityTable::get() {
  static const SensitivityTable kTable;
  return kTable;
}

SensitivityTable::SensitivityTable() : nodes_(kSize * kSize * kSize) {
  const auto along = [](double from, double to, std::size_t i) {
    return from + (to - from) * static_cast<double>(i) / static_cast<double>(kSize - 1);
  };
  for (std::size_t l = 0; l < kSize; ++l) {
    const double luminance = std::exp2(along(std::log2(kLeastLuminance), std::log2(kMostLuminance), l));
    for (std::size_t r = 0; r < kSize; ++r) {
      const double rho = std::exp2(along(kLeastLog2Rho, kMostLog2Rho, r));
      for (std::size_t e = 0; e < kSize; ++e) {
        const double root = along(0, std::sqrt(kMostEccentricityDeg), e);
        nodes_[(l * kSize + r) * kSize + e] = {
            static_cast<float>(std::log2(contrast_sensitivity(rho, kSustainedHz, luminance, root * root))),
            static_cast<float>(std::log2(contrast_sensitivity(rho, kTransientHz, luminance, root * root)))};
      }
    }
  }
}

std::array<float, 2> SensitivityTable::log2_sensitivity(const Query& query) const {
  constexpr auto kLast = static_cast<float>(kSize - 1);
  static const auto kLeastLog2L = static_cast<float>(std::log2(kLeastLuminance));
  static const auto kPerLog2L = static_cast<float>(kLast / (std::log2(kMostLuminance) - std::log2(kLeastLuminance)));
  static const auto kPerRoot = static_cast<float>(kLast / std::sqrt(kMostEccentricityDeg));
  constexpr auto kPerLog2Rho = static_cast<float>(kLast / (kMostLog2Rho - kLeastLog2Rho));
  const auto limited = [last = kLast](float v) { return std::min(std::max(v, 0.0F), last); };
  const float l = limited((query.log2_luminance - kLeastLog2L) * kPerLog2L);
  const float r = limited((query.log2_rho - static_cast<float>(kLeastLog2Rho)) * kPerLog2Rho);
  const float e = limited(query.sqrt_eccentricity * kPerRoot);
  const auto cell = [last = kSize - 2](float v) { return std::min(static_cast<std::size_t>(v), last); };
  const std::size_t li = cell(l);
  const std::size_t ri = cell(r);
  const std::size_t ei = cell(e);
  const float lf = l - static_cast<float>(li);
  const float rf = r - static_cast<float>(ri);
  const float ef = e - static_cast<float>(ei);
  const Node* at = &nodes_[(li * kSize + ri) * kSize + ei];
  const auto mix = [](const Node& a, const Node& b, float f) {
    return Node{a.sustained + f * (b.sustained - a.sustained), a.transient + f * (b.transient - a.transient)};
  };
  const auto plane = [&](const Node* p) { return mix(mix(p[0], p[1], ef), mix(p[kSize], p[kSize + 1], ef), rf); };
  const Node value = mix(plane(at), plane(at + kSize * kSize), lf);
  return {value.sustained, value.transient};
}

}  // namespace gazetrace
