// SPDX-License-Identifier: Apache-2.0
#include "gazetrace/metric_options.hpp"

namespace gazetrace {

template <>
struct EnumNames<DisplayResponse> {
  static constexpr const char* kWhat = "display response";
  static NameList<DisplayResponse> values() {
    return {{DisplayResponse::srgb, "srgb"},
            {DisplayResponse::gamma22, "gamma2.2"},
            {DisplayResponse::gamma24, "gamma2.4"},
            {DisplayResponse::linear, "linear"},
            {DisplayResponse::pq, "pq"},
            {DisplayResponse::linear_hdr, "linear-hdr"}};
  }
};
template <>
struct EnumNames<FlipToneMapper> {
  static constexpr const char* kWhat = "tone mapper";
  static NameList<FlipToneMapper> values() {
    return {{FlipToneMapper::aces, "aces"}, {FlipToneMapper::hable, "hable"}, {FlipToneMapper::reinhard, "reinhard"}};
  }
};

OptionSchema<MetricChoice> metric_schema() {
  using M = MetricSettings;
  using P = DisplayPhotometry;
  const auto metric = [](auto... members) {
    return at(&MetricChoice::settings, &ComparisonSettings::metric, members...);
  };
  const auto display = [](auto member) { return at(&MetricChoice::settings, &ComparisonSettings::photometry, member); };
  OptionSchema<MetricChoice> schema;
  schema.group("Metrics");
  schema.value(
      "--metrics", &MetricChoice::metrics, "NAME,NAME",
      "Which ('gazetrace list metrics'); default: mse, relmse, psnr, ssim, flip and, where screen and gaze are known, "
      "fovvideovdp and, from a second on, flicker");
  schema.value(
      "--response", metric(&M::response), choices<DisplayResponse>(),
      "How the display turns code values into light; pq: SMPTE ST 2084; linear-hdr: the pictures (.exr, .hdr) hold "
      "cd/m2 and no view is applied, metrics of code values see PQ");
  schema.value("--relmse-epsilon", metric(&M::relmse_epsilon), "VALUE", "Added to the squared reference in relmse");
  schema.value("--flip-tone-mapper", metric(&M::hdr_flip, &FlipExposureSettings::tone_mapper), "aces|hable|reinhard",
               "Curve of hdr_flip");
  schema.value("--flip-start", metric(&M::hdr_flip, &FlipExposureSettings::start_ev), "STOPS",
               "First exposure of hdr_flip; default: from the first reference frame");
  schema.value("--flip-stop", metric(&M::hdr_flip, &FlipExposureSettings::stop_ev), "STOPS",
               "Last exposure of hdr_flip");
  schema.value("--flip-count", metric(&M::hdr_flip, &FlipExposureSettings::count), "N",
               "Number of exposures of hdr_flip");
  schema.value(
      "--peak-cd-m2", display(&P::peak_cd_m2), "CD_M2",
      "Luminance of the display's white, for fovvideovdp and flicker, and for all metrics with pq and linear-hdr");
  schema.value("--contrast", display(&P::contrast), "RATIO", "White over the display's own black, for fovvideovdp");
  schema.value("--ambient-lux", display(&P::ambient_lux), "LUX", "Light that falls on the display, for fovvideovdp");
  schema.value("--reflectivity", display(&P::reflectivity), "SHARE", "How much of it comes back, for fovvideovdp");
  schema.flag("--correct-border", &MetricChoice::correct_border,
              "fovvideovdp treats the right border as the others, which its authors' program does not; such scores do "
              "not compare with theirs");
  return schema;
}

}  // namespace gazetrace
