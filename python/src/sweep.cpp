// SPDX-License-Identifier: Apache-2.0
// Sweeps: measured on a thread of their own, while the caller's passes on what is told and looks after signals.
#include <pybind11/functional.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <exception>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "bind.hpp"
#include "gazetrace/error.hpp"
#include "gazetrace/results.hpp"
#include "gazetrace/sweep_plan.hpp"
#include "threads.hpp"

namespace gazetrace::python {
namespace {

namespace py = pybind11;

struct SweepThread {
  std::mutex mutex;
  std::condition_variable changed;
  std::vector<std::string> told, warnings;
  std::exception_ptr failure;
  bool ended = false;
  std::atomic<bool> stop{false};

  void tell(std::vector<std::string>& lines, const std::string& line) {
    const std::lock_guard guard(mutex);
    lines.push_back(line);
    changed.notify_all();
  }

  void measure(const SweepPlan& plan) {  // throws nothing
    SweepObserver observer;
    observer.tell = [this](const std::string& line) { tell(told, line); };
    observer.warn = [this](const std::string& line) { tell(warnings, line); };
    observer.stop_before_frame = [this](double /*frame_ms*/) { return stop.load(); };
    observer.stop_now = [this] { return stop.load(); };
    try {
      const SweepDirectory directory = prepare_sweep(plan, std::nullopt, observer);
      write_results(plan.directory, run_sweep(plan, observer));
    } catch (...) {
      failure = std::current_exception();
    }
    const std::lock_guard guard(mutex);
    ended = true;
    changed.notify_all();
  }
};

// Returns what there is to warn of. An exception of a signal's handler, or of `tell`, ends the sweep, which keeps what
// is measured, and is raised again.
std::vector<std::string> sweep(Threads& threads, const std::string& path, const std::string& folder,
                               const std::optional<std::string>& frames, const std::optional<int>& threads_count,
                               bool restart, const py::object& tell) {
  constexpr std::chrono::milliseconds kBetweenQuestions{50};
  const auto thread = std::make_shared<SweepThread>();
  {
    const py::gil_scoped_release release;
    LoadedSweepPlan loaded = load_sweep_plan(
        path, frames ? std::optional(FrameList{parse_frame_list(*frames)}) : std::nullopt, threads_count);
    loaded.plan.directory = folder;
    loaded.plan.restart = restart;
    thread->warnings = loaded.warnings;
    threads.run([thread, plan = std::make_shared<const SweepPlan>(std::move(loaded.plan))] { thread->measure(*plan); });
  }
  std::exception_ptr raised;
  bool ended = false;
  while (!ended) {
    std::vector<std::string> lines;
    {
      const py::gil_scoped_release release;
      std::unique_lock lock(thread->mutex);
      thread->changed.wait_for(lock, kBetweenQuestions, [&] { return thread->ended || !thread->told.empty(); });
      lines.swap(thread->told);
      ended = thread->ended;
    }
    if (raised) {
      continue;
    }
    try {
      for (const std::string& line : lines) {
        if (!tell.is_none()) {
          tell(line);
        }
      }
      if (PyErr_CheckSignals() != 0) {
        throw py::error_already_set();
      }
    } catch (const py::error_already_set&) {
      raised = std::current_exception();
      thread->stop = true;
    }
  }
  if (raised || thread->failure) {
    std::rethrow_exception(raised ? raised : thread->failure);
  }
  return thread->warnings;
}

}  // namespace

void bind_sweep(py::module_& module) {
  const auto threads = std::make_shared<Threads>();
  module.def(
      "sweep",
      [threads](const std::string& path, const std::string& folder, const std::optional<std::string>& frames,
                const std::optional<int>& count, bool restart,
                const py::object& tell) { return sweep(*threads, path, folder, frames, count, restart, tell); },
      py::arg("path"), py::arg("folder"), py::arg("frames"), py::arg("threads"), py::arg("restart"), py::arg("tell"));
}

}  // namespace gazetrace::python
