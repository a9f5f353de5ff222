# SPDX-License-Identifier: Apache-2.0
"""Gaze is biometric: what tells whose a log is does not get into pictures, records, plans and reports by itself."""

import harness

FIRST_NS = 1698682600011534600  # 30 October 2023
STAMP = "16986826"
NAMES = ("Ada Lovelace", "TG02B-080105", "2023/10/30", "13:34:49")

LOG = "# gazetrace-gaze 1\n# wearer Ada Lovelace\n# serial TG02B-080105\n# clock host, 2023/10/30 13:34:49.156\nt[ns],dx,dy,dz\n" + "".join(
    f"{FIRST_NS + i * 10_000_000},{0.001 * i},0,-1\n" for i in range(60))
# The name of Gazepoint's time column holds the date.
GAZEPOINT = "MEDIA_ID,MEDIA_NAME,CNT,TIME(2023/10/30 13:34:49.156),TIMETICK(f=10000000),FPOGX,FPOGY,FPOGS,FPOGD,FPOGID,FPOGV,BPOGX,BPOGY,BPOGV,USER,\n" + "".join(
    f"0,Ada Lovelace,{i},{0.016 * i:.3f},{160000 * i},0.5,0.5,0,0.1,1,1,{0.5 + 0.001 * (i % 7)},{0.5 - 0.001 * (i % 5)},1,TG02B-080105,\n" for i in range(60))


class Privacy(harness.CliTest):
    def everything_said(self, *more):
        """Text of all that is printed and written about the log."""
        self.write("log.csv", LOG)
        self.write("gazepoint.csv", GAZEPOINT)
        said = {}
        for log in ("log.csv", "gazepoint.csv"):
            for form in ([], ["--json"]):
                said[f"inspect {log} {form}"] = self.run_ok("gaze", "inspect", log, *form, *more).stdout
            self.run_ok("gaze", "inspect", log, "--svg", "log.svg", "--overwrite", *more)
            said[f"svg {log}"] = (self.folder / "log.svg").read_text()
        gaze = ["--gaze", "log.csv", "--size", "32x18", "--frames", "1-2"]
        said["plan"] = self.run_ok("plan", "box.gltf", *gaze, *more).stdout
        said["plan --json"] = self.run_ok("plan", "box.gltf", *gaze, "--json", *more).stdout
        self.run_ok("render", "box.gltf", *gaze, "--env", "constant:1,1,1", "-o", "out/f.####.exr", "--spp", "1", "--overwrite", *more)
        for name in self.files("out"):
            said[name] = (self.folder / "out" / name).read_bytes().decode("latin-1")
        self.assertTrue({"f.0001.exr", "run.json", "timing.csv"} <= set(said))
        return said

    def test_nothing_identifies_the_wearer(self):
        for place, text in self.everything_said().items():
            for word in (STAMP, *NAMES):
                self.assertNotIn(word, text, place)

    def test_times_of_day_are_kept_when_asked_for(self):
        said = self.everything_said("--keep-ids")
        for place in ("inspect log.csv []", "plan --json", "f.0001.exr"):
            self.assertIn(STAMP, said[place], place)
        self.assertIn("2023/10/30", said["inspect log.csv []"])

    def test_frames_get_the_same_gaze_either_way(self):
        self.write("log.csv", LOG)
        arguments = ["plan", "box.gltf", "--gaze", "log.csv", "--size", "32x18", "--frames", "1-3", "--gaze-start", f"{FIRST_NS + 100_000_000}ns"]
        hidden = self.run_ok(*arguments).stdout
        kept = self.run_ok(*arguments, "--keep-ids").stdout
        self.assertEqual(hidden, kept)


if __name__ == "__main__":
    harness.main()
