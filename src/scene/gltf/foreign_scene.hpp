// SPDX-License-Identifier: Apache-2.0
// Names what was given for a scene and is none that can be read.
#pragma once

#include <string>
#include <string_view>

namespace gazetrace {

// Error(input) with the way to glTF, where the bytes or the name are those of a scene or mesh of another program.
void refuse_foreign_scene(const std::string& path, std::string_view bytes);
// Error(input) for a folder, with the scene that lies in it.
[[noreturn]] void refuse_folder_as_scene(const std::string& path);

}  // namespace gazetrace
