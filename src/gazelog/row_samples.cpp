// SPDX-License-Identifier: Apache-2.0
#include "gazelog/row_samples.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/nan.hpp"
#include "core/text.hpp"
#include "gazelog/json.hpp"

namespace gazetrace {
namespace {

constexpr double kInt16Min = -32768;
constexpr double kLarge = 1e7;

// Size of the display in the unit of the positions.
Vec2d display_size(PositionUnit unit, const DisplayGeometry& d, const std::string& place) {
  const auto missing = [&](std::string_view what, std::string_view remedy) {
    throw Error(
        ErrorKind::input, place,
        fmt::format("positions are in {}, and {} of the display of the recording is not known", to_string(unit), what),
        remedy);
  };
  if (unit == PositionUnit::px) {
    if (d.width_px <= 0 || d.height_px <= 0) {
      missing("the size in pixels", "give `screen-px` W,H, or write `# display_px W H` above the header");
    }
    return {static_cast<double>(d.width_px), static_cast<double>(d.height_px)};
  }
  if (!(d.width_cm > 0) || !(d.height_cm > 0)) {
    missing("the size in cm", "give `screen-cm` W,H, or write `# display_mm W H` above the header");
  }
  if (unit == PositionUnit::deg && !(d.distance_cm > 0)) {
    missing("the eye's distance", "give `screen-distance-cm`, or write `# distance_mm D` above the header");
  }
  const double per_cm = unit == PositionUnit::mm ? 10.0 : 1.0;
  return {d.width_cm * per_cm, d.height_cm * per_cm};
}

void lose(GazeValidity& validity) {
  validity = is_usable(validity) ? GazeValidity::lost : validity;
}

// Whether the numbers of a row stand for a place that the tracker did not know.
bool is_mark(const Vec3d& at, const Conventions& c) {
  const bool has_three = c.form == PlaceForm::vector;
  // A place on a display is unknown where one of its coordinates is. Zero alone is the display's edge, and a component
  // of a direction may be any number.
  const bool one_is_enough = !has_three && c.missing_value && *c.missing_value != 0;
  const bool is_given =
      c.missing_value && (one_is_enough ? at.x == *c.missing_value || at.y == *c.missing_value
                                        : at.x == *c.missing_value && at.y == at.x && (!has_three || at.z == at.x));
  return is_given || is_missing_marker(at.x) || is_missing_marker(at.y) || (has_three && is_missing_marker(at.z));
}

// x and y of a row of positions, in `c.unit`; NaN where they are a mark.
Vec2d position_of(const RawSample& row, const Vec2d& corner, const Conventions& c, bool& is_missing) {
  Vec2d at{row.at.x - corner.x, row.at.y - corner.y};
  // As the file has it, or counted from the corner of the display.
  const bool is_zero = (row.at.x == 0 && row.at.y == 0) || (at.x == 0 && at.y == 0);
  is_missing = is_mark(row.at, c) || (c.zero_is_missing && is_zero);
  if (is_missing) {
    return {kNan, kNan};
  }
  if (c.swap_xy) {
    std::swap(at.x, at.y);
  }
  return c.unit_scale == 1 ? at : Vec2d{at.x * c.unit_scale, at.y * c.unit_scale};
}

// Whether azimuth and elevation in degrees meet a plane in front of the eye. Beyond 90 degrees tan would come back from
// the other side.
bool is_ahead(const Vec2d& deg) {
  return std::abs(deg.x) < 90 && std::abs(deg.y) < 90;
}

GazeSample sample_of(const RawSample& row) {
  GazeSample sample;
  sample.t_ns = row.t_ns;
  sample.validity = row.validity;
  sample.eye = row.eye;
  sample.confidence = row.confidence;
  sample.pupil = row.pupil;
  sample.row = row.row;
  return sample;
}

}  // namespace

bool is_missing_marker(double coordinate) {
  return coordinate == kInt16Min || std::abs(coordinate) >= kLarge;
}

Vec2d corner_of(const RawGaze& raw, const Conventions& conventions, std::size_t row) {
  const auto behind = std::upper_bound(raw.corners.begin(), raw.corners.end(), row,
                                       [](std::size_t r, const CornerFromRow& c) { return r < c.first_row; });
  return behind == raw.corners.begin() ? conventions.corner : (behind - 1)->corner;
}

RawRows measurable_rows(const RawGaze& raw, const Conventions& conventions) {
  // Of a long log some of the rows tell as much.
  constexpr std::size_t kAllUpTo = 200'000;
  std::size_t stride = raw.rows.size() / kAllUpTo + 1;
  while (stride > 1 && (stride % 2 == 0 || stride % 3 == 0)) {
    ++stride;  // or it would meet the same eye of two or three each time
  }
  RawRows rows;
  for (std::size_t i = 0; i < raw.rows.size(); i += stride) {
    RawSample row = raw.rows[i];
    bool is_missing = false;
    const Vec2d at = position_of(row, corner_of(raw, conventions, i), conventions, is_missing);
    row.at = {at.x, at.y, 0};
    if (is_missing) {
      lose(row.validity);
    }
    rows.push_back(row);
  }
  return rows;
}

// The direction that a row holds, in the axes of the file; need not be of unit length.
Vec3d vector_of(const RawSample& row, const Conventions& c) {
  if (is_mark(row.at, c)) {
    return {kNan, kNan, kNan};
  }
  switch (c.form) {
    case PlaceForm::azimuth_elevation: {
      const double az = row.at.x * kRadPerDeg;
      const double el = row.at.y * kRadPerDeg;
      return {std::sin(az) * std::cos(el), std::sin(el), -std::cos(az) * std::cos(el)};
    }
    case PlaceForm::lens_pixel:
      return is_usable(row.validity) && c.lens ? ray_of(*c.lens, {row.at.x, row.at.y}) : Vec3d{kNan, kNan, kNan};
    default:
      return row.at;
  }
}

Vec3d from_axes(const Vec3d& v, GazeAxes axes) {
  switch (axes) {
    case GazeAxes::automatic:
    case GazeAxes::gl:
      break;
    case GazeAxes::unity:
      return {v.x, v.y, -v.z};
    case GazeAxes::sranipal:
      return {-v.x, v.y, -v.z};
    case GazeAxes::cv:
      return {v.x, -v.y, -v.z};
    case GazeAxes::unreal:
      return {v.y, v.z, -v.x};
  }
  return v;
}

bool are_positions(const Conventions& c) {
  return c.form == PlaceForm::position && !(c.degrees_are_directions && c.unit.value == PositionUnit::deg);
}

ToFractions::ToFractions(const Conventions& c, const std::string& place)
    : unit_(c.unit.value), origin_(c.origin.value) {
  const DisplayGeometry display = c.display ? c.display->value : DisplayGeometry{};
  if (unit_ == PositionUnit::deg && origin_ != PositionOrigin::center) {
    throw Error(ErrorKind::usage, place,
                fmt::format("positions in degrees cannot count from the {}", to_string(origin_)),
                "degrees count from straight ahead: `origin` center");
  }
  if (unit_ == PositionUnit::norm || unit_ == PositionUnit::height) {
    const bool is_norm = unit_ == PositionUnit::norm;
    const Vec2d px = is_norm ? Vec2d{1, 1} : display_size(PositionUnit::px, display, place);
    size_ = is_norm ? Vec2d{2, 2} : Vec2d{px.x / px.y, 1};
    origin_ = PositionOrigin::center;
    return;
  }
  // Centred fractions count half the display: -1..1.
  size_ = unit_ != PositionUnit::fraction     ? display_size(unit_, display, place)
          : origin_ == PositionOrigin::center ? Vec2d{2, 2}
                                              : Vec2d{1, 1};
  display_ = display;
}

Vec2d ToFractions::operator()(const Vec2d& at) const {
  if (unit_ == PositionUnit::deg) {
    if (!is_ahead(at)) {
      return {kNan, kNan};
    }
    // Azimuth and elevation taken as independent: x = d tan(azimuth), y = d tan(elevation).
    const double right = std::tan(at.x * kRadPerDeg) * display_.distance_cm + display_.eye_x_cm;
    const double up = std::tan(at.y * kRadPerDeg) * display_.distance_cm + display_.eye_y_cm;
    return {0.5 + right / size_.x, 0.5 - up / size_.y};
  }
  const double u = at.x / size_.x;
  const double v = at.y / size_.y;
  switch (origin_) {
    case PositionOrigin::bottom_left:
      return {u, 1.0 - v};
    case PositionOrigin::center:
      return {0.5 + u, 0.5 - v};
    default:
      return {u, v};
  }
}

RowSamples::RowSamples(const RawGaze& raw, const Conventions& conventions) : raw_(raw), c_(conventions) {
  if (are_positions(conventions)) {
    to_fractions_.emplace(conventions, raw.place);
  }
}

GazeKind RowSamples::kind() const {
  return to_fractions_ ? raw_.kind : GazeKind::direction;
}

GazeSample RowSamples::operator()(std::size_t row) const {
  const RawSample raw = raw_.rows[row];
  GazeSample sample = sample_of(raw);
  if (to_fractions_) {
    place_position(raw, row, sample);
  } else if (c_.form == PlaceForm::position) {
    place_degrees(raw, row, sample);
  } else {
    place_vector(raw, sample);
  }
  return sample;
}

void RowSamples::place_position(const RawSample& row, std::size_t i, GazeSample& sample) const {
  bool is_missing = false;
  const Vec2d at = (*to_fractions_)(position_of(row, corner_of(raw_, c_, i), c_, is_missing));
  if (is_missing || std::isnan(at.x)) {
    lose(sample.validity);
  }
  sample.u = c_.flip_x ? 1.0 - at.x : at.x;
  sample.v = c_.flip_y ? 1.0 - at.y : at.y;
  const bool inside = sample.u >= 0 && sample.u <= 1 && sample.v >= 0 && sample.v <= 1;
  const bool marks_off_screen = !c_.off_screen_is_told && raw_.kind == GazeKind::screen;
  if (marks_off_screen && sample.validity == GazeValidity::ok && !inside) {
    sample.validity = GazeValidity::off_screen;
  }
}

// Degrees from straight ahead, azimuth and elevation taken as independent, as on a flat display: (tan az, tan el, -1).
void RowSamples::place_degrees(const RawSample& row, std::size_t i, GazeSample& sample) const {
  const double up = c_.origin.value == PositionOrigin::top_left && !raw_.directions_grow_up ? -1.0 : 1.0;
  bool is_missing = false;
  const Vec2d at = position_of(row, corner_of(raw_, c_, i), c_, is_missing);
  const bool known = is_ahead(at);
  sample.direction = known ? normalize(Vec3d{std::tan(at.x * kRadPerDeg), up * std::tan(at.y * kRadPerDeg), -1})
                           : Vec3d{kNan, kNan, kNan};
  if (!known) {
    lose(sample.validity);
  }
  sample.direction.x *= c_.flip_x ? -1 : 1;
  sample.direction.y *= c_.flip_y ? -1 : 1;
}

void RowSamples::place_vector(const RawSample& row, GazeSample& sample) const {
  const bool mirror_x = c_.x_is_turned && c_.x_is_turned->value;
  Vec3d d = from_axes(vector_of(row, c_), c_.axes.value);
  if (c_.swap_xy) {
    std::swap(d.x, d.y);
  }
  const double norm = length(d);
  if (!(norm > 0) || !std::isfinite(norm)) {
    sample.direction = {kNan, kNan, kNan};
    lose(sample.validity);
    return;
  }
  // A unit vector that was written with all its digits stays as it is, bit by bit.
  if (std::abs(norm - 1.0) > 1e-14) {
    d = d / norm;
  }
  sample.direction = {d.x * (c_.flip_x != mirror_x ? -1 : 1), d.y * (c_.flip_y ? -1 : 1), d.z};
}

SceneLens load_scene_lens(const std::string& path) {
  const JsonLeaves json(read_text_file(path), path);
  SceneLens lens;
  const auto entry = [&](const char* key, double& value) {
    const auto number = json.number(key);
    if (!number) {
      throw Error(ErrorKind::input, path, std::string("has no number '") + key + "'",
                  "a scene_camera.json of Pupil Cloud has camera_matrix and dist_coefs");
    }
    value = *number;
  };
  entry("camera_matrix.0.0", lens.fx);
  entry("camera_matrix.1.1", lens.fy);
  entry("camera_matrix.0.2", lens.cx);
  entry("camera_matrix.1.2", lens.cy);
  std::vector<double> k;
  for (const char* const key : {"dist_coefs.0", "dist_coefs", "distortion_coefficients.0", "distortion_coefficients"}) {
    k = k.empty() ? json.numbers(key) : k;
  }
  std::copy_n(k.begin(), std::min(k.size(), lens.k.size()), lens.k.begin());
  if (!(lens.fx > 0) || !(lens.fy > 0)) {
    throw Error(ErrorKind::input, path, "its focal lengths are not positive");
  }
  return lens;
}

Vec3d ray_of(const SceneLens& lens, const Vec2d& pixel) {
  const Vec2d distorted{(pixel.x - lens.cx) / lens.fx, (pixel.y - lens.cy) / lens.fy};
  const auto& [k1, k2, p1, p2, k3, k4, k5, k6] = lens.k;
  Vec2d at = distorted;
  for (int i = 0; i < 40; ++i) {
    const double r2 = at.x * at.x + at.y * at.y;
    const double shrink = (1 + ((k6 * r2 + k5) * r2 + k4) * r2) / (1 + ((k3 * r2 + k2) * r2 + k1) * r2);
    const double dx = 2 * p1 * at.x * at.y + p2 * (r2 + 2 * at.x * at.x);
    const double dy = p1 * (r2 + 2 * at.y * at.y) + 2 * p2 * at.x * at.y;
    at = {(distorted.x - dx) * shrink, (distorted.y - dy) * shrink};
  }
  return normalize(Vec3d{at.x, at.y, 1});
}

}  // namespace gazetrace
