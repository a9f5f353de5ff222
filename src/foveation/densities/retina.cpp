// SPDX-License-Identifier: Apache-2.0
// Spacing of the midget ganglion cells, Watson, "A formula for human retinal ganglion cell receptive field density as a
// function of visual field location", Journal of Vision 14(7), 2014. Along a meridian of the visual field the density
// is
//   d(e) = 33163.2 (a (1 + e/r2)^-2 + (1 - a) exp(-e/re)) 0.8928 / (1 + e/41.03) per square degree;
// half of them are on-centre cells, whose hexagonal lattice carries f = 1/2 sqrt(2/sqrt(3) d/2) cycles per degree.
// Between two meridians lines of equal spacing are ellipses: 1/f^2 = cos^2/f_x^2 + sin^2/f_y^2.
// In the right eye's visual field the temporal side is on the right, in the left eye's on the left.
#include <cmath>

#include "foveation/densities.hpp"

namespace gazetrace {
namespace {

struct Meridian {
  double a, r2_deg, re_deg;
};
constexpr Meridian kTemporal{0.9851, 1.058, 22.14};
constexpr Meridian kSuperior{0.9935, 1.035, 16.35};
constexpr Meridian kNasal{0.9729, 1.084, 7.633};
constexpr Meridian kInferior{0.9960, 0.9932, 12.13};

double cutoff_cpd(const Meridian& m, double e) {
  const double near = 1 + e / m.r2_deg;
  const double midget_share = 0.8928 / (1 + e / 41.03);
  const double density = 33163.2 * (m.a / (near * near) + (1 - m.a) * std::exp(-e / m.re_deg)) * midget_share;
  return 0.5 * std::sqrt(2 / std::sqrt(3.0) * 0.5 * density);
}

double right_eye_cpd(double e, double cosine, double sine) {
  const double x = cosine / cutoff_cpd(cosine >= 0 ? kTemporal : kNasal, e);
  const double y = sine / cutoff_cpd(sine >= 0 ? kSuperior : kInferior, e);
  return 1 / std::sqrt(x * x + y * y);
}

}  // namespace

DensityModel retina_model(FieldOf eye) {
  DensityModel model;
  model.uses_meridian = true;
  model.value = [eye](const DensityPlace& place) {
    const double cosine = place.meridian.x;
    // The temporal meridian is the better one at every eccentricity, so of two eyes the one counts on whose temporal
    // side the place is.
    const double x = eye == FieldOf::right ? cosine : eye == FieldOf::left ? -cosine : std::abs(cosine);
    return right_eye_cpd(place.eccentricity_deg, x, place.meridian.y);
  };
  return model;
}

}  // namespace gazetrace
