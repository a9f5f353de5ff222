// SPDX-License-Identifier: Apache-2.0
// What is left of the past after something has changed at once.
#pragma once

#include "temporal/bench.hpp"

namespace gazetrace::temporal {

// The sky falls to a tenth from one frame to the next.
void light_goes_out(PathTracer& tracer, const Scene& scene, const Bench& bench, const std::string& filter);
// A board that stands before the camera is gone: where it was seen, and where its shadow or light was.
void body_is_gone(PathTracer& tracer, const Scene& scene, const Bench& bench, const Options& options,
                  const std::string& filter);
// A run that begins later, with frames rendered before its first, against the whole one.
void seams(PathTracer& tracer, const Bench& bench, const std::string& filter);

}  // namespace gazetrace::temporal
