// SPDX-License-Identifier: Apache-2.0
// What the header of a frame's EXR says.
#pragma once

#include <OpenEXR/ImfHeader.h>

#include <string>

#include "gazetrace/output.hpp"

namespace gazetrace {

// `gazetrace:name`.
void add_text(Imf::Header& header, const std::string& name, const std::string& value);
// `aspect`: width over height.
void describe(Imf::Header& header, const FrameHeader& frame, double aspect);

}  // namespace gazetrace
