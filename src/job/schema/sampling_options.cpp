// SPDX-License-Identifier: Apache-2.0
// How samples are distributed. The ranges that are stated here are checked by check_foveation(), whose messages say
// more.
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
             "Samples in fovea, intermediate region and periphery")
      .within(1, kMostSamples)
      .with(Trait::always_stated)
      .idle_when({without_gaze(), without_regions()});
  schema
      .value("--region-blocks", foveation(&F::region_blocks_px), "N,N", Touch::sampling,
             "Block sizes of intermediate region and periphery, pixels")
      .within(1, 64)
      .with(Trait::always_stated)
      .idle_when({without_gaze(), without_regions()});
  schema
      .value("--region-angles", foveation(&F::region_angles_deg), "DEG,DEG", Touch::sampling,
             "Where fovea and intermediate region end, degrees")
      .with(Trait::always_stated)
      .idle_when({without_gaze()});
  schema
      .value("--angle-reading", foveation(&F::reading), choices<AngleReading>(), Touch::sampling,
             "The angles are diameters (full-angle) or eccentricities")
      .with(Trait::always_stated)
      .idle_when({without_gaze()});
  schema
      .value("--sample-unit", foveation(&F::unit), choices<SampleUnit>(), Touch::sampling,
             "Samples count for a block or for each of its pixels")
      .with(Trait::always_stated)
      .idle_when({without_gaze(), without_regions()});
  schema
      .value("--region-shape", foveation(&F::shape), choices<RegionShape>(), Touch::sampling,
             "cone: by the angle between rays; disc: the paper's circle in pixels")
      .with(Trait::always_stated)
      .idle_when({without_gaze(), without_regions()});
  schema
      .value("--border-blend-deg", foveation(&F::border_blend_deg), "DEG", Touch::sampling,
             "Width of the rim about a region's border over which the density goes smoothly from one to the other, "
             "between the regions' own rates and blocks; 0: a hard border")
      .within(0, 180)
      .idle_when({without_gaze(), without_regions()});
}

void add_budget_options(JobSchema& schema) {
  using F = FoveationSettings;
  schema
      .value("--budget-spp", foveation(&F::budget_spp), "SAMPLES", Touch::sampling,
             "Scales any fall-off until a frame has so many samples a pixel on average")
      .above(0, kMostSamples);
  schema
      .value("--budget-samples", foveation(&F::budget_samples), "N", Touch::sampling,
             "The same by the samples of a frame in all; excludes --budget-spp")
      .at_least(1);
  schema
      .value("--block-samples", foveation(&F::block_samples), "SAMPLES", Touch::sampling,
             "Density models: the smallest block is taken that expects so many samples")
      .within(1, 65536)
      .idle_when({without_density(), with_hard_regions(), with_uniform()});
  schema
      .value("--max-block", foveation(&F::max_block_px), "1|2|4|8|16", Touch::sampling,
             "Density models: largest side of a block, pixels")
      .within(1, 16)
      .idle_when({without_density(), with_hard_regions(), with_uniform()});
  schema
      .value("--density-floor", foveation(&F::density_floor), "DENSITY", Touch::sampling,
             "Density models: the least part of the full rate that a place gets; blended regions go below 1/512 where "
             "their own rates do")
      .above(0, 1)
      .idle_when({without_density(), with_hard_regions(), with_uniform()});
}

void add_model_options(JobSchema& schema) {
  using P = FalloffParameters;
  schema.value("--falloff-normalisation", model(&P::normalization), choices<FalloffNormalization>(), Touch::sampling,
               "Models of a cut-off frequency: against what the display shows, or relative to the fovea");
  schema
      .value("--falloff-ramp", model(&P::ramp), "DEG,DEG,DENSITY", Touch::sampling,
             "linear, quadric: full up to the first eccentricity, the density from the second on")
      .idle_when({with_other_falloffs({"linear", "quadric"})});
  schema
      .value("--falloff-mar-slope", model(&P::mar_slope), "DEG", Touch::sampling,
             "mar: degrees a cycle for each degree of eccentricity; 0.022 to 0.0275")
      .within(0, 180)
      .idle_when({with_other_falloffs({"mar"})});
  schema
      .value("--falloff-mar-foveal", model(&P::mar_foveal_deg), "DEG", Touch::sampling,
             "mar: degrees a cycle at the gaze")
      .within(0, 180)
      .idle_when({with_other_falloffs({"mar"})});
  schema
      .value("--falloff-contrast", model(&P::contrast), "CONTRAST", Touch::sampling,
             "geisler-perry, csf: contrast of the details to be seen")
      .above(0, 1)
      .idle_when({with_other_falloffs({"geisler-perry", "csf"})});
  schema
      .value("--falloff-luminance", model(&P::luminance_cd_m2), "CD/M2", Touch::sampling,
             "csf: luminance the eye is adapted to")
      .above(0)
      .idle_when({with_other_falloffs({"csf"})});
  schema
      .value("--falloff-eye", model(&P::eye), choices<FalloffEye>(), Touch::sampling,
             "retina, csf: whose visual field; both: the better of the two at each place")
      .idle_when({with_other_falloffs({"retina", "csf"})});
  schema
      .value("--falloff-log-polar-sigma", model(&P::log_polar_sigma), "RATIO", Touch::sampling,
             "log-polar: side of the frame over the buffer's")
      .above(0)
      .idle_when({with_other_falloffs({"log-polar"})});
  schema
      .value("--falloff-log-polar-alpha", model(&P::log_polar_alpha), "EXPONENT", Touch::sampling,
             "log-polar: exponent of the kernel")
      .above(0)
      .idle_when({with_other_falloffs({"log-polar"})});
  schema.value("--falloff-table", model(&P::table), "FILE", Touch::sampling, "table: a CSV of ecc_deg,density")
      .decides_by_file()
      .idle_when({with_other_falloffs({"table"})});
  schema
      .value(
          "--density-map", foveation(&FoveationSettings::density_map), "FILE", Touch::sampling,
          "map: an EXR of samples a pixel, or of relative rates where there is a budget; of any size, stretched over "
          "the frame. With #### in its name, one for each frame")
      .decides_by_file()
      .idle_when({with_other_falloffs({"map"})});
}

void add_pilot_options(JobSchema& schema) {
  using F = FoveationSettings;
  JobIdleRule without_rates_to_limit = with_other_falloffs({"visible"});
  without_rates_to_limit.holds = [elsewhere = without_rates_to_limit.holds](const JobSettings& job) {
    return elsewhere(job) && !job.foveation.target.jod;
  };
  schema
      .value("--min-spp", foveation(&F::min_spp), "SAMPLES", Touch::sampling,
             "visible: the least samples a pixel, anywhere")
      .within(0, kMostSamples)
      .idle_when({with_other_falloffs({"visible"})});
  schema
      .value("--max-spp", foveation(&F::max_spp), "SAMPLES", Touch::sampling,
             "visible: the most samples a pixel, anywhere; with a target in JOD, of the frame")
      .above(0, kMostSamples)
      .idle_when({without_rates_to_limit});
  schema
      .value("--target-relmse", at(&JobSettings::foveation, &F::target, &QualityTarget::relmse), "ERROR",
             Touch::sampling,
             "visible: as many samples as it takes until a pilot expects a frame of this relative squared error; "
             "excludes budgets")
      .above(0)
      .need("`falloff` visible");
}

void add_target_options(JobSchema& schema) {
  using F = FoveationSettings;
  schema
      .value(
          "--target-jod", at(&JobSettings::foveation, &F::target, &QualityTarget::jod), "JOD", Touch::sampling,
          "Uniform frames without a filter, of a view at rest: as many samples as a pilot expects it to take until the "
          "sequence scores so much by FovVideoVDP, as 'gazetrace compare' measures it")
      .within(0, 10)
      .need("gaze, `falloff` uniform and `filter` none");
}

void add_term_options(JobSchema& schema) {
  using F = FoveationSettings;
  schema
      .value("--contrast-strength", foveation(&F::contrast_strength), "0..1", Touch::sampling,
             "Density models: fewer samples where a first look at the frame, at an eighth of its size, shows no "
             "contrast; 1: down to a quarter of what there is without. A budget counts that look's samples")
      .within(0, 1)
      .idle_when({without_gaze()});
  schema
      .flag("--retinal-velocity", foveation(&F::retinal_velocity), Touch::sampling,
            "Density models: fewer samples while the gaze is moving, by what that takes of acuity")
      .idle_when({without_gaze_log()});
  schema
      .value("--saccade-density", foveation(&F::saccade_density), "FACTOR", Touch::sampling,
             "Density models: part of the density that is left during a saccade, at the gaze, too (see also "
             "--gaze-process snap-to-landing); a budget is met all the same")
      .within(0, 1)
      .idle_when({without_gaze_log()});
}

}  // namespace

void add_sampling_options(JobSchema& schema) {
  schema.group("Where the samples go");
  JobIdleRule without_any_gaze = without_gaze();
  without_any_gaze.holds = [](const JobSettings& job) { return !has_gaze(job) && !works_without_gaze(job.foveation); };
  schema
      .value("--falloff", foveation(&FoveationSettings::falloff), "NAME", Touch::sampling,
             "How sampling falls off with eccentricity ('gazetrace list falloffs')")
      .with(Trait::always_stated)
      .idle_when({without_any_gaze});
  schema
      .value("--spp", foveation(&FoveationSettings::uniform_spp), "N", Touch::sampling,
             "Samples a pixel of uniform frames, and where a density model is at its full rate; plan --counts compares "
             "with it")
      .within(1, kMostSamples);
  add_region_options(schema);
  add_budget_options(schema);
  add_target_options(schema);
  schema.group("Density models ('gazetrace list falloffs')");
  add_model_options(schema);
  add_pilot_options(schema);
  add_term_options(schema);
}

}  // namespace gazetrace
