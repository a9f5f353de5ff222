// SPDX-License-Identifier: Apache-2.0
// Traces the first hits of a whole frame, tile by tile: the first stage of the path tracer alone.
#pragma once

#include "gazetrace/guides.hpp"
#include "trace/lights/light_sampling.hpp"
#include "trace/rays/camera_rays.hpp"
#include "trace/scene/render_scene.hpp"

namespace gazetrace {

// Error(usage) for a number of rays out of range.
void check_guides(const GuideSettings& settings);
Guides trace_guides(const RenderScene& scene, const LightSampler& lights, const CameraRays& camera, int width_px,
                    int height_px, const GuideSettings& settings, int threads);

}  // namespace gazetrace
