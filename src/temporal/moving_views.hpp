// SPDX-License-Identifier: Apache-2.0
// Where nothing but the camera moves, a surface is lit in one frame as in any other. What the frames around a frame saw
// of its surfaces' light joins what its own samples say, before the filter, which then finds less noise to take away
// and leaves less bias. If each frame were filtered by itself, bias would be what all of them have in common, and a
// mean over them would keep it.
#pragma once

#include <cstdint>
#include <vector>

#include "gazetrace/camera.hpp"
#include "gazetrace/foveation.hpp"
#include "gazetrace/guides.hpp"
#include "gazetrace/trace.hpp"

namespace gazetrace {

// What a frame has sampled, and from where.
struct ViewSamples {
  std::int32_t frame = 1;
  const Camera* camera = nullptr;
  const SamplingMap* map = nullptr;
  const SparseFrame* sparse = nullptr;  // with surfaces
};

// Members of SparseFrame, and how many samples of others there are for each pixel of each site.
struct JoinedSurfaces {
  std::vector<SurfaceSums> surfaces;
  std::vector<std::uint32_t> first_surface;
  std::vector<std::uint32_t> samples_of_others;
  std::vector<float> others_per_pixel;
};

// The surfaces of `own`, lit as its samples and those of the others found: of those surfaces that lie in the same site
// as `own` sees them, are of the same kind, on the same plane and face the same way. Samples of all frames count alike.
// Left out are surfaces whose look depends on the view, unless the camera is the same; all that was seen from a
// direction more than 5 degrees away, since other surfaces shine a little, too; and what was seen more coarsely than at
// kMostCoarse times the frame's own footprint, whose mean would lie in one of the many sites that it belongs to.
//
// What joins a surface is the light on it, the quotient of what it reflects and its albedo. Its own texture, normal and
// place stay, as do all other sums of the site, since they hold what is seen at this very place: edges, reflections.
// Where nothing joins a surface it keeps its bits. Halves are the samples of frames an even and an odd number of frames
// away, beside the halves of the frame's own samples where it has both.
//
// A site without samples has the surface that the guides see in its middle, lit as the others found it, if they did; it
// counts one of their samples as its own.
//
// A surface is where its samples hit it, which through a lens or an open shutter is not where the site is: there fewer
// samples find a surface of the site to join.
//
// `others`: frames of the same size, of other numbers, in any order; the last digits depend on it. `guides`: of `own`.
inline constexpr float kMostCoarse = 2;
JoinedSurfaces surfaces_of_views(const ViewSamples& own, const std::vector<ViewSamples>& others, const Guides& guides,
                                 int threads);

}  // namespace gazetrace
