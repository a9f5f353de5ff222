// SPDX-License-Identifier: Apache-2.0
// The samplings: what each of them is called, and the model behind it.
#include <string>
#include <type_traits>
#include <utility>

#include "foveation/model.hpp"
#include "foveation/named_values.hpp"
#include "gazetrace/error.hpp"

namespace gazetrace {
namespace {

template <class... S>
std::vector<Sampling> one_of_each(const std::variant<S...>* /*type*/) {
  return {S{}...};
}

// Shape and unit, whose values are those of the enumerations.
const std::vector<NamedParameter>& region_parameters() {
  static const std::vector<NamedParameter> kParameters{{"shape", 0, 0, 2, false, {"cone", "disc", "disc-by-radius"}},
                                                       {"unit", 0, 0, 1, false, {"block", "pixel"}}};
  return kParameters;
}

}  // namespace

SamplingTraits traits_of(const Sampling& sampling) {
  SamplingTraits traits = std::visit([](const auto& one) { return std::decay_t<decltype(one)>::kTraits; }, sampling);
  if (const auto* density = std::get_if<DensitySampling>(&sampling); density != nullptr && density->from_picture) {
    traits.needs_gaze = false;
    traits.follows_picture = true;
  }
  return traits;
}

std::vector<SamplingTraits> samplings() {
  std::vector<SamplingTraits> all;
  for (const Sampling& sampling : one_of_each(static_cast<const Sampling*>(nullptr))) {
    all.push_back(traits_of(sampling));
  }
  return all;
}

std::string picture_files_of(const Sampling& sampling) {
  const auto* density = std::get_if<DensitySampling>(&sampling);
  return density == nullptr ? std::string() : density->picture_files;
}

Sampling parse_sampling(std::string_view text, const std::string& place) {
  const NamedText named = split_named_text(text);
  const std::vector<SamplingTraits> known = samplings();
  const auto index = &find_named(known, named.name, "sampling", place) - known.data();
  Sampling sampling = one_of_each(static_cast<const Sampling*>(nullptr)).at(static_cast<std::size_t>(index));
  auto* const regions = std::get_if<RegionSampling>(&sampling);
  const std::vector<double> values =
      parse_values(named.values, regions != nullptr ? region_parameters() : std::vector<NamedParameter>(), place);
  if (regions != nullptr) {
    regions->shape = static_cast<RegionShape>(static_cast<int>(values[0]));
    regions->unit = static_cast<SampleUnit>(static_cast<int>(values[1]));
  }
  return sampling;
}

std::string to_string(const Sampling& sampling) {
  const RegionSampling* const regions = regions_of(sampling);
  return traits_of(sampling).name +
         (regions == nullptr ? std::string()
                             : values_text({static_cast<double>(regions->shape), static_cast<double>(regions->unit)},
                                           region_parameters()));
}

Layout uniform_layout(std::uint32_t samples_per_pixel, int width_px, int height_px) {
  return {{{"uniform", 1, samples_per_pixel, SampleUnit::per_pixel}}, Image<std::uint8_t>(width_px, height_px, 0)};
}

namespace {

// One function for each sampling.
struct ModelOf {
  const PlanarView& view;
  const Vec3d& gaze;

  SamplingModel operator()(const UniformSampling& /*uniform*/) const {
    return uniform_layout(static_cast<std::uint32_t>(kUsualSpp), view.width_px, view.height_px);
  }
  SamplingModel operator()(const RegionSampling& regions) const { return region_layout(regions, view, gaze); }
  SamplingModel operator()(const DensitySampling& density) const { return density_model(density, view, gaze); }
  // A pilot has limits of its own for its rates. Blocks are for places with less than two samples a pixel only: their
  // light is known by the pixel, unlike that of models which take detail away on purpose.
  SamplingModel operator()(const AdaptiveSampling& /*adaptive*/) const {
    DensityModel model = picture_density();
    model.floor = 1e-9;
    model.own_block_samples = 2;
    return model;
  }
};

}  // namespace

SamplingModel sampling_model(const FoveationSettings& settings, const PlanarView& view, const Vec3d& gaze_direction) {
  return std::visit(ModelOf{view, gaze_direction}, settings.sampling);
}

}  // namespace gazetrace
