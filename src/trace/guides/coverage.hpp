// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "gazetrace/coverage.hpp"
#include "trace/rays/camera_rays.hpp"
#include "trace/scene/render_scene.hpp"

namespace gazetrace {

// See PosedScene::coverage.
std::vector<Coverage> trace_coverage(const Scene& scene, const RenderScene& render_scene, const CameraRays& camera,
                                     std::int32_t frame, int width_px, int height_px,
                                     const std::vector<SurfaceIds>& surfaces, const CoverageSettings& settings,
                                     int threads);

}  // namespace gazetrace
