// SPDX-License-Identifier: Apache-2.0
// The files of page/, put into the program when it is built.
#pragma once

#include <string_view>

namespace gazetrace {

extern const std::string_view kReportPageHtml;
extern const std::string_view kReportPageStyle;
extern const std::string_view kReportPageScript;

}  // namespace gazetrace
