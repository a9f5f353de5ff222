# SPDX-License-Identifier: Apache-2.0
"""The panels in the properties of a render."""

import textwrap

import bpy

LINE_WIDTH = 60


class RenderPanel:
    """Where all panels of the add-on are."""

    bl_space_type = "PROPERTIES"
    bl_region_type = "WINDOW"
    bl_context = "render"


class GAZETRACE_PT_main(RenderPanel, bpy.types.Panel):
    """Rendering, progress, and the program's last words."""

    bl_label = "gazetrace"
    bl_idname = "GAZETRACE_PT_main"

    def draw(self, context: bpy.types.Context) -> None:
        """Buttons and progress."""
        layout = self.layout
        shown = context.window_manager.gazetrace_run
        row = layout.row()
        row.operator("gazetrace.render", icon="RENDER_ANIMATION")
        row.operator("gazetrace.write_job", icon="FILE_TICK")
        if shown.is_running:
            row = layout.row()
            row.prop(shown, "share", slider=True)
            row.operator("gazetrace.cancel", icon="X")
        for line in textwrap.wrap(shown.told, LINE_WIDTH):
            layout.label(text=line)


class GAZETRACE_PT_viewer(RenderPanel, bpy.types.Panel):
    """Gaze and screen."""

    bl_label = "Viewer"
    bl_parent_id = "GAZETRACE_PT_main"

    def draw(self, context: bpy.types.Context) -> None:
        """Only what belongs to the chosen kinds."""
        layout = self.layout
        layout.use_property_split = True
        chosen = context.scene.gazetrace
        layout.prop(chosen, "gaze_source")
        if chosen.gaze_source == "LOG":
            layout.prop(chosen, "gaze_log")
            layout.prop(chosen, "gaze_delay")
            layout.prop(chosen, "gaze_transfer")
        elif chosen.gaze_source == "POINT":
            layout.prop(chosen, "gaze_at")
        layout.prop(chosen, "screen_source")
        if chosen.screen_source == "NAMED":
            layout.prop(chosen, "screen_name")
        elif chosen.screen_source == "SIZE":
            for name in ("screen_px", "screen_width", "screen_height", "screen_distance"):
                layout.prop(chosen, name)


class GAZETRACE_PT_sampling(RenderPanel, bpy.types.Panel):
    """Samples, filter, output."""

    bl_label = "Sampling and Output"
    bl_parent_id = "GAZETRACE_PT_main"

    def draw(self, context: bpy.types.Context) -> None:
        """Everything in one column."""
        layout = self.layout
        layout.use_property_split = True
        for name in ("preset", "sampling", "density", "samples", "filter", "view_source", "output_folder", "display_pictures"):
            layout.prop(context.scene.gazetrace, name)
        layout.prop(context.scene.gazetrace, "further_settings")


CLASSES = (GAZETRACE_PT_main, GAZETRACE_PT_viewer, GAZETRACE_PT_sampling)
