// SPDX-License-Identifier: Apache-2.0
// Errors, bias and flicker over a sequence, variant by variant.
#pragma once

#include "temporal/bench.hpp"

namespace gazetrace::temporal {

void compare_sequences(PathTracer& tracer, const Bench& bench, const Options& options);

}  // namespace gazetrace::temporal
