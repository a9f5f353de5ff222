// SPDX-License-Identifier: Apache-2.0
// What NeRF programs write, as JSON without times: each pose becomes a frame.
// - transforms.json (instant-ngp, nerfstudio, the synthetic sets) has camera-to-world matrices; the camera looks along
// -z
//   with y up. Pictures become frames in the order of their names. The vertical field of view comes from fl_y and h,
//   else from camera_angle_y, else from fl_x or camera_angle_x with w and h.
// - camera paths of nerfstudio have such matrices as 16 numbers by rows, and the vertical field of view in degrees.
// - camera paths of instant-ngp (base_cam.json) have quaternions x, y, z, w in its own world, the unit cube.
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
    "give {\"frames\": [{\"file_path\": ..., \"transform_matrix\": [[4 numbers], [4], [4], [0, 0, 0, 1]]}, ...]}, a "
    "camera path of nerfstudio or one of instant-ngp";

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

// Rows of numbers, or all numbers one after the other.
Affine matrix_of(const Json& frame, const char* key, const std::string& place) {
  const auto found = frame.find(key);
  const std::size_t size = found == frame.end() || !found->is_array() ? 0 : found->size();
  const bool flat = size == 12 || size == 16;
  if (size != 3 && size != 4 && !flat) {
    refuse(place, fmt::format("has no {} of 4 rows", key));
  }
  std::array<std::array<double, 4>, 4> m{};
  m[3] = {0, 0, 0, 1};
  for (std::size_t r = 0; r < (flat ? size / 4 : size); ++r) {
    if (const Json& row = (*found)[r]; !flat && (!row.is_array() || row.size() != 4)) {
      refuse(place, fmt::format("row {} of its {} does not have 4 numbers", r + 1, key));
    }
    for (std::size_t c = 0; c < 4; ++c) {
      const Json& number = flat ? (*found)[4 * r + c] : (*found)[r][c];
      if (!number.is_number() || !std::isfinite(number.get<double>())) {
        refuse(place, fmt::format("{} has no finite number at row {}, column {}", key, r + 1, c + 1));
      }
      m[r][c] = number.get<double>();
    }
  }
  if (m[3] != std::array<double, 4>{0, 0, 0, 1}) {
    refuse(place, fmt::format("the last row of its {} is not 0, 0, 0, 1", key));
  }
  const auto column = [&](std::size_t c) { return Vec3d{m[0][c], m[1][c], m[2][c]}; };
  return {column(0), column(1), column(2), column(3)};
}

// Text files round to a few digits; a larger deviation is a scale, a shear or a mirror image.
void check_rotation(const Affine& a, const char* key, const std::string& place) {
  constexpr double kOff = 1e-2;
  const bool unit =
      std::abs(length(a.x) - 1) < kOff && std::abs(length(a.y) - 1) < kOff && std::abs(length(a.z) - 1) < kOff;
  const bool square =
      std::abs(dot(a.x, a.y)) < kOff && std::abs(dot(a.y, a.z)) < kOff && std::abs(dot(a.z, a.x)) < kOff;
  if (!unit || !square || determinant(a) < 0) {
    throw Error(ErrorKind::input, place,
                unit && square ? fmt::format("its {} is a mirror image, not a rotation", key)
                               : fmt::format("the columns of its {} are not a rotation", key),
                "export camera-to-world matrices without scale; `camera-scale` scales a path");
  }
}

constexpr double kNgpScale = 0.33;
constexpr double kNgpOffset = 0.5;

// instant-ngp's camera looks along +z with y down, in a world whose x, y, z are the y, z, x of transforms.json.
CameraPose out_of_unit_cube(const Json& frame, const std::string& place) {
  std::array<double, 7> v{};
  for (std::size_t i = 0; i < v.size(); ++i) {
    const char* const key = i < 4 ? "R" : "T";
    const std::size_t at = i < 4 ? i : i - 4;
    const auto found = frame.find(key);
    if (found == frame.end() || !found->is_array() || found->size() != (i < 4 ? 4U : 3U) || !(*found)[at].is_number()) {
      refuse(place, fmt::format("has no {} of {} numbers", key, i < 4 ? 4 : 3));
    }
    v[i] = (*found)[at].get<double>();
  }
  const Quatd turned{v[0], v[1], v[2], v[3]};
  const double norm = std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2] + v[3] * v[3]);
  if (!(norm > 1e-6) || !std::isfinite(norm) || !std::isfinite(v[4] + v[5] + v[6])) {
    refuse(place, "its R or T is not finite, or R has no direction");
  }
  constexpr Quatd kCycle{0.5, 0.5, 0.5, 0.5};  // turns x to y, y to z and z to x
  const auto moved = [](double x) { return (x - kNgpOffset) / kNgpScale; };
  return {{moved(v[6]), moved(v[4]), moved(v[5])}, kCycle * normalize(turned) * Quatd{1, 0, 0, 0}};
}

// nerfstudio's own rendering shows all poses within the stated seconds.
void warn_about_rate(const Json& json, std::size_t poses, const FrameRate& fps, const std::string& path,
                     Warnings& warnings) {
  const auto seconds = number_of(json, "seconds");
  const double used = static_cast<double>(fps.numerator) / static_cast<double>(fps.denominator);
  if (!seconds || !(*seconds > 0)) {
    return;
  }
  if (const double stated = static_cast<double>(poses) / *seconds; std::abs(stated / used - 1) > 0.01) {
    warnings.push_back(
        fmt::format("{}: has {} poses for {:g} s, and each is a frame at {:g} a second; `camera-fps` {:g} "
                    "keeps its time",
                    path, poses, *seconds, used, stated));
  }
}

// A frame may state some of its lens, and the file what all frames share.
std::optional<double> of_frame_or_all(const Json& frame, const Json& all, const char* key) {
  const auto own = number_of(frame, key);
  return own ? own : number_of(all, key);
}

std::optional<double> field_of_view(const Json& object, const Json& all) {
  const auto height = of_frame_or_all(object, all, "h");
  const auto width = of_frame_or_all(object, all, "w");
  const auto focal_y = of_frame_or_all(object, all, "fl_y");
  const auto focal_x = of_frame_or_all(object, all, "fl_x");
  const auto angle_y = of_frame_or_all(object, all, "camera_angle_y");
  const auto angle_x = of_frame_or_all(object, all, "camera_angle_x");
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

// Whether a frame's lens is not straight and centred.
bool is_odd_lens(const Json& frame, const Json& all) {
  const auto is_off_center = [&](const char* center, const char* size) {
    const auto at = of_frame_or_all(frame, all, center);
    return at && std::abs(*at - 0.5 * of_frame_or_all(frame, all, size).value_or(2 * *at)) > 1;
  };
  constexpr std::array<const char*, 6> kDistortions{"k1", "k2", "k3", "k4", "p1", "p2"};
  const bool is_bent = std::any_of(kDistortions.begin(), kDistortions.end(),
                                   [&](const char* key) { return of_frame_or_all(frame, all, key).value_or(0) != 0; });
  const auto text_of = [&](const char* key) {
    for (const Json* const object : {&frame, &all}) {
      if (const auto found = object->find(key); found != object->end() && found->is_string()) {
        return found->get<std::string>();
      }
    }
    return std::string();
  };
  const std::string type = text_of("camera_type");
  const bool is_wide = text_of("camera_model").find("FISHEYE") != std::string::npos ||
                       (!type.empty() && type.find("ersp") == std::string::npos);
  return is_off_center("cx", "w") || is_off_center("cy", "h") || is_bent || is_wide;
}

void warn_about_lens(const Json& json, const Json& frames, const std::string& path, CameraKeys& result) {
  if (std::any_of(frames.begin(), frames.end(), [&](const Json& frame) { return is_odd_lens(frame, json); })) {
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
  const auto holds = [&](const char* key) { return file.text.find(key) != std::string::npos; };
  const bool known = holds("\"transform_matrix\"") || (holds("\"camera_path\"") && holds("\"camera_to_world\"")) ||
                     (holds("\"path\"") && holds("\"R\"") && holds("\"T\""));
  return object && known ? 0.95 : 0.0;
}

CameraKeys read_camera_nerf(const CameraFile& file, const CameraReadOptions& options) {
  const Json json = Json::parse(file.text, nullptr, false);
  if (json.is_discarded() || !json.is_object()) {
    refuse(file.path, "is not a JSON object");
  }
  const auto list_of = [&](const char* key) {
    const auto found = json.find(key);
    return found != json.end() && found->is_array() ? &*found : nullptr;
  };
  const Json* const shown = list_of("camera_path");
  const Json* const steered = shown != nullptr ? nullptr : list_of("path");
  const Json* const frames = shown != nullptr ? shown : steered != nullptr ? steered : list_of("frames");
  if (frames == nullptr) {
    refuse(file.path, "has no list of frames");
  }
  const std::string list = shown != nullptr ? "camera_path" : steered != nullptr ? "path" : "frames";
  const char* const key = shown != nullptr ? "camera_to_world" : "transform_matrix";
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
    const std::string place = fmt::format("{}: {}[{}]", file.path, list, index);
    if (!frame.is_object()) {
      refuse(place, "is not a JSON object");
    }
    const auto name = frame.find("file_path");
    Picture picture;
    picture.name = name != frame.end() && name->is_string() ? name->get<std::string>() : "";
    picture.key.row = index + 1;
    if (steered != nullptr) {
      picture.key.pose = out_of_unit_cube(frame, place);
    } else {
      const Affine matrix = matrix_of(frame, key, place);
      check_rotation(matrix, key, place);
      picture.key.pose = {matrix.t, rotation_of(matrix)};
    }
    pictures.push_back(std::move(picture));
    if (const auto own = list == "frames" ? field_of_view(frame, json) : number_of(frame, "fov")) {
      yfovs_rad.push_back(list == "frames" ? *own : *own * kRadPerDeg);
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
  if (const auto common = field_of_view(json, json); common && yfovs_rad.empty()) {
    yfovs_rad.push_back(*common);
  }
  result.yfov_rad = one_field_of_view(yfovs_rad, file.path, result.warnings);
  warn_about_lens(json, *frames, file.path, result);
  if (steered != nullptr) {
    result.warnings.push_back(fmt::format(
        "{}: is taken out of instant-ngp's unit cube to the world of its transforms.json by the usual scale of {} and "
        "offset of {}; `camera-scale` and `camera-start` correct it where that file states others",
        file.path, kNgpScale, kNgpOffset));
  }
  if (shown != nullptr) {
    warn_about_rate(json, pictures.size(), options.fps, file.path, result.warnings);
  }
  return result;
}

}  // namespace gazetrace
