// SPDX-License-Identifier: Apache-2.0
#include "gazetrace/light_groups.hpp"

namespace gazetrace {

const std::vector<std::string>& light_group_names() {
  static const std::vector<std::string> kNames{"diffuse_direct",    "diffuse_indirect", "specular_direct",
                                               "specular_indirect", "emission",         "background"};
  return kNames;
}

}  // namespace gazetrace
