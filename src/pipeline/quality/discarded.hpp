// SPDX-License-Identifier: Apache-2.0
// Settings of renderings that decide how a sequence is rendered, and whose samples are then discarded.
#pragma once

#include <cstdint>

#include "gazetrace/frame_renderer.hpp"

namespace gazetrace {

// Part of the seed of every such rendering, so that its samples are not those of the sequence: "LOOK".
constexpr std::uint64_t kLookTag = 0x4c4f4f4bULL;

// The job's own, with samples of their own that `tag` chooses, and nothing beside the picture.
FrameSettings discarded(const FrameSettings& settings, std::uint64_t tag);

// The same number of samples in every pixel, neither guided nor clamped, without accumulation.
FrameSettings raw(FrameSettings settings, double spp, const char* filter);

}  // namespace gazetrace
