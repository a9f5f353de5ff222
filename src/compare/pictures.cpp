// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cstring>
#include <limits>
#include <utility>

#include "core/image_io.hpp"
#include "core/parallel.hpp"
#include "gazetrace/compare.hpp"
#include "gazetrace/error.hpp"
#include "metrics/code_values.hpp"

namespace gazetrace {

ComparedPicture read_compared_picture(const std::string& path) {
  Picture read = read_picture(path);
  ComparedPicture result;
  result.is_linear = read.facts.is_linear;
  result.first_px = {read.facts.x_px, read.facts.y_px};
  (result.is_linear ? result.picture.light : result.picture.code) = std::move(read.rgb);
  result.facts = read_frame_facts(path);
  return result;
}

ImageGray read_pooling_weights(const std::string& path) {
  const ImageRgb picture = read_picture(path).rgb;
  ImageGray weights(picture.width_px, picture.height_px);
  std::transform(picture.pixels.begin(), picture.pixels.end(), weights.pixels.begin(),
                 [](const Vec3f& value) { return value.x; });
  return weights;
}

ImageRgb viewed(const ImageRgb& light, const ColorPipeline& color, double exposure_ev, int threads) {
  const DisplayImage display = color.apply(light, exposure_ev, 8, threads);
  ImageRgb code(light.width_px, light.height_px);
  std::array<float, 256> values{};
  for (std::size_t i = 0; i < values.size(); ++i) {
    values[i] = static_cast<float>(i) / 255.0F;
  }
  for (std::size_t i = 0; i < code.pixels.size(); ++i) {
    const std::uint8_t* bytes = &display.bytes[3 * i];
    code.pixels[i] = {values[bytes[0]], values[bytes[1]], values[bytes[2]]};
  }
  return code;
}

ImageRgb emitted(const ImageRgb& code, DisplayResponse response, double peak_cd_m2, int threads) {
  return light_of_code(code, response, peak_cd_m2, threads);
}

ImageRgb pq_codes(const ImageRgb& light_cd_m2, double peak_cd_m2, int threads) {
  ImageRgb code(light_cd_m2.width_px, light_cd_m2.height_px);
  const auto encode = [peak_cd_m2](float v) {
    return static_cast<float>(pq_code(std::min(static_cast<double>(v), peak_cd_m2)));
  };
  parallel_for(static_cast<std::size_t>(code.height_px), threads, [&](std::size_t row) {
    for (int x = 0; x < code.width_px; ++x) {
      const Vec3f& v = light_cd_m2(x, static_cast<int>(row));
      code(x, static_cast<int>(row)) = {encode(v.x), encode(v.y), encode(v.z)};
    }
  });
  return code;
}

}  // namespace gazetrace
