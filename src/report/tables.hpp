// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "gazetrace/report.hpp"

namespace gazetrace {

// HTML: runs of each scene and gaze with the bands below, speed-up at fixed quality, wrong-gaze controls.
std::string tables_html(const Results& data);
std::string findings_html(const ReportFindings& findings);
std::string list_html(const std::vector<std::string>& items);

}  // namespace gazetrace
