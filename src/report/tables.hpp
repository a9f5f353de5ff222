// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "gazetrace/report.hpp"

namespace gazetrace {

// Tables as HTML: the runs of each scene and gaze with their bands below, speed-up at fixed quality, and controls with
// a wrong gaze.
std::string tables_html(const Results& data);
std::string findings_html(const ReportFindings& findings);
std::string list_html(const std::vector<std::string>& items);

}  // namespace gazetrace
