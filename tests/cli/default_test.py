# SPDX-License-Identifier: Apache-2.0
"""What is rendered by default with a gaze is not worse than as many samples spread evenly, on the shipped example in small."""

import json
import statistics

import harness

EXAMPLE = ["--config", harness.SOURCE / "examples/example.toml", "--frames", "9-10", "--size", "160x90", "--fps", "10", "--quiet"]
SEEDS = (1, 2, 3, 4)
T_95 = 3.182  # Student's, two-sided, for three degrees of freedom


class Default(harness.CliTest):
    def render(self, name, *more):
        self.run_ok("render", *EXAMPLE, *more, "-o", f"{name}/f.####.exr", "--json", f"{name}.json", timeout=600)
        summary = json.loads((self.folder / f"{name}.json").read_text())
        return summary["samples"] / summary["pixels"]

    def jod(self, name):
        self.run_ok("compare", "truth/f.####.exr", f"{name}/f.####.exr", "--metrics", "fovvideovdp", "--anyway", "--csv", f"{name}.csv")
        lines = [line.split(",") for line in (self.folder / f"{name}.csv").read_text().splitlines() if not line.startswith("#")]
        at = lines[0].index("value")
        scores = [float(line[at]) for line in lines[1:] if line[lines[0].index("metric")] == "fovvideovdp"]
        self.assertTrue(scores)
        return statistics.mean(scores)

    def test_it_is_not_worse_than_uniform(self):
        self.render("truth", "--sampling", "uniform", "--spp", "64", "--filter", "none", "--accumulate", "off", "--seed", "99")
        gains = []
        for seed in SEEDS:
            traced = self.render(f"default{seed}", "--seed", str(seed))
            even = self.render(f"even{seed}", "--seed", str(seed), "--sampling", "uniform", "--spp", "2")
            self.assertAlmostEqual(traced, even, delta=0.01 * traced)  # those of the windows' other frames included
            gains.append(self.jod(f"default{seed}") - self.jod(f"even{seed}"))
        half = T_95 * statistics.stdev(gains) / len(gains) ** 0.5
        self.assertGreaterEqual(statistics.mean(gains) + half, 0, gains)


if __name__ == "__main__":
    harness.main()
