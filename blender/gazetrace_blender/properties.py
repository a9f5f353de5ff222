# SPDX-License-Identifier: Apache-2.0
"""What a user sets: in a scene for its job, in the preferences for the machine."""

import bpy
from bpy.props import (
    BoolProperty,
    EnumProperty,
    FloatProperty,
    FloatVectorProperty,
    IntProperty,
    IntVectorProperty,
    PointerProperty,
    StringProperty,
)

from .program import names_of, program_path
from .refusal import Refusal


def names(family: str):  # noqa: ANN201
    """A search function over the names that the program has for a family of its options."""

    def search(_self, context: bpy.types.Context, text: str) -> list[str]:
        try:
            known = names_of(program_path(context), family)
        except Refusal:
            return []
        return [name for name, _ in known if text.lower() in name.lower()]

    return search


def any_name(family: str, name: str, description: str) -> StringProperty:
    """A text that may be any name of a family, or another one that the program will judge."""
    return StringProperty(name=name, description=description, search=names(family), search_options={"SUGGESTION"})


class GazetraceSettings(bpy.types.PropertyGroup):
    """The part of a job that a scene of Blender does not already say."""

    gaze_source: EnumProperty(
        name="Gaze",
        description="Where the viewer looks",
        items=[
            ("NONE", "Nobody looks", "The program decides; without a viewer all pixels are sampled alike"),
            ("LOG", "Recording", "Where a recorded viewer looked, from the log of an eye tracker"),
            ("POINT", "Fixed place", "The viewer looks at one place of the screen"),
        ],
        default="NONE",
    )
    gaze_log: StringProperty(
        name="Gaze log",
        description="The log of an eye tracker; its format is found by its content",
        subtype="FILE_PATH",
    )
    gaze_delay: FloatProperty(
        name="Begins after",
        description="The time from the beginning of the first frame to the beginning of the log",
        unit="TIME_ABSOLUTE",
    )
    gaze_at: FloatVectorProperty(
        name="Place",
        description="The place in parts of the screen's width and height, from its top left",
        size=2,
        default=(0.5, 0.5),
        soft_min=0,
        soft_max=1,
    )
    gaze_transfer: EnumProperty(
        name="Transfer",
        description="How gaze is carried from the screen of the recording to another one",
        items=[
            ("NONE", "Not needed", "The recording was made on this screen"),
            ("fraction", "Same place", "The place on the screen stays the same"),
            ("angle", "Same angle", "The angle at the eye stays the same"),
        ],
    )
    screen_source: EnumProperty(
        name="Screen",
        description="The screen on which the pictures will be seen: it says how large a pixel is to the eye",
        items=[
            ("LOG", "As the log states", "The screen of the recording"),
            ("NAMED", "Known screen", "A screen that the program knows by name, or a file that describes one"),
            ("SIZE", "By its size", "Resolution, size and distance"),
        ],
    )
    screen_name: any_name("screens", "Name", "The name of a known screen, or the path of a .json file")
    screen_px: IntVectorProperty(
        name="Resolution", description="Pixels of the whole screen", size=2, default=(1920, 1080), min=1
    )
    screen_width: FloatProperty(
        name="Width", description="Width of the screen's active area", default=0.531, min=0.001, unit="LENGTH"
    )
    screen_height: FloatProperty(
        name="Height", description="Height of the screen's active area", default=0.299, min=0.001, unit="LENGTH"
    )
    screen_distance: FloatProperty(
        name="Distance", description="Distance from the eye to the screen", default=0.6, min=0.001, unit="LENGTH"
    )
    preset: any_name("presets", "Preset", "A named list of settings. Empty: the program's defaults")
    sampling: any_name("samplings", "Sampling", "Where the samples of a frame go. Empty: the preset's")
    density: any_name("densities", "Density", "How samples become fewer away from the gaze, for the sampling by density")
    filter: any_name("filters", "Filter", "How pixels between the samples are filled. Empty: the preset's")
    samples: IntProperty(
        name="Samples",
        description="Samples a pixel on average, with any sampling. 0: the sampling's own",
        min=0,
        soft_max=1024,
    )
    view_source: EnumProperty(
        name="View",
        description="The view of display pictures",
        items=[
            ("SCENE", "Of the scene", "Exposure, view and look of the scene, from Blender's own configuration"),
            ("PROGRAM", "Of the program", "The program's own view at its own exposure"),
        ],
    )
    output_folder: StringProperty(
        name="Output", description="The folder of the pictures", subtype="DIR_PATH", default="//gazetrace"
    )
    display_pictures: BoolProperty(
        name="Display pictures", description="Writes .png pictures through the view beside the linear .exr ones"
    )
    further_settings: PointerProperty(
        name="Further settings",
        description="A text of this file whose lines are added to the job: options of the program in TOML",
        type=bpy.types.Text,
    )


class GazetraceRun(bpy.types.PropertyGroup):
    """What the window shows of a run."""

    is_running: BoolProperty()
    cancel_is_wanted: BoolProperty()
    share: FloatProperty(name="Progress", subtype="FACTOR", min=0, max=1)
    told: StringProperty(name="Last words")


class GazetracePreferences(bpy.types.AddonPreferences):
    """What belongs to the machine."""

    bl_idname = __package__

    program: StringProperty(
        name="Program",
        description="The gazetrace program. Empty: the environment variable GAZETRACE, else the one on the PATH",
        subtype="FILE_PATH",
    )

    def draw(self, _context: bpy.types.Context) -> None:
        """The only setting."""
        self.layout.prop(self, "program")


CLASSES = (GazetraceSettings, GazetraceRun, GazetracePreferences)


def attach() -> None:
    """Gives every scene its settings, and the window manager its run."""
    bpy.types.Scene.gazetrace = PointerProperty(type=GazetraceSettings)
    bpy.types.WindowManager.gazetrace_run = PointerProperty(type=GazetraceRun)


def detach() -> None:
    """Takes both away."""
    del bpy.types.WindowManager.gazetrace_run
    del bpy.types.Scene.gazetrace
