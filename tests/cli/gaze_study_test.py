# SPDX-License-Identifier: Apache-2.0
"""Trials, objects and areas of interest from outside."""

import csv
import io
import json
import math

import harness


def blocks(count, seconds=2, rate=250, pause=3):
    """An EyeLink recording of several blocks; in each, IMAGE_ON after half a second and IMAGE_OFF half a second later."""
    lines = ["** CONVERTED FROM x.edf", "MSG\t1000 DISPLAY_COORDS 0 0 1023 767"]
    for block in range(count):
        begin = 1000 + block * (seconds + pause) * 1000
        lines += [f"MSG\t{begin} TRIALID {block + 1}", f"START\t{begin} \tLEFT\tSAMPLES\tEVENTS",
                  f"SAMPLES\tGAZE\tLEFT\tRATE\t{rate}.00\tTRACKING\tCR"]
        for i in range(seconds * rate):
            t = begin + i * 1000 // rate
            if i == rate // 2:
                lines.append(f"MSG\t{t} IMAGE_ON")
            if i == rate:
                lines.append(f"MSG\t{t} IMAGE_OFF")
            lines.append(f"{t}\t {200 + 300 * (i % 125 > 62) + i % 3:.1f}\t  {300 + 50 * block:.1f}\t  900.0\t...")
        lines.append(f"END\t{begin + seconds * 1000 - 1} \tSAMPLES\tEVENTS\tRES\t  35.00\t  35.00")
    return "\n".join(lines) + "\n"


def table(text):
    return list(csv.DictReader(io.StringIO(text), delimiter="\t"))


class Study(harness.CliTest):
    VIEW = ["--eye", "0,1,4", "--target", "0,0,0", "--size", "64x48"]

    def frames_of_plan(self, *arguments):
        text = self.run_ok("plan", "--gaze", "blocks.asc", "--json", *self.VIEW, *arguments).stdout
        return json.loads(text)["frames"]

    def test_trials_of_blocks_and_their_frames(self):
        self.write("blocks.asc", blocks(4))
        report = json.loads(self.run_ok("gaze", "trials", "blocks.asc", "--fps", "24", "--json").stdout)
        self.assertEqual([t["block"] for t in report["trials"]], [1, 2, 3, 4])
        self.assertNotIn("name", report["trials"][0])
        planned = [self.frames_of_plan("--fps", "24", "--trial", str(n)) for n in (1, 2, 3, 4)]
        self.assertEqual([len(p) for p in planned], [t["frames"] for t in report["trials"]])
        self.assertEqual(sum(len(p) for p in planned), report["frames"])
        # The whole recording holds the pauses too.
        self.assertGreater(len(self.frames_of_plan("--fps", "24")), 2 * report["frames"])

    def test_messages_split_and_align(self):
        self.write("blocks.asc", blocks(3))
        options = ["--trial-start", "TRIALID *", "--trial-end", "IMAGE_OFF"]
        self.run_ok("gaze", "import", "blocks.asc", *options, "--keep-ids", "-o", "named.csv")
        report = json.loads(self.run_ok("gaze", "trials", "named.csv", "--keep-ids", "--json").stdout)
        self.assertEqual([t["name"] for t in report["trials"]], ["TRIALID 1", "TRIALID 2", "TRIALID 3"])
        events = table(self.run_ok("gaze", "events", "named.csv", "--trial", "TRIALID 2").stdout)
        self.assertGreaterEqual(min(int(e["onset_ns"]) for e in events), 6_000_000_000)
        self.assertLessEqual(max(int(e["offset_ns"]) for e in events), 7_000_000_000)
        frame = self.frames_of_plan("--fps", "10", "--frames", "1", "--trial", "2", "--gaze-anchor", "IMAGE_ON=0s")[0]
        other = self.frames_of_plan("--fps", "10", "--frames", "6", "--trial", "2")[0]
        self.assertEqual(frame["gaze_true"]["row_before"], other["gaze_true"]["row_before"])
        inspected = self.run_ok("gaze", "inspect", "blocks.asc", "--trial", "2", "--json").stdout
        self.assertEqual(json.loads(inspected)["samples"], 500)
        self.assert_refused(["gaze", "events", "blocks.asc", "--trial", "4"], ["there is no trial 4", "1 to 3"])
        # Who was recorded may stand in a message: without names the trials stay, and their numbers.
        self.run_ok("gaze", "import", "blocks.asc", *options, "-o", "numbered.csv")
        self.assertNotIn("TRIALID", (self.folder / "numbered.csv").read_text())
        numbered = json.loads(self.run_ok("gaze", "trials", "numbered.csv", "--json").stdout)
        self.assertEqual([t["begin_ns"] for t in numbered["trials"]], [t["begin_ns"] for t in report["trials"]])
        self.assert_refused(["gaze", "import", "blocks.asc", "-o", "no.csv", "--trial-start", "NO SUCH"],
                            ["has no trial by messages", "3 blocks"])
        self.assert_refused(["gaze", "import", "blocks.asc", "-o", "no.csv", "--trial-nth", "2"], ["--trial-nth"])

    def test_a_table_of_ages_is_refused(self):
        self.write("blocks.asc", blocks(1))
        for rows in ("-9000000000000000000\t9000000000000000000\n", "-5000000000000000000\t2000000000\n", "0\t5000000000000000000\n"):
            self.write("ages.tsv", "onset_ns\toffset_ns\n" + rows)
            self.assert_refused(["gaze", "import", "blocks.asc", "-o", "no.csv", "--trial-table", "ages.tsv"], ["ages.tsv:2: the trial lasts more than a hundred years"])

    def test_all_trials_of_a_recording_are_one_sweep(self):
        """By a grid over `trial`, or by a [[gaze]] for each; each row has the frames of its trial."""
        self.write("blocks.asc", blocks(2))
        self.write("trials.tsv", "onset\tduration\n1\t0.95\n6\t1.95\n")
        self.run_ok("gaze", "import", "blocks.asc", "--trial-table", "trials.tsv", "-o", "gaze.csv")
        self.write("box.gltf", json.dumps(harness.box_gltf()))
        plan = ('[common]\nsize = "64x36"\nscreen-px = [64, 36]\nscreen-cm = [64, 36]\nscreen-distance-cm = 60\nfps = 4\n'
                'gaze-transfer = "fraction"\n[[scene]]\nname = "box"\npath = "box.gltf"\n{}\n[reference]\nspp = 4\n'
                '[measure]\nrepeats = 2\ncontrols = false\nefficiency-spp = 0\nreference-rate = 8\nbaselines = ["none"]\nmetrics = ["mse"]\n')
        rates = 'region-samples = [[2, 2, 2]]\nregion-blocks = [[1, 1]]\n'
        each = '[[gaze]]\nname = "{0}"\nlog = "gaze.csv"\ntrial = "{1}"\n'
        for text in ('[[gaze]]\nname = "log"\nlog = "gaze.csv"\n[grid]\ntrial = ["1", "2"]\n' + rates,
                     each.format("first", 1) + each.format("second", 2) + "[grid]\n" + rates):
            self.write("plan.toml", plan.format(text))
            rows = [line.split() for line in self.run_ok("sweep", "plan.toml", "--dry-run").stdout.splitlines() if " test " in line]
            self.assertEqual([int(row[2]) for row in rows], [2 * 64 * 36 * count for count in (4, 8)])

    def test_objects_and_areas_of_a_scene(self):
        self.write("box.gltf", json.dumps(harness.box_gltf()))
        self.write("log.csv", harness.gaze_csv(f"{i * 10_000_000},0.5,0.6,ok,cyclopean" for i in range(50)))
        common = ["box.gltf", "--gaze", "log.csv", "--size", "64x36", "--fps", "10", "--frames", "1-4", "--gaze-accuracy", "0.5"]
        rows = table(self.run_ok("gaze", "objects", *common).stdout)
        self.assertEqual(len(rows), 4)
        self.assertEqual({(r["stimulus"], r["gaze"]) for r in rows}, {("replayed", "measured")})
        self.assertEqual({r["node"] for r in rows}, {"#0"})  # the box in the middle, whose node has no name
        self.assertAlmostEqual(float(rows[0]["share"]), 1, places=3)
        # A tenth of the frame's height below the middle, from (0, 0.5, 4): the box's front at z = 0.5.
        down = 0.2 * math.tan(0.4)
        self.assertAlmostEqual(float(rows[0]["distance_m"]), 3.5 * math.hypot(1, down), places=2)
        self.assertAlmostEqual(float(rows[0]["y_m"]), 0.5 - 3.5 * down, places=2)
        # One sample beside the box, in the middle of the first frame: processing takes it out.
        self.write("jumps.csv", harness.gaze_csv(f"{i * 10_000_000},0.5,{0.05 if i == 5 else 0.6},ok,cyclopean" for i in range(50)))
        jumps = [*common[:2], "jumps.csv", *common[3:]]
        of_frame_1 = lambda *more: table(self.run_ok("gaze", "objects", *jumps, *more).stdout)[0]
        self.assertNotEqual(of_frame_1()["node"], "#0")
        self.assertEqual(of_frame_1("--gaze-process", "median:samples=5")["node"], "#0")
        self.run_ok("gaze", "objects", *common, "--recorded-here", "--table", "objects.json")
        report = json.loads((self.folder / "objects.json").read_text())
        self.assertEqual(report["stimulus"], "recorded")
        self.assertEqual(report["accuracy_deg"], 0.5)
        self.assert_refused(["gaze", "objects", *common[:-2]], ["--gaze-accuracy"])
        self.write("areas.toml", '[[aoi]]\nname = "box"\nnode = "#0"\n[[aoi]]\nname = "corner"\nrectangle = [0, 0, 0.1, 0.1]\n')
        areas = table(self.run_ok("gaze", "aois", *common, "--aois", "areas.toml", "--tables", "tables").stdout)
        self.assertEqual([a["aoi"] for a in areas], ["box", "corner", "(none)"])
        self.assertEqual([a["fixations"] for a in areas], ["1", "0", "0"])
        self.assertEqual(table((self.folder / "tables/fixations.tsv").read_text())[0]["aoi"], "box")

    def test_outlines_of_the_shipped_walk(self):
        """Filled again no pixel has two, each object has as many as are stated, and the one at the gaze is that of `gaze objects`: in frames
        one after the other, and in the middle of each fixation."""
        yard = str(harness.SOURCE / "scenes/courtyard/courtyard.gltf")
        common = [yard, "--camera", "walk", "--gaze", str(harness.SOURCE / "gazelogs/tx300_left.csv"), "--screen", "paper", "--gaze-transfer", "fraction", "--size", "96x54"]
        steady = ["--gaze-process", "median:samples=5"]
        for timing, least in ((["--fps", "5", "--frames", "1-20"], 10), (["--fps", "10", "--frames", "fixations", *steady], 6)):
            self.run_ok("gaze", "aois", *common, *timing, "--outlines", "o.json", "--overwrite")
            outlines = json.loads((self.folder / "o.json").read_text())
            self.assertEqual((outlines["format"], outlines["size_px"]), ("gazetrace-outlines-1", [96, 54]))
            self.assertEqual(len({one["name"] for one in outlines["objects"]}), len(outlines["objects"]))
            drawn = [self.filled_again(frame, outlines["objects"]) for frame in outlines["frames"]]
            places = json.loads(self.run_ok("plan", *common, *timing, "--json").stdout)["frames"]
            found = json.loads(self.run_ok("gaze", "objects", *common, *timing, "--gaze-accuracy", "0", "--gaze-precision", "0", "--json").stdout)["frames"]
            compared = 0
            for pixels, place, objects in zip(drawn, places, found, strict=True):
                if objects["objects"]:
                    at = place["gaze_render"] if steady[0] in timing else place["gaze_true"]
                    x, y = int(96 * at["u"]), int(54 * at["v"])
                    around = {(pixels.get((x + i, y + j)) or {"node": None})["node"] for i in (-1, 0, 1) for j in (-1, 0, 1)}
                    self.assertIn(objects["objects"][0]["node"], around)
                    compared += len(around) == 1  # no border beside it: there is no choice
            self.assertGreater(compared, least)
        self.assert_refused(["gaze", "aois", *common, *timing], ["--aois", "--outlines"])
        self.assert_refused(["gaze", "aois", *common, *timing, "--outlines", "o.json"], ["o.json", "--overwrite"])

    def filled_again(self, frame, objects):
        pixels = {}
        for seen in frame["objects"]:
            count = 0
            for rings in seen["polygons"]:
                for y in range(54):
                    # A line through the middles of pixels crosses the rings' upright sides.
                    sides = sorted(a[0] for ring in rings for a, b in zip(ring, ring[1:] + ring[:1]) if a[0] == b[0] and min(a[1], b[1]) <= y < max(a[1], b[1]))
                    for left, right in zip(sides[::2], sides[1::2]):
                        for x in range(left, right):
                            self.assertNotIn((x, y), pixels)
                            pixels[x, y] = objects[seen["object"]]
                            count += 1
            self.assertEqual(count, seen["pixels"])
        return pixels

    def test_a_heat_map_on_the_scene(self):
        self.write("box.gltf", json.dumps(harness.box_gltf()))
        self.write("log.csv", harness.gaze_csv(f"{i * 10_000_000},0.5,0.6,ok,cyclopean" for i in range(50)))
        common = ["gaze", "objects", "box.gltf", "--gaze", "log.csv", "--size", "64x36", "--fps", "10", "--frames", "1-4", "--gaze-accuracy", "0.01",
                  "--gaze-precision", "0.01", "--table", "t.tsv", "--overwrite"]
        values = lambda name: [[float(cell) for cell in line.split(",")] for line in (self.folder / name).read_text().splitlines()]
        said = self.run_ok(*common, "--heat-map", "heat.csv", "--heat-sigma", "1").stderr
        self.assertIn("0.4 s of gaze in the scene; as frame 3 sees it", said)
        heat = values("heat.csv")
        self.assertEqual((len(heat), len(heat[0])), (270, 480))
        # All of it on one place of the box's front, which is seen from 3.5 m in front and below: in the middle, a tenth of the
        # height below it.
        sd = 3.5 * math.hypot(1, 0.2 * math.tan(0.4)) * math.tan(math.radians(1))
        highest = max(max(row) for row in heat)
        self.assertAlmostEqual(highest / (0.4 / (2 * math.pi * sd * sd)), 1, delta=0.05)
        place = next((x, y) for y, row in enumerate(heat) for x, value in enumerate(row) if value == highest)
        self.assertAlmostEqual(place[0] + 0.5, 240, delta=3)
        self.assertAlmostEqual(place[1] + 0.5, 162, delta=3)
        # The picture is bright there, and else as the picture behind it, darkened.
        self.write("behind.png", harness.png(64, 36, lambda x, y: (200, 100, 40)))
        self.run_ok(*common, "--heat-map", "heat.png", "--heat-sigma", "1", "--heat-picture", "behind.png")
        size, pixels = harness.read_png(self.folder / "heat.png")
        self.assertEqual(size, (480, 270))
        self.assertEqual(pixels[0][0], (130, 65, 26))
        self.assertGreater(min(pixels[place[1]][place[0]][:2]), 180)
        # What is hidden from a frame is not on it: the box's front, once the camera has gone behind the box. Gaze is straight
        # ahead, and in the sky when it gets there.
        self.write("path.csv", "t[s],x[m],y[m],z[m],qx,qy,qz,qw\n0,0,0.5,4,0,0,0,1\n0.27,0,0.5,4,0,0,0,1\n0.3,0,0.5,-4,0,1,0,0\n1,0,0.5,-4,0,1,0,0\n")
        self.write("up.csv", harness.gaze_csv(f"{i * 10_000_000},0.5,{0.5 if i < 30 else 0.02},ok,cyclopean" for i in range(50)))
        around = ["up.csv" if word == "log.csv" else word for word in common]
        for frame, sees in (("1", True), ("4", False)):
            self.run_ok(*around, "--camera-path", "path.csv", "--heat-map", "around.csv", "--heat-frame", frame)
            self.assertEqual(max(max(row) for row in values("around.csv")) > 0, sees, frame)
        self.assert_refused([*common, "--heat-map", "x.png", "--heat-frame", "9"], ["--heat-frame", "9"])
        self.assert_refused([*common, "--heat-map", "x.png", "--heat-sigma", "0"], ["--heat-sigma"])
        self.assert_refused([*common, "--heat-map", "x.svg"], ["--heat-map", ".png or .csv"])


if __name__ == "__main__":
    harness.main()
