# SPDX-License-Identifier: Apache-2.0
"""Gaze is biometric: what tells whose a log is does not get into pictures, records, plans and reports by itself."""

import gzip

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
            said[f"measure {log}"] = self.run_ok("gaze", "measure", log, "--json", "--tables", "t", "--overwrite", *harness.SCREEN, *more).stdout
            for name in self.files("t"):
                said[f"{name} {log}"] = (self.folder / "t" / name).read_text()
        gaze = ["--gaze", "log.csv", "--size", "32x18", "--frames", "1-2"]
        said["plan"] = self.run_ok("plan", "box.gltf", *gaze, *more).stdout
        said["plan --json"] = self.run_ok("plan", "box.gltf", *gaze, "--json", *more).stdout
        self.run_ok("render", "box.gltf", *gaze, "--env", "constant:1,1,1", "-o", "out/f.####.exr", "--spp", "1", "--overwrite", *more)
        for name in self.files("out"):
            said[name] = (self.folder / "out" / name).read_bytes().decode("latin-1")
        self.assertTrue({"f.0001.exr", "f.run.json", "f.timing.csv"} <= set(said))
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

    def converted(self, *more):
        """Text of all files that converting an EyeLink log with a talkative experiment writes."""
        self.write("talk.asc", "MSG\t1000 participant Ada Lovelace 2023/10/30 13:34:49 serial TG02B-080105\n" +
                   "MSG\t1000 DISPLAY_COORDS 0 0 1023 767\nSTART\t1000 \tLEFT\tSAMPLES\tEVENTS\nSAMPLES\tGAZE\tLEFT\tRATE\t250.00\n" +
                   "".join(f"{1000 + 4 * i}\t  200.0\t  300.0\t  900.0\t...\n" for i in range(60)) +
                   "MSG\t1100 Ada Lovelace answers\nEND\t1240 \tSAMPLES\tEVENTS\tRES\t  35.00\t  35.00\n")
        for output in ("talk.csv", "sub-01_physio.tsv.gz"):
            warnings = self.run_ok("gaze", "import", "talk.asc", "-o", output, "--overwrite", *more).stderr
        self.write("log.csv", LOG)
        self.run_ok("gaze", "import", "log.csv", "-o", "clock.csv", "--overwrite", *more)
        names = ["talk.csv", "clock.csv", *(name for name in self.files() if name.startswith("sub-01"))]
        self.assertGreater(len(names), 4)
        data = [(self.folder / name).read_bytes() for name in names]
        return warnings, "\n".join((gzip.decompress(d) if d[:2] == b"\x1f\x8b" else d).decode() for d in data)

    def test_converted_logs_name_nobody(self):
        warnings, text = self.converted()
        for word in NAMES:
            self.assertNotIn(word, text)
        self.assertIn("--keep-ids", warnings)
        self.assertIn("messages are left out", warnings)

    def test_converted_logs_keep_messages_when_asked_to(self):
        warnings, text = self.converted("--keep-ids")
        for word in (*NAMES, "answers"):
            self.assertIn(word, text)
        self.assertNotIn("left out", warnings)

    def test_events_tell_no_time_of_day(self):
        own = f"# event fixation cyclopean {FIRST_NS + 20_000_000} {FIRST_NS + 300_000_000}\n"
        self.write("log.csv", LOG.replace("t[ns]", own + "t[ns]"))
        for method in ([], ["--method", "log"]):
            hidden, kept = ([line.split("\t") for line in self.run_ok("gaze", "events", "log.csv", *method, *more).stdout.splitlines()[1:]]
                            for more in ([], ["--keep-ids"]))
            self.assertTrue(kept)
            self.assertEqual([(row[0], int(row[1]) + FIRST_NS, int(row[2]) + FIRST_NS, *row[3:]) for row in hidden],
                             [(row[0], int(row[1]), int(row[2]), *row[3:]) for row in kept])
        self.run_ok("gaze", "events", "log.csv", "-o", "events.json")
        self.assertNotIn(STAMP, (self.folder / "events.json").read_text())

    def test_frames_get_the_same_gaze_either_way(self):
        self.write("log.csv", LOG)
        arguments = ["plan", "box.gltf", "--gaze", "log.csv", "--size", "32x18", "--frames", "1-3", "--gaze-start", f"{FIRST_NS + 100_000_000}ns"]
        hidden = self.run_ok(*arguments).stdout
        kept = self.run_ok(*arguments, "--keep-ids").stdout
        self.assertEqual(hidden, kept)


if __name__ == "__main__":
    harness.main()
