// SPDX-License-Identifier: Apache-2.0
// The files of the page of a gaze report, which are put into the program when it is built.
#pragma once

#include <string_view>

namespace gazetrace {

extern const std::string_view gaze_page_html;
extern const std::string_view gaze_page_style;

}  // namespace gazetrace
