// SPDX-License-Identifier: Apache-2.0
// Reads Radiance pictures (.hdr, .pic), as Radiance's "File Formats" (filefmts.pdf) describes them: a header of lines,
// a line with the size, scanlines of shared-exponent pixels. OpenImageIO keeps to the file's order of rows, leaves
// EXPOSURE in and does not know the old run lengths.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>

#include "core/picture_module.hpp"

namespace gazetrace {

// `bytes` outlive the reader, and are a whole file. Error(input) at `place` where the header is not one, and where the
// pixels are of another kind than RGBE.
std::unique_ptr<PictureReader> open_radiance(std::span<const std::uint8_t> bytes, const std::string& place);

}  // namespace gazetrace
