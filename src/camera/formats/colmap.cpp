// SPDX-License-Identifier: Apache-2.0
// COLMAP sparse models as text: images.txt has two lines per picture, `IMAGE_ID QW QX QY QZ TX TY TZ CAMERA_ID NAME`
// and its points, of which there may be none. Poses are world *to camera*, x_camera = R x_world + t, so the camera
// stands at -R' t; the axes are those of computer vision. cameras.txt in the same folder has the lenses. There are no
// times: pictures become frames in the order of their names.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <map>

#include "camera/path_format.hpp"
#include "core/text.hpp"

namespace gazetrace {
namespace {

constexpr std::string_view kForm =
    "a picture's first line is `IMAGE_ID QW QX QY QZ TX TY TZ CAMERA_ID NAME`, its points are on the second";
constexpr std::string_view kCameraForm = "a line of cameras.txt is `CAMERA_ID MODEL WIDTH HEIGHT PARAMS...`";

struct Picture {
  std::string name;
  std::string camera;
  CameraKey key;
};

// The first nine cells, and the name, which is the rest of the line.
bool split_picture(std::string_view line, std::array<std::string_view, 9>& cells, std::string_view& name) {
  for (std::string_view& cell : cells) {
    line = trim(line);
    const std::size_t end = std::min(line.find_first_of(" \t"), line.size());
    cell = line.substr(0, end);
    line.remove_prefix(end);
    if (cell.empty()) {
      return false;
    }
  }
  name = trim(line);
  return !name.empty();
}

// Some tools leave out the empty lines of pictures without points. Then each second picture would be taken for points.
void check_points(std::string_view line, const std::string& place) {
  std::vector<std::string_view> cells;
  if (trim(line).empty()) {
    return;
  }
  split_cells(trim(line), ' ', cells);
  // A picture's name may hold numbers, too; its third value is a part of a quaternion, where points have a number.
  bool numbers = true;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const auto value = number_from(trim(cells[i]));
    numbers = numbers && value && (i % 3 != 2 || *value == std::trunc(*value));
  }
  if (!numbers || cells.size() % 3 != 0) {
    throw Error(ErrorKind::input, place, "where the points of a picture belong, there are no triples X Y POINT3D_ID",
                "a picture without points has an empty line here; put it back after each picture");
  }
}

std::vector<Picture> read_pictures(const CameraFile& file) {
  std::vector<Picture> pictures;
  LineReader lines(file.text);
  for (std::string_view line; lines.next(line);) {
    if (trim(line).empty() || trim(line).front() == '#') {
      continue;
    }
    const std::string place = fmt::format("{}:{}", file.path, lines.number());
    std::array<std::string_view, 9> cells{};
    std::string_view name;
    if (!split_picture(line, cells, name)) {
      throw Error(ErrorKind::input, place, "is not the line of a picture: it has less than 10 values", kForm);
    }
    std::array<double, 7> v{};
    for (std::size_t i = 0; i < v.size(); ++i) {
      v[i] = number_at(cells[i + 1], place, kForm);
    }
    Picture picture{std::string(name), std::string(cells[8]), {}};
    picture.key.row = lines.number();
    // The inverse: the conjugate of a quaternion of length 1, which is checked with those of all formats.
    const Quatd to_world{-v[1], -v[2], -v[3], v[0]};
    picture.key.pose = {-rotate(normalize(to_world), Vec3d{v[4], v[5], v[6]}), to_world};
    pictures.push_back(std::move(picture));
    if (lines.next(line)) {
      check_points(line, fmt::format("{}:{}", file.path, lines.number()));
    }
  }
  std::sort(pictures.begin(), pictures.end(),
            [](const Picture& a, const Picture& b) { return natural_less(a.name, b.name); });
  return pictures;
}

struct Lens {
  double yfov_rad = 0;
  bool is_simple = true;  // centred and without distortion
};

// The positions, in a model's parameters, of the vertical focal length, the centre and the first distortion
// coefficient.
struct LensModel {
  std::string_view name;
  std::size_t focal_y, center, distortion, count;
};
constexpr std::array<LensModel, 11> kModels{{{"SIMPLE_PINHOLE", 0, 1, 3, 3},
                                             {"PINHOLE", 1, 2, 4, 4},
                                             {"SIMPLE_RADIAL", 0, 1, 3, 4},
                                             {"RADIAL", 0, 1, 3, 5},
                                             {"OPENCV", 1, 2, 4, 8},
                                             {"OPENCV_FISHEYE", 1, 2, 4, 8},
                                             {"FULL_OPENCV", 1, 2, 4, 12},
                                             {"FOV", 1, 2, 4, 5},
                                             {"SIMPLE_RADIAL_FISHEYE", 0, 1, 3, 4},
                                             {"RADIAL_FISHEYE", 0, 1, 3, 5},
                                             {"THIN_PRISM_FISHEYE", 1, 2, 4, 12}}};

Lens parse_lens(const std::vector<std::string_view>& cells, const std::string& place) {
  const auto model =
      std::find_if(kModels.begin(), kModels.end(), [&](const LensModel& m) { return m.name == cells[1]; });
  if (model == kModels.end() || cells.size() != 4 + model->count) {
    throw Error(ErrorKind::input, place,
                model == kModels.end()
                    ? fmt::format("camera model '{}' is unknown", cells[1].substr(0, 40))
                    : fmt::format("{} has {} parameters, not {}", model->name, model->count, cells.size() - 4),
                kCameraForm);
  }
  const double width = number_at(cells[2], place, kCameraForm);
  const double height = number_at(cells[3], place, kCameraForm);
  std::vector<double> p;
  for (std::size_t i = 4; i < cells.size(); ++i) {
    p.push_back(number_at(cells[i], place, kCameraForm));
  }
  const double focal_px = p[model->focal_y];
  if (!(focal_px > 0) || !(height > 0) || !(width > 0)) {
    throw Error(ErrorKind::input, place, "a size or a focal length is not positive", kCameraForm);
  }
  Lens lens;
  lens.yfov_rad = 2.0 * std::atan2(0.5 * height, focal_px);
  const bool centered =
      std::abs(p[model->center] - 0.5 * width) <= 1 && std::abs(p[model->center + 1] - 0.5 * height) <= 1;
  const bool straight =
      std::all_of(p.begin() + static_cast<std::ptrdiff_t>(model->distortion), p.end(), [](double k) { return k == 0; });
  lens.is_simple = centered && straight && model->name.find("FISHEYE") == std::string_view::npos;
  return lens;
}

std::map<std::string, Lens> read_lenses(const std::string& path) {
  const std::string text = read_text_file(path);
  std::map<std::string, Lens> lenses;
  LineReader lines(text);
  std::vector<std::string_view> cells;
  for (std::string_view line; lines.next(line);) {
    line = trim(line);
    if (line.empty() || line.front() == '#') {
      continue;
    }
    const std::string place = fmt::format("{}:{}", path, lines.number());
    split_cells(line, ' ', cells);
    if (cells.size() < 5) {
      throw Error(ErrorKind::input, place, fmt::format("{} values where 5 or more belong", cells.size()), kCameraForm);
    }
    lenses[std::string(cells[0])] = parse_lens(cells, place);
  }
  return lenses;
}

void add_field_of_view(const CameraFile& file, const std::vector<Picture>& pictures, CameraKeys& result) {
  const std::string path = (std::filesystem::path(file.path).parent_path() / "cameras.txt").string();
  std::error_code code;
  if (!std::filesystem::exists(path, code)) {
    return;
  }
  const auto lenses = read_lenses(path);
  std::vector<double> yfovs_rad;
  bool all_simple = true;
  for (const Picture& picture : pictures) {
    const auto lens = lenses.find(picture.camera);
    if (lens == lenses.end()) {
      throw Error(ErrorKind::input, fmt::format("{}:{}", file.path, picture.key.row),
                  fmt::format("camera {} is not in cameras.txt", picture.camera.substr(0, 40)),
                  "both files must be of one model");
    }
    yfovs_rad.push_back(lens->second.yfov_rad);
    all_simple = all_simple && lens->second.is_simple;
  }
  result.yfov_rad = one_field_of_view(yfovs_rad, file.path, result.warnings);
  if (!all_simple) {
    result.warnings.push_back(path + ": a lens is distorted or off its centre; a straight, centred one is rendered");
  }
}

}  // namespace

double sniff_camera_colmap(const CameraFile& file) {
  if (file.text.starts_with("# Image list with two lines of data per image")) {
    return 0.98;
  }
  LineReader lines(file.text);
  for (std::string_view line; lines.next(line);) {
    line = trim(line);
    if (line.empty() || line.front() == '#') {
      continue;
    }
    std::array<std::string_view, 9> cells{};
    std::string_view name;
    if (!split_picture(line, cells, name) || number_from(name)) {
      return 0.0;
    }
    const bool numbers = std::all_of(cells.begin(), cells.end(), [](std::string_view cell) {
      return cell.find(',') == std::string_view::npos && number_from(cell).has_value();
    });
    return numbers ? 0.8 : 0.0;
  }
  return 0.0;
}

CameraKeys read_camera_colmap(const CameraFile& file, const CameraReadOptions& options) {
  CameraKeys result;
  result.axes = CameraAxes::cv;
  result.counts_frames = true;
  const std::vector<Picture> pictures = read_pictures(file);
  add_field_of_view(file, pictures, result);
  std::int64_t frame = 0;
  for (const Picture& picture : pictures) {
    ++frame;
    result.keys.push_back(picture.key);
    result.keys.back().t_ns = frame_time_at(frame, 1, options, fmt::format("{}:{}", file.path, picture.key.row));
  }
  return result;
}

}  // namespace gazetrace
