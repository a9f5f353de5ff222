// SPDX-License-Identifier: Apache-2.0
#include "job/schema/idle_rules.hpp"
#include "job/schema/parts.hpp"

namespace gazetrace {
namespace {

constexpr auto trace(auto member) {
  return at(&JobSettings::trace, member);
}

constexpr double kMostBounces = 1000;
constexpr double kMostThreads = 1024;

void add_light_path_options(JobSchema& schema) {
  schema
      .value("--bounces", trace(&TraceSettings::max_bounces), "N", Touch::tracing,
             "Scattering events on a path; 0 shows emission only")
      .within(0, kMostBounces)
      .with(Trait::trade_off)
      .with(Trait::needs_truth)
      .with(Trait::always_stated);
  schema
      .flag("--russian-roulette", trace(&TraceSettings::russian_roulette), Touch::tracing,
            "Ends dim paths early from the third bounce on, without bias")
      .with(Trait::trade_off);
  schema
      .value("--diffuse", trace(&TraceSettings::diffuse), choices<DiffuseModel>(), Touch::tracing,
             "The model of diffuse reflection")
      .with(Trait::always_stated);
  schema
      .value("--light-sampling", trace(&TraceSettings::light_sampling), choices<LightSampling>(), Touch::tracing,
             "Samples at a hit: of lights and surface together (mis), or of one of them alone")
      .with(Trait::trade_off)
      .with(Trait::always_stated);
  schema
      .flag("--guiding", trace(&TraceSettings::guiding), Touch::tracing,
            "Path guiding: training paths of each frame find where its light arrives from, and bounces are drawn "
            "towards it: "
            "less noise indoors and under arcades, without bias")
      .with(Trait::trade_off)
      .with(Trait::always_stated)
      .idle_when({with_lights_sampled_alone()});
  schema
      .value("--clamp-indirect", trace(&TraceSettings::clamp_indirect), "RADIANCE", Touch::tracing,
             "The most that a sample may add after more than one scattering event, which removes fireflies but is "
             "biased; 0: off")
      .at_least(0, "give a positive number, or 0 for none")
      .with(Trait::trade_off)
      .with(Trait::always_stated);
}

void add_texture_options(JobSchema& schema) {
  schema
      .value("--pixel-filter", trace(&TraceSettings::filter), choices<PixelFilter>(), Touch::tracing,
             "Spread of the samples of a pixel; --filter guided has edges and texture of a box in any case")
      .with(Trait::always_stated);
}

}  // namespace

void add_tracing_options(JobSchema& schema) {
  schema.group("Light transport");
  add_light_path_options(schema);
  add_texture_options(schema);
  schema
      .value("--seed", trace(&TraceSettings::seed), "N", Touch::tracing,
             "Same seed, same pictures, for any number of threads")
      .with(Trait::own_seed)
      .with(Trait::always_stated);
  schema
      .value("--threads", &JobSettings::threads, "N", Touch::speed,
             "0: as many as the machine has; pictures do not depend on it")
      .decides_nothing()
      .within(0, kMostThreads, "0 takes all");
  schema
      .value("--only-pixel", &JobSettings::only_pixel, "X,Y", Touch::tracing,
             "Traces only the samples of this pixel, for replaying a bad one; without --output it is printed")
      .with(Trait::one_run);
}

}  // namespace gazetrace
