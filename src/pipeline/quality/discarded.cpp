// SPDX-License-Identifier: Apache-2.0
#include "pipeline/quality/discarded.hpp"

#include "core/hash.hpp"

namespace gazetrace {

FrameSettings discarded(const FrameSettings& settings, std::uint64_t tag) {
  FrameSettings own = settings;
  own.foveation.target = {};
  own.trace.seed = hash_combine(hash_combine(settings.trace.seed, kLookTag), tag);
  own.trace.guides = false;
  own.trace.only_pixel.reset();
  own.layers = {};
  return own;
}

FrameSettings raw(FrameSettings settings, double spp, const char* filter) {
  settings.foveation = {};
  settings.foveation.sampling = UniformSampling{};
  settings.foveation.spp = spp;
  settings.accumulate = {};
  settings.reconstruction = {filter};
  settings.trace.clamp_indirect = 0;
  settings.trace.guiding = false;
  return settings;
}

}  // namespace gazetrace
