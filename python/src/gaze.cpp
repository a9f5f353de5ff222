// SPDX-License-Identifier: Apache-2.0
// Gaze logs as arrays over the memory of the log.
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "arrays.hpp"
#include "bind.hpp"
#include "errors.hpp"
#include "gazetrace/error.hpp"
#include "gazetrace/gaze_event_check.hpp"
#include "gazetrace/gaze_events.hpp"
#include "gazetrace/gaze_log.hpp"
#include "gazetrace/gaze_process.hpp"
#include "gazetrace/gaze_read.hpp"
#include "gazetrace/gaze_trials.hpp"
#include "gazetrace/gaze_write.hpp"
#include "gazetrace/job_schema.hpp"
#include "gazetrace/resolve.hpp"
#include "options.hpp"

namespace gazetrace::python {
namespace {

using LogPtr = std::shared_ptr<GazeLog>;

LogPtr read_log(const std::string& path, const OptionTexts& file, const OptionTexts& screen) {
  GazeFileSettings settings;
  ScreenSettings seen_on;
  assign_options(settings, gaze_import_schema(), file);
  assign_options(seen_on, screen_schema(), screen);
  settings.path = path;
  return std::make_shared<GazeLog>(read_gaze_file(settings, seen_on));
}

template <class T>
py::array column(const py::object& self, T GazeSample::*member) {
  return column_of(self.cast<const GazeLog&>().samples, member, self);
}

py::array directions(const py::object& self) {
  static_assert(sizeof(Vec3d) == 3 * sizeof(double));
  const std::vector<GazeSample>& samples = self.cast<const GazeLog&>().samples;
  const auto count = static_cast<py::ssize_t>(samples.size());
  if (samples.empty()) {
    return py::array(py::dtype::of<double>(), std::vector<py::ssize_t>{0, 3});
  }
  return py::array(py::dtype::of<double>(), {count, py::ssize_t{3}},
                   {static_cast<py::ssize_t>(sizeof(GazeSample)), static_cast<py::ssize_t>(sizeof(double))},
                   &samples.front().direction.x, self);
}

template <class Name>
std::vector<std::string> names(const GazeLog& log, Name name) {
  std::vector<std::string> texts;
  texts.reserve(log.samples.size());
  for (const GazeSample& sample : log.samples) {
    texts.emplace_back(name(sample));
  }
  return texts;
}

py::array_t<bool> usable(const GazeLog& log) {
  py::array_t<bool> flags(static_cast<py::ssize_t>(log.samples.size()));
  for (std::size_t i = 0; i < log.samples.size(); ++i) {
    flags.mutable_at(i) = is_usable(log.samples[i].validity);
  }
  return flags;
}

py::list events(const GazeLog& log) {
  py::list list;
  for (const GazeEvent& event : log.events) {
    py::dict one;
    one["type"] = std::string(to_string(event.type));
    one["eye"] = std::string(to_string(event.eye));
    one["begin_ns"] = event.begin_ns;
    one["end_ns"] = event.end_ns;
    one["text"] = event.text;
    one["row"] = event.row;
    list.append(one);
  }
  return list;
}

py::list facts(const GazeLog& log) {
  py::list list;
  for (const GazeFact& fact : log.facts) {
    py::dict one;
    one["what"] = fact.what;
    one["value"] = fact.value;
    one["evidence"] = std::string(to_string(fact.evidence));
    one["detail"] = fact.detail;
    list.append(one);
  }
  return list;
}

// By the name of a preset, "auto", or "log" for those that the log states: events as JSON, and why not to rely on them.
std::pair<std::string, std::vector<std::string>> detected_events(const GazeLog& log, const std::string& method,
                                                                 const std::string& device_name) {
  std::optional<GazeDevice> device;
  for (const GazeDevice one : {GazeDevice::desktop, GazeDevice::head_mounted}) {
    device = to_string(one) == device_name ? std::optional(one) : device;
  }
  if (!device_name.empty() && !device) {
    throw Error(ErrorKind::usage, "`device`", "is 'desktop' or 'head-mounted', not '" + device_name + "'");
  }
  if (method == "log") {
    return {events_as_json(events_of_log(log), log), {}};
  }
  const EyeEvents found =
      detect_events(log, method == "auto" ? default_event_preset(log, device) : event_preset(method), device);
  return {events_as_json(found, log), in_keywords(doubts_in_words(doubt_events(log, found), found, log))};
}

LogPtr processed(const GazeLog& log, const std::vector<std::string>& texts) {
  std::vector<GazeStep> steps;
  for (const std::string& text : texts) {
    steps.push_back(parse_gaze_step(text));
  }
  return std::make_shared<GazeLog>(process_gaze(log, steps).log);
}

// Samples from one to the one before another, with what the log says of their time.
LogPtr part_of(const GazeLog& log, std::size_t begin, std::size_t end) {
  GazeTrial part;
  part.begin_ns = log.samples.at(begin).t_ns;
  part.end_ns = log.samples.at(end - 1).t_ns;
  auto cut = std::make_shared<GazeLog>(cut_to_trial(log, part));
  cut->trial = log.trial;
  return cut;
}

}  // namespace

void bind_gaze(py::module_& module) {
  module.def("read_gaze", &read_log, py::call_guard<py::gil_scoped_release>());
  py::class_<GazeLog, LogPtr>(module, "GazeLog")
      .def("__len__", [](const GazeLog& log) { return log.samples.size(); })
      .def_readonly("source", &GazeLog::source)
      .def_readonly("format", &GazeLog::format)
      .def_readonly("clock", &GazeLog::clock)
      .def_readonly("pupil_unit", &GazeLog::pupil_unit)
      .def_readonly("nominal_rate_hz", &GazeLog::nominal_rate_hz)
      .def_readonly("warnings", &GazeLog::warnings)
      .def_property_readonly("kind", [](const GazeLog& log) { return std::string(to_string(log.kind)); })
      .def_property_readonly("t_ns", [](const py::object& self) { return column(self, &GazeSample::t_ns); })
      .def_property_readonly("u", [](const py::object& self) { return column(self, &GazeSample::u); })
      .def_property_readonly("v", [](const py::object& self) { return column(self, &GazeSample::v); })
      .def_property_readonly("confidence", [](const py::object& self) { return column(self, &GazeSample::confidence); })
      .def_property_readonly("pupil", [](const py::object& self) { return column(self, &GazeSample::pupil); })
      .def_property_readonly("row", [](const py::object& self) { return column(self, &GazeSample::row); })
      .def_property_readonly("direction", &directions)
      .def_property_readonly("valid", &usable)
      .def("validity",
           [](const GazeLog& log) {
             return names(log, [](const GazeSample& sample) { return to_string(sample.validity); });
           })
      .def(
          "eye",
          [](const GazeLog& log) { return names(log, [](const GazeSample& sample) { return to_string(sample.eye); }); })
      .def("events", &events)
      .def("detected_events", &detected_events, py::call_guard<py::gil_scoped_release>())
      .def("processed", &processed, py::call_guard<py::gil_scoped_release>())
      .def("part", &part_of, py::call_guard<py::gil_scoped_release>())
      .def("write", [](const GazeLog& log, const std::string& path) { write_gaze_csv(log, path); })
      .def("facts", &facts);
}

}  // namespace gazetrace::python
