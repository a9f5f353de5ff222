// SPDX-License-Identifier: Apache-2.0
// Plans: what would be rendered, without a ray.
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "bind.hpp"
#include "errors.hpp"
#include "frame.hpp"
#include "gazetrace/gaze_outlines.hpp"
#include "gazetrace/resolve.hpp"

namespace gazetrace::python {
namespace {

namespace py = pybind11;

struct Planned {
  ResolvedJob resolved;

  [[nodiscard]] const FrameRequest& request(std::size_t index) const { return resolved.plan.frames.at(index); }
  [[nodiscard]] HeldMap sampling_map(std::size_t index) const {
    const JobSettings& job = resolved.job.settings;
    return {std::make_shared<const SamplingMap>(
        planned_sampling_map(job.foveation, request(index), job.trace.seed, job.threads))};
  }
};

}  // namespace

void bind_plan(py::module_& module) {
  py::class_<Scene, std::shared_ptr<Scene>>(module, "Scene").def_property_readonly("source", [](const Scene& scene) {
    return scene.source;
  });
  module.def(
      "load_scene", [](const Job& job) { return std::make_shared<Scene>(load_job_scene(job.settings)); },
      py::call_guard<py::gil_scoped_release>());
  module.def("outlines", [](const Job& job) {
    const py::gil_scoped_release release;
    const OutlinesOfJob made = outlines_of_job(job);
    return std::pair(outlines_as_json(made.outlines), in_keywords(made.warnings));
  });
  py::class_<Planned, std::shared_ptr<Planned>>(module, "Planned")
      .def(py::init([](const Job& job) {
             ResolveOptions options;
             options.scope = ResolveScope::plan;
             return std::make_shared<Planned>(Planned{resolve(job, options)});
           }),
           py::call_guard<py::gil_scoped_release>())
      .def("json", [](const Planned& planned) { return plan_as_json(planned.resolved.plan); })
      .def("frames", [](const Planned& planned) { return planned.resolved.frames; })
      .def("warnings", [](const Planned& planned) { return in_keywords(planned.resolved.warnings); })
      .def("decisions", [](const Planned& planned) { return planned.resolved.decisions; })
      .def("sampling_map", &Planned::sampling_map, py::call_guard<py::gil_scoped_release>())
      .def("view", [](const Planned& planned, std::size_t index) { return planned.request(index).view; })
      .def("samples", [](const Planned& planned) {
        std::vector<std::uint64_t> samples;
        const py::gil_scoped_release release;
        for (std::size_t i = 0; i < planned.resolved.plan.frames.size(); ++i) {
          samples.push_back(planned.sampling_map(i).map->samples());
        }
        return samples;
      });
}

}  // namespace gazetrace::python
