// SPDX-License-Identifier: Apache-2.0
// The library without the program: one foveated frame of a scene, with the picture that
//   gazetrace render scene.gltf -o out.exr --gaze-at U,V --screen paper --size 320x180 --overwrite
// makes, and what it cost.
//   embed scene.gltf out.exr [u v]      (u, v: gaze as fractions of the screen)
#include <cstdio>
#include <string>
#include <utility>

#include "gazetrace/color.hpp"
#include "gazetrace/error.hpp"
#include "gazetrace/job.hpp"
#include "gazetrace/pipeline.hpp"
#include "gazetrace/resolve.hpp"
#include "gazetrace/trace.hpp"

namespace {

int render(const std::string& scene, const std::string& picture, const std::string& u, const std::string& v) {
  using namespace gazetrace;
  Job job;
  set_option(job, "scene", scene);
  set_option(job, "output", picture);
  set_option(job, "gaze-at", u + "," + v);
  set_option(job, "screen", "paper");
  set_option(job, "size", "320x180");
  set_option(job, "overwrite", "true");

  ResolvedJob resolved = resolve(job);  // everything that can fail is found here
  prepare_outputs(resolved);
  for (const auto& [what, decision] : resolved.decisions) {
    std::printf("%s: %s\n", what.c_str(), decision.c_str());
  }
  PathTracer tracer(*resolved.scene, tracer_options(resolved.job.settings));
  const ColorPipeline color(resolved.job.settings.color);
  const SequenceResult result =
      render_sequence(tracer, resolved.plan, color, resolved.pipeline, {}, std::move(resolved.history));

  for (const TimingRow& row : result.rows) {
    std::printf("frame %d: %llu samples for %llu pixels in %.1f ms\n", row.frame,
                static_cast<unsigned long long>(row.samples), static_cast<unsigned long long>(row.pixels),
                row.total_ms);
  }
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3 && argc != 5) {
    std::fprintf(stderr, "usage: embed scene.gltf out.exr [u v]\n");
    return 2;
  }
  try {
    return render(argv[1], argv[2], argc == 5 ? argv[3] : "0.5", argc == 5 ? argv[4] : "0.5");
  } catch (const gazetrace::Error& error) {
    std::fprintf(stderr, "embed: %s\n", error.what());
    return error.kind() == gazetrace::ErrorKind::runtime ? 3 : 2;
  }
}
