// SPDX-License-Identifier: Apache-2.0
// Running sums for an unmoving camera: each pixel's mean over the frames, weighted by the samples behind it.
#include <cstddef>
#include <utility>

#include "core/parallel.hpp"
#include "gazetrace/temporal.hpp"
#include "temporal/same_camera.hpp"

namespace gazetrace {
namespace {

bool fits(const TemporalHistory& history, const Frame& frame, const Camera& camera) {
  return history.frames > 0 && history.camera && same_camera(*history.camera, camera) &&
         history.radiance_sum.width_px == frame.radiance.width_px &&
         history.radiance_sum.height_px == frame.radiance.height_px;
}

void reset(TemporalHistory& history, const Frame& frame, const Camera& camera) {
  const int w = frame.radiance.width_px;
  const int h = frame.radiance.height_px;
  history.radiance_sum = Image<Vec3d>(w, h);
  history.count_sum = Image<double>(w, h);
  history.variance_weight_sum = Image<double>(w, h);
  history.surfaces = {};
  history.camera = camera;
  history.frames = 0;
}

}  // namespace

Frame accumulate(Frame frame, const FrameRequest& request, const AccumulateSettings& settings, TemporalHistory& history,
                 int threads) {
  if (settings.mode == AccumulateMode::off) {
    return frame;
  }
  if (!fits(history, frame, request.camera)) {
    reset(history, frame, request.camera);
  }
  const bool first = history.frames == 0;
  const auto width = static_cast<std::size_t>(frame.radiance.width_px);
  parallel_for(static_cast<std::size_t>(frame.radiance.height_px), threads, [&](std::size_t y) {
    for (std::size_t i = y * width; i < (y + 1) * width; ++i) {
      const double count = static_cast<double>(frame.sample_count.pixels[i]);
      Vec3d& radiance = history.radiance_sum.pixels[i];
      double& counts = history.count_sum.pixels[i];
      double& variance = history.variance_weight_sum.pixels[i];
      radiance += count * to_double(frame.radiance.pixels[i]);
      counts += count;
      variance += count * count * static_cast<double>(frame.variance.pixels[i]);
      // A pixel that no frame has sampled keeps what its neighbours gave it in this one.
      if (!first && counts > 0) {
        frame.radiance.pixels[i] = to_float(radiance / counts);
        frame.sample_count.pixels[i] = static_cast<float>(counts);
        frame.variance.pixels[i] = static_cast<float>(variance / (counts * counts));
      }
    }
  });
  ++history.frames;
  history.t_video_ns = request.t_video_ns;
  return frame;
}

}  // namespace gazetrace
