// SPDX-License-Identifier: Apache-2.0
// What tracing counts, added up: of several traces, of the parts of a frame, or in a frame's row of timing.csv.
#pragma once

#include "gazetrace/output.hpp"
#include "gazetrace/trace.hpp"

namespace gazetrace {

inline double pixels_of(const FrameRequest& request) {
  return static_cast<double>(request.width_px) * request.height_px;
}

// `From` and `To` are TraceStats or TimingRow, which name these counts alike.
template <class From, class To>
void add_counts(const From& from, To& to) {
  to.samples += from.samples;
  to.training_paths += from.training_paths;
  to.rays_primary += from.rays_primary;
  to.rays_bounce += from.rays_bounce;
  to.rays_shadow += from.rays_shadow;
  to.rejected_rays += from.rejected_rays;
  to.non_finite_samples += from.non_finite_samples;
}

// Of traces whose regions need not be the same: they are kept one after the other, for their time.
inline void add_traces(const TraceStats& from, TraceStats& to) {
  add_counts(from, to);
  to.seen_backs += from.seen_backs;
  to.bad_samples.insert(to.bad_samples.end(), from.bad_samples.begin(), from.bad_samples.end());
  to.regions.insert(to.regions.end(), from.regions.begin(), from.regions.end());
  to.kernel = from.kernel;
}

}  // namespace gazetrace
