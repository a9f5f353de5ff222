// SPDX-License-Identifier: Apache-2.0
#include "metrics/code_values.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/parallel.hpp"
#include "core/srgb.hpp"

namespace gazetrace {

namespace {

constexpr double kPqM1 = 2610.0 / 16384;
constexpr double kPqM2 = 2523.0 / 4096 * 128;
constexpr double kPqC1 = 3424.0 / 4096;
constexpr double kPqC2 = 2413.0 / 4096 * 32;
constexpr double kPqC3 = 2392.0 / 4096 * 32;
constexpr double kPqMost = 10000;  // cd/m2

}  // namespace

double pq_luminance(double code) {
  const double root = std::pow(std::clamp(code, 0.0, 1.0), 1 / kPqM2);
  return kPqMost * std::pow(std::max(root - kPqC1, 0.0) / (kPqC2 - kPqC3 * root), 1 / kPqM1);
}

double pq_code(double cd_m2) {
  const double power = std::pow(std::clamp(cd_m2 / kPqMost, 0.0, 1.0), kPqM1);
  return std::pow((kPqC1 + kPqC2 * power) / (1 + kPqC3 * power), kPqM2);
}

double display_light(DisplayResponse response, double code, double peak_cd_m2) {
  const double v = std::clamp(code, 0.0, 1.0);
  switch (response) {
    case DisplayResponse::srgb:
      return light_of_srgb(v);
    case DisplayResponse::gamma22:
      return std::pow(v, 2.2);
    case DisplayResponse::gamma24:
      return std::pow(v, 2.4);
    case DisplayResponse::linear:
      return v;
    case DisplayResponse::pq:
      return std::min(pq_luminance(v) / peak_cd_m2, 1.0);
    case DisplayResponse::linear_hdr:
      return std::clamp(code / peak_cd_m2, 0.0, 1.0);
  }
  return v;
}

ImageRgb light_of_code(const ImageRgb& code, DisplayResponse response, double peak_cd_m2, int threads) {
  std::array<float, 256> codes{};
  std::array<float, 256> lights{};
  for (std::size_t i = 0; i < codes.size(); ++i) {
    codes[i] = static_cast<float>(i) / 255.0F;
    lights[i] = static_cast<float>(display_light(response, static_cast<double>(i) / 255.0, peak_cd_m2));
  }
  const auto decode = [&](float v) {
    const auto i = static_cast<std::size_t>(std::clamp(v, 0.0F, 1.0F) * 255.0F + 0.5F);
    return codes[i] == v ? lights[i] : static_cast<float>(display_light(response, v, peak_cd_m2));
  };
  ImageRgb light(code.width_px, code.height_px);
  parallel_for(static_cast<std::size_t>(code.height_px), threads, [&](std::size_t row) {
    for (int x = 0; x < code.width_px; ++x) {
      const Vec3f& v = code(x, static_cast<int>(row));
      light(x, static_cast<int>(row)) = {decode(v.x), decode(v.y), decode(v.z)};
    }
  });
  return light;
}

}  // namespace gazetrace
