// SPDX-License-Identifier: Apache-2.0
#include "options.hpp"

#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <algorithm>

#include "bind.hpp"
#include "gazetrace/compare_job.hpp"
#include "gazetrace/former_options.hpp"
#include "gazetrace/job.hpp"
#include "gazetrace/job_schema.hpp"
#include "gazetrace/metric_options.hpp"
#include "gazetrace/output.hpp"
#include "gazetrace/resolve.hpp"

namespace gazetrace::python {
namespace {

namespace py = pybind11;

const char* shape_name(OptionShape shape) {
  switch (shape) {
    case OptionShape::flag:
      return "flag";
    case OptionShape::value:
      return "value";
    case OptionShape::list:
      return "list";
    case OptionShape::repeated:
      break;
  }
  return "repeated";
}

py::list described(const OptionList& options) {
  py::list list;
  for (const Option* const option : options) {
    py::dict one;
    one["name"] = keyword_of(option->name);
    one["group"] = option->group;
    one["unit"] = option->unit;
    one["help"] = option->help;
    one["shape"] = shape_name(option->shape);
    one["defaults"] = option->defaults;
    list.append(one);
  }
  return list;
}

// The option that a keyword names and that is no more; empty: it is none.
std::string former_of(const std::string& keyword) {
  for (const FormerOption& former : former_options()) {
    if (keyword_of(former.option) == keyword && job_schema().find(former.option) == nullptr) {
      return former.option;
    }
  }
  return {};
}

// Names that the program looks up when it resolves a job, which here may be long after they were given.
void check_names(const Job& job) {
  static_cast<void>(gaze_steps_of(job.settings.gaze_process));
  if (const std::string& name = job.settings.screen.name; !name.empty() && !name.ends_with(".json")) {
    ScreenSettings screen;
    screen.name = name;
    static_cast<void>(screen_geometry(screen));
  }
  for (const std::string& name : job.settings.exr.aovs) {
    if (std::find(aov_names().begin(), aov_names().end(), name) == aov_names().end()) {
      throw Error(ErrorKind::usage, "`aov`", unknown_name_message("channel", name, aov_names()));
    }
  }
}

// An empty list takes away what was given to an option that may be given several times.
void set_by_keywords(Job& job, const std::vector<std::pair<std::string, std::vector<std::string>>>& keywords) {
  std::vector<GivenOption> given;
  for (const auto& [keyword, values] : keywords) {
    const std::string former = former_of(keyword);
    const std::string name = former.empty() ? option_of(keyword, job_schema().list()) : former;
    if (values.empty() && former.empty() && job_schema().find(name)->shape == OptionShape::repeated) {
      job_schema().find(name)->assign(job.settings, values, name);
      job.sources[name] = {};
    } else {
      given.push_back({name, values, {}, {}});
    }
  }
  set_options(job, given);
  check_names(job);
}

}  // namespace

std::string keyword_of(const std::string& option) {
  std::string keyword = option;
  std::replace(keyword.begin(), keyword.end(), '-', '_');
  return keyword;
}

std::string option_of(const std::string& keyword, const OptionList& options) {
  std::vector<std::string> known;
  for (const Option* const option : options) {
    known.push_back(keyword_of(option->name));
    if (known.back() == keyword) {
      return option->name;
    }
  }
  refuse_option(keyword, known);
}

void refuse_option(const std::string& keyword, const std::vector<std::string>& known) {
  throw Error(ErrorKind::usage, "`" + keyword + "`", unknown_among_many("option", keyword, known));
}

void bind_options(py::module_& module) {
  module.def("refuse_option", &refuse_option);
  module.def("job_options", [] { return described(job_schema().list()); });
  module.def("gaze_file_options", [] { return described(gaze_import_schema().list()); });
  module.def("screen_options", [] { return described(screen_schema().list()); });
  module.def("color_options", [] { return described(color_config_schema().list()); });
  module.def("compare_options", [] { return described(compare_schema().list()); });
  module.def("metric_options", [] { return described(metric_schema().list()); });

  py::class_<Job>(module, "Job")
      .def(py::init<>())
      .def(py::init<const Job&>())
      .def("set", &set_by_keywords)
      .def("add_toml",
           [](Job& job, const std::string& text, const std::string& path) {
             add_toml(job, text, path, "gazetrace.options() lists every option");
           })
      .def("add_file",
           [](Job& job, const std::string& path) {
             add_toml(job, read_settings_file(path), path, "gazetrace.options() lists every option");
           })
      .def("values",
           [](const Job& job, const std::string& keyword) {
             return option_values(job, option_of(keyword, job_schema().list()));
           })
      .def("as_toml", [](const Job& job) { return job_as_toml(job, "gazetrace render"); });
}

}  // namespace gazetrace::python
