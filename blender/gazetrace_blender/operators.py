# SPDX-License-Identifier: Apache-2.0
"""Writing a job, rendering it, and ending the run."""

import bpy

from . import result
from .job import Job, write_job
from .program import program_path
from .refusal import Refusal
from .run import Run

POLL_S = 0.2
INTERRUPTED = 4  # the program's exit code


class GAZETRACE_OT_write_job(bpy.types.Operator):
    """Exports the scene and writes the job beside the .blend file, without rendering it"""

    bl_idname = "gazetrace.write_job"
    bl_label = "Write Job"

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Writes it, or says why it cannot be written."""
        try:
            job = write_job(context)
        except (Refusal, OSError) as refusal:
            self.report({"ERROR"}, str(refusal))
            return {"CANCELLED"}
        for sentence in job.left_out:
            self.report({"WARNING"}, sentence)
        self.report({"INFO"}, f"Wrote {job.settings_file}")
        return {"FINISHED"}


class GAZETRACE_OT_render(bpy.types.Operator):
    """Renders the frames of the scene with gazetrace and shows them in the image editor"""

    bl_idname = "gazetrace.render"
    bl_label = "Render with gazetrace"

    _job: Job
    _run: Run
    _timer: bpy.types.Timer

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """One run at a time."""
        return not context.window_manager.gazetrace_run.is_running

    def start(self, context: bpy.types.Context) -> bool:
        """Writes the job and starts the program."""
        try:
            program = program_path(context)
            self._job = write_job(context)
            self._run = Run(program, self._job.settings_file)
        except (Refusal, OSError) as refusal:
            self.report({"ERROR"}, str(refusal))
            context.window_manager.gazetrace_run.told = str(refusal)
            return False
        for sentence in self._job.left_out:
            self.report({"WARNING"}, sentence)
        return True

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Renders and waits: for scripts, and for Blender without a window."""
        return self.end(context, self._run.wait()) if self.start(context) else {"CANCELLED"}

    def invoke(self, context: bpy.types.Context, _event: bpy.types.Event) -> set[str]:
        """Renders beside Blender, which stays usable."""
        if not self.start(context):
            return {"CANCELLED"}
        shown = context.window_manager.gazetrace_run
        shown.is_running, shown.cancel_is_wanted, shown.share, shown.told = True, False, 0, "Loading the scene"
        self._timer = context.window_manager.event_timer_add(POLL_S, window=context.window)
        context.window_manager.modal_handler_add(self)
        return {"RUNNING_MODAL"}

    def modal(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        """Takes in what the program tells, and passes a wish to cancel on to it."""
        if event.type != "TIMER":
            return {"PASS_THROUGH"}
        shown = context.window_manager.gazetrace_run
        if shown.cancel_is_wanted:
            shown.cancel_is_wanted = False
            shown.told = "Ending after this frame"
            self._run.cancel()
        code = self._run.poll()
        progress = self._run.progress
        if progress.done and progress.share() != shown.share:
            shown.share = progress.share()
            shown.told = f"Frame {progress.done} of {progress.count}"
        for area in context.screen.areas if context.screen else ():
            if area.type == "PROPERTIES":
                area.tag_redraw()
        if code is None:
            return {"RUNNING_MODAL"}
        context.window_manager.event_timer_remove(self._timer)
        shown.is_running = False
        return self.end(context, code)

    def cancel(self, context: bpy.types.Context) -> None:
        """Blender is being closed, or another file opened: the program ends as well."""
        self._run.cancel()
        context.window_manager.gazetrace_run.is_running = False

    def end(self, context: bpy.types.Context, code: int) -> set[str]:
        """Shows the pictures, and says what the program said."""
        progress = self._run.progress
        for warning in progress.warnings:
            self.report({"WARNING"}, warning)
        result.show(context, self._job)
        shown = context.window_manager.gazetrace_run
        if code == 0:
            shown.told = f"{progress.done} frames are rendered"
            return {"FINISHED"}
        if code == INTERRUPTED:
            shown.told = f"Ended after {progress.done} of {progress.count} frames"
        else:
            shown.told = " ".join(progress.errors) or f"The program ended with the exit code {code}"
        self.report({"WARNING" if code == INTERRUPTED else "ERROR"}, shown.told)
        return {"CANCELLED"}


class GAZETRACE_OT_cancel(bpy.types.Operator):
    """Ends the run after the frame in hand; finished frames stay"""

    bl_idname = "gazetrace.cancel"
    bl_label = "Cancel"

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """There must be a run."""
        return context.window_manager.gazetrace_run.is_running

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Leaves the wish for the operator that renders."""
        context.window_manager.gazetrace_run.cancel_is_wanted = True
        return {"FINISHED"}


CLASSES = (GAZETRACE_OT_write_job, GAZETRACE_OT_render, GAZETRACE_OT_cancel)
