// SPDX-License-Identifier: Apache-2.0
// Cleans and checks PNG files before libpng reads them, because libpng prints what it finds wrong.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace gazetrace {

bool is_png(std::span<const std::uint8_t> file_bytes);

// The same picture as a file of only those chunks that its pixels need (IHDR, PLTE, tRNS, IDAT, IEND), so that there is
// no other chunk, such as an old colour profile, of which libpng could complain. Error(input) that names `place` for a
// header, palette, checksum or order of chunks that PNG (ISO/IEC 15948) does not allow, and for a file that ends early.
// The compressed stream of the pixels is not checked.
std::vector<std::uint8_t> essential_png(std::span<const std::uint8_t> file_bytes, const std::string& place);

// Unpacks the pixels of an essential_png() once, without keeping them. Error(input) for a stream that is damaged or
// ends early, for rows whose filter does not exist, and for more data than a few kilobytes beyond the pixels.
void check_png_pixels(std::span<const std::uint8_t> essential, const std::string& place);

// The text of a PNG file that its title or else its description states, empty where it states none or is not complete;
// nothing where the file is no PNG.
std::optional<std::string> png_description(const std::string& path);

}  // namespace gazetrace
