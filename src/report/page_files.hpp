// SPDX-License-Identifier: Apache-2.0
// The files of page/, which are put into the program when it is built.
#pragma once

#include <string_view>

namespace gazetrace {

extern const std::string_view report_page_html;
extern const std::string_view report_page_style;
extern const std::string_view report_page_script;

}  // namespace gazetrace
