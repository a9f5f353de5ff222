// SPDX-License-Identifier: Apache-2.0
// A traced frame in a file: one machine traces it, another reads the file and finishes the frame.
#pragma once

#include <cstdint>
#include <string>

#include "gazetrace/frame_renderer.hpp"
#include "gazetrace/output.hpp"

namespace gazetrace {

// A traced frame in a file, to the bit; `frame` is its number. The file appears under its name only when it is
// complete. Error(runtime) where it cannot be written.
WrittenFile save_traced(const std::string& path, std::int32_t frame, const TracedFrame& traced,
                        const std::string& settings_digest);
// Error(input) for a file that is not one of this frame, is damaged, or was made under other settings.
TracedFrame load_traced(const std::string& path, std::int32_t frame, const std::string& settings_digest);

}  // namespace gazetrace
