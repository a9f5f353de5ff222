# SPDX-License-Identifier: Apache-2.0
"""Bad input ends in one line that names the thing, exit code 2, and leaves nothing behind."""

import json
import struct

import harness

OUT = ["-o", "out/f.####.exr", "--size", "64x36"]


def glb(gltf, binary):
    text = json.dumps(gltf).encode()
    text += b" " * (-len(text) % 4)
    binary += b"\0" * (-len(binary) % 4)
    chunks = struct.pack("<II", len(text), 0x4E4F534A) + text + struct.pack("<II", len(binary), 0x004E4942) + binary
    return struct.pack("<III", 0x46546C67, 2, 12 + len(chunks)) + chunks


class BadScenes(harness.CliTest):
    def refuse(self, name, words):
        self.assert_refused(["render", name, *OUT], words)
        self.assert_refused(["scene", name], words)

    def test_missing_file(self):
        self.refuse("nowhere.gltf", ["nowhere.gltf"])

    def test_a_missing_environment_is_told_before_the_scene_is_read(self):
        self.write("box.gltf", json.dumps(harness.box_gltf()))
        self.write("text.gltf", "{ this is not JSON")
        for scene in ("box.gltf", "text.gltf"):
            self.assert_refused(["render", scene, "--env", "nosuch.hdr", *OUT], ["nosuch.hdr", "--env", "soft-sky"])

    def test_folder_as_scene(self):
        (self.folder / "folder.gltf").mkdir()
        self.refuse("folder.gltf", ["folder.gltf"])

    def test_truncated_glb(self):
        whole = glb({"asset": {"version": "2.0"}, "buffers": [{"byteLength": 400}]}, bytes(400))
        for length in (0, 3, 12, 19, 40, len(whole) - 200):
            with self.subTest(length=length):
                self.write("cut.glb", whole[:length])
                self.refuse("cut.glb", ["cut.glb"])

    def test_not_json(self):
        self.write("text.gltf", "{ this is not JSON")
        self.refuse("text.gltf", ["text.gltf"])

    def test_an_empty_file_is_empty(self):
        for name in ("empty.glb", "empty.gltf"):
            self.write(name, "")
            line = self.assert_refused(["scene", name], [name, "is empty"])
            self.assertNotIn("JSON", line)

    def test_what_is_wrong_with_json_is_told_in_words_of_our_own(self):
        for text, words in (("{ this is not JSON", "line 1, column 4: it cannot go on with '{ th';"),
                            ('{"asset": {"version": "2.0"},', "line 1, column 30: the text ends too early")):
            self.write("text.gltf", text)
            line = self.assert_refused(["scene", "text.gltf"], ["is not valid JSON", words])
            self.assertNotIn("exception", line)

    def test_a_scene_of_which_nothing_is_left(self):
        gltf = harness.box_gltf()
        gltf["meshes"][0]["primitives"][0]["mode"] = 1  # lines
        self.write("lines.gltf", json.dumps(gltf))
        self.write("nothing.gltf", json.dumps({"asset": {"version": "2.0"}}))
        line = self.assert_refused(["render", "lines.gltf", *OUT], ["lines.gltf", "no geometry", "left out", "lines"])
        self.assertIn("gazetrace scene", line)
        self.assert_refused(["render", "nothing.gltf", *OUT], ["nothing.gltf", "no geometry"])
        self.run_ok("scene", "nothing.gltf")  # which is for looking into files

    def test_accessor_out_of_bounds(self):
        gltf = harness.box_gltf()
        gltf["accessors"][0]["count"] = 1000
        self.write("wide.gltf", json.dumps(gltf))
        self.refuse("wide.gltf", ["wide.gltf", "accessors[0]"])

    def test_index_beyond_vertices(self):
        gltf = harness.box_gltf()
        gltf["accessors"][0]["count"] = 4
        self.write("index.gltf", json.dumps(gltf))
        self.refuse("index.gltf", ["index.gltf"])

    def test_required_extension(self):
        gltf = harness.box_gltf()
        gltf["extensionsRequired"] = ["VENDOR_unheard_of"]
        self.write("extension.gltf", json.dumps(gltf))
        self.refuse("extension.gltf", ["extension.gltf", "VENDOR_unheard_of"])

    def test_missing_buffer(self):
        gltf = harness.box_gltf()
        gltf["buffers"][0]["uri"] = "gone.bin"
        self.write("buffer.gltf", json.dumps(gltf))
        self.refuse("buffer.gltf", ["gone.bin"])

    def test_missing_environment(self):
        self.assert_refused(["render", "box.gltf", *OUT, "--env", "gone.hdr"], ["gone.hdr"])

    def test_broken_environment(self):
        self.write("broken.exr", "no picture")
        self.assert_refused(["render", "box.gltf", *OUT, "--env", "broken.exr"], ["broken.exr"])


class BadGaze(harness.CliTest):
    def refuse(self, content, words, more=(), name="log.csv"):
        self.write(name, content)
        self.assert_refused(["render", "box.gltf", *OUT, "--gaze", name, *more], words)
        if not more:
            self.assert_refused(["gaze", "import", name, "-o", "converted.csv"], words)

    def test_missing_file(self):
        self.assert_refused(["render", "box.gltf", *OUT, "--gaze", "gone.csv"], ["gone.csv"])
        self.assert_refused(["gaze", "inspect", "gone.csv"], ["gone.csv"])

    def test_without_time(self):
        self.refuse(harness.gaze_csv(["0.5,0.5,ok,left"], "u[1],v[1],valid,eye"), ["log.csv", "time"])

    def test_unordered_stamps(self):
        rows = ["0,0.5,0.5,ok,left", "20,0.5,0.5,ok,left", "10,0.5,0.5,ok,left"]
        self.refuse(harness.gaze_csv(rows), ["log.csv:8", "--order sort"])

    def test_duplicated_stamps(self):
        rows = ["0,0.5,0.5,ok,left", "10,0.5,0.5,ok,left", "10,0.6,0.5,ok,left"]
        self.refuse(harness.gaze_csv(rows), ["log.csv:8", "2 of 3 rows"])

    def test_empty_log(self):
        self.refuse(harness.gaze_csv([]), ["log.csv", "no sample"])
        self.refuse("", ["log.csv"])

    def test_unknown_column(self):
        self.refuse("when,where_x,where_y\n0,0.5,0.5\n1,0.5,0.5\n", ["log.csv", "time"])
        self.write("named.csv", "t[ns],u[1],v[1]\n0,0.5,0.5\n")
        self.assert_refused(["gaze", "import", "named.csv", "-o", "no.csv", "--x-column", "uu"], ["named.csv", "uu"])

    def test_options_of_reading_are_the_importers(self):
        """How a file is read is said once: nothing else takes it, and says who does."""
        self.write("log.csv", "clock,x[px],y[px]\n0,5,5\n4,5,5\n")
        import_it = "gazetrace gaze import log.csv -o gaze.csv"
        for command in (["render", "box.gltf", *OUT, "--gaze"], ["gaze", "events"]):
            self.assert_refused([*command, "log.csv", "--screen-px", "64,36"], ["--time-column", "which " + import_it + " takes"])
            self.assert_refused([*command, "log.csv", "--time-column", "clock"], ["--time-column", "an option of 'gazetrace gaze import'"])
            self.assert_refused([*command, "log.csv", "--gaze-unit", "px"], ["gazetrace gaze import LOG -o gaze.csv --unit UNIT"])
        self.write("job.toml", 'gaze = "log.csv"\ngaze-zero-missing = true\n')
        self.assert_refused(["plan", "--config", "job.toml"], ["gaze-zero-missing", "gaze import LOG -o gaze.csv --missing-value 0"])
        self.assert_refused(["plan", "--gaze", "log.csv", "--gaze-eye", "dominant"], ["give left or right"])

    def test_screen_log_without_geometry(self):
        rows = "t[ns],u[1],v[1],valid,eye\n0,0.5,0.5,ok,left\n10,0.5,0.5,ok,left\n"
        self.refuse(rows, ["log.csv", "--screen"], more=["--frames", "1"])
        self.refuse(rows, ["distance"], more=["--screen-px", "64,36", "--screen-cm", "64,36"])
        self.refuse(rows, ["width"], more=["--screen-px", "64,36", "--screen-distance-cm", "60"])
        self.refuse(rows, ["--screen", "nothing-like-it", "paper"], more=["--screen", "nothing-like-it"])

    def test_gaze_at_without_geometry(self):
        self.assert_refused(["render", "box.gltf", *OUT, "--gaze-at", "0.5,0.5"], ["--gaze-at", "--screen"])
        for at in ("-1e160,0.5", "0.5,1e4"):
            self.assert_refused(["render", "box.gltf", *OUT, *harness.SCREEN, f"--gaze-at={at}"],
                                ["--gaze-at", "far outside of the screen", "0.5,0.5"])

    def test_two_gazes(self):
        self.write("log.csv", harness.moving_gaze())
        self.assert_refused(["render", "box.gltf", *OUT, "--gaze", "log.csv", "--gaze-at", "0.5,0.5"], ["--gaze-at"])

    def test_gap_under_the_error_policy(self):
        self.write("log.csv", harness.gaze_csv(["0,0.5,0.5,ok,left", "10000000,0.5,0.5,ok,left"]))
        self.assert_refused(
            ["render", "box.gltf", *OUT, "--gaze", "log.csv", "--frames", "100", "--gaze-missing", "error"], ["log.csv"])

    def test_screen_of_another_shape(self):
        self.assert_refused(
            ["render", "box.gltf", "-o", "f.exr", "--size", "64x64", "--gaze-at", "0.5,0.5", *harness.SCREEN], ["shape"])


class BadCameras(harness.CliTest):
    def test_path_does_not_cover_the_frames(self):
        self.write("path.csv", "t[s],x[m],y[m],z[m],qx,qy,qz,qw\n0,0,0,4,0,0,0,1\n1,0,0,5,0,0,0,1\n")
        arguments = ["render", "box.gltf", *OUT, "--camera-path", "path.csv", "--fps", "24"]
        self.assert_refused([*arguments, "--frames", "20-30"], ["path.csv", "frame 25"])
        self.run_ok(*arguments, "--frames", "24-30", "--camera-extrapolation", "hold", "--spp", "1")

    def test_animated_camera_does_not_cover_the_frames(self):
        self.write("glide.gltf", json.dumps(harness.box_gltf(camera_seconds=1.0)))
        self.assert_refused(["render", "glide.gltf", *OUT, "--frames", "1-30"], ["frame 25"])

    def test_unknown_names(self):
        arguments = ["render", "box.gltf", *OUT]
        self.assert_refused([*arguments, "--camera", "mian"], ["--camera", "mian", "did you mean 'main'"])
        self.assert_refused([*arguments, "--camera", "7"], ["--camera", "7"])
        self.assert_refused([*arguments, "--camera-path", "gone.csv"], ["gone.csv"])
        self.assert_refused([*arguments, "--eye", "0,0,4"], ["--target"])
        self.assert_refused([*arguments, "--eye", "0,0,4", "--target", "0,0,4"], ["--target"])
        self.assert_refused([*arguments, "--eye", "0,0,4", "--target", "0,0,0", "--up", "0,0,0"], ["--up"])
        self.assert_refused([*arguments, "--eye", "0,0,4", "--target", "0,0,0", "--camera", "main"], ["--camera"])


class BadOutputs(harness.CliTest):
    def test_unwritable_folder(self):
        self.write("file", "not a folder")
        self.assert_refused(["render", "box.gltf", "-o", "file/f.exr", "--size", "64x36"], ["file", "not a folder"])
        self.assert_refused(["render", "box.gltf", "-o", "/proc/f.exr", "--size", "64x36"], ["/proc"])

    def test_existing_output(self):
        arguments = ["render", "box.gltf", *OUT, "--frames", "1-3", "--spp", "1"]
        self.write("out/f.0002.exr", "precious")
        self.assert_refused(arguments, ["out/f.0002.exr", "exists", "--overwrite"])
        self.assertEqual((self.folder / "out/f.0002.exr").read_text(), "precious")
        self.run_ok(*arguments, "--overwrite")
        self.assertNotEqual((self.folder / "out/f.0002.exr").read_bytes(), b"precious")
        self.assert_refused(arguments, ["exists"])

    def test_converting_over_a_file(self):
        self.write("log.csv", harness.moving_gaze())
        self.write("out.csv", "precious")
        self.assert_refused(["gaze", "import", "log.csv", "-o", "out.csv"], ["out.csv", "exists"])

    def test_names(self):
        def refuse(output, words):
            self.assert_refused(["render", "box.gltf", "--size", "64x36", "--frames", "1-2", *output], words)

        refuse([], ["output"])
        refuse(["-o", "f.exr"], ["f.exr", "####"])
        refuse(["-o", "f.####.bmpp"], ["f.####.bmpp"])
        refuse(["-o", "a.####.exr", "-o", "b.####.exr"], ["a.####.exr", "b.####.exr"])
        refuse(["-o", "a.####.exr", "--aov", "albdeo"], ["albdeo", "albedo"])
        refuse(["-o", "a.####.exr", "--aov", "eccentricity"], ["eccentricity", "--gaze"])
        refuse(["-o", "a.####.exr", "--exr-compression", "zap"], ["zap"])

    def test_outputs_that_meet(self):
        arguments = ["render", "box.gltf", "--size", "64x36", "--spp", "1", "--overwrite"]
        self.assert_refused([*arguments, "-o", "f.exr", "--map", "./f.exr"], ["f.exr", "two outputs"])
        self.run_ok(*arguments, "-o", "sky.exr")
        before = (self.folder / "sky.exr").read_bytes()
        self.assert_refused([*arguments, "-o", "sky.exr", "--env", "sky.exr"], ["sky.exr", "input"])
        self.assertEqual((self.folder / "sky.exr").read_bytes(), before)

    def test_more_than_the_format_holds(self):
        self.assert_refused(["render", "box.gltf", "-o", "f.jpg", "--size", "1x65535"], ["f.jpg", "65500"])
        self.assert_refused(["render", "box.gltf", "-o", "f.png", "--size", "64x36", "--aov", "normal"], ["--aov", "exr"])

    def test_going_on_with_another_run(self):
        arguments = ["render", "box.gltf", "--size", "16x9", "--spp", "1", "-o", "f.####.exr"]
        self.run_ok(*arguments, "--frames", "1-3")
        self.assert_refused([*arguments, "--frames", "4-6", "--resume"], ["f.run.json", "1-3", "another folder"])
        self.run_ok(*arguments, "--frames", "1-5", "--resume")
        self.write("f.timing.csv", "garbage\n")
        self.assertIn("f.timing.csv", self.run_ok(*arguments, "--frames", "1-5", "--resume").stderr)  # made anew
        self.assertIn('"done"', (self.folder / "f.run.json").read_text())

    def test_converting_into_what_cannot_be_a_folder(self):
        self.write("log.csv", harness.moving_gaze())
        self.assert_refused(["gaze", "import", "log.csv", "-o", "log.csv/out.csv"], ["log.csv", "cannot be made"])

    def test_unknown_view(self):
        arguments = ["render", "box.gltf", "-o", "f.png", "--size", "64x36"]
        self.assert_refused([*arguments, "--view", "ACES SDX"], ["ACES SDX", "ACES SDR"])
        self.assert_refused([*arguments, "--display", "none such"], ["none such"])
        self.assert_refused([*arguments, "--look", "none such"], ["none such"])
        self.assert_refused([*arguments, "--ocio", "gone.ocio"], ["gone.ocio"])
        self.assert_refused(arguments, ["gone.ocio"], environment={"OCIO": "gone.ocio"})


class BadOptions(harness.CliTest):
    def test_values(self):
        for option, value, words in [
            ("--size", "0x10", ["--size"]), ("--size", "64", ["--size", "1920x1080"]),
            ("--fps", "0", ["--fps"]), ("--fps", "fast", ["--fps"]),
            ("--frames", "5-1", ["--frames"]), ("--frames", "0", ["--frames"]), ("--frames", "x", ["--frames"]),
            ("--gaze-max-age", "50", ["--gaze-max-age", "unit"]), ("--gaze-max-age", "1.5ns", ["nanosecond"]),
            ("--gaze-max-age", "-1s", ["--gaze-max-age"]), ("--gaze-mode", "holdd", ["hold"]),
            ("--region-samples", "1,2", ["--region-samples"]), ("--region-eccentricities", "8.5,2.6", ["angle"]),
            ("--region-blocks", "0,4", ["block"]), ("--sampling", "region", ["regions"]), ("--filter", "liner", ["linear"]),
            ("--bounces", "-1", ["--bounces"]), ("--threads", "-1", ["--threads"]), ("--seed", "-1", ["--seed"]),
            ("--exposure", "bright", ["--exposure"]), ("--yfov", "180", ["--yfov"]), ("--env", "constant:1,2", ["--env"]),
            ("--env", "constant:-1,0,0", ["negative"]), ("--only-pixel", "64,0", ["--only-pixel", "64x36"]),
            ("--progress", "sometimes", ["auto"]), ("--bits", "12", ["12"]), ("--exr-space", "sRGB", ["Rec.709", "ACEScg"]), ("--crop", "0,0,0,5", ["positive"]),
            ("--gaze-scale", "0", ["--gaze-scale"]), ("--threads", "66000", ["--threads", "1024"]),
            ("--env-ev", "500", ["--env-ev", "500"]), ("--exposure", "auto+1e9", ["--exposure"]),
        ]:
            with self.subTest(option=option, value=value):
                size = [] if option == "--size" else ["--size", "64x36"]
                self.assert_refused(["render", "box.gltf", "-o", "f.####.exr", "-o", "f.####.png", *size, option, value], words)
        message = self.assert_refused(["render", "box.gltf", "-o", "f.exr", "--frames", "3-1"], ["--frames"])
        self.assertEqual(message.count("--frames"), 1, message)

    def test_usage(self):
        self.assert_refused([], ["command"])
        self.assert_refused(["rendr"], ["rendr", "render"])
        self.assert_refused(["render"], ["scene"])
        self.assert_refused(["render", "box.gltf", "--gase", "x"], ["--gase", "--gaze"])
        self.assert_refused(["render", "box.gltf", "more.gltf"], ["more.gltf"])
        self.assert_refused(["render", "box.gltf", "--size"], ["--size"])
        self.assert_refused(["scene"], ["scene"])
        self.assert_refused(["gaze", "inspect"], ["log"])
        self.assert_refused(["gaze"], ["subcommand", "gazetrace gaze --help"])
        self.assert_refused(["gaze", "inspekt", "log.csv"], ["inspekt", "did you mean 'inspect'"])
        self.assert_refused(["gaze", "inspect", "log.csv", "--jsom"], ["did you mean '--json'", "gazetrace gaze inspect --help"])
        self.assert_refused(["merge", "."], ["parts"])
        self.assert_refused(["list", "densites"], ["densities"])
        self.assert_refused(["plan"], ["scene"])



class Outputs(harness.CliTest):
    def test_links_do_not_hide_what_an_output_replaces(self):
        self.write("box.gltf", json.dumps(harness.box_gltf()))
        job = ["render", "box.gltf", "--size", "16x9", "--spp", "1", "--quiet"]
        (self.folder / "q").mkdir()
        (self.folder / "linked").symlink_to("q")
        self.assert_refused([*job, "-o", "q/a.png", "--json=linked/a.png"], ["linked/a.png", "another name"])
        self.assertEqual(list((self.folder / "q").iterdir()), [])
        (self.folder / "nowhere.png").symlink_to("gone/x.png")
        self.assert_refused([*job, "-o", "nowhere.png"], ["nowhere.png", "--overwrite"])
        self.assertTrue((self.folder / "nowhere.png").is_symlink())

    def test_densities_of_a_film_are_no_picture_of_a_display(self):
        self.write("box.gltf", json.dumps(harness.box_gltf()))
        self.run_ok("render", "box.gltf", "--size", "16x9", "--spp", "1", "--quiet", "-o", "a.png", "-o", "a.exr")
        self.run_ok("render", "box.gltf", "--size", "16x9", "--spp", "1", "--quiet", "-o", "d.dpx", "-o", "d.exr")
        dpx = bytearray((self.folder / "d.dpx").read_bytes())
        dpx[801] = 1  # the transfer of the first image element: printing density (SMPTE 268M, table 5A)
        (self.folder / "film.dpx").write_bytes(dpx)
        self.run_ok("compare", "a.png", "d.dpx", "--metrics", "mse")
        self.assert_refused(["compare", "a.png", "film.dpx", "--metrics", "mse"], ["film.dpx", "densities", "oiiotool"])


if __name__ == "__main__":
    harness.main()
