// SPDX-License-Identifier: Apache-2.0
// Which values of options are names of files, and where those that a settings file names are looked for.
#pragma once

#include <string>

#include "gazetrace/option_schema.hpp"

namespace gazetrace {

// Whether the value names a file or a pattern of files. Some options take a name of ours or a file: there, what has a
// slash or exists is a file.
bool names_file(const Option& option, const std::string& value);

struct LocatedFile {
  std::string value;    // as the option takes it, for a program that runs in the working folder
  std::string warning;  // empty: none
};

// A file that is read is looked for beside the settings file first. Where only the working folder has it, which is
// where all relative paths began in earlier versions, it is taken from there with a warning that names both. Files that
// are written, absolute paths, addresses such as ocio://default and names of ours stay as they are.
LocatedFile located_file(const Option& option, const std::string& value, const std::string& settings_path);

}  // namespace gazetrace
