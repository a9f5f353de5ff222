// SPDX-License-Identifier: Apache-2.0
// How samples are distributed. The ranges that are stated here are checked by check_foveation(), whose messages say
// more.
#include <string>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include "job/schema/idle_rules.hpp"
#include "job/schema/parts.hpp"

namespace gazetrace {
namespace {

constexpr auto foveation(auto member) {
  return at(&JobSettings::foveation, member);
}
// The part of the settings that is of one sampling: in the chosen one or, while another is chosen, beside it.
template <class Settings>
auto& regions_in(Settings& settings) {
  auto* const chosen = std::get_if<RegionSampling>(&settings.sampling);
  return chosen == nullptr ? settings.unused_regions : *chosen;
}
template <class Settings>
auto& density_in(Settings& settings) {
  auto* const chosen = std::get_if<DensitySampling>(&settings.sampling);
  return chosen == nullptr ? settings.unused_density : *chosen;
}

// The type of an option whose value is found in the SamplingSettings by `Find`.
template <class Find>
const OptionType& found_type(Find /*find*/) {
  using T = std::remove_cvref_t<decltype(Find{}(std::declval<SamplingSettings&>()))>;
  static const OptionType kType = [] {
    OptionType type = option_type<T>();
    type.parse = [](const std::vector<std::string>& texts, const std::string& place, void* settings) {
      option_type<T>().parse(texts, place, &Find{}(*static_cast<SamplingSettings*>(settings)));
    };
    type.format = [](const void* settings) {
      return option_type<T>().format(&Find{}(*static_cast<const SamplingSettings*>(settings)));
    };
    type.numbers = [](const void* settings) {
      return option_type<T>().numbers(&Find{}(*static_cast<const SamplingSettings*>(settings)));
    };
    return type;
  }();
  return kType;
}

// From here on the option's value is all of the SamplingSettings, of which the type takes its part.
OptionOf<JobSettings>& within_sampling(OptionOf<JobSettings>& option, const OptionType& type) {
  option.type = &type;
  option.offset = at(&JobSettings::foveation).offset;
  option.defaults = option.values(option_detail::defaults<JobSettings>());
  return option;
}

constexpr double kMostSamples = 1e6;

// What is known of the regions and the density stays, whichever is chosen. The text decides shape and unit of regions.
void choose_sampling(SamplingSettings& settings, Sampling sampling) {
  settings.unused_regions = regions_in(settings);
  settings.unused_density = density_in(settings);
  if (auto* chosen = std::get_if<RegionSampling>(&sampling)) {
    settings.unused_regions.shape = chosen->shape;
    settings.unused_regions.unit = chosen->unit;
    *chosen = settings.unused_regions;
  } else if (std::holds_alternative<DensitySampling>(sampling)) {
    sampling = settings.unused_density;
  }
  settings.sampling = std::move(sampling);
}

const OptionType& sampling_type() {
  static const OptionType kType = [] {
    OptionType type = option_type<Sampling>();
    type.parse = [](const std::vector<std::string>& texts, const std::string& place, void* settings) {
      choose_sampling(*static_cast<SamplingSettings*>(settings), parse_sampling(texts.at(0), place));
    };
    type.format = [](const void* settings) {
      return std::vector{to_string(static_cast<const SamplingSettings*>(settings)->sampling)};
    };
    return type;
  }();
  return kType;
}

// It has no value while another sampling is chosen, so that settings that are written down say one thing.
const OptionType& density_type() {
  static const OptionType kType = [] {
    OptionType type = found_type([](auto& settings) -> auto& { return density_in(settings); });
    type.format = [](const void* settings) {
      const auto* density = std::get_if<DensitySampling>(&static_cast<const SamplingSettings*>(settings)->sampling);
      return density == nullptr ? std::vector<std::string>() : std::vector{to_string(*density)};
    };
    return type;
  }();
  return kType;
}

std::string names_of_samplings() {
  std::string names;
  for (const SamplingTraits& traits : samplings()) {
    names += std::string(names.empty() ? "" : "|") + traits.name;
  }
  return names;
}

void add_sampling_choice(JobSchema& schema) {
  OptionOf<JobSettings>& density =
      schema
          .value(
              "--density", at(&JobSettings::foveation, &SamplingSettings::unused_density), "NAME|FILE", Touch::sampling,
              "Density of samples over eccentricity: a model of acuity ('gazetrace list densities'), with its "
              "parameters as in mar:slope=0.0275; a CSV file with the columns ecc_deg,density; or an EXR file of "
              "samples a pixel (of "
              "relative rates with --spp), stretched over the frame. #### in its name: a file for each frame. Chooses "
              "--sampling density")
          .decides_by_file()
          .idle_when({with_other_sampling("density"), without_density()});
  within_sampling(density, density_type()).implies = {"sampling", "density"};
  JobIdleRule without_any_gaze = without_gaze();
  without_any_gaze.holds = [](const JobSettings& job) {
    const Sampling& sampling = job.foveation.sampling;  // of a density it is told by itself
    return !has_gaze(job) && traits_of(sampling).needs_gaze && !std::holds_alternative<DensitySampling>(sampling);
  };
  OptionOf<JobSettings>& sampling =
      schema
          .value(
              "--sampling", foveation(&FoveationSettings::sampling), names_of_samplings(), Touch::sampling,
              "Distribution of samples: uniform; in three regions about the gaze; by --density; or adaptive, where a "
              "pilot of the frame finds noise. The paper's readings are regions:shape=disc or disc-by-radius, and "
              "regions:unit=pixel. Without it, --target-jod and --target-relmse take adaptive, and options of "
              "regions take regions")
          .with(Trait::always_stated)
          .idle_when({without_any_gaze})
          .with(Trait::everyday);
  within_sampling(sampling, sampling_type());
  schema
      .value("--spp", foveation(&FoveationSettings::spp), "SAMPLES", Touch::sampling,
             "Samples a pixel on average over a frame, with any sampling; a fraction is possible. Without it, "
             "regions have their own counts, pictures state theirs, densities about the gaze have 2, and all "
             "else has 32")
      .above(0, kMostSamples)
      .with(Trait::everyday);
}

void add_region_options(JobSchema& schema) {
  using R = RegionSampling;
  const auto of_regions = [](auto member) {
    return at(&JobSettings::foveation, &SamplingSettings::unused_regions, member);
  };
  within_sampling(
      schema
          .value("--region-samples", of_regions(&R::samples), "N,N,N", Touch::sampling,
                 "Samples of a pixel of the fovea, and of a block of the intermediate region and of the periphery")
          .within(1, kMostSamples)
          .with(Trait::always_stated)
          .idle_when({without_gaze(), without_regions()}),
      found_type([](auto& settings) -> auto& { return regions_in(settings).samples; }));
  within_sampling(schema
                      .value("--region-blocks", of_regions(&R::blocks_px), "N,N", Touch::sampling,
                             "Sides of the blocks of pixels in the intermediate region and in the periphery, in pixels")
                      .within(1, 64)
                      .with(Trait::always_stated)
                      .idle_when({without_gaze(), without_regions()}),
                  found_type([](auto& settings) -> auto& { return regions_in(settings).blocks_px; }));
  within_sampling(
      schema
          .value("--region-eccentricities", of_regions(&R::eccentricities_deg), "DEG,DEG", Touch::sampling,
                 "Eccentricities at which the fovea and the intermediate region end, in degrees from the gaze outwards")
          .with(Trait::always_stated)
          .idle_when({without_gaze(), without_regions()}),
      found_type([](auto& settings) -> auto& { return regions_in(settings).eccentricities_deg; }));
}

void add_block_options(JobSchema& schema) {
  using F = FoveationSettings;
  schema
      .value("--block-samples", foveation(&F::block_samples), "SAMPLES", Touch::sampling,
             "Densities: each place gets the smallest block that expects at least this many samples")
      .within(1, 65536)
      .idle_when({without_density(), with_regions(), with_uniform()});
  schema
      .value("--max-block", foveation(&F::max_block_px), "1|2|4|8|16", Touch::sampling,
             "Densities: the largest side of a block, in pixels. With --sampling adaptive and --accumulate window "
             "the default is 1, since frames are added up where their blocks are the same; 16 then counts as not given")
      .within(1, 16)
      .idle_when({without_density(), with_regions(), with_uniform()});
}

void add_pilot_options(JobSchema& schema) {
  using F = FoveationSettings;
  JobIdleRule without_rates_to_limit = with_other_sampling("adaptive");
  without_rates_to_limit.words = "with another `sampling` than adaptive and without a target";
  without_rates_to_limit.holds = [elsewhere = without_rates_to_limit.holds](const JobSettings& job) {
    return elsewhere(job) && !job.foveation.target.is_given();
  };
  schema
      .value(
          "--min-spp", foveation(&F::min_spp), "SAMPLES", Touch::sampling,
          "adaptive: the lowest rate anywhere in the frame, in samples a pixel; with --target-jod, of a frame, which "
          "never has less than 0.25")
      .within(0, kMostSamples)
      .idle_when({without_rates_to_limit});
  schema
      .value("--max-spp", foveation(&F::max_spp), "SAMPLES", Touch::sampling,
             "adaptive: the highest rate anywhere in the frame, in samples a pixel; with --target-jod, of a frame")
      .above(0, kMostSamples)
      .idle_when({without_rates_to_limit});
  schema
      .value("--target-relmse", at(&JobSettings::foveation, &F::target, &QualityTarget::relmse), "ERROR",
             Touch::sampling,
             "adaptive: chooses the number of samples for which the pilot predicts this relative mean squared error of "
             "the frame; excludes --spp")
      .above(0)
      .need("`sampling` adaptive");
}

void add_target_options(JobSchema& schema) {
  using F = FoveationSettings;
  schema
      .value("--target-jod", at(&JobSettings::foveation, &F::target, &QualityTarget::jod), "JOD", Touch::sampling,
             "As many samples as it takes until the sequence scores so much by FovVideoVDP, as 'gazetrace compare' "
             "measures it. Any --sampling but regions, any --filter; with --accumulate window at rest many times "
             "fewer samples")
      .within(0, 10)
      .need("gaze and another `sampling` than regions");
}

}  // namespace

void add_sampling_options(JobSchema& schema) {
  schema.group("Where the samples go");
  add_sampling_choice(schema);
  add_region_options(schema);
  add_block_options(schema);
  add_pilot_options(schema);
  add_target_options(schema);
}

}  // namespace gazetrace
