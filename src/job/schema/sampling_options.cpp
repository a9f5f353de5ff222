// SPDX-License-Identifier: Apache-2.0
// How samples are distributed. The ranges that are stated here are checked by check_foveation(), whose messages say
// more.
#include "job/registry_names.hpp"
#include "job/schema/idle_rules.hpp"
#include "job/schema/parts.hpp"

namespace gazetrace {
namespace {

constexpr auto foveation(auto member) {
  return at(&JobSettings::foveation, member);
}
constexpr auto model(auto member) {
  return at(&JobSettings::foveation, &FoveationSettings::parameters, member);
}

constexpr double kMostSamples = 1e6;

void add_region_options(JobSchema& schema) {
  using F = FoveationSettings;
  schema
      .value("--region-samples", foveation(&F::region_samples), "N,N,N", Touch::sampling,
             "Samples of the fovea, the intermediate region and the periphery; --sample-unit says whether for a block "
             "or a pixel")
      .within(1, kMostSamples)
      .with(Trait::always_stated)
      .idle_when({without_gaze(), without_regions()});
  schema
      .value("--region-blocks", foveation(&F::region_blocks_px), "N,N", Touch::sampling,
             "Sides of the blocks of pixels in the intermediate region and in the periphery, in pixels")
      .within(1, 64)
      .with(Trait::always_stated)
      .idle_when({without_gaze(), without_regions()});
  schema
      .value("--region-angles", foveation(&F::region_angles_deg), "DEG,DEG", Touch::sampling,
             "Angles at which the fovea and the intermediate region end, in degrees; --angle-reading says how they are "
             "measured")
      .with(Trait::always_stated)
      .idle_when({without_gaze()});
  schema
      .value("--angle-reading", foveation(&F::reading), choices<AngleReading>(), Touch::sampling,
             "Whether the region angles are full angles, from one side of the gaze to the other, or eccentricities, "
             "from the gaze outwards")
      .with(Trait::always_stated)
      .idle_when({without_gaze()});
  schema
      .value("--sample-unit", foveation(&F::unit), choices<SampleUnit>(), Touch::sampling,
             "Whether region samples are counted for a whole block or for each of its pixels")
      .with(Trait::always_stated)
      .idle_when({without_gaze(), without_regions()});
  schema
      .value("--region-shape", foveation(&F::shape), choices<RegionShape>(), Touch::sampling,
             "How a region's border is measured: cone, by the angle between the rays of gaze and pixel; disc, as the "
             "paper's circle in pixels")
      .with(Trait::always_stated)
      .idle_when({without_gaze(), without_regions()});
}

void add_budget_options(JobSchema& schema) {
  using F = FoveationSettings;
  schema
      .value("--budget-spp", foveation(&F::budget_spp), "SAMPLES", Touch::sampling,
             "Scales the fall-off so that a frame has this many samples a pixel on average")
      .above(0, kMostSamples);
  schema
      .value("--budget-samples", foveation(&F::budget_samples), "N", Touch::sampling,
             "Scales the fall-off so that a frame has this many samples in all; excludes --budget-spp")
      .at_least(1);
  schema
      .value("--block-samples", foveation(&F::block_samples), "SAMPLES", Touch::sampling,
             "Density models: each place gets the smallest block that expects at least this many samples")
      .within(1, 65536)
      .idle_when({without_density(), with_regions(), with_uniform()});
  schema
      .value(
          "--max-block", foveation(&F::max_block_px), "1|2|4|8|16", Touch::sampling,
          "Density models: the largest side of a block, in pixels. With --falloff visible and --accumulate two-sided "
          "the default is 1, since frames are added up where their blocks are the same; 16 then counts as not given")
      .within(1, 16)
      .idle_when({without_density(), with_regions(), with_uniform()});
  schema
      .value("--density-floor", foveation(&F::density_floor), "DENSITY", Touch::sampling,
             "Density models: the lowest density, as a share of the full rate")
      .above(0, 1)
      .idle_when({without_density(), with_regions(), with_uniform()});
}

void add_model_options(JobSchema& schema) {
  using P = FalloffParameters;
  schema.value("--falloff-normalisation", model(&P::normalization), choices<FalloffNormalization>(), Touch::sampling,
               "Models with a cut-off frequency: density relative to the finest detail that the display can show, or "
               "relative to the fovea");
  schema
      .value("--falloff-ramp", model(&P::ramp), "DEG,DEG,DENSITY", Touch::sampling,
             "linear, quadric: full rate up to the first eccentricity, falling to the given density at the second and "
             "beyond")
      .idle_when({with_other_falloffs({"linear", "quadric"})});
  schema
      .value("--falloff-mar-slope", model(&P::mar_slope), "DEG", Touch::sampling,
             "mar: growth of the minimum angle of resolution, in degrees a cycle for each degree of eccentricity; "
             "published values are 0.022 to 0.0275")
      .within(0, 180)
      .idle_when({with_other_falloffs({"mar"})});
  schema
      .value("--falloff-mar-foveal", model(&P::mar_foveal_deg), "DEG", Touch::sampling,
             "mar: the minimum angle of resolution at the gaze, in degrees a cycle")
      .within(0, 180)
      .idle_when({with_other_falloffs({"mar"})});
  schema
      .value("--falloff-contrast", model(&P::contrast), "CONTRAST", Touch::sampling,
             "geisler-perry, csf: contrast of the detail that must stay visible")
      .above(0, 1)
      .idle_when({with_other_falloffs({"geisler-perry", "csf"})});
  schema
      .value("--falloff-luminance", model(&P::luminance_cd_m2), "CD/M2", Touch::sampling,
             "csf: luminance that the eye is adapted to, in cd/m2")
      .above(0)
      .idle_when({with_other_falloffs({"csf"})});
  schema
      .value("--falloff-eye", model(&P::eye), choices<FalloffEye>(), Touch::sampling,
             "retina, csf: which eye's visual field; both: at each place the eye that sees better")
      .idle_when({with_other_falloffs({"retina", "csf"})});
  schema
      .value("--falloff-log-polar-sigma", model(&P::log_polar_sigma), "RATIO", Touch::sampling,
             "log-polar: ratio of the frame's side to that of the log-polar buffer")
      .above(0)
      .idle_when({with_other_falloffs({"log-polar"})});
  schema
      .value("--falloff-log-polar-alpha", model(&P::log_polar_alpha), "EXPONENT", Touch::sampling,
             "log-polar: exponent of the kernel")
      .above(0)
      .idle_when({with_other_falloffs({"log-polar"})});
  schema
      .value("--falloff-table", model(&P::table), "FILE", Touch::sampling,
             "table: a CSV file with the columns ecc_deg,density")
      .decides_by_file()
      .idle_when({with_other_falloffs({"table"})});
  schema
      .value("--density-map", foveation(&FoveationSettings::density_map), "FILE", Touch::sampling,
             "map: an EXR file of samples a pixel or, with a budget, of relative rates. A picture of another size is "
             "stretched over the frame; with #### in its name there is one for each frame")
      .decides_by_file()
      .idle_when({with_other_falloffs({"map"})});
}

void add_pilot_options(JobSchema& schema) {
  using F = FoveationSettings;
  JobIdleRule without_rates_to_limit = with_other_falloffs({"visible"});
  without_rates_to_limit.words = "with any other `falloff` than visible and without a target";
  without_rates_to_limit.holds = [elsewhere = without_rates_to_limit.holds](const JobSettings& job) {
    return elsewhere(job) && !job.foveation.target.is_given();
  };
  schema
      .value("--min-spp", foveation(&F::min_spp), "SAMPLES", Touch::sampling,
             "visible: the lowest rate anywhere in the frame, in samples a pixel; with --target-jod, of a frame, which "
             "never has less than 0.25")
      .within(0, kMostSamples)
      .idle_when({without_rates_to_limit});
  schema
      .value("--max-spp", foveation(&F::max_spp), "SAMPLES", Touch::sampling,
             "visible: the highest rate anywhere in the frame, in samples a pixel; with --target-jod, of a frame")
      .above(0, kMostSamples)
      .idle_when({without_rates_to_limit});
  schema
      .value("--target-relmse", at(&JobSettings::foveation, &F::target, &QualityTarget::relmse), "ERROR",
             Touch::sampling,
             "visible: chooses the number of samples for which the pilot predicts this relative mean squared error of "
             "the frame; excludes budgets")
      .above(0)
      .need("`falloff` visible");
}

void add_target_options(JobSchema& schema) {
  using F = FoveationSettings;
  schema
      .value("--target-jod", at(&JobSettings::foveation, &F::target, &QualityTarget::jod), "JOD", Touch::sampling,
             "As many samples as it takes until the sequence scores so much by FovVideoVDP, as 'gazetrace compare' "
             "measures it. Any --falloff but 'regions', any --filter; with --accumulate two-sided at rest many times "
             "fewer samples")
      .within(0, 10)
      .need("gaze and another `falloff` than regions");
}

}  // namespace

void add_sampling_options(JobSchema& schema) {
  schema.group("Where the samples go");
  JobIdleRule without_any_gaze = without_gaze();
  without_any_gaze.holds = [](const JobSettings& job) { return !has_gaze(job) && !works_without_gaze(job.foveation); };
  schema
      .value("--falloff", foveation(&FoveationSettings::falloff), "NAME", Touch::sampling,
             "How the sampling density falls off with eccentricity ('gazetrace list falloffs'); how pixels are filled "
             "from the samples is --filter, which has a 'linear', too. Where nothing names one, --target-jod and "
             "--target-relmse take visible")
      .checked_by(check_falloff_name)
      .with(Trait::always_stated)
      .idle_when({without_any_gaze})
      .with(Trait::everyday);
  schema
      .value("--spp", foveation(&FoveationSettings::uniform_spp), "N", Touch::sampling,
             "Samples a pixel of uniform frames, the full rate of density models, and the budget of 'visible' where no "
             "other is given; plan --counts compares with it")
      .within(1, kMostSamples)
      .with(Trait::everyday);
  add_region_options(schema);
  add_budget_options(schema);
  add_target_options(schema);
  schema.group("Density models ('gazetrace list falloffs')");
  add_model_options(schema);
  add_pilot_options(schema);
}

}  // namespace gazetrace
