# SPDX-License-Identifier: Apache-2.0
"""The add-on inside Blender: what it refuses, what it writes, and what it shows of a run."""

import json
import math
import os
import subprocess
import sys
import tempfile
import time
import unittest
from pathlib import Path
from types import SimpleNamespace

import bpy
import mathutils
import numpy as np

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), str(HERE.parents[1] / "blender")]

import gazetrace_blender  # noqa: E402
import scenes  # noqa: E402
from gazetrace_blender import job, lights, program, refusal, result, run, world  # noqa: E402

PROGRAM = os.environ["GAZETRACE"]
LOG = "# gazetrace-gaze 1\n# display_px 64 36\n# display_mm 640 360\n# distance_mm 600\nt[ns],u[1],v[1],valid,eye\n"


class AddOnTest(unittest.TestCase):
    """A saved file with the scene of the first view, and the add-on."""

    def setUp(self):
        self.scene = scenes.build(scenes.View("small", size=(64, 36)))
        gazetrace_blender.register()
        self.addCleanup(gazetrace_blender.unregister)
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)
        self.settings = self.scene.gazetrace
        self.settings.gaze_source = "NONE"
        self.settings.samples = 4
        self.save()

    def save(self):
        bpy.ops.wm.save_as_mainfile(filepath=str(self.folder / "shot.blend"))

    def further(self, text):
        self.settings.further_settings = bpy.data.texts.new("further")
        self.settings.further_settings.write(text)

    def job_text(self):
        return job.write_job(bpy.context).settings_file.read_text(encoding="utf-8")

    def plan(self):
        """The frames as the program plans them, and its warnings."""
        written = job.write_job(bpy.context)
        told = subprocess.run([PROGRAM, "plan", "--config", written.settings_file.name, "--json", "-"], cwd=written.folder,
                              capture_output=True, text=True, check=False)
        self.assertEqual(told.returncode, 0, told.stderr)
        return json.loads(told.stdout)["frames"], "".join(line for line in told.stderr.splitlines() if "warning" in line)

    def picture(self, frame=scenes.FIRST):
        self.assertEqual(bpy.ops.gazetrace.render(), {"FINISHED"})
        return scenes.pixels(self.folder / "gazetrace" / f"frame.{frame:04d}.exr")

    def cycles_picture(self, samples=64):
        self.scene.render.engine = "CYCLES"
        self.scene.cycles.samples = samples
        self.scene.cycles.use_denoising = False
        self.scene.render.image_settings.file_format = "OPEN_EXR"
        self.scene.render.filepath = str(self.folder / "cycles.exr")
        self.scene.frame_set(scenes.FIRST)
        bpy.ops.render.render(write_still=True)
        return scenes.pixels(self.folder / "cycles.exr")


class Refusals(AddOnTest):
    def assert_refused(self, words):
        with self.assertRaises(refusal.Refusal) as caught:
            job.write_job(bpy.context)
        self.assertIn(words, str(caught.exception))
        self.assertIn("; ", str(caught.exception))
        self.assertFalse((self.folder / "shot.gazetrace.toml").exists())

    def test_pixels_that_are_not_square(self):
        self.scene.render.pixel_aspect_x = 2
        self.assert_refused("pixel aspect is 2 to 1")

    def test_a_panorama(self):
        self.scene.camera.data.type = "PANO"
        self.assert_refused("panoramic")

    def test_no_camera(self):
        self.scene.camera = None
        self.assert_refused("no camera")

    def test_a_region_without_a_pixel(self):
        self.scene.render.use_border, self.scene.render.border_max_x = True, 0.01
        self.assert_refused("region is smaller than a pixel")

    def test_frames_before_the_first(self):
        self.scene.frame_start = 0
        self.assert_refused("counts frames from 1")

    def test_a_lens_that_zooms(self):
        scenes.key(self.scene.camera.data, "lens", 1, 35.0)
        scenes.key(self.scene.camera.data, "lens", 20, 80.0)
        self.assert_refused("is another in frame 12 than in frame 11")

    def test_markers_that_switch_cameras(self):
        other = bpy.data.objects.new("other", bpy.data.cameras.new("other"))
        self.scene.collection.objects.link(other)
        self.scene.timeline_markers.new("begin", frame=1).camera = self.scene.camera
        self.scene.timeline_markers.new("cut", frame=13).camera = other
        self.assert_refused("a marker switches to camera 'other' in frame 13")

    def test_a_gaze_without_a_log(self):
        self.settings.gaze_source = "LOG"
        self.assert_refused("no gaze log")


class Settings(AddOnTest):
    def test_frames_are_at_blenders_times_and_camera_where_blender_has_it(self):
        self.scene.frame_end, self.scene.frame_step = 17, 3
        frames, warnings = self.plan()
        self.assertEqual([frame["frame"] for frame in frames], [11, 14, 17])
        self.assertEqual(warnings, "")
        for frame in frames:
            self.assertAlmostEqual(frame["t_video_ns"] * 1e-9, frame["frame"] * 1.001 / 24, delta=2e-9)
            self.scene.frame_set(frame["frame"])
            x, y, z = self.scene.camera.matrix_world.translation
            for told, wanted in zip(frame["camera"]["position_m"], (x, z, -y)):
                self.assertAlmostEqual(told, wanted, delta=1e-5)

    def test_the_scene_is_left_as_it_was(self):
        self.scene.frame_set(13)
        before = [(item.name, tuple(map(tuple, item.matrix_world))) for item in self.scene.objects]
        job.write_job(bpy.context)
        self.assertEqual(self.scene.frame_current, 13)
        self.assertEqual((self.scene.frame_start, self.scene.frame_end), (scenes.FIRST, scenes.LAST))
        self.assertAlmostEqual(self.scene.render.fps_base, 1.001, places=6)
        self.assertEqual(before, [(item.name, tuple(map(tuple, item.matrix_world))) for item in self.scene.objects])

    def test_gaze_begins_with_the_first_frame_and_after_its_delay(self):
        # One sample a frame of 24/1.001 a second, in the middle of the frame's interval: u says which.
        rows = [f"{round((i + 0.5) * 1.001 / 24 * 1e9)},{0.1 * (i + 1):.1f},0.5,ok,cyclopean" for i in range(8)]
        (self.folder / "gaze.csv").write_text(LOG + "0,0,0.5,ok,cyclopean\n" + "\n".join(rows) + "\n")
        self.settings.gaze_source, self.settings.gaze_log = "LOG", "//gaze.csv"
        self.further('gaze-mode = "nearest"\n')
        frames, _ = self.plan()
        self.assertEqual([round(frame["gaze_render"]["u"], 3) for frame in frames], [0.1, 0.2, 0.3, 0.4, 0.5])
        self.settings.gaze_delay = 2 * 1.001 / 24
        frames, _ = self.plan()
        self.assertEqual([round(frame["gaze_render"]["u"], 3) for frame in frames[2:]], [0.1, 0.2, 0.3])

    def test_screens_by_name_and_by_size(self):
        self.settings.gaze_source = "POINT"
        self.settings.screen_source, self.settings.screen_name = "NAMED", "tx300"
        self.assertIn('screen = "tx300"', self.job_text())
        self.plan()
        self.settings.screen_source = "SIZE"
        text = self.job_text()
        for line in ("screen-px = [1920, 1080]", "screen-cm = [53.1, 29.9]", "screen-distance-cm = 60.0"):
            self.assertIn(line, text)
        self.plan()

    def test_depth_of_field_and_shutter(self):
        lens = self.scene.camera.data
        lens.dof.use_dof, lens.dof.aperture_fstop, lens.dof.focus_distance = True, 2.8, 4.0
        self.scene.render.use_motion_blur, self.scene.render.motion_blur_shutter = True, 0.5
        text = self.job_text()
        self.assertIn(f"aperture = {35e-3 / 2 / lens.dof.aperture_fstop!r}", text)
        self.assertIn("focus-distance = 4.0", text)
        self.assertIn('shutter = "0.25,0.75"', text)
        self.plan()

    def test_names_come_from_the_program(self):
        self.assertIn("guided", [name for name, _ in program.names_of(PROGRAM, "filters")])
        self.assertEqual(program.names_of("/nonexistent", "filters"), ())

    def test_what_is_lost_of_lights_is_said(self):
        light = bpy.data.lights.new("panel", "AREA")
        panel = bpy.data.objects.new("panel", light)
        self.scene.collection.objects.link(panel)
        self.assertEqual(job.write_job(bpy.context).left_out, [])
        light.spread = math.radians(60)
        scenes.key(light, "energy", 1, 10.0)
        panel.matrix_world = self.scene.camera.matrix_world @ mathutils.Matrix.Translation((0, 0, -3))
        panel.rotation_euler.rotate_axis("Y", math.pi)  # towards the camera
        told = " ".join(job.write_job(bpy.context).left_out)
        for words in ("spread is 60 degrees", "is seen by the camera", "stays as in the first frame"):
            self.assertIn(words, told)

    def test_a_region_of_the_picture(self):
        render = self.scene.render
        render.use_border = True
        render.border_min_x, render.border_max_x, render.border_min_y, render.border_max_y = 0.25, 0.7, 0.1, 0.5
        self.assertIn("crop = [16, 18, 28, 15]", self.job_text())
        self.plan()


class Runs(AddOnTest):
    def test_the_result_is_an_image_sequence(self):
        self.settings.display_pictures = True
        windows = bpy.context.window_manager.windows
        if windows:
            windows[0].screen.areas[0].type = "IMAGE_EDITOR"
        self.picture()
        image = bpy.data.images["gazetrace"]
        self.assertEqual(image.source, "SEQUENCE")
        self.assertTrue(image.filepath.endswith(f"frame.{scenes.FIRST:04d}.exr"))
        if windows:
            editor = windows[0].screen.areas[0].spaces.active
            user = editor.image_user
            self.assertEqual(editor.image, image)
            # Blender shows the file of number frame - frame_start + 1 + frame_offset.
            self.assertEqual((user.frame_offset + 1, user.frame_start, user.frame_duration), (11, 11, 5))
        names = sorted(path.name for path in (self.folder / "gazetrace").glob("frame.[0-9]*"))
        self.assertEqual(names, [f"frame.{n:04d}.{end}" for n in range(11, 16) for end in ("exr", "png")])

    def test_the_view_is_that_of_the_scene(self):
        self.settings.display_pictures = True
        self.scene.view_settings.exposure = 1.5
        self.further('sampling = "uniform"\n')
        self.picture()
        linear = bpy.data.images.load(str(self.folder / "gazetrace" / "frame.0011.exr"), check_existing=False)
        self.scene.render.image_settings.file_format = "PNG"
        linear.save_render(str(self.folder / "blender.png"), scene=self.scene)
        ours = scenes.pixels(self.folder / "gazetrace" / "frame.0011.png")
        blenders = scenes.pixels(self.folder / "blender.png")
        self.assertGreater(ours.max(), 0.5)
        self.assertLessEqual(np.abs(ours - blenders).max(), 2.01 / 255)

    def test_the_programs_own_words_reach_the_user(self):
        self.further('density = "nonsense"\n')
        with self.assertRaises(RuntimeError) as caught:
            bpy.ops.gazetrace.render()
        self.assertIn("nonsense", str(caught.exception))
        self.assertIn("nonsense", bpy.context.window_manager.gazetrace_run.told)
        self.assertNotIn("gazetrace: error", str(caught.exception))

    def test_a_program_that_is_not_there(self):
        kept = os.environ.pop("GAZETRACE")
        os.environ["GAZETRACE"] = "/nonexistent/gazetrace"
        self.addCleanup(os.environ.__setitem__, "GAZETRACE", kept)
        with self.assertRaises(RuntimeError) as caught:
            bpy.ops.gazetrace.render()
        self.assertIn("was not found", str(caught.exception))

    def test_a_cancelled_run_keeps_its_frames_and_goes_on(self):
        self.scene.frame_end = 400
        self.scene.render.use_overwrite = False
        written = job.write_job(bpy.context)
        first = run.Run(PROGRAM, written.settings_file)
        deadline = time.monotonic() + 120
        while first.progress.done < 2 and time.monotonic() < deadline:
            self.assertIsNone(first.poll(), first.progress.errors)
            time.sleep(0.01)
        first.cancel()
        self.assertEqual(first.wait(), 4)
        self.assertLess(first.progress.done, first.progress.count)
        self.assertTrue(0 < first.progress.share() < 1)
        self.assertIsNotNone(result.show(bpy.context, written))
        second = run.Run(PROGRAM, written.settings_file)
        self.assertEqual(second.wait(), 0)
        self.assertEqual(len(list((self.folder / "gazetrace").glob("frame.*.exr"))), 390)


class Light(AddOnTest):
    def empty_scene(self):
        for item in list(self.scene.objects):
            if item is not self.scene.camera:
                bpy.data.objects.remove(item)
        self.scene.camera.constraints.clear()
        self.scene.frame_end = scenes.FIRST

    def test_the_world_stands_as_in_blender(self):
        """A picture of the surroundings with one bright place is seen at the same pixel, turned or not."""
        self.empty_scene()
        bpy.ops.mesh.primitive_plane_add(size=0.1, location=(0, 0, 90))  # A scene needs a shape: this one is out of sight.
        radiance = np.full((64, 128, 4), 0.001, np.float32)
        radiance[20:24, 30:34, :3] = 50
        image = bpy.data.images.new("around", 128, 64, float_buffer=True)
        image.colorspace_settings.name = "Non-Color"  # The file has the numbers as they are.
        image.pixels.foreach_set(radiance.ravel())
        image.file_format, image.filepath_raw = "OPEN_EXR", str(self.folder / "around.exr")
        image.save()
        bpy.data.images.remove(image)
        around = self.scene.world = bpy.data.worlds.new("around")
        around.use_nodes = True
        tree = around.node_tree
        texture, mapping = tree.nodes.new("ShaderNodeTexEnvironment"), tree.nodes.new("ShaderNodeMapping")
        where = tree.nodes.new("ShaderNodeTexCoord")
        texture.image = bpy.data.images.load(str(self.folder / "around.exr"))
        tree.links.new(where.outputs["Generated"], mapping.inputs["Vector"])
        tree.links.new(mapping.outputs["Vector"], texture.inputs["Vector"])
        tree.links.new(texture.outputs["Color"], tree.nodes["Background"].inputs["Color"])
        tree.nodes["Background"].inputs["Strength"].default_value = 2
        self.further('sampling = "uniform"\nfilter = "none"\n')
        self.settings.samples = 32
        camera = self.scene.camera
        # The direction of the bright place: columns 30 to 34 of 128, rows 20 to 24 of 64 from below.
        azimuth, elevation = math.pi - 32 / 128 * 2 * math.pi, (22 / 64 - 0.5) * math.pi
        there = mathutils.Vector((math.cos(azimuth), math.sin(azimuth), math.tan(elevation)))
        self.addCleanup(setattr, world, "BAKED_SIZE_PX", world.BAKED_SIZE_PX)
        world.BAKED_SIZE_PX = (512, 256)
        # The last world is turned about another axis than the vertical one, so that it is baked.
        for turn, kind in (((0, 0, 0), "POINT"), ((0, 0, 0.7), "POINT"), ((0, 0, 0.7), "TEXTURE"), ((0.3, 0, 0.2), "POINT")):
            with self.subTest(turn=turn, kind=kind):
                mapping.vector_type = kind
                mapping.inputs["Rotation"].default_value = turn
                matrix = mathutils.Euler(turn).to_matrix()
                towards = (matrix if kind == "TEXTURE" else matrix.inverted()) @ there
                camera.rotation_euler = towards.to_track_quat("-Z", "Y").to_euler()
                camera.rotation_euler.rotate(mathutils.Euler((0.05, 0, 0.15)))
                self.assertEqual((self.folder / "shot.gazetrace" / "world.exr").exists(), False)
                blender, ours = self.cycles_picture(16), self.picture()
                self.assertGreater(blender.max(), 50)
                places = scenes.centroids(blender), scenes.centroids(ours)
                self.assertLess(np.abs(places[0] - places[1]).max(), 0.2)
                self.assertAlmostEqual(ours.max() / blender.max(), 1, delta=0.02)
        self.assertTrue((self.folder / "shot.gazetrace" / "world.exr").exists())

    @staticmethod
    def show_second_emission(lamp):
        """Of 2 and coloured, through a point of the link; the first stays, of 5."""
        lamp.use_nodes = True
        tree = lamp.node_tree
        tree.nodes["Emission"].inputs["Strength"].default_value = 5
        shown, point = tree.nodes.new("ShaderNodeEmission"), tree.nodes.new("NodeReroute")
        shown.inputs["Strength"].default_value, shown.inputs["Color"].default_value = 2, (0.5, 1, 0.25, 1)
        tree.links.new(shown.outputs["Emission"], point.inputs[0])
        tree.links.new(point.outputs[0], tree.get_output_node("CYCLES").inputs["Surface"])
        return shown

    def test_suns_by_nodes(self):
        """An emission that nothing shows is dark, and a strength that is linked is the exporter's, which is said."""
        def exported():
            entry = {"type": "directional", "name": sun.name, "intensity": 7.0}
            lights.set_suns(SimpleNamespace(document={"extensions": {"KHR_lights_punctual": {"lights": [entry]}}}))
            return entry["intensity"]

        self.empty_scene()
        sun = bpy.data.lights.new("sun", "SUN")
        sun.energy = 3
        self.scene.collection.objects.link(bpy.data.objects.new("sun", sun))
        self.assertEqual(exported(), 3)
        shown = self.show_second_emission(sun)
        self.assertEqual(exported(), 6)
        self.assertEqual(lights.lost_of_lights(self.scene), [])
        number = sun.node_tree.nodes.new("ShaderNodeValue")
        sun.node_tree.links.new(number.outputs[0], shown.inputs["Strength"])
        self.assertEqual(exported(), 7)
        self.assertIn("its nodes compute them", " ".join(lights.lost_of_lights(self.scene)))
        surface = sun.node_tree.get_output_node("CYCLES").inputs["Surface"]
        sun.node_tree.links.remove(surface.links[0])
        self.assertEqual(exported(), 0)

    def test_lights_are_as_strong_as_in_blender(self):
        """A matte floor under one lamp has the same mean light: a point, a spot, a sun, and areas."""
        self.empty_scene()
        bpy.ops.mesh.primitive_plane_add(size=40)
        material = bpy.data.materials.new("matte")
        material.use_nodes = True
        surface = material.node_tree.nodes["Principled BSDF"]
        for name in ("Specular", "Specular IOR Level"):
            if name in surface.inputs:
                surface.inputs[name].default_value = 0
        surface.inputs["Roughness"].default_value = 1
        bpy.context.object.data.materials.append(material)
        camera = self.scene.camera
        camera.location, camera.rotation_euler = (0, 0, 5), (0, 0, 0)
        self.further('sampling = "uniform"\nfilter = "none"\ndiffuse = "lambert"\nbounces = 1\n')
        self.settings.samples = 64
        # Cycles of Blender 3.4 darkens a spot by the cosine of the angle to its axis, which glTF cannot say: near the axis
        # the two agree.
        # Area lights hang above the camera, which would see them from behind.
        for kind, energy, height in (("POINT", 100, 3), ("SPOT", 4000, 15), ("SUN", 3, 3), ("SUN BY NODES", 1.5, 3), ("SQUARE", 500, 6),
                                     ("ELLIPSE", 500, 6)):
            with self.subTest(kind):
                shape, kind = (kind, "AREA") if kind in ("SQUARE", "ELLIPSE") else ("", kind)
                kind, by_nodes = kind.removesuffix(" BY NODES"), kind.endswith(" BY NODES")
                lamp = bpy.data.lights.new(kind, kind)
                if by_nodes:
                    self.show_second_emission(lamp)
                lamp.energy, lamp.color = energy, (1, 0.5, 0.25)
                if kind in ("POINT", "SPOT"):
                    lamp.shadow_soft_size = 0
                if kind == "AREA":
                    lamp.shape, lamp.size, lamp.size_y = shape, 2, 0.5
                    if hasattr(lamp, "normalize"):
                        lamp.normalize, lamp.exposure = shape == "SQUARE", 0.5
                if kind == "SPOT":
                    lamp.spot_size, lamp.spot_blend = 1.5, 0
                item = bpy.data.objects.new(kind, lamp)
                item.location = (0.3, 0.2, height)
                if kind == "AREA":
                    item.rotation_euler, item.scale = (0.2, -0.1, 0.5), (1.5, 0.7, 1)
                self.scene.collection.objects.link(item)
                blender = self.cycles_picture(64).mean(axis=(0, 1))
                ours = self.picture().mean(axis=(0, 1))
                bpy.data.objects.remove(item)
                for a, b in zip(ours, blender):
                    self.assertAlmostEqual(a / b, 1, delta=0.02)


class Bones(AddOnTest):
    def test_what_bones_and_shape_keys_move_is_where_blender_has_it(self):
        bpy.ops.object.armature_add()
        armature = bpy.context.object
        armature.name = "armature"
        bone = armature.pose.bones[0]
        bone.rotation_mode = "XYZ"
        for frame, turn in ((1, 0.0), (30, 1.5)):
            bone.rotation_euler = (turn, 0, 0.3)
            bone.keyframe_insert("rotation_euler", frame=frame)
        scenes.key(armature, "location", 1, (0, 0, -0.5))
        scenes.key(armature, "location", 30, (0.3, 0, -0.4))
        green = bpy.data.objects["green"]
        green.parent = None
        green.constraints.clear()
        green.location = (0, 0, 0)
        for vertex in green.data.vertices:
            vertex.co.z += 0.6
        group = green.vertex_groups.new(name=bone.name)
        group.add(range(len(green.data.vertices)), 1, "REPLACE")
        green.parent = armature
        green.modifiers.new("armature", "ARMATURE").object = armature
        red = bpy.data.objects["red"]
        red.shape_key_add(name="rest")
        moved = red.shape_key_add(name="moved")
        for point in moved.data:
            point.co.x += 0.5
        scenes.key(moved, "value", 1, 0.0)
        scenes.key(moved, "value", 30, 1.0)
        self.scene.render.resolution_x, self.scene.render.resolution_y = 160, 90
        self.scene.render.fps_base = 1.25
        self.further('sampling = "uniform"\nfilter = "none"\nbounces = 0\n')
        self.settings.samples = 64
        self.save()
        self.assertEqual(bpy.ops.gazetrace.render(), {"FINISHED"})
        self.scene.render.engine = "CYCLES"
        self.scene.cycles.samples = 64
        self.scene.cycles.use_denoising = False
        self.scene.render.image_settings.file_format = "OPEN_EXR"
        places = []
        for frame in (scenes.FIRST, scenes.LAST):
            self.scene.frame_set(frame)
            self.scene.render.filepath = str(self.folder / "cycles.exr")
            bpy.ops.render.render(write_still=True)
            blender = scenes.centroids(scenes.pixels(self.folder / "cycles.exr"))
            ours = scenes.centroids(scenes.pixels(self.folder / "gazetrace" / f"frame.{frame:04d}.exr"))
            self.assertLess(np.abs(blender - ours).max(), 0.5)
            places.append(blender)
        self.assertTrue((np.abs(places[1] - places[0]).max(axis=1) > 1).all())


if __name__ == "__main__":
    names = sys.argv[sys.argv.index("--") + 1 :] if "--" in sys.argv else sys.argv[1:]
    scenes.leave(0 if unittest.main(argv=["addon.py", *names], exit=False, verbosity=2).result.wasSuccessful() else 1)
