// SPDX-License-Identifier: Apache-2.0
#include "pipeline/frame_layers.hpp"

#include <cmath>
#include <cstddef>

#include "gazetrace/frame_renderer.hpp"
#include "pipeline/frame_stages.hpp"
#include "pipeline/light_layers.hpp"

namespace gazetrace {
namespace {

// From the pixels' centres, x right and y up.
Image<Vec2f> vectors_to(const SurfaceMotion& motion) {
  Image<Vec2f> vectors(motion.other_px.width_px, motion.other_px.height_px);
  for (int y = 0; y < vectors.height_px; ++y) {
    for (int x = 0; x < vectors.width_px; ++x) {
      const Vec2d other = motion.other_px(x, y);
      if (std::isfinite(other.x) && std::isfinite(other.y)) {
        vectors(x, y) = {static_cast<float>(other.x - (x + 0.5)), static_cast<float>((y + 0.5) - other.y)};
      }
    }
  }
  return vectors;
}

// Where blocks and filters let light of surfaces run over their edges.
void blacken_uncovered(FrameLayers& layers, ImageRgb& radiance) {
  for (std::size_t i = 0; i < layers.alpha.pixels.size(); ++i) {
    if (layers.alpha.pixels[i] == 0) {
      radiance.pixels[i] = {};
      for (ImageRgb& light : layers.light) {
        light.pixels[i] = {};
      }
    }
  }
}

OtherView view_of(const NeighborView& neighbor, const Camera& camera) {
  OtherView view{camera, neighbor.t_video_ns};
  view.camera.pose = neighbor.pose;
  return view;
}

}  // namespace

std::shared_ptr<const std::vector<MatteTable>> matte_tables(const Scene& scene,
                                                            const std::vector<std::string>& layers) {
  if (layers.empty()) {
    return nullptr;
  }
  auto tables = std::make_shared<std::vector<MatteTable>>();
  for (const std::string& layer : layers) {
    tables->push_back(matte_table(scene, layer));
  }
  return tables;
}

std::vector<ImageRgb> FrameRenderer::filtered_light(const SparseFrame& sparse, const SamplingMap& map,
                                                    StageTimes& times) const {
  if (!settings_.layers.light) {
    return {};
  }
  return timed(times.layers_ms, [&] {
    const Reconstruction filter = is_linear(reconstruction_) ? reconstruction_ : Reconstruction({"linear"});
    return filter_light_groups(sparse, map, filter, settings_.threads);
  });
}

void FrameRenderer::add_layers(const FrameRequest& request, std::vector<ImageRgb> light,
                               RenderedFrame& rendered) const {
  const LayerSettings& wanted = settings_.layers;
  if (!wanted.any()) {
    return;
  }
  rendered.layers = timed(rendered.times.layers_ms, [&] {
    FrameLayers layers;
    layers.light = std::move(light);
    if (!layers.light.empty() && !is_linear(reconstruction_)) {
      scale_to_picture(rendered.frame.radiance, layers.light);
    }
    const PosedScene scene = tracer_->at({request.shutter_open_ns, request.shutter_close_ns});
    if (tables_ || wanted.alpha) {
      std::vector<SurfaceIds> surfaces;
      for (std::size_t i = 0; tables_ && i < tables_->size(); ++i) {
        surfaces.push_back((*tables_)[i].surfaces);
      }
      if (wanted.alpha) {
        surfaces.push_back({false, std::vector<std::uint32_t>(tracer_->scene().instances.size(), 1)});
      }
      CoverageSettings coverage = wanted.coverage;
      coverage.filter = settings_.trace.filter;
      coverage.footprint = settings_.trace.footprint;
      coverage.seed = settings_.trace.seed;
      layers.tables = tables_;
      layers.mattes =
          scene.coverage(request.camera, request.frame, request.width_px, request.height_px, surfaces, coverage);
      if (wanted.alpha) {
        layers.alpha = std::move(layers.mattes.back().share.front());
        layers.mattes.pop_back();
        blacken_uncovered(layers, rendered.frame.radiance);
      }
    }
    const auto motion_to = [&](const NeighborView& neighbor) {
      return scene.surface_motion(request.camera, request.width_px, request.height_px,
                                  view_of(neighbor, request.camera));
    };
    if (wanted.backward || wanted.position) {
      SurfaceMotion motion = motion_to(request.before);
      if (wanted.backward) {
        layers.motion.backward_px = vectors_to(motion);
      }
      if (wanted.position) {
        layers.motion.position_m = std::move(motion.position_m);
      }
    }
    if (wanted.forward) {
      layers.motion.forward_px = vectors_to(motion_to(request.after));
    }
    return layers;
  });
}

}  // namespace gazetrace
