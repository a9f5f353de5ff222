// SPDX-License-Identifier: Apache-2.0
#include "job/schema/idle_rules.hpp"
#include "job/schema/parts.hpp"

namespace gazetrace {
namespace {

void add_exr_options(JobSchema& schema) {
  const auto exr = [](auto member) { return at(&JobSettings::exr, member); };
  schema
      .value("--exr-pixels", exr(&ExrSettings::pixels), choices<ExrPixels>(), Touch::output,
             "Type of the colour channels")
      .with(Trait::one_run);
  schema
      .value("--exr-space", exr(&ExrSettings::space), choices<ExrSpace>(), Touch::output,
             "Linear colours of the .exr: converted when they are written, with their chromaticities in the header")
      .with(Trait::one_run);
  schema
      .value("--exr-compression", exr(&ExrSettings::compression), "NAME", Touch::output,
             "none, rle, zips, zip, piz, pxr24, b44, b44a, dwaa or dwab")
      .with(Trait::one_run);
  schema
      .flag(
          "--alpha", exr(&ExrSettings::alpha), Touch::output,
          "Writes how much of each pixel surfaces cover, and leaves the environment out of the picture, which it still "
          "lights: premultiplied in .exr, straight in .png and .tif")
      .with(Trait::one_run);
  schema
      .value("--aov", exr(&ExrSettings::aovs), "NAME,NAME", Touch::output,
             "Further channels of the .exr ('gazetrace list aovs')")
      .with(Trait::one_run);
  schema
      .value("--exr-parts", exr(&ExrSettings::parts), choices<ExrParts>(), Touch::output,
             "All channels of the .exr in one part, or each layer in a part of its own")
      .with(Trait::one_run);
  schema
      .value("--sky-depth", exr(&ExrSettings::sky_depth_m), "METRES", Touch::output,
             "Depth of pixels that see nothing, for programs that cannot take infinite ones")
      .within(0, 1e9)
      .with(Trait::one_run)
      .idle_when({without_aov("depth")});
  schema
      .value("--crypto-ranks", exr(&ExrSettings::crypto_ranks), "N", Touch::output,
             "How many names Cryptomatte layers keep for a pixel: an even number, two to a layer")
      .within(2, 16)
      .with(Trait::one_run)
      .idle_when({without_aov("crypto_")});
  schema
      .value("--crypto-samples", exr(&ExrSettings::crypto_rays), "N", Touch::output,
             "First hits in each pixel that the coverage of Cryptomatte and `alpha` is counted from, the same in all "
             "pixels")
      .within(1, 1024)
      .with(Trait::one_run)
      .idle_when({without_coverage()});
}

}  // namespace

void add_output_options(JobSchema& schema) {
  schema.group("Files");
  schema
      .repeated("-o,--output", &JobSettings::outputs, "PATTERN", Touch::output,
                "Linear pictures (.exr) and display pictures (.png .jpg .tif .dpx), one option each; the frame's "
                "number stands where ####, %04d or <frame> is")
      .decides_nothing()
      .with(Trait::one_run)
      .with(Trait::everyday);
  add_exr_options(schema);
  schema
      .value("--map", &JobSettings::map_pattern, "PATTERN", Touch::output,
             "Sampling maps (.exr): region, samples a pixel, eccentricity")
      .decides_nothing()
      .with(Trait::one_run);
  schema.value("--bits", at(&JobSettings::picture, &DisplaySettings::bits), "8|16", Touch::output,
               "Bits per channel of .png and .tif");
  schema.value("--jpeg-quality", at(&JobSettings::picture, &DisplaySettings::quality), "1..100", Touch::output,
               "Quality of .jpg");
  schema.flag("--overwrite", &JobSettings::overwrite, Touch::output, "Replaces files that exist already")
      .decides_nothing()
      .with(Trait::one_run)
      .with(Trait::everyday);
  schema
      .flag("--resume", &JobSettings::resume, Touch::output,
            "Keeps finished frames of the same settings and inputs, after comparing their files with their digests, "
            "and renders the rest. It refuses frames of other settings or inputs; with --overwrite it renders them "
            "again")
      .decides_nothing()
      .with(Trait::one_run)
      .with(Trait::everyday);
}

void add_talk_options(JobSchema& schema) {
  schema.group("Talk");
  schema
      .value(
          "--progress", &JobSettings::progress, "auto|always|never|openjd|json|json:FD", Touch::talk,
          "auto: a bar on a terminal, plain lines elsewhere. always: the bar. openjd: lines on stdout for workers of "
          "Open Job Description. json: a JSON object for each event (begin, frame, warning, end) on stderr in place of "
          "all text; json:FD: on that file descriptor")
      .decides_nothing()
      .with(Trait::one_run);
  schema.flag("--quiet", &JobSettings::quiet, Touch::talk, "No progress and no summary; warnings and errors stay")
      .decides_nothing()
      .with(Trait::one_run);
}

}  // namespace gazetrace
