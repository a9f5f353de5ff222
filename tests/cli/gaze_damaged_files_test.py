# SPDX-License-Identifier: Apache-2.0
"""Files that are damaged or of an unusual encoding are read where that is possible, and otherwise said to be so."""

import json
import resource
import subprocess

import harness

TABLE = "time[ms],u,v\n" + "".join(f"{4 * i},{0.4 + 0.001 * (i % 50):.3f},0.5\n" for i in range(600))


class DamagedFiles(harness.CliTest):
    def inspect(self, name, *arguments):
        return json.loads(self.run_ok("gaze", "inspect", name, *arguments, "--json").stdout)

    def accused(self, name, *arguments):
        return [f["code"] for f in self.inspect(name, *arguments)["findings"] if f["kind"] != "note"]

    def convert(self, name, *arguments):
        result = self.run_ok("gaze", "import", name, "-o", "out.csv", "--overwrite", *arguments)
        return [line for line in (self.folder / "out.csv").read_text().splitlines() if line[:1] != "#"], result.stderr

    def test_stamps_over_the_whole_range_are_refused(self):
        self.write("ages.csv", "t[ns],u[1],v[1]\n-9223372036854775808,0.5,0.5\n0,0.5,0.5\n9223372036854775807,0.5,0.5\n")
        self.assert_refused(["gaze", "inspect", "ages.csv"], ["more than a hundred years", "--time-unit"])
        self.assert_refused(["gaze", "import", "ages.csv", "-o", "no.csv"], ["more than a hundred years"])

    def test_a_file_cut_in_the_middle_of_a_row_is_said_to_be(self):
        self.write("cut.csv", TABLE[:-3])  # 0. where 0.5 was
        rows, warnings = self.convert("cut.csv")
        self.assertEqual(len(rows), 601)
        self.assertIn("cut.csv:601: the last row has no line end", warnings)
        self.assertIn("damaged", self.accused("cut.csv"))
        self.write("whole.csv", TABLE)
        self.assertEqual(self.accused("whole.csv"), [])

    def test_bytes_of_value_zero_are_said(self):
        lines = TABLE.splitlines(keepends=True)
        # As after a crash: a stretch of zeros where a comment or an unused cell was.
        self.write("zeros.csv", "".join(lines[:300]) + "#" + "\0" * 4096 + "\n" + "".join(lines[300:]))
        _, warnings = self.convert("zeros.csv")
        self.assertIn("zeros.csv:301: 4096 bytes of value zero", warnings)
        self.assertIn("damaged", self.accused("zeros.csv"))

    def test_files_without_their_end_are_no_whole_ones(self):
        """Where the format itself tells that an end is missing, the doctor says so, too."""
        head = "** CONVERTED FROM x.edf\nMSG\t1 DISPLAY_COORDS 0 0 1919 1079\nSTART\t5000 \tLEFT\tSAMPLES\tEVENTS\n"
        samples = "".join(f"{5000 + 4 * i}\t{960 + i % 7}.0\t540.0\t900.0\t...\n" for i in range(300))
        glasses = "".join('{"type":"gaze","timestamp":%.2f,"data":{"gaze2d":[0.5,0.%d],"eyeleft":{"gazeorigin":[30,0,0],"gazedirection":'
                          '[0,0,1],"pupildiameter":3},"eyeright":{}}}\n' % (i / 50, 40 + i % 9) for i in range(300))
        for name, text, words in (("block.asc", head + samples, "no END"), ("gazedata", glasses[:-40], "the last line is cut off")):
            self.write(name, text)
            report = self.inspect(name)
            self.assertIn(words, " ".join(f["what"] for f in report["findings"] if f["code"] == "damaged"), name)
            self.assertNotIn("nothing suspicious", report["verdict"])
        self.write("block.asc", head + samples + "END\t6200 \tSAMPLES\tEVENTS\tRES\t35.00\t35.00\n")
        self.assertEqual(self.accused("block.asc"), [])
        # A disk that was full in the middle of an EyeLink's row.
        self.write("zeros.asc", head + samples[:4000] + "\0" * 300 + samples[4300:])
        line = 4 + samples[:4000].count("\n")
        self.assert_refused(["gaze", "inspect", "zeros.asc"], [f"zeros.asc:{line}: bytes of value zero", "copy the file again"])

    def test_zeros_in_a_row_are_not_called_a_number(self):
        lines = TABLE.splitlines(keepends=True)
        for name, content in (("middle.csv", "".join(lines[:300]) + lines[300][:5] + "\0" * 40 + "".join(lines[301:])),
                              ("end.csv", TABLE + "\0" * 4000)):
            self.write(name, content)
            line = 301 if name == "middle.csv" else 1 + len(lines)
            self.assert_refused(["gaze", "inspect", name], [f"{name}:{line}: bytes of value zero", "copy the file again"])

    def test_a_log_of_one_row_is_no_good_log(self):
        self.write("one.csv", "t[ns],u[1],v[1]\n5,0.5,0.5\n")
        self.assertIn("one-row", self.accused("one.csv"))
        text = self.run_ok("gaze", "inspect", "one.csv").stdout
        self.assertNotIn("0.00 Hz", text)
        self.assertNotIn("nothing suspicious", text)

    def test_utf16_without_a_mark_and_lines_that_end_in_cr(self):
        self.write("plain.csv", TABLE)
        rows, _ = self.convert("plain.csv")
        for name, content in (("le.csv", TABLE.encode("utf-16-le")), ("be.csv", TABLE.encode("utf-16-be")),
                              ("cr.csv", TABLE.replace("\n", "\r").encode()),
                              ("cr16.csv", TABLE.replace("\n", "\r").encode("utf-16"))):
            self.write(name, content)
            self.assertEqual(self.convert(name)[0], rows, name)

    def test_thousands_separators_are_no_decimal_commas(self):
        def rows(separator, number, count=600):
            return "".join(separator.join((number(4 * i), number(900 + i % 200), "540")) + "\n" for i in range(count))

        def grouped(value):
            return f"{value:,}"

        more = ["--time-unit", "ms", "--screen-px", "1920,1080"]
        self.write("tabs.tsv", "time\tx\ty\n" + rows("\t", grouped))
        self.assert_refused(["gaze", "import", "tabs.tsv", "-o", "no.csv", *more], ["thousands separators", "column 'time'", "'1,000'"])
        self.write("quotes.csv", "time,x,y\n" + rows(",", lambda v: f'"{v:,}"'))
        self.assert_refused(["gaze", "import", "quotes.csv", "-o", "no.csv", *more], ["thousands separators"])
        self.write("bare.csv", "time,x,y\n" + rows(",", grouped))
        self.assert_refused(["gaze", "import", "bare.csv", "-o", "no.csv", *more], ["between thousands", "without thousands separators"])
        self.write("point.tsv", "time\tx\ty\n" + "".join(f"{4 * i}\t{1000.5 + i:,.1f}\t540\n" for i in range(20)))
        self.assert_refused(["gaze", "import", "point.tsv", "-o", "no.csv", *more], ["thousands separators", "'1,000.5' in column 'x'"])
        for mark in ("'", ".", " ", "\u00a0", "\u2019", "\u202f"):
            def spaced(value):
                return f"{value:,}".replace(",", mark)

            self.write("country.tsv", "time\tx\ty\n" + rows("\t", lambda v: spaced(v) + ",5"))
            self.assert_refused(["gaze", "import", "country.tsv", "-o", "no.csv", *more], ["thousands separators", "'1" + mark + "000,5'"])
            self.write("country.tsv", "time\tx\ty\n" + rows("\t", spaced))
            self.assert_refused(["gaze", "import", "country.tsv", "-o", "no.csv", *more], ["thousands separators", "'1" + mark + "000'"])
        # Points before three digits are fractions as well, with marks of missing values between them.
        marks = ("-1", "0", "9999", "-9999")
        self.write("points.tsv", "time\tx\ty\n" + "".join(
            f"{4 * i}\t{marks[i // 20 % 4] if i % 20 == 0 else f'{900 + i / 1000:.3f}'}\t540\n" for i in range(600)))
        self.assertEqual(len(self.convert("points.tsv", *more)[0]), 601)
        # Decimal commas are still understood, with three digits, too.
        self.write("comma.tsv", "time\tx\ty\n" + "".join(f"{4 * i}\t{f'{900 + i / 1000:.3f}'.replace('.', ',')}\t540\n" for i in range(600)))
        self.assertEqual(len(self.convert("comma.tsv", *more)[0]), 601)

    def test_a_first_line_that_tells_spreadsheets_the_separator(self):
        for separator in (";", ",", "\t"):
            table = TABLE.replace(",", separator)
            self.write("plain.csv", table)
            self.write("sep.csv", f"sep={separator}\n" + table)
            self.assertEqual(self.convert("sep.csv")[0], self.convert("plain.csv")[0])

    def test_times_of_day_are_called_so(self):
        for first in ("12:30:05.250", "2026-05-01T12:30:05.250Z"):
            self.write("day.csv", "timestamp,x,y\n" + "".join(f"{first.replace('.250', f'.{i:03d}')},500,400\n" for i in range(20)))
            self.assert_refused(["gaze", "inspect", "day.csv"], ["is a time of day", "write times as numbers", "--time-column"])

    def test_a_line_without_an_end_is_not_held_whole(self):
        with open(self.folder / "line.csv", "wb") as file:
            file.write(b"time[ms],u,v\n0,0.5,")
            for _ in range(300):
                file.write(b"5" * (1 << 20))
        command = [harness.PROGRAM, "gaze", "inspect", "line.csv"]
        before = resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss
        result = subprocess.run(command, cwd=self.folder, capture_output=True, check=False)
        self.assertEqual(result.returncode, 2)
        self.assertIn(b"line.csv:2: the line is longer than 16 MiB", result.stderr)
        self.assertLess(resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss, max(before, 200 << 10))


if __name__ == "__main__":
    harness.main()
