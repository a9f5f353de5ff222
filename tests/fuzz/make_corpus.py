#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""First inputs for the fuzzers: small cuts of real recordings, and the seeds beside this file.

usage: make_corpus.py FOLDER [GAZE_SAMPLES]   writes FOLDER/READER/NAME for every reader
"""
import gzip
import shutil
import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent
# Reader, recording, where to cut it in bytes (of the unpacked text), further files that belong to it.
CUTS = [
    ("gaze-eyelink-asc", "eyelink-asc/bino1000.asc", [(0, 9000)], []),
    ("gaze-eyelink-asc", "eyelink-asc/mono500.asc", [(0, 8000)], []),
    ("gaze-eyelink-asc", "eyelink-asc/bino1000_blinks.asc", [(0, 4000)], []),
    ("gaze-tobii-studio", "tobii-studio-tsv/data.tsv", [(0, 8000)], []),
    ("gaze-tobii-pro-lab", "tobii-pro-lab-tsv/mobile_mapped_excerpt.tsv", [(0, 8000)], []),
    ("gaze-tobii-glasses-2", "tobii-glasses2/livedata.json.gz", [(0, 6000)], []),
    ("gaze-tobii-glasses-3", "tobii-glasses3/gazedata.gz", [(0, 4000)], []),
    ("gaze-pupil-core", "pupil-core/gaze_positions.csv", [(0, 5000)], []),
    ("gaze-pupil-core", "pupil-core/gaze_positions_with_monocular.csv", [(0, 5000)], []),
    ("gaze-pupil-cloud", "pupil-invisible-cloud/gaze.csv", [(0, 3000)], ["pupil-invisible-cloud/scene_camera.json"]),
    ("gaze-neon-native", "pupil-neon-native/gaze ps1.raw", [(0, 160)],
     ["pupil-neon-native/gaze ps1.time", "pupil-neon-native/worn ps1.raw", "pupil-invisible-cloud/scene_camera.json"]),
    ("gaze-smi", "smi-iview-txt/recording1_Samples.txt", [(0, 6000)], []),
    ("gaze-arff", "arff/gaze.arff", [(0, 2000)], []),
    ("gaze-vive-sranipal", "vive-pro-eye/TESTNA01_360VR_Fist3.csv", [(0, 3500)], []),
    ("gaze-pico", "pico-neo3-pro/boxing_VR.csv", [(0, 6000)], []),
    ("gaze-gazebase", "gazebase-vr/gazebase_vr_example.csv", [(0, 2000)], []),
    ("gaze-generic", "plain-csv/gaze-toy-example.csv", [(0, 1000)], []),
    ("gaze-bids", "bids/derived-tx300/sub-01_task-view_recording-eye1_physio.tsv.gz", [(0, 600)],
     ["bids/derived-tx300/sub-01_task-view_recording-eye1_physio.json",
      "bids/derived-tx300/sub-01_task-view_events.json"]),
]


def text_of(path, limit=None):
    data = gzip.open(path).read() if path.suffix == ".gz" else path.read_bytes()
    return data[:limit]


def cut(data, begin, end):
    """Whole lines where there are lines."""
    piece = data[begin:end]
    return piece if len(data) <= end or b"\n" not in piece else piece[:piece.rindex(b"\n") + 1]


def main():
    if len(sys.argv) < 2:
        sys.exit(__doc__)
    target = Path(sys.argv[1])
    samples = Path(sys.argv[2]) if len(sys.argv) > 2 else HERE.parents[1].parent / "shared" / "gaze-samples"

    def put(reader, name, data):
        families = {reader, reader.split("-")[0] + "-any"}
        for family in families:
            (target / family).mkdir(parents=True, exist_ok=True)
            (target / family / f"{reader}-{name}").write_bytes(data)

    for seed in sorted((HERE / "seeds").glob("*/*")):
        put(seed.parent.name, seed.name, seed.read_bytes())
    for reader, recording, pieces, others in CUTS:
        path = samples / recording
        if not path.exists():
            print(f"{path} is not here", file=sys.stderr)
            continue
        data = text_of(path)
        for index, (begin, end) in enumerate(pieces):
            is_binary = path.suffix == ".raw"
            piece = data[begin:end] if is_binary else cut(data, begin, end)
            for other in others:
                if (samples / other).exists():
                    limit = (end // 8 if "worn" in other else end) if is_binary and ".json" not in other else None
                    name = Path(other).name
                    piece += b"\n%%FILE " + name.encode() + b"\n" + text_of(samples / other, limit)
            put(reader, f"{path.stem.replace(' ', '_')}-{index}", piece)
        if path.suffix == ".gz":
            packed = gzip.compress(cut(data, 0, 1500), mtime=0)
            put(reader, path.name.replace(" ", "_"), packed)


if __name__ == "__main__":
    main()
