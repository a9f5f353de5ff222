// SPDX-License-Identifier: Apache-2.0
// How much light a layer leaves for what is below it, from the layer's directional albedo A and the cosine average of
// A. Both forms are symmetric in o and i, so that the whole BSDF stays reciprocal:
//   broad lobes (diffuse, sheen, repeated scattering)   (1 - A(o)) (1 - A(i)) / (1 - A_avg)
//       exact at every angle for a white Lambertian base (Kulla and Conty 2017)
//   narrow lobes (facets, refraction)                   1 - max(A(o), A(i))
//       exact for mirrors, where both are equal; KHR_materials_sheen states this form. Elsewhere it loses light, a few
//       percent under a clearcoat, and never gains any.
// Over a base that is not quite Lambertian the broad form gains light: 1.3 % under a smooth clearcoat, 1.6 % under
// sheen, and 3.3 % under a clearcoat over sheen, at roughness 0 seen from above (layered_furnace_test).
#pragma once

#include <algorithm>

namespace gazetrace {

struct LayerAlbedo {
  float o = 0, average = 0;

  [[nodiscard]] float broad(float i) const { return (1.0F - o) * (1.0F - i) / std::max(1.0F - average, 1e-3F); }
  [[nodiscard]] float narrow(float i) const { return 1.0F - std::max(o, i); }
};

}  // namespace gazetrace
