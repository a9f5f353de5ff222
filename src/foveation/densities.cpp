// SPDX-License-Identifier: Apache-2.0
#include "foveation/densities.hpp"

#include <cmath>

namespace gazetrace {
namespace {

// Of a model that is the same in every direction.
template <class Cutoff>
DensityModel isotropic_cutoff(const Cutoff& cutoff) {
  DensityModel model;
  model.value = [cutoff](const DensityPlace& place) { return cutoff(place.eccentricity_deg); };
  return model;
}
template <class Density>
DensityModel isotropic_density(const Density& density) {
  DensityModel model;
  model.quantity = DensityModel::Quantity::density;
  model.value = [density](const DensityPlace& place) { return density(place.eccentricity_deg); };
  return model;
}

constexpr double kFovealCpd = 60;  // acuity at the fovea, where a model does not say it

// Visual acuity relative to the fovea, after Reddy, "Perceptually Optimized 3D Graphics", IEEE CG&A 21(5), 2001:
//   M(e) = 1                       e <= 5.79 degrees
//          7.49 / (0.3 e + 1)^2    beyond
constexpr double kAcuityPlateauDeg = 5.79;
double relative_acuity(double eccentricity_deg) {
  const double root = 0.3 * eccentricity_deg + 1;
  return eccentricity_deg <= kAcuityPlateauDeg ? 1.0 : 7.49 / (root * root);
}

DensityModel acuity(const DensityArguments& /*given*/) {
  return isotropic_cutoff([](double e) { return kFovealCpd * relative_acuity(e); });
}

// Cortical magnification: A/(e + e2) mm of visual cortex per degree, with e2 = 3.67 degrees (Dougherty et al., Journal
// of Vision 3(10), 2003). Visible detail is taken to be in proportion to it: f(e) = 60 e2/(e + e2).
DensityModel cortical(const DensityArguments& /*given*/) {
  constexpr double kHalfDeg = 3.67;
  return isotropic_cutoff([](double e) { return kFovealCpd * kHalfDeg / (e + kHalfDeg); });
}

// Geisler and Perry, "A real-time foveated multiresolution system for low-bandwidth video communication", SPIE 3299,
// 1998: the contrast threshold CT(f, e) = CT0 exp(alpha f (e + e2)/e2) with alpha = 0.106, e2 = 2.3 degrees and
// CT0 = 1/64. A detail of contrast C is seen up to
//   f(e) = e2 ln(C/CT0) / (alpha (e + e2)).
constexpr double kLeastContrast = 1.0 / 64;
DensityModel geisler_perry(const DensityArguments& given) {
  constexpr double kAlpha = 0.106;
  constexpr double kHalfDeg = 2.3;
  const double span = std::log(given.values[0] / kLeastContrast);
  return isotropic_cutoff([=](double e) { return kHalfDeg * span / (kAlpha * (e + kHalfDeg)); });
}

// Guenter et al., "Foveated 3D Graphics", ACM TOG 31(6), 2012: the smallest cycle that is resolved grows in proportion
// to eccentricity, w(e) = m e + w0 degrees, f = 1/w. m = 0.022 (conservative) to 0.0275 (aggressive) from their user
// study, w0 = 1/48 degree. The paper rendered its layers with antialiasing, jitter and temporal filtering; without
// them, such low sampling rates are visible.
DensityModel mar(const DensityArguments& given) {
  return isotropic_cutoff(
      [slope = given.values[0], foveal_deg = given.values[1]](double e) { return 1 / (slope * e + foveal_deg); });
}

// The probability of a path in Koskela, "Foveated Path Tracing with Fast Reconstruction and Efficient Sample
// Distribution", 2020, eq. 4.1, taken as a density for any number of samples:
//   p(e) = 1                               e <= e_f
//          1 + (p_p - 1)(e - e_f)/(e_p - e_f)  e <= e_p
//          p_p                             beyond
// Weier et al. 2016 use the same shape. The default angles (5 and 25 degrees) and p_p = 0.1 are within the usual range.
DensityModel linear(const DensityArguments& given) {
  return isotropic_density(
      [inner_deg = given.values[0], outer_deg = given.values[1], least = given.values[2]](double e) {
        if (e <= inner_deg) {
          return 1.0;
        }
        return e < outer_deg ? 1 + (least - 1) * (e - inner_deg) / (outer_deg - inner_deg) : least;
      });
}

// The source paper announces a "quadric" fall-off without giving a formula. This is its natural reading: in place of
// steps, a parabola that meets the outer rate without a kink,
//   p(e) = p_p + (1 - p_p) ((e_p - e)/(e_p - e_f))^2   for e_f < e < e_p, 1 before and p_p beyond.
DensityModel quadric(const DensityArguments& given) {
  return isotropic_density(
      [inner_deg = given.values[0], outer_deg = given.values[1], least = given.values[2]](double e) {
        if (e <= inner_deg) {
          return 1.0;
        }
        const double left = e < outer_deg ? (outer_deg - e) / (outer_deg - inner_deg) : 0.0;
        return least + (1 - least) * left * left;
      });
}

// The sample density of visual-polar space, in outline (Koskela et al., "Foveated Real-Time Path Tracing in
// Visual-Polar Space", EGSR 2019): a polar buffer about the gaze whose radial axis is warped by visual acuity, and
// which narrows to a triangle towards the gaze, where equal steps of the angle would put thousands of samples into a
// pixel. The radial coordinate is u(e) = integral of M(e). Beyond the plateau e_a of the acuity, every eccentricity has
// the same number of steps around; within it, the number falls in proportion to sin e. Samples per solid angle then go
// as the Jacobian
//   M(e) / sin e  beyond e_a,  M(e) / sin e_a  within,
// or, relative to the fovea, M(e) min(1, sin e_a / sin e). A grid of f x f cells per square degree carries f cycles, so
// the cut-off is 60 times the root of it. Beyond 90 degrees, where the circle about the gaze shrinks again, sin e is
// held at 1.
DensityModel visual_polar(const DensityArguments& /*given*/) {
  const double plateau = std::sin(kAcuityPlateauDeg * kRadPerDeg);
  return isotropic_cutoff([plateau](double e) {
    const double around = e <= kAcuityPlateauDeg ? 1.0 : plateau / (e < 90 ? std::sin(e * kRadPerDeg) : 1.0);
    return kFovealCpd * std::sqrt(relative_acuity(e) * around);
  });
}

FieldOf eye_of(double value) {
  return static_cast<FieldOf>(static_cast<int>(value));
}

NamedParameter above(const char* name, double value, double low, double high) {
  return {name, value, low, high, true, {}};
}

std::vector<NamedDensity> make_table() {
  constexpr double kAny = 1e9;
  const NamedParameter relative_to{kRelativeTo, 0, 0, 1, false, {"display", "fovea"}};
  const NamedParameter eye{"eye", 0, 0, 2, false, {"both", "left", "right"}};
  const std::vector<NamedParameter> ramp{
      {"inner", 5, 0, 180, false, {}}, {"outer", 25, 0, 180, false, {}}, {"least", 0.1, 0, 1, false, {}}};
  using Given = const DensityArguments&;
  return {
      {{"acuity", "visual acuity (Reddy 2001)", {relative_to}}, acuity},
      {{"cortical", "cortical magnification (Dougherty 2003)", {relative_to}}, cortical},
      {{"csf",
        "contrast sensitivity at a luminance in cd/m2 (Barten 2004) and its decline with eccentricity (stelaCSF)",
        {above("contrast", 1, 0, 1), above("luminance", 100, 0, kAny), eye, relative_to}},
       [](Given given) { return csf_model(given.values[0], given.values[1], eye_of(given.values[2])); }},
      {{"geisler-perry",
        "contrast threshold over frequency and eccentricity (Geisler and Perry 1998)",
        {above("contrast", 1, kLeastContrast, 1), relative_to}},
       geisler_perry},
      {{"linear", "full up to one eccentricity, then falling in proportion to it up to another (Koskela)", ramp},
       linear,
       true},
      {{"log-polar",
        "the samples of a log-polar buffer with kernel (Meng 2018)",
        {above("sigma", 1.8, 0, kAny), above("alpha", 4, 0, kAny)}},
       [](Given given) { return log_polar_model(given.values[0], given.values[1], given.view, given.gaze_direction); }},
      {{"mar",
        "minimum angle of resolution that grows in proportion to eccentricity (Guenter 2012)",
        {{"slope", 0.022, 0, 180, false, {}}, {"foveal", 1.0 / 48, 0, 180, false, {}}, relative_to}},
       mar},
      {{"quadric", "full up to one eccentricity, then falling with the square of the distance from another", ramp},
       quadric,
       true},
      {{"retina",
        "spacing of the retina's midget ganglion cells, different in each direction (Watson 2014)",
        {eye, relative_to}},
       [](Given given) { return retina_model(eye_of(given.values[0])); }},
      {{"visual-polar", "the samples of a polar buffer warped by acuity (Koskela 2019)", {relative_to}}, visual_polar},
  };
}

}  // namespace

const std::vector<NamedDensity>& named_densities() {
  static const std::vector<NamedDensity> kTable = make_table();
  return kTable;
}

}  // namespace gazetrace
