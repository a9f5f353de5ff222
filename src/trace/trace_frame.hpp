// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "gazetrace/foveation.hpp"
#include "gazetrace/trace.hpp"
#include "trace/kernel/kernel.hpp"

namespace gazetrace {

// Traces the samples of all sites of a map, or of those that the settings of `context` name: ranges of sites in
// parallel, the batches of a range in order. TraceStats::kernel stays empty.
SparseFrame trace_frame(const FrameContext& context, Kernel kernel, std::int32_t frame, const SamplingMap& map,
                        int threads);

}  // namespace gazetrace
