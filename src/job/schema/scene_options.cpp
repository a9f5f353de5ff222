// SPDX-License-Identifier: Apache-2.0
#include "job/schema/parts.hpp"

namespace gazetrace {

void add_scene_options(JobSchema& schema) {
  schema.group("Scene and light");
  schema.value("scene", &JobSettings::scene, "FILE", Touch::scene, "glTF 2.0 scene, .gltf or .glb").decides_by_file();
  schema.value("--animation", &JobSettings::animation, "NAME|N", Touch::scene,
               "The animation that plays, by name or number from 0; default: for each body and camera the first that "
               "moves it ('gazetrace scene' lists them)");
  schema
      .value("--env", &JobSettings::environment, "FILE|sky|constant:R,G,B|none|auto", Touch::light,
             "Light from all around: a lat-long .hdr or .exr, the built-in sky, a constant radiance, or none; auto is "
             "the sky for a scene without light of its own, otherwise none")
      .decides_by_file();
  schema.value("--env-rotation", &JobSettings::environment_rotation_deg, "DEG", Touch::light,
               "Turns the environment about +y, degrees");
  schema.value("--env-ev", &JobSettings::environment_ev, "STOPS", Touch::light, "Multiplies the environment by 2^STOPS")
      .within(-kMaxStops, kMaxStops);
}

}  // namespace gazetrace
