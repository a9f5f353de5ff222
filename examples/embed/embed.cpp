// SPDX-License-Identifier: Apache-2.0
// The library without the program: one frame, foveated about a fixed gaze. It is the picture that
//   gazetrace render scene.gltf --gaze-at U,V --screen paper --size 320x180 --frames 1 -o out.exr
// makes, to the bit: a job stands for the options, resolve() reads and checks what it names, and a FrameRenderer
// renders each frame of the plan.
//   embed scene.gltf out.exr [U V]      (U, V: gaze in fractions of the screen; default: its middle)
#include <cstdio>
#include <string>

#include "gazetrace/error.hpp"
#include "gazetrace/frame_renderer.hpp"
#include "gazetrace/output.hpp"
#include "gazetrace/resolve.hpp"

namespace {

void render(const std::string& scene, const std::string& exr, const std::string& gaze) {
  using namespace gazetrace;
  Job job;
  set_option(job, "scene", scene);
  set_option(job, "gaze-at", gaze);
  set_option(job, "screen", "paper");
  set_option(job, "size", "320x180");
  set_option(job, "frames", "1");

  ResolvedJob resolved = resolve(job);
  for (const auto& [what, decision] : resolved.decisions) {
    std::printf("%s: %s\n", what.c_str(), decision.c_str());
  }
  PathTracer tracer(*resolved.scene, tracer_options(resolved.job.settings));
  const FrameRenderer renderer(tracer, resolved.pipeline);
  for (const FrameRequest& request : resolved.plan.frames) {
    const RenderedFrame rendered = renderer.render(request);
    FrameHeader header;
    header.frame = request.frame;
    header.camera = request.camera;
    write_frame_exr(exr, rendered.frame, nullptr, header, {});
    std::printf("frame %d: %llu samples, %.1f ms of tracing\n", request.frame,
                static_cast<unsigned long long>(rendered.samples.samples), rendered.times.trace_ms);
  }
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3 && argc != 5) {
    std::fprintf(stderr, "usage: embed scene.gltf out.exr [U V]\n");
    return 2;
  }
  try {
    render(argv[1], argv[2], argc == 5 ? std::string(argv[3]) + "," + argv[4] : "0.5,0.5");
    return 0;
  } catch (const gazetrace::Error& error) {
    std::fprintf(stderr, "embed: %s\n", error.what());
    return error.kind() == gazetrace::ErrorKind::runtime ? 3 : 2;
  }
}
