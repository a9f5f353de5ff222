// SPDX-License-Identifier: Apache-2.0
// The parts of the module. Each file adds its own.
#pragma once

#include <pybind11/pybind11.h>

namespace gazetrace::python {

void bind_options(pybind11::module_& module);    // options.cpp
void bind_plan(pybind11::module_& module);       // plan.cpp
void bind_frame(pybind11::module_& module);      // frame.cpp
void bind_rendering(pybind11::module_& module);  // rendering.cpp
void bind_gaze(pybind11::module_& module);       // gaze.cpp
void bind_compare(pybind11::module_& module);    // compare.cpp
void bind_sweep(pybind11::module_& module);      // sweep.cpp

}  // namespace gazetrace::python
