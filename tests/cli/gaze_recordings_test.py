# SPDX-License-Identifier: Apache-2.0
"""Files that hold several recordings, or several blocks of one: they are counted, one of them is chosen, and what
names them stays out of what is written."""

import csv
import json

import harness

SCREEN = ["--screen-px", "1920,1080", "--screen-cm", "50.9,28.6", "--screen-distance-cm", "65"]
VIEW = ["--eye", "0,1,4", "--target", "0,0,0", "--size", "64x36"]
HOURS_20 = 72_000_000_000_000


def cloud(names=("anna-1", "anna-2", "berta-1"), rows=500):
    """Pupil Cloud's export of several recordings: 200 Hz, 20 hours apart; the fixation ids go on within a recording."""
    lines = ["section id,recording id,timestamp [ns],gaze x [px],gaze y [px],worn,fixation id,blink id,azimuth [deg],elevation [deg]"]
    for r, name in enumerate(names):
        begin = 1_700_000_000_000_000_000 + r * HOURS_20
        lines += [f"s{r},{name},{begin + 5_000_000 * i},{600 + 0.5 * (i % 50)},500.0,1.0,{1 + i // 100 if i % 100 < 80 else ''},,"
                  f"{0.1 * (i % 50)},{1.5 + r}" for i in range(rows)]
    return "\n".join(lines) + "\n"


def surface(names=("r1", "r2")):
    lines = ["section id,recording id,timestamp [ns],gaze detected on surface,gaze position on surface x [normalized],"
             "gaze position on surface y [normalized],fixation id,blink id"]
    for r, name in enumerate(names):
        begin = 1_700_000_000_000_000_000 + r * HOURS_20
        lines += [f"s{r},{name},{begin + 5_000_000 * i},true,0.{40 + r},0.5,{1 + i // 100 if i % 100 < 80 else ''},"
                  f"{7 if 85 <= i % 100 < 95 else ''}" for i in range(300)]
    return "\n".join(lines) + "\n"


def pro_lab(people=(("P1", "Rec 1"), ("P1", "Rec 2"), ("P2", "Rec 1"))):
    """Each recording counts from its own zero."""
    lines = ["Recording timestamp [ms]\tSensor\tParticipant name\tRecording name\tRecording resolution width\t"
             "Recording resolution height\tGaze point X [DACS px]\tGaze point Y [DACS px]"]
    for p, (person, recording) in enumerate(people):
        lines += [f"{i * 8}\tEye Tracker\t{person}\t{recording}\t1920\t1080\t{900 + p}\t500" for i in range(200)]
    return "\n".join(lines) + "\n"


def eyelink(starts, length_ms=1000, rate=250):
    """Blocks of one eye, each with the message of its trial in front of it."""
    step = 1000 // rate
    lines = ["** CONVERTED FROM x.edf using edfapi", "** EYELINK II 1", "MSG\t1 DISPLAY_COORDS 0 0 1919 1079"]
    for b, start in enumerate(starts):
        lines += [f"MSG\t{start - 2} TRIALID {b + 1}", f"START\t{start} \tLEFT\tSAMPLES\tEVENTS",
                  f"SAMPLES\tGAZE\tLEFT\tRATE\t{rate}.00\tTRACKING\tCR"]
        lines += [f"{start + i}\t{960 + b:.1f}\t540.0\t900.0\t..." for i in range(0, length_ms, step)]
        lines += [f"EFIX L\t{start}\t{start + length_ms - step}\t{length_ms}\t{960 + b}.0\t540.0\t900",
                  f"END\t{start + length_ms} \tSAMPLES\tEVENTS\tRES\t35.00\t35.00"]
    return "\n".join(lines) + "\n"


class Recordings(harness.CliTest):
    def inspect(self, *arguments):
        return json.loads(self.run_ok("gaze", "inspect", *arguments, "--json").stdout)

    def codes(self, report):
        return [finding["code"] for finding in report["findings"]]

    def converted(self, *arguments):
        self.run_ok("gaze", "import", *arguments, "-o", "out.csv", "--overwrite")
        lines = [line for line in (self.folder / "out.csv").read_text().splitlines() if line[:1] != "#"]
        return list(csv.DictReader(lines))

    def test_several_recordings_are_counted_and_one_is_chosen(self):
        for name, text, count, rows, more in (
                ("cloud.csv", cloud(), 3, 500, ["--frame", "head"]), ("surface.csv", surface(), 2, 300, []),
                ("lab.tsv", pro_lab(), 3, 200, [])):
            self.write(name, text)
            report = self.inspect(name, *more)
            self.assertEqual([r["rows"] for r in report["recordings"]], [rows] * count, name)
            self.assertEqual((report["recording"], report["samples"]), (1, rows))
            self.assertIn("several-recordings", self.codes(report))
            self.assertEqual((report["gaps"]["count"], report["order"]["backward_steps"]), (0, 0), name)
            self.assertIn(f"the file holds {count} recordings", self.run_ok("gaze", "inspect", name, *more).stdout)
            self.assert_refused(["gaze", "import", name, "-o", "no.csv", *more], [f"{count} recordings", "--gaze-recording"])
            self.assertEqual(len(self.converted(name, *more, "--gaze-recording", str(count))), rows)
            chosen = self.inspect(name, *more, "--gaze-recording", str(count))
            self.assertEqual((chosen["recording"], chosen["samples"]), (count, rows))
            self.assertNotIn("several-recordings", self.codes(chosen))

    def test_a_name_chooses_as_well_and_stays_out_of_what_is_written(self):
        self.write("lab.tsv", pro_lab())
        report = self.run_ok("gaze", "inspect", "lab.tsv").stdout
        self.assertNotIn("P2", report + self.run_ok("gaze", "inspect", "lab.tsv", "--json").stdout)
        kept = self.inspect("lab.tsv", "--keep-ids")
        self.assertEqual([r["name"] for r in kept["recordings"]], ["P1/Rec 1", "P1/Rec 2", "P2/Rec 1"])
        self.assertEqual(float(self.converted("lab.tsv", "--gaze-recording", "P2/Rec 1")[0]["u[1]"]), 902 / 1920)
        self.assert_refused(["gaze", "import", "lab.tsv", "-o", "no.csv", "--gaze-recording", "P3"], ["no recording 'P3'", "1 (200 rows"])
        self.assert_refused(["gaze", "import", "lab.tsv", "-o", "no.csv", "--gaze-recording", "4"], ["no recording '4'"])
        for command in (["gaze", "import", "lab.tsv", "-o", "no.csv"], ["gaze", "events", "lab.tsv"],
                        ["plan", "--gaze", "lab.tsv", *VIEW, *SCREEN]):
            self.assertNotIn("P2", self.run_program(*command).stderr)

    def test_every_command_takes_the_choice(self):
        self.write("lab.tsv", pro_lab())
        events = self.run_ok("gaze", "events", "lab.tsv", "--gaze-recording", "2", *SCREEN).stdout
        self.assertEqual([row["movement"] for row in csv.DictReader(events.splitlines(), delimiter="\t")], ["fixation"])
        plan = json.loads(self.run_ok("plan", "--gaze", "lab.tsv", "--gaze-recording", "2", *VIEW, *SCREEN, "--fps", "50", "--json").stdout)
        self.assertEqual(len(plan["frames"]), 80)
        self.assertEqual(plan["frames"][0]["gaze_true"]["u"], 901 / 1920)

    def test_a_table_of_ones_own_names_the_column(self):
        rows = "".join(f"{who},{4 * i},{x},0.5\n" for who, x in (("a", 0.25), ("b", 0.75)) for i in range(100))
        for header, option in (("participant", []), ("who", ["--recording-column", "who"])):
            self.write("own.csv", f"{header},time[ms],u,v\n" + rows)
            self.assertEqual(len(self.inspect("own.csv", *option)["recordings"]), 2)
            table = self.converted("own.csv", *option, "--gaze-recording", "b")
            self.assertEqual((len(table), table[0]["u[1]"]), (100, "0.75"))

    def test_the_fixation_ids_of_an_export_are_events(self):
        self.write("surface.csv", surface())
        report = self.inspect("surface.csv", "--gaze-recording", "2")
        self.assertEqual((report["events"]["fixation"], report["events"]["blink"]), (3, 3))
        self.write("cloud.csv", cloud())
        self.assertEqual(self.inspect("cloud.csv", "--gaze-recording", "2")["events"]["fixation"], 5)

    def test_blocks_of_one_clock_are_read_together_or_one_by_one(self):
        self.write("blocks.asc", eyelink([10_000, 20_000, 30_000, 40_000]))
        report = self.inspect("blocks.asc")
        self.assertEqual([(r["kind"], r["rows"]) for r in report["recordings"]], [("block", 250)] * 4)
        self.assertEqual((report["recording"], report["samples"]), (None, 1000))
        self.assertEqual(len(self.converted("blocks.asc")), 1000)
        third = self.converted("blocks.asc", "--gaze-recording", "3", "--keep-ids")
        self.assertEqual((len(third), third[0]["t[ns]"], float(third[0]["u[1]"])), (250, "30000000000", 962 / 1920))
        text = (self.folder / "out.csv").read_text()
        self.assertEqual([n for n in range(1, 5) if f"TRIALID {n}" in text], [3])
        self.assertEqual(text.count("# event fixation"), 1)

    def test_sessions_of_a_tracker_that_was_started_anew_are_recordings(self):
        self.write("sessions.asc", eyelink([10_000, 20_000, 5_000, 15_000]))
        report = self.inspect("sessions.asc")
        self.assertEqual([(r["kind"], r["rows"]) for r in report["recordings"]], [("recording", 500)] * 2)
        self.assert_refused(["gaze", "import", "sessions.asc", "-o", "no.csv"], ["2 recordings", "--gaze-recording"])
        self.assertEqual(self.converted("sessions.asc", "--gaze-recording", "2")[0]["t[ns]"], "5000000000")

    def test_three_recordings_of_four_blocks_are_planned_trial_by_trial(self):
        self.write("sessions.asc", eyelink([10_000, 20_000, 5_000, 3_000]))
        plan = ["plan", "--gaze", "sessions.asc", *VIEW, *SCREEN, "--fps", "24", "--gaze-transfer", "fraction"]
        lengths = []
        for recording, blocks in (("1", 2), ("2", 1), ("3", 1)):
            one = ["--gaze-recording", recording]
            listed = json.loads(self.run_ok("gaze", "trials", "sessions.asc", *one, "--fps", "24", "--json").stdout)
            self.assertEqual(len(listed["trials"]), blocks)
            planned = [json.loads(self.run_ok(*plan, *one, "--trial", str(trial), "--json").stdout)["frames"]
                       for trial in range(1, blocks + 1)]
            self.assertEqual(listed["frames"], sum(len(frames) for frames in planned))
            lengths += [len(frames) for frames in planned]
        self.assertEqual(lengths, [24] * 4)  # a second each

    def test_a_plan_of_hours_without_gaze_is_refused(self):
        self.write("hours.asc", eyelink([10_000, 14_410_000]))
        plan = ["plan", "--gaze", "hours.asc", *VIEW, *SCREEN, "--fps", "60", "--gaze-transfer", "fraction"]
        self.assert_refused(plan, ["more than 3600 frames in a row", "--gaze-recording", "--gaze-max-missing-frames 0"])
        one = json.loads(self.run_ok(*plan, "--gaze-recording", "2", "--json").stdout)
        self.assertEqual(len(one["frames"]), 60)
        self.assert_refused([*plan, "--gaze-max-missing-frames", "10"], ["more than 10 frames"])
        few = self.run_ok(*plan, "--frames", "1-200x5", "--gaze-max-missing-frames", "0", "--json").stdout
        self.assertEqual(len(json.loads(few)["frames"]), 40)


if __name__ == "__main__":
    harness.main()
