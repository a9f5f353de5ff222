// SPDX-License-Identifier: Apache-2.0
#include "job/registry_names.hpp"

#include <algorithm>
#include <vector>

#include "gazetrace/density.hpp"
#include "gazetrace/error.hpp"
#include "gazetrace/reconstruct.hpp"

namespace gazetrace {
namespace {

template <class Infos>
std::vector<std::string> names_of_all(const Infos& infos) {
  std::vector<std::string> names;
  names.reserve(infos.size());
  for (const auto& info : infos) {
    names.push_back(info.name);
  }
  return names;
}

bool has_name(const std::vector<std::string>& names, const std::string& name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

}  // namespace

void check_filter_name(const std::string& name, const std::string& place) {
  const std::vector<std::string> known = names_of_all(reconstruction_filters());
  if (name == "auto" || has_name(known, name)) {
    return;
  }
  if (name == "oidn") {
    throw Error(ErrorKind::usage, place, "this build has no Open Image Denoise",
                "build it where that library is found, or give guided");
  }
  throw Error(ErrorKind::usage, place, unknown_name_message("filter", name, known),
              has_name(names_of_all(densities()), name) ? "a density has this name: give `density`" : "");
}

}  // namespace gazetrace
