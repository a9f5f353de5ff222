# SPDX-License-Identifier: Apache-2.0
"""Losses at the ends of a log count like others; pauses between blocks are no losses, and nothing is a fixation then."""

import json

import harness

SCREEN = ["--screen-px", "1920,1080", "--screen-cm", "50.9,28.6", "--screen-distance-cm", "65"]
VIEW = ["--eye", "0,1,4", "--target", "0,0,0", "--size", "64x36"]


def log(usable, samples=1000, step_ms=10):
    """`usable` says of a sample's index whether the eye was seen."""
    rows = (f"{i * step_ms * 1_000_000},{0.5 + 0.0001 * (i % 7):.4f},0.5,{'ok' if usable(i) else 'lost'},cyclopean" for i in range(samples))
    return harness.gaze_csv(rows)


def blocks(starts, length_ms=2000, lost_ms=0):
    lines = ["** CONVERTED FROM x.edf using edfapi", "** EYELINK II 1", "MSG\t1 DISPLAY_COORDS 0 0 1919 1079"]
    for start in starts:
        lines += [f"START\t{start} \tLEFT\tSAMPLES\tEVENTS", "SAMPLES\tGAZE\tLEFT\tRATE\t250.00\tTRACKING\tCR"]
        lines += [f"{start + i}\t{'.' if i >= length_ms - lost_ms else 960.0 + i % 16 / 8}\t{'.' if i >= length_ms - lost_ms else 540.0}\t900.0\t..."
                  for i in range(0, length_ms, 4)]
        lines.append(f"END\t{start + length_ms} \tSAMPLES\tEVENTS\tRES\t35.00\t35.00")
    return "\n".join(lines) + "\n"


class Losses(harness.CliTest):
    def inspect(self, name, *arguments):
        return json.loads(self.run_ok("gaze", "inspect", name, *arguments, "--json").stdout)

    def test_losses_at_the_ends_count_and_are_accused(self):
        self.write("end.csv", log(lambda i: i < 630))
        end = self.inspect("end.csv")
        self.assertEqual((end["losses"]["longer"], end["losses"]["longest_ns"]), (1, 3_700_000_000))
        self.assertEqual(end["losses"]["trailing_ns"], 3_700_000_000)
        self.assertIn("lost-end", [finding["code"] for finding in end["findings"] if finding["kind"] == "suspicion"])
        self.assertNotIn("nothing suspicious", end["verdict"])
        text = self.run_ok("gaze", "inspect", "end.csv").stdout
        self.assertIn("no gaze in the last 37 % of the log (3.7 s)", text)
        self.write("begin.csv", log(lambda i: i >= 200))
        begin = self.inspect("begin.csv")
        self.assertEqual((begin["losses"]["longer"], begin["losses"]["leading_ns"]), (1, 2_000_000_000))
        self.assertIn("lost-beginning", [finding["code"] for finding in begin["findings"]])
        # 200 ms at each end are as long as a blink, and nothing to accuse anybody of.
        self.write("short.csv", log(lambda i: 20 <= i < 980))
        short = self.inspect("short.csv")
        self.assertEqual(short["losses"]["blink_like"], 2)
        self.assertIn("nothing suspicious", short["verdict"])

    def test_pauses_between_blocks_are_no_losses(self):
        self.write("blocks.asc", blocks([10_000, 30_000, 60_000]))
        report = self.inspect("blocks.asc")
        self.assertEqual((report["gaps"]["count"], report["losses"]["longer"], report["losses"]["longest_ns"]), (0, 0, 0))
        self.assertEqual(report["pauses"]["count"], 2)
        self.assertEqual(report["losses"], {"blink_like": 0, "blink_like_median_ms": 0, "longer": 0, "longest_ns": 0,
                                            "leading_ns": 0, "trailing_ns": 0})
        # What is lost at the end of each block is.
        self.write("lost.asc", blocks([10_000, 30_000, 60_000], lost_ms=800))
        lost = self.inspect("lost.asc")
        self.assertEqual((lost["losses"]["longer"], lost["losses"]["longest_ns"]), (3, 800_000_000))

    def test_frames_in_a_pause_are_no_fixations(self):
        self.write("blocks.asc", blocks([10_000, 30_000]))
        frames = json.loads(self.run_ok("plan", "--gaze", "blocks.asc", *VIEW, *SCREEN, "--gaze-transfer", "fraction", "--fps", "10", "--json").stdout)["frames"]
        movements = [frame["gaze_true"]["event"] for frame in frames]
        self.assertEqual(movements[:20], ["fixation"] * 20)
        self.assertEqual(set(movements[22:199]), {"lost"})
        self.assertEqual(set(movements[201:219]), {"fixation"})


if __name__ == "__main__":
    harness.main()
