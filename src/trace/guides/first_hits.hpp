// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "gazetrace/trace.hpp"
#include "trace/rays/camera_rays.hpp"
#include "trace/scene/render_scene.hpp"

namespace gazetrace {

// See PosedScene::first_hits.
std::vector<RayHit> trace_first_hits(const Scene& scene, const RenderScene& render_scene, const CameraRays& camera,
                                     int width_px, int height_px, const std::vector<Vec2d>& places_px, int threads);

}  // namespace gazetrace
