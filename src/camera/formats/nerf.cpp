// SPDX-License-Identifier: Apache-2.0
// NeRF's transforms.json (instant-ngp, nerfstudio, the synthetic sets): camera-to-world matrices; the camera looks
// along -z with y up. There are no times: pictures become frames in the order of their names. The vertical field of
// view comes from fl_y and h, else from camera_angle_y, else from fl_x or camera_angle_x with w and h.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>

#include "camera/path_format.hpp"
#include "core/text.hpp"

namespace gazetrace {
namespace {

using Json = nlohmann::json;

constexpr std::string_view kForm =
    "give {\"frames\": [{\"file_path\": ..., \"transform_matrix\": [[4 numbers], [4], [4], [0, 0, 0, 1]]}, ...]}";

[[noreturn]] void refuse(const std::string& place, const std::string& problem) {
  throw Error(ErrorKind::input, place, problem, kForm);
}

std::optional<double> number_of(const Json& object, const char* key) {
  const auto found = object.find(key);
  if (found == object.end() || !found->is_number() || !std::isfinite(found->get<double>())) {
    return std::nullopt;
  }
  return found->get<double>();
}

Affine matrix_of(const Json& frame, const std::string& place) {
  const auto found = frame.find("transform_matrix");
  if (found == frame.end() || !found->is_array() || (found->size() != 3 && found->size() != 4)) {
    refuse(place, "has no transform_matrix of 4 rows");
  }
  std::array<std::array<double, 4>, 4> m{};
  m[3] = {0, 0, 0, 1};
  for (std::size_t r = 0; r < found->size(); ++r) {
    const Json& row = (*found)[r];
    if (!row.is_array() || row.size() != 4) {
      refuse(place, fmt::format("row {} of its transform_matrix does not have 4 numbers", r + 1));
    }
    for (std::size_t c = 0; c < 4; ++c) {
      if (!row[c].is_number() || !std::isfinite(row[c].get<double>())) {
        refuse(place, fmt::format("transform_matrix has no finite number at row {}, column {}", r + 1, c + 1));
      }
      m[r][c] = row[c].get<double>();
    }
  }
  if (m[3] != std::array<double, 4>{0, 0, 0, 1}) {
    refuse(place, "the last row of its transform_matrix is not 0, 0, 0, 1");
  }
  const auto column = [&](std::size_t c) { return Vec3d{m[0][c], m[1][c], m[2][c]}; };
  return {column(0), column(1), column(2), column(3)};
}

// Text files round to a few digits; a larger deviation is a scale, a shear or a mirror image.
void check_rotation(const Affine& a, const std::string& place) {
  constexpr double kOff = 1e-2;
  const bool unit =
      std::abs(length(a.x) - 1) < kOff && std::abs(length(a.y) - 1) < kOff && std::abs(length(a.z) - 1) < kOff;
  const bool square =
      std::abs(dot(a.x, a.y)) < kOff && std::abs(dot(a.y, a.z)) < kOff && std::abs(dot(a.z, a.x)) < kOff;
  if (!unit || !square || determinant(a) < 0) {
    throw Error(ErrorKind::input, place,
                unit && square ? "its transform_matrix is a mirror image, not a rotation"
                               : "the columns of its transform_matrix are not a rotation",
                "export camera-to-world matrices without scale; `camera-scale` scales a path");
  }
}

std::optional<double> field_of_view(const Json& object) {
  const auto height = number_of(object, "h");
  const auto width = number_of(object, "w");
  const auto focal_y = number_of(object, "fl_y");
  const auto focal_x = number_of(object, "fl_x");
  const auto angle_y = number_of(object, "camera_angle_y");
  const auto angle_x = number_of(object, "camera_angle_x");
  const auto positive = [](const std::optional<double>& value) { return value && *value > 0; };
  if (positive(focal_y) && positive(height)) {
    return 2.0 * std::atan2(0.5 * *height, *focal_y);
  }
  if (positive(angle_y) && *angle_y < kPi) {
    return *angle_y;
  }
  if (!positive(width) || !positive(height)) {
    return std::nullopt;
  }
  if (positive(focal_x)) {
    return 2.0 * std::atan2(0.5 * *height, *focal_x);
  }
  if (positive(angle_x) && *angle_x < kPi) {
    return 2.0 * std::atan(std::tan(0.5 * *angle_x) * *height / *width);
  }
  return std::nullopt;
}

void warn_about_lens(const Json& json, const std::string& path, CameraKeys& result) {
  const auto center_x = number_of(json, "cx");
  const auto center_y = number_of(json, "cy");
  const bool off_center = (center_x && std::abs(*center_x - 0.5 * number_of(json, "w").value_or(2 * *center_x)) > 1) ||
                          (center_y && std::abs(*center_y - 0.5 * number_of(json, "h").value_or(2 * *center_y)) > 1);
  constexpr std::array<const char*, 6> kDistortions{"k1", "k2", "k3", "k4", "p1", "p2"};
  const bool bent = std::any_of(kDistortions.begin(), kDistortions.end(),
                                [&](const char* key) { return number_of(json, key).value_or(0) != 0; });
  const auto model = json.find("camera_model");
  const bool fisheye =
      model != json.end() && model->is_string() && model->get<std::string>().find("FISHEYE") != std::string::npos;
  if (off_center || bent || fisheye) {
    result.warnings.push_back(path + ": the lens is distorted or off its centre; a straight, centred one is rendered");
  }
  if (!result.yfov_rad && number_of(json, "camera_angle_x")) {
    result.warnings.push_back(path +
                              ": states camera_angle_x but neither w and h nor camera_angle_y, so no vertical field of "
                              "view; `yfov` gives one");
  }
}

}  // namespace

double sniff_camera_nerf(const CameraFile& file) {
  const bool object = trim(std::string_view(file.text).substr(0, 4096)).starts_with('{');
  return object && file.text.find("\"transform_matrix\"") != std::string::npos ? 0.95 : 0.0;
}

CameraKeys read_camera_nerf(const CameraFile& file, const CameraReadOptions& options) {
  const Json json = Json::parse(file.text, nullptr, false);
  if (json.is_discarded() || !json.is_object()) {
    refuse(file.path, "is not a JSON object");
  }
  const auto frames = json.find("frames");
  if (frames == json.end() || !frames->is_array()) {
    refuse(file.path, "has no list of frames");
  }
  CameraKeys result;
  result.counts_frames = true;
  struct Picture {
    std::string name;
    CameraKey key;
  };
  std::vector<Picture> pictures;
  std::vector<double> yfovs_rad;
  for (const Json& frame : *frames) {
    const auto index = static_cast<std::int64_t>(pictures.size());
    const std::string place = fmt::format("{}: frames[{}]", file.path, index);
    if (!frame.is_object()) {
      refuse(place, "is not a JSON object");
    }
    const Affine matrix = matrix_of(frame, place);
    check_rotation(matrix, place);
    const auto name = frame.find("file_path");
    Picture picture;
    picture.name = name != frame.end() && name->is_string() ? name->get<std::string>() : "";
    picture.key.row = index + 1;
    picture.key.pose = {matrix.t, rotation_of(matrix)};
    pictures.push_back(std::move(picture));
    if (const auto own = field_of_view(frame)) {
      yfovs_rad.push_back(*own);
    }
  }
  const bool named = std::none_of(pictures.begin(), pictures.end(), [](const Picture& p) { return p.name.empty(); });
  if (named) {
    std::stable_sort(pictures.begin(), pictures.end(),
                     [](const Picture& a, const Picture& b) { return natural_less(a.name, b.name); });
  }
  std::int64_t number = 0;
  for (const Picture& picture : pictures) {
    ++number;
    result.keys.push_back(picture.key);
    result.keys.back().t_ns = frame_time_at(number, 1, options, file.path);
  }
  if (const auto common = field_of_view(json); common && yfovs_rad.empty()) {
    yfovs_rad.push_back(*common);
  }
  result.yfov_rad = one_field_of_view(yfovs_rad, file.path, result.warnings);
  warn_about_lens(json, file.path, result);
  return result;
}

}  // namespace gazetrace
