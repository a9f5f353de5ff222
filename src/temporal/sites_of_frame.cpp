// SPDX-License-Identifier: Apache-2.0
// Turns accumulated pixels back into sums per site, for a filter that follows accumulation.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "core/luminance.hpp"
#include "foveation/sites.hpp"
#include "gazetrace/temporal.hpp"

namespace gazetrace {

SparseFrame sites_of_frame(const Frame& frame, const SparseFrame& traced, const SamplingMap& map) {
  SparseFrame sparse = traced;
  for (std::size_t s = 0; s < map.sites.size(); ++s) {
    Vec3d sum;
    double count = 0;
    double deviation = 0;
    for_each_pixel(map, map.sites[s], [&](int x, int y) {
      const auto n = static_cast<double>(frame.sample_count(x, y));
      sum += n * to_double(frame.radiance(x, y));
      deviation += n * std::sqrt(std::max(0.0, static_cast<double>(frame.variance(x, y))));
      count += n;
    });
    const auto whole = static_cast<std::uint32_t>(std::clamp(std::round(count), count > 0 ? 1.0 : 0.0, 4e9));
    sparse.count[s] = whole;
    if (whole == 0) {
      sparse.sum[s] = {};
      sparse.sum_square_luminance[s] = 0;
      continue;
    }
    const auto n = static_cast<double>(whole);
    const Vec3d mean = sum / count;
    const double variance = (deviation / count) * (deviation / count);  // of the mean; the site's pixels share samples
    const double of_luminance = luminance(mean);
    sparse.sum[s] = to_float(mean * n);
    sparse.sum_square_luminance[s] = static_cast<float>(n * of_luminance * of_luminance + n * (n - 1) * variance);
    if (!sparse.guides.empty() && traced.count[s] > 0) {
      const float ratio = static_cast<float>(whole) / static_cast<float>(traced.count[s]);
      GuideSums& guides = sparse.guides[s];
      guides.albedo = guides.albedo * ratio;
      guides.normal = guides.normal * ratio;
      const auto hits = static_cast<std::uint32_t>(std::lround(static_cast<float>(guides.hits) * ratio));
      guides.depth_m =
          guides.hits > 0 ? guides.depth_m / static_cast<float>(guides.hits) * static_cast<float>(hits) : 0;
      guides.hits = hits;
    }
  }
  return sparse;
}

}  // namespace gazetrace
