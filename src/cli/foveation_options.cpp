// SPDX-License-Identifier: Apache-2.0
#include "cli/foveation_options.hpp"

namespace gazetrace {
namespace {

constexpr Influence kPixels = Influence::pixels;

void add_region_options(OptionTable& table, FoveationSettings& fov) {
  table.value("--region-samples", fov.region_samples, "N,N,N", "Samples in fovea, intermediate region and periphery",
              kPixels);
  table.value("--region-blocks", fov.region_blocks_px, "N,N",
              "Block sizes of intermediate region and periphery, pixels", kPixels);
  table.value("--region-angles", fov.region_angles_deg, "DEG,DEG", "Where fovea and intermediate region end, degrees",
              kPixels);
  table.value("--angle-reading", fov.reading, choices<AngleReading>(),
              "The angles are diameters (full-angle) or eccentricities", kPixels);
  table.value("--sample-unit", fov.unit, choices<SampleUnit>(), "Samples count for a block or for each of its pixels",
              kPixels);
  table.value("--region-shape", fov.shape, choices<RegionShape>(),
              "cone: by the angle between rays; disc: the paper's circle in pixels", kPixels);
  table.value(
      "--border-blend-deg", fov.border_blend_deg, "DEG",
      "Width of the rim about a region's border over which the density goes smoothly from one to the other, between "
      "the regions' own rates and blocks; 0: a hard border",
      kPixels);
}

void add_budget_options(OptionTable& table, FoveationSettings& fov) {
  table.value("--budget-spp", fov.budget_spp, "SAMPLES",
              "Scales any fall-off until a frame has so many samples a pixel on average", kPixels);
  table.value("--budget-samples", fov.budget_samples, "N", "The same by the samples of a frame in all", kPixels);
  table.value("--block-samples", fov.block_samples, "SAMPLES",
              "Density models: the smallest block is taken that expects so many samples", kPixels);
  table.value("--max-block", fov.max_block_px, "1|2|4|8|16", "Density models: largest side of a block, pixels",
              kPixels);
  table.value(
      "--density-floor", fov.density_floor, "DENSITY",
      "Density models: least part of the full rate, above 0, that a place gets; blended regions go below 1/512 where "
      "their own rates do",
      kPixels);
}

void add_model_options(OptionTable& table, FalloffParameters& p) {
  table.value("--falloff-normalisation", p.normalization, choices<FalloffNormalization>(),
              "Models of a cut-off frequency: against what the display shows, or relative to the fovea", kPixels);
  table.value("--falloff-ramp", p.ramp, "DEG,DEG,DENSITY",
              "linear, quadric: full up to the first eccentricity, the density from the second on", kPixels);
  table.value("--falloff-mar-slope", p.mar_slope, "DEG",
              "mar: degrees a cycle for each degree of eccentricity; 0.022 to 0.0275", kPixels);
  table.value("--falloff-mar-foveal", p.mar_foveal_deg, "DEG", "mar: degrees a cycle at the gaze", kPixels);
  table.value("--falloff-contrast", p.contrast, "CONTRAST",
              "geisler-perry, csf: contrast of the details to be seen, up to 1", kPixels);
  table.value("--falloff-luminance", p.luminance_cd_m2, "CD/M2", "csf: luminance the eye is adapted to", kPixels);
  table.value("--falloff-eye", p.eye, choices<FalloffEye>(),
              "retina, csf: whose visual field; both: the better of the two at each place", kPixels);
  table.value("--falloff-log-polar-sigma", p.log_polar_sigma, "RATIO", "log-polar: side of the frame over the buffer's",
              kPixels);
  table.value("--falloff-log-polar-alpha", p.log_polar_alpha, "EXPONENT", "log-polar: exponent of the kernel", kPixels);
  table.value("--falloff-table", p.table, "FILE", "table: a CSV of ecc_deg,density", Influence::file);
}

void add_term_options(OptionTable& table, FoveationSettings& fov) {
  table.value(
      "--contrast-strength", fov.contrast_strength, "0..1",
      "Density models: fewer samples where a first look at the frame, at an eighth of its size, shows no contrast; "
      "1: down to a quarter of what there is without. A budget counts that look's samples",
      kPixels);
  table.flag("--retinal-velocity", fov.retinal_velocity,
             "Density models: fewer samples while the gaze is moving, by what that takes of acuity", kPixels);
  table.value("--saccade-density", fov.saccade_density, "FACTOR",
              "Density models: part of the density that is left during a saccade, at the gaze, too (see also "
              "--gaze-process snap-to-landing); a budget is met all the same",
              kPixels);
}

}  // namespace

void add_foveation_options(OptionTable& table, FoveationSettings& fov) {
  table.group("Where the samples go");
  table.value("--falloff", fov.falloff, "NAME", "How sampling falls off with eccentricity ('gazetrace list falloffs')",
              kPixels);
  table.value(
      "--spp", fov.uniform_spp, "N",
      "Samples a pixel of uniform frames, and where a density model is at its full rate; plan --counts compares "
      "with it",
      kPixels);
  add_region_options(table, fov);
  add_budget_options(table, fov);
  table.group("Density models ('gazetrace list falloffs')");
  add_model_options(table, fov.parameters);
  add_term_options(table, fov);
}

}  // namespace gazetrace
