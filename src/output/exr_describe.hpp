// SPDX-License-Identifier: Apache-2.0
// What the header of a frame's EXR says.
#pragma once

#include <OpenEXR/ImfHeader.h>

#include <optional>
#include <string>

#include "core/primaries.hpp"
#include "gazetrace/output.hpp"

namespace gazetrace {

// `gazetrace:name`.
void add_text(Imf::Header& header, const std::string& name, const std::string& value);
// The header must have its windows.
void describe(Imf::Header& header, const FrameHeader& frame, ExrSpace space);
// Nothing for Rec.709, which is rendered in.
std::optional<RgbMatrix> matrix_to(ExrSpace space);

}  // namespace gazetrace
