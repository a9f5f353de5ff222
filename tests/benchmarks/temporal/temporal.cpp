// SPDX-License-Identifier: Apache-2.0
// What accumulation over time gives and costs, on a scene under a sky, at equal samples.
//   gazetrace_temporal scene.gltf sky.hdr gaze.csv [--frames N] [--height PX] [--reference-spp N]
//   [--filter NAME,NAME] [--start X,Y,Z] [--only sequences|light|body|seams]
// Two sequences at 24 frames a second, both with the recorded gaze (replay, not viewing): a camera that glides and
// turns, and one that stands still while the gaze moves. References are uniform, of two halves with other seeds, whose
// difference gives the floor below which nothing is claimed; where the camera stands, of 16 times --reference-spp.
//   relmse   mean over frames and pixels of (x - ref)^2 / (ref^2 + 0.01 mean^2), the reference's own taken off
//   bias     mean of x - ref over all frames and pixels, by the mean of ref, percent
//   local    root mean square over pixels of the mean over time of x - ref, by the mean of ref: what does not average
//            out; noise of x and reference is in it
//   flicker  standard deviation over time between 1 Hz and half the frame rate, in excess of the reference's, root mean
//            square over pixels, by the mean of ref
//   seen     the same as an eye sees it: FlickerMeter's excess, in multiples of what is just visible where it is (0.18
//            of a display of 200 cd/m2 shows the mean of ref); beside it that of the pixels beyond 8.5 degrees
// Then: how long a light that goes out (a tenth of the sky) and a body that is gone (its shadow too) are still seen,
// and what a run that begins with frames rendered before its first differs from the whole one.
#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <string>
#include <string_view>
#include <vector>

#include "benchmark_main.hpp"
#include "gazetrace/error.hpp"
#include "temporal/changes.hpp"
#include "temporal/sequences.hpp"
#include "world.hpp"

namespace {

using namespace gazetrace;
using namespace gazetrace::temporal;

Options parse(int argc, char** argv) {
  Options options;
  std::vector<std::string> files;
  for (int i = 1; i < argc; ++i) {
    const std::string_view name = argv[i];
    if (name.substr(0, 2) != "--") {
      files.emplace_back(name);
      continue;
    }
    const char* value = i + 1 < argc ? argv[++i] : "";
    if (name == "--frames") {
      options.frames = std::atoi(value);
    } else if (name == "--height") {
      options.height_px = std::atoi(value);
    } else if (name == "--reference-spp") {
      options.reference_spp = static_cast<std::uint32_t>(std::atoi(value));
    } else if (name == "--filter") {
      options.filters = benchmark::parse_names(value);
    } else if (name == "--start") {
      options.start = benchmark::parse_point(value);
    } else if (name == "--only") {
      options.only = value;
    } else {
      throw Error(ErrorKind::usage, name, "is not known");
    }
  }
  if (options.frames < 1 || options.height_px < 1) {
    throw Error(ErrorKind::usage, options.frames < 1 ? "--frames" : "--height", "must be 1 or more");
  }
  const std::array<std::string_view, 5> parts{"", "seams", "light", "body", "sequences"};
  if (std::find(parts.begin(), parts.end(), options.only) == parts.end()) {
    throw Error(ErrorKind::usage, "--only", options.only + " is no part", "seams, light, body or sequences");
  }
  if (files.size() != 3) {
    throw Error(ErrorKind::usage, "", "give a scene, a sky and a gaze log");
  }
  options.scene = files[0];
  options.sky = files[1];
  options.gaze = files[2];
  return options;
}

int run(int argc, char** argv) {
  const Options options = parse(argc, argv);
  Scene scene = load_scene(options.scene);
  scene.environment = load_environment(options.sky);
  PathTracer tracer(scene, {});
  const Bench bench(options);
  const auto wanted = [&](const char* part) { return options.only.empty() || options.only == part; };
  for (const std::string& filter : options.filters) {
    if (options.only != "sequences") {
      fmt::print("\n## {}\n", filter);
    }
    if (wanted("seams")) {
      seams(tracer, bench, filter);
    }
    if (wanted("light")) {
      light_goes_out(tracer, scene, bench, filter);
    }
    if (wanted("body")) {
      body_is_gone(tracer, scene, bench, options, filter);
    }
  }
  if (wanted("sequences")) {
    compare_sequences(tracer, bench, options);
  }
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  return gazetrace::benchmark::benchmark_main(run, argc, argv);
}
