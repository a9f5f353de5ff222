// SPDX-License-Identifier: Apache-2.0
// What the header of a frame's EXR says.
#pragma once

#include <OpenEXR/ImfHeader.h>

#include <array>
#include <optional>
#include <string>

#include "gazetrace/output.hpp"

namespace gazetrace {

// `gazetrace:name`.
void add_text(Imf::Header& header, const std::string& name, const std::string& value);
// The header must have its windows.
void describe(Imf::Header& header, const FrameHeader& frame, ExrSpace space);
// The rows of the matrix from Rec.709, which is rendered in; nothing for that itself.
std::optional<std::array<Vec3f, 3>> matrix_to(ExrSpace space);

}  // namespace gazetrace
