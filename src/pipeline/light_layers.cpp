// SPDX-License-Identifier: Apache-2.0
#include "pipeline/light_layers.hpp"

#include <cstddef>
#include <utility>

#include "gazetrace/error.hpp"
#include "gazetrace/light_groups.hpp"

namespace gazetrace {

bool is_linear(const Reconstruction& filter) {
  const ReconstructionNeeds& needs = filter.needs();
  return !needs.guides && !needs.surfaces && !needs.halves;
}

std::vector<ImageRgb> filter_light_groups(const SparseFrame& sparse, const SamplingMap& map,
                                          const Reconstruction& filter, int threads) {
  if (sparse.light_groups.size() != sparse.sum.size()) {
    throw Error(ErrorKind::runtime, "light groups", "the samples were traced without them",
                "trace with TraceSettings::light_groups");
  }
  SparseFrame part;
  part.width_px = sparse.width_px;
  part.height_px = sparse.height_px;
  part.sum.resize(sparse.sum.size());
  part.sum_square_luminance = sparse.sum_square_luminance;
  part.count = sparse.count;
  std::vector<ImageRgb> layers;
  for (std::size_t group = 0; group < kLightGroups; ++group) {
    for (std::size_t site = 0; site < part.sum.size(); ++site) {
      part.sum[site] = sparse.light_groups[site].sum[group];
    }
    layers.push_back(std::move(filter.frame(part, map, nullptr, threads).radiance));
  }
  return layers;
}

void scale_to_picture(const ImageRgb& picture, std::vector<ImageRgb>& layers) {
  const auto bring = [&](std::size_t pixel, float Vec3f::*channel) {
    double sum = 0;
    for (const ImageRgb& layer : layers) {
      sum += static_cast<double>(layer.pixels[pixel].*channel);
    }
    const float whole = picture.pixels[pixel].*channel;
    if (sum > 0) {
      const double scale = static_cast<double>(whole) / sum;
      for (ImageRgb& layer : layers) {
        float& part = layer.pixels[pixel].*channel;
        part = static_cast<float>(static_cast<double>(part) * scale);
      }
    } else {
      for (ImageRgb& layer : layers) {
        layer.pixels[pixel].*channel = 0;
      }
      layers[static_cast<std::size_t>(LightGroup::diffuse_indirect)].pixels[pixel].*channel = whole;
    }
  };
  for (std::size_t i = 0; i < picture.pixels.size(); ++i) {
    bring(i, &Vec3f::x);
    bring(i, &Vec3f::y);
    bring(i, &Vec3f::z);
  }
}

}  // namespace gazetrace
