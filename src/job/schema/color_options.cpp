// SPDX-License-Identifier: Apache-2.0
#include "job/schema/idle_rules.hpp"
#include "job/schema/parts.hpp"

namespace gazetrace {
namespace {

constexpr auto color(auto member) {
  return at(&JobSettings::color, member);
}

}  // namespace

OptionSchema<ColorSettings> color_config_schema() {
  OptionSchema<ColorSettings> schema;
  schema.group("Exposure and colour");
  schema
      .value("--ocio", &ColorSettings::config, "FILE", Touch::color,
             "OpenColorIO config; default: $OCIO, else the built-in one")
      .decides_by_file();
  schema.value("--ocio-input", &ColorSettings::input, "NAME", Touch::color,
               "The config's name of linear Rec.709, where it has no aces_interchange role");
  return schema;
}

void add_color_options(JobSchema& schema) {
  schema.group("Exposure and colour");
  schema
      .value("--exposure", &JobSettings::exposure, "STOPS|auto", Touch::color,
             "Exposure in stops, or auto for one that follows from the log-average luminance of at most eight small "
             "frames of the whole sequence, the same for all its frames, with a shift if wanted: auto+0.5. EXRs do not "
             "depend on it")
      .within(-kMaxStops, kMaxStops)
      .with(Trait::always_stated)
      .with(Trait::everyday);
  schema
      .value("--exposure-key", at(&JobSettings::exposure, &ExposureSettings::key), "LUMINANCE", Touch::color,
             "The luminance to which auto brings the log-average")
      .above(0)
      .idle_when({without_automatic_exposure()});
  schema.include(color_config_schema(), &JobSettings::color);
  schema.value("--display", color(&ColorSettings::display), "NAME", Touch::color,
               "OpenColorIO display; default: the config's ('gazetrace list views')");
  schema.value("--view", color(&ColorSettings::view), "NAME", Touch::color, "OpenColorIO view; default: the display's")
      .with(Trait::always_stated);
  schema.value("--look", color(&ColorSettings::look), "NAME", Touch::color, "OpenColorIO look; default: the view's");
}

}  // namespace gazetrace
