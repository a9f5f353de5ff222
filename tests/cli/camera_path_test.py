# SPDX-License-Identifier: Apache-2.0
"""Camera paths from outside: formats, placement, export and back; screens of recording and viewing."""

import json
import math
from pathlib import Path

import harness

PATH = "0 1 2 3 0 0 0 1\n1 4 2 3 0 0.7071067811865476 0 0.7071067811865476\n2 4 2 0 0.5 0.5 0.5 0.5\n"


class CameraPaths(harness.CliTest):
    def frames(self, *arguments):
        return json.loads(self.run_ok("plan", "--size", "64x36", *arguments, "--json").stdout)["frames"]

    def cameras(self, *arguments):
        return [frame["camera"] for frame in self.frames(*arguments)]

    def assert_same_cameras(self, first, second):
        self.assertEqual(len(first), len(second))
        for a, b in zip(first, second):
            self.assertLess(math.dist(a["position_m"], b["position_m"]), 1e-9)
            sign = math.copysign(1, sum(x * y for x, y in zip(a["orientation_xyzw"], b["orientation_xyzw"])))
            turned = [sign * x for x in b["orientation_xyzw"]]
            self.assertLess(2 * math.dist(a["orientation_xyzw"], turned), 1e-9)

    def test_out_and_in_again(self):
        self.write("path.tum", PATH)
        first = self.cameras("--camera-path", "path.tum", "--fps", "24000/1001", "--yfov", "40")
        self.assertEqual(len(first), 48)  # the middle of frame 48, 1.981 s, is still on the path of 2 s
        for name, flags in (("again.chan", []), ("again.tum", ["--camera-keep-time", "--yfov", "40"]),
                            ("xyz.chan", ["--camera-rotation-order", "xyz"])):
            order = flags if "--camera-rotation-order" in flags else []
            self.run_ok("plan", "--size", "64x36", "--camera-path", "path.tum", "--fps", "24000/1001", "--yfov", "40",
                        "--save-camera", name, *order)
            again = self.cameras("--camera-path", name, "--fps", "24000/1001", *flags)
            self.assert_same_cameras(first, again)
            self.assertAlmostEqual(again[0]["yfov_deg"], 40, places=12)
        self.assert_refused(["plan", "--size", "64x36", "--camera-path", "path.tum", "--save-camera", "x.fbx"],
                            ["x.fbx", ".chan"])

    def test_a_plan_is_as_long_as_what_moves_in_the_scene(self):
        moving = harness.box_gltf(camera_seconds=1)
        self.write("camera.gltf", json.dumps(moving))
        moving["animations"][0]["channels"][0]["target"]["node"] = 0
        self.write("moving.gltf", json.dumps(moving))
        eye = ["--eye", "0,0,3", "--target", "0,0,0", "--fps", "4"]
        self.write("log.csv", harness.moving_gaze(50))  # half a second
        for frames, arguments in ((4, ["moving.gltf", *eye]), (1, ["camera.gltf", *eye]), (1, ["box.gltf", *eye]), (1, eye),
                                  (2, ["moving.gltf", *eye, "--gaze", "log.csv"]), (3, ["moving.gltf", *eye, "--frames", "1-3"])):
            self.assertEqual(len(self.frames(*arguments)), frames, arguments)

    def test_each_pose_is_a_frame(self):
        self.write("ten.chan", "".join(f"{1001 + i} {i} 0 0 0 0 0\n" for i in range(10)))
        for rate in ("24000/1001", "59.94", "90"):
            for arguments, first in (([], 1), (["--first-frame", "1001"], 1001), (["--first-frame", "1001", "--camera-keep-time"], 1001),
                                     (["--camera-keep-time"], 1001)):
                frames = self.frames("--camera-path", "ten.chan", "--fps", rate, *arguments)
                self.assertEqual([frame["frame"] for frame in frames], list(range(first, first + 10)), (rate, arguments))
                for i, frame in enumerate(frames):
                    self.assertAlmostEqual(frame["camera"]["position_m"][0], i, 7)
        # At another rate the middle of the first frame lies before the first pose.
        self.assertEqual([frame["frame"] for frame in self.frames("--camera-path", "ten.chan", "--fps", "60", "--camera-fps", "24")], list(range(2, 25)))

    def test_frames_may_be_counted_from_1001(self):
        self.write("path.tum", PATH)
        arguments = ["box.gltf", "--camera-path", "path.tum", "--fps", "4"]
        plain, numbered = (self.frames(*arguments, *more) for more in ([], ["--first-frame", "1001"]))
        self.assertEqual([frame["frame"] for frame in numbered], [frame["frame"] + 1000 for frame in plain])
        self.assertEqual([{**frame, "frame": 0} for frame in numbered], [{**frame, "frame": 0} for frame in plain])
        self.run_ok("render", *arguments, "--first-frame", "1001", "--frames", "1002-1003", "--size", "16x9", "--spp", "1", "-o", "f.####.exr", "--quiet")
        self.assertEqual(sorted(path.name for path in self.folder.glob("f.*.exr")), ["f.1002.exr", "f.1003.exr"])
        self.assert_refused(["plan", *arguments, "--first-frame", "1001", "--frames", "1-3"], ["--frames", "numbered from 1001"])

    def test_a_wide_camera_is_not_cropped(self):
        scene = harness.box_gltf()
        scene["cameras"] = [{"type": "orthographic", "orthographic": {"xmag": 2.5, "ymag": 1, "znear": 0.01, "zfar": 100}},
                            {"type": "perspective", "perspective": {"yfov": 1.5707963267948966, "aspectRatio": 4, "znear": 0.01}}]
        scene["nodes"] += [{"camera": 1}]
        scene["scenes"][0]["nodes"] += [4]
        self.write("wide.gltf", json.dumps(scene))
        self.assertAlmostEqual(self.cameras("wide.gltf", "--camera", "0")[0]["ymag_m"], 1.40625)
        self.assertAlmostEqual(self.cameras("wide.gltf", "--camera", "1")[0]["yfov_deg"], math.degrees(2 * math.atan(4 / (16 / 9))))
        self.assertAlmostEqual(self.cameras("wide.gltf", "--camera", "1", "--yfov", "40")[0]["yfov_deg"], 40)
        self.assertIn("2.5 times as wide", self.run_ok("scene", "wide.gltf").stdout)

    def test_the_help_says_how_a_saved_path_is_read_again(self):
        text = " ".join(self.run_ok("plan", "--help").stdout.split())
        saving = text[text.index("--save-camera"):]
        self.assertIn("--camera-keep-time", saving[:saving.index("--json")])

    def test_a_path_is_placed(self):
        self.write("path.tum", PATH)
        placed = self.cameras("--camera-path", "path.tum", "--fps", "2", "--camera-turn", "90", "--camera-scale", "2",
                              "--camera-start", "10,20,30")
        # A quarter of the way from (1, 2, 3) to (4, 2, 3) is 0.75 m along x, 1.5 m along -z after the turn and the scale.
        self.assertLess(math.dist(placed[0]["position_m"], [10, 20, 28.5]), 1e-9)
        self.assert_refused(["plan", "--eye", "0,0,0", "--target", "0,0,1", "--camera-turn", "5"], ["--camera-turn"])

    def test_lenses_beside_the_pictures_are_inputs(self):
        self.write("images.txt", "1 1 0 0 0 0 0 -4 7 a.png\n\n2 1 0 0 0 0 0.1 -4 7 b.png\n\n")
        digests = []
        for i, focal in enumerate((900, 800)):
            self.write("cameras.txt", f"7 PINHOLE 1920 1080 {focal} {focal} 960 540\n")
            self.run_ok("render", "box.gltf", "--camera-path", "images.txt", "--size", "16x9", "--spp", "1", "--frames", "1",
                        "-o", f"{i}/f.####.exr", "--quiet")
            inputs = json.loads((self.folder / f"{i}/f.run.json").read_text())["input_digests"]
            digests.append({Path(name).name: digest for name, digest in inputs.items()})
        self.assertEqual(digests[0]["images.txt"], digests[1]["images.txt"])
        self.assertNotEqual(digests[0]["cameras.txt"], digests[1]["cameras.txt"])

    def test_screens_differ(self):
        self.write("log.csv", "# display_px 1920 1080\n# display_mm 400 225\n# distance_mm 500\nt[ms],u[1],v[1]\n0,0.75,0.5\n")
        self.write("wall.json", '{"width_px": 3840, "height_px": 2160, "width_cm": 80, "height_cm": 45, "distance_cm": 50}')
        arguments = ["--gaze", "log.csv", "--screen", "wall.json", "--eye", "0,0,0", "--target", "0,0,-1"]
        self.assert_refused(["plan", "--size", "64x36", *arguments], ["log.csv", "--gaze-transfer"])
        self.assertAlmostEqual(self.frames(*arguments, "--gaze-transfer", "fraction")[0]["gaze_render"]["u"], 0.75)
        self.assertAlmostEqual(self.frames(*arguments, "--gaze-transfer", "angle")[0]["gaze_render"]["u"], 0.625)
        self.assertAlmostEqual(self.frames(*arguments, "--recording-screen", "wall.json")[0]["gaze_render"]["u"], 0.75)

    def test_pixels_a_degree_are_enough(self):
        self.write("log.csv", "t[ms],x[px],y[px]\n0,960,540\n")
        arguments = ["--gaze", "log.csv", "--eye", "0,0,0", "--target", "0,0,-1", "--screen-px", "1920,1080"]
        self.assert_refused(["plan", "--size", "64x36", *arguments], ["display", "width in cm"])
        self.assertEqual(self.frames(*arguments, "--screen-ppd", "40")[0]["gaze_render"]["u"], 0.5)


if __name__ == "__main__":
    harness.main()
