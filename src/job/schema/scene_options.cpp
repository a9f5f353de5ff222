// SPDX-License-Identifier: Apache-2.0
#include "job/schema/parts.hpp"

namespace gazetrace {

void add_scene_options(JobSchema& schema) {
  schema.group("Scene and light");
  schema.value("scene", &JobSettings::scene, "FILE", Touch::scene, "glTF 2.0 scene, .gltf or .glb")
      .decides_by_file()
      .with(Trait::everyday);
  schema.value("--animation", &JobSettings::animation, "NAME|N", Touch::scene,
               "The animation that plays, by name or number from 0; default: for each body and camera the first that "
               "moves it ('gazetrace scene' lists them)");
  schema.flag("--cull-back-faces", &JobSettings::cull_back_faces, Touch::scene,
              "The camera looks through the backs of faces whose material is not double-sided, as glTF says; light and "
              "reflections see them in any case");
  schema
      .value("--env", &JobSettings::environment, "FILE|sky|soft-sky|constant:R,G,B|none|auto", Touch::light,
             "Light from all around: a lat-long .hdr or .exr, the built-in clear sky with its sun, one without a sun "
             "(soft-sky), a constant radiance, or none. auto: the environment that the scene names in its extras, else "
             "the sky if the scene has no light of its own, else none")
      .decides_by_file()
      .with(Trait::everyday);
  schema.value("--env-rotation", &JobSettings::environment_rotation_deg, "DEG", Touch::light,
               "Turns the environment about +y, degrees");
  schema.value("--env-ev", &JobSettings::environment_ev, "STOPS", Touch::light, "Multiplies the environment by 2^STOPS")
      .within(-kMaxStops, kMaxStops);
}

void add_limit_options(JobSchema& schema) {
  schema.group("Limits");
  schema
      .flag("--allow-outside", &JobSettings::allow_outside, Touch::scene,
            "The scene and a BIDS gaze log may lead to files outside of their folder, or of the data set that they "
            "belong to; give it for data that you trust")
      .decides_nothing();
  schema.flag("--allow-missing", &JobSettings::allow_missing, Touch::scene,
              "Materials whose pictures are not there are shown without them, with a warning; else they end the run");
  schema
      .flag("--strict", &JobSettings::strict, Touch::scene,
            "Refuses a scene that has to be mended, or of which something is left out, in place of a warning")
      .decides_nothing();
  schema
      .flag(
          "--confine", &JobSettings::confine, Touch::output,
          "The settings file must not name files outside of its own folder, or of the data set that it belongs to, to "
          "read or to write; give it on the command line for settings that you do not trust")
      .decides_nothing()
      .with(Trait::one_run);
  schema
      .value("--max-memory", &JobSettings::max_memory, "BYTES", Touch::scene,
             "Refuses a scene that will take more memory, before it is loaded: 8G, 500M; 0: three quarters of the "
             "machine's memory. Frames whose windows take more (--accumulate) are refused, too. Nodes, and pictures "
             "beyond 200 times "
             "their file, may take a sixteenth of it. 'gazetrace "
             "scene FILE --estimate' says how much a scene will take")
      .decides_nothing();
}

}  // namespace gazetrace
