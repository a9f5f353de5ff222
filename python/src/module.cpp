// SPDX-License-Identifier: Apache-2.0
// gazetrace._core: the library, as little changed as possible. What users see is the package around it.
#include "bind.hpp"
#include "errors.hpp"
#include "gazetrace/build_info.hpp"
#include "gazetrace/version.hpp"

PYBIND11_MODULE(_core, module) {
  using namespace gazetrace::python;
  translate_errors();
  module.attr("version") = gazetrace::kVersion;
  // Before this version pybind11 takes the fields of NumPy 2's types from the wrong places.
  module.attr("knows_numpy_2") = PYBIND11_VERSION_HEX >= 0x020c0000;
  module.def("build_description", &gazetrace::build_description);
  module.def("instruction_set", &gazetrace::instruction_set);
  module.def("peak_memory_mib", &gazetrace::peak_memory_mib);
  bind_options(module);
  bind_plan(module);
  bind_frame(module);
  bind_rendering(module);
  bind_gaze(module);
  bind_compare(module);
  bind_sweep(module);
}
