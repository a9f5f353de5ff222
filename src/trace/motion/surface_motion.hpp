// SPDX-License-Identifier: Apache-2.0
// Traces the first hits of a whole frame, and finds where they are in another view, earlier or later.
#pragma once

#include "gazetrace/motion.hpp"
#include "gazetrace/scene.hpp"
#include "trace/rays/camera_rays.hpp"
#include "trace/scene/render_scene.hpp"

namespace gazetrace {

// `with_triangles`: PixelHits::hits is wanted.
PixelHits trace_pixel_hits(const RenderScene& scene, const OtherView& view, int width_px, int height_px,
                           bool with_triangles, int threads);

// `render_scene` may be in any pose.
HitPlaces places_of_hits(const Scene& scene, const std::shared_ptr<const RenderScene>& render_scene,
                         const PixelHits& seen, const OtherView& other, int threads);

SurfaceMotion trace_surface_motion(const Scene& scene, const RenderScene& render_scene, const Camera& camera,
                                   int width_px, int height_px, const OtherView& other, int threads);

}  // namespace gazetrace
