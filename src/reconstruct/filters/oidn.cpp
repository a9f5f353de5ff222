// SPDX-License-Identifier: Apache-2.0
// Intel Open Image Denoise, shown what it was trained on: radiance, albedo and normal of every pixel
// (denoiser_input.hpp), at the resolution of its samples (denoiser_levels.hpp). The network runs once for each size of
// blocks, or twice (denoiser_work()).
#include <utility>
#include <vector>

#include "reconstruct/denoise.hpp"
#include "reconstruct/denoiser_input.hpp"
#include "reconstruct/denoiser_levels.hpp"
#include "reconstruct/filter.hpp"

namespace gazetrace {

const FilterDefinition filter_oidn{
    .needs = {.guides = GuideSettings{.spp = kDenoiserGuideRays}, .surfaces = true, .halves = true, .first_half = true},
    .needs_independent_halves = [](const SamplingMap& map) { return denoiser_work(map) == DenoiserWork::with_halves; },
    .frame =
        [](const FilterInput& input) {
          // AOVs and the variance of the samples are those of the linear filter.
          Frame frame = filter_linear.frame(input);
          DenoiserInput shown = denoiser_input(input.sparse, input.map, *input.guides, input.threads);
          const std::vector<DenoiserLevel> levels = denoiser_levels(shown, input.map, input.threads);
          const DenoiserWork work = denoiser_work(input.map);
          std::vector<ImageRgb> pictures;
          for (const DenoiserLevel& level : levels) {
            pictures.push_back(denoise(level.input, work, input.threads));
          }
          frame.radiance = blend_levels(levels, pictures, input.map, input.threads);
          frame.sample_count = std::move(shown.samples);
          return frame;
        }};

}  // namespace gazetrace
