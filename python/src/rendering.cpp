// SPDX-License-Identifier: Apache-2.0
#include "rendering.hpp"

#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <utility>

#include "bind.hpp"
#include "errors.hpp"
#include "gazetrace/error.hpp"

namespace gazetrace::python {
Rendering::Rendering(const Job& job, std::shared_ptr<const Scene> scene, Threads& threads) : scene_(std::move(scene)) {
  if (job.settings.max_time) {
    latest_ = Clock::now() + std::chrono::nanoseconds(job.settings.max_time->ns);
  }
  threads.run([this, job] { run(job); });
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [this] { return begun_ || ended_; });
  if (!begun_ && failure_) {
    std::rethrow_exception(failure_);
  }
}

Rendering::~Rendering() {
  close();
}

void Rendering::run(const Job& job) {
  try {
    render(job);
  } catch (...) {
    const std::lock_guard guard(mutex_);
    failure_ = std::current_exception();
  }
  const std::lock_guard guard(mutex_);
  ended_ = true;
  changed_.notify_all();
}

std::unique_ptr<GivenFrame> Rendering::packed(const FrameRequest& request, RenderedFrame&& rendered,
                                              const TimingRow& row) const {
  const ResolvedJob& resolved = run_->resolved;
  auto frame = std::make_unique<GivenFrame>();
  frame->request = request;
  frame->rendered = std::move(rendered);
  frame->row = row;
  frame->color = run_->color;
  frame->threads = resolved.pipeline.threads;
  const std::optional<DisplayGeometry>& screen = resolved.plan_settings.display;
  frame->is_on_screen = screen.has_value();
  const FrameRate& fps = resolved.pipeline.fps;
  frame->frames_per_second = static_cast<double>(fps.numerator) / static_cast<double>(fps.denominator);
  GazeAtTime gaze = request.gaze_true;
  if (!gaze.movement && resolved.job.settings.gaze_at) {
    gaze.movement = EyeMovement::fixation;  // an eye that rests there
  }
  frame->gaze_class = gaze_class_of(gaze);
  if (frame->gaze_class != GazeClass::no_gaze && gaze.kind == GazeKind::screen) {
    frame->gaze_px =
        gaze_in_frame(gaze, screen, resolved.plan_settings.frame_rect, request.width_px, request.height_px);
  }
  return frame;
}

void Rendering::render(const Job& job) {
  RunObserver observer;
  observer.begins = [this](const StartedRun& run) {
    const std::lock_guard guard(mutex_);
    run_ = &run;
    facts_ = {run.resolved.frames, run.resolved.decisions, run.resolved.pipeline.settings_digest, run.files,
              run.color->description()};
    warnings_ = in_keywords(run.resolved.warnings);
    begun_ = true;
    changed_.notify_all();
  };
  observer.stop_before_frame = [this](double frame_ms) { return !wait_until_wanted(frame_ms); };
  observer.take_frame = [this](const FrameRequest& request, RenderedFrame&& rendered, const TimingRow& row) {
    auto frame = packed(request, std::move(rendered), row);
    const std::lock_guard guard(mutex_);
    given_ = std::move(frame);
    wanted_ = false;
    changed_.notify_all();
  };
  observer.stop_now = [this] {
    if (latest_ && Clock::now() >= *latest_) {
      out_of_time_ = true;
    }
    return stop_.load(std::memory_order_relaxed) || out_of_time_.load(std::memory_order_relaxed);
  };
  RunOptions options;
  options.loaded = scene_.get();
  options.shows_frames = true;
  options.words = with_keywords;
  FinishedRun run = run_job(job, observer, options);
  const Warnings late = in_keywords(run.warnings);
  const std::lock_guard guard(mutex_);
  warnings_.insert(warnings_.end(), late.begin(), late.end());
  result_ = std::move(run.result);
}

bool Rendering::wait_until_wanted(double frame_ms) {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [this] { return wanted_ || stop_; });
  if (latest_ && Clock::now() + std::chrono::duration<double, std::milli>(frame_ms) > *latest_) {
    out_of_time_ = true;
  }
  return !stop_ && !out_of_time_;
}

std::unique_ptr<GivenFrame> Rendering::next(const std::function<bool()>& interrupted) {
  constexpr std::chrono::milliseconds kBetweenQuestions{50};
  std::unique_lock lock(mutex_);
  wanted_ = true;
  changed_.notify_all();
  while (!given_ && !ended_) {
    changed_.wait_for(lock, kBetweenQuestions);
    if (given_ || ended_ || stop_) {
      continue;
    }
    lock.unlock();
    const bool ask_to_stop = interrupted();
    lock.lock();
    if (ask_to_stop) {
      stop_ = true;
      changed_.notify_all();
    }
  }
  if (stop_) {
    given_.reset();
    return nullptr;
  }
  if (given_) {
    return std::move(given_);
  }
  if (failure_) {
    std::rethrow_exception(std::exchange(failure_, nullptr));
  }
  if (out_of_time_ && result_.interrupted) {
    out_of_time_ = false;  // told once
    throw Error(ErrorKind::interrupted, "",
                "interrupted by `max-time`: " + std::to_string(result_.left.size()) + " of " +
                    std::to_string(facts_.frames.size()) + " frames are left, " + format_frame_list(result_.left),
                "go on with `resume`");
  }
  return nullptr;
}

void Rendering::close() {
  std::unique_lock lock(mutex_);
  stop_ = true;
  changed_.notify_all();
  changed_.wait(lock, [this] { return ended_; });
  given_.reset();
}

SequenceResult Rendering::result() const {
  const std::lock_guard guard(mutex_);
  return result_;
}

Warnings Rendering::warnings() const {
  const std::lock_guard guard(mutex_);
  return warnings_;
}

bool Rendering::has_ended() const {
  const std::lock_guard guard(mutex_);
  return ended_;
}

namespace {

namespace py = pybind11;

// The signal's handler runs in here, with the lock of the interpreter; what it raised is raised again by next_frame().
bool signal_has_come() {
  const py::gil_scoped_acquire acquire;
  return PyErr_CheckSignals() != 0;
}

py::object next_frame(Rendering& rendering) {
  // An exception in the interpreter belongs to the thread that waits, and stays with it while others run.
  bool raised = false;
  std::unique_ptr<GivenFrame> frame;
  {
    const py::gil_scoped_release release;
    frame = rendering.next([&raised] {
      raised = signal_has_come();
      return raised;
    });
    if (raised) {
      rendering.close();
    }
  }
  if (raised) {
    throw py::error_already_set();
  }
  return frame ? py::cast(std::shared_ptr<GivenFrame>(std::move(frame))) : py::none();
}

}  // namespace

void bind_rendering(py::module_& module) {
  const auto threads = std::make_shared<Threads>();
  py::class_<Rendering>(module, "Rendering")
      .def(py::init([threads](const Job& job, const std::shared_ptr<Scene>& scene) {
             return std::make_unique<Rendering>(job, scene, *threads);
           }),
           py::arg("job"), py::arg("scene") = py::none(), py::call_guard<py::gil_scoped_release>())
      .def("next", &next_frame)
      .def("close", &Rendering::close, py::call_guard<py::gil_scoped_release>())
      .def("has_ended", &Rendering::has_ended)
      .def("warnings", &Rendering::warnings)
      .def("files", [](const Rendering& rendering) { return rendering.facts().files; })
      .def("view", [](const Rendering& rendering) { return rendering.facts().view; })
      .def("frames", [](const Rendering& rendering) { return rendering.facts().frames; })
      .def("decisions", [](const Rendering& rendering) { return rendering.facts().decisions; })
      .def("digest", [](const Rendering& rendering) { return rendering.facts().digest; })
      .def("skipped", [](const Rendering& rendering) { return rendering.result().skipped; })
      .def("left", [](const Rendering& rendering) { return rendering.result().left; })
      .def("facts", [](const Rendering& rendering) { return rendering.result().facts; })
      .def("timing", [](const Rendering& rendering) {
        std::vector<std::string> rows;
        const SequenceResult result = rendering.result();
        for (const TimingRow& row : result.rows) {
          rows.push_back(timing_row_text(row));
        }
        return rows;
      });
}

}  // namespace gazetrace::python
