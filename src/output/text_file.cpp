// SPDX-License-Identifier: Apache-2.0
#include <span>

#include "core/atomic_file.hpp"
#include "gazetrace/output.hpp"

namespace gazetrace {

void write_text_atomically(const std::string& path, const std::string& text) {
  write_bytes_atomically(path, std::as_bytes(std::span(text)));
}

}  // namespace gazetrace
