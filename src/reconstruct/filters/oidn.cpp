// SPDX-License-Identifier: Apache-2.0
// Intel Open Image Denoise, shown what it was trained on: radiance, albedo and normal of every pixel
// (denoiser_input.hpp). The network runs once for a frame.
#include <cstddef>

#include "reconstruct/denoiser_input.hpp"
#include "reconstruct/filter.hpp"
#include "reconstruct/open_image_denoise.hpp"

namespace gazetrace {

const FilterDefinition filter_oidn{
    .needs = {.guides = GuideSettings{.spp = kDenoiserGuideRays}, .surfaces = true, .halves = true},
    .frame = [](const FilterInput& input) {
      // AOVs and the variance of the samples are those of the linear filter.
      Frame frame = filter_linear.frame(input);
      DenoiserInput shown = denoiser_input(input.sparse, input.map, *input.guides, input.threads);
      frame.radiance = open_image_denoise(shown, input.threads);
      frame.sample_count = std::move(shown.samples);
      return frame;
    }};

}  // namespace gazetrace
