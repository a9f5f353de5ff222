// SPDX-License-Identifier: Apache-2.0
#include "cli/gaze_uncertainty.hpp"

#include <CLI/CLI.hpp>
#include <limits>

namespace gazetrace {

void add_uncertainty_options(CLI::App& app, GazeUncertainty& uncertainty) {
  uncertainty = {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::quiet_NaN()};
  app.add_option("--gaze-accuracy", uncertainty.accuracy_deg,
                 "The tracker's systematic error; default: the mean error of the log's validations")
      ->type_name("DEG");
  app.add_option("--gaze-precision", uncertainty.precision_deg,
                 "The tracker's scatter; default: the root mean square in the log's fixations")
      ->type_name("DEG");
}

}  // namespace gazetrace
