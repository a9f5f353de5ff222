# SPDX-License-Identifier: Apache-2.0
"""Cameras of glTF files, and camera paths of other programs."""

import json
import math


def _frames(bench, *arguments):
    result = bench.run_program("plan", "--size", "64x36", *arguments, "--json")
    if result.returncode:
        raise AssertionError(bench.last_line(result))
    return json.loads(result.stdout)["frames"]


def _poses(frames):
    return [(tuple(frame["camera"]["position_m"]), tuple(frame["camera"]["orientation_xyzw"])) for frame in frames]


def _turn(a, b):
    """The angle between two orientations, in radians."""
    return 2 * math.acos(min(1, abs(sum(x * y for x, y in zip(a, b)))))


def _same(frames, others, tolerance=1e-5):
    """Whether both have the same poses, one after the other; how far apart they are."""
    if len(frames) != len(others):
        return False, f"{len(frames)} and {len(others)} frames"
    apart = max(max(math.dist(a, b), _turn(p, q)) for (a, p), (b, q) in zip(_poses(frames), _poses(others)))
    return apart < tolerance, f"{len(frames)} frames, {apart:.1e} m or rad apart"


def _path(bench, name, *options):
    return _frames(bench, "--camera-path", bench.scene(name), *options)


def _refused(bench, name, *words):
    return bench.refused(bench.run_program("plan", "--size", "64x36", "--camera-path", bench.scene(name)), *words)


def wide_orthographic_camera(bench):
    """xmag 2.5, ymag 1 in a frame of 16:9: balls at x = +-2.2 are in the picture (glTF 3.10.3), 2.2/2.5 of the half width away"""
    picture = bench.picture(bench.scene("cameras/ortho_wide.gltf"), "--env", "constant:1,2,3", "--spp", "1")
    lit = [x for x in range(picture.width) if any(picture.pixel(x, y) != (1, 2, 3) for y in range(picture.height))]
    wanted = [picture.width / 2 * (1 + side * 2.4 / 2.5) for side in (-1, 1)]
    return abs(lit[0] - wanted[0]) < 1.5 and abs(lit[-1] + 1 - wanted[1]) < 1.5, f"columns {lit[0]} to {lit[-1]} of {picture.width}"


def orthographic_camera_without_width(bench):
    """xmag 0, which glTF 3.10.3.2 forbids: drawn in the frame's shape, and said"""
    scene = json.loads(bench.scene("cameras/ortho_wide.gltf").read_text())
    for camera in scene["cameras"]:
        camera.get("orthographic", {})["xmag"] = 0
    path = bench.write("narrow.gltf", json.dumps(scene))
    result, picture = bench.render(path, "--env", "constant:1,2,3", "--spp", "1")
    return picture is not None and "xmag must not be zero" in result.stderr, bench.last_line(result)


def ten_poses_of_nuke(bench):
    """10 poses: 10 frames without --frames"""
    frames = _path(bench, "chan/c1.chan")
    return len(frames) == 10, f"{len(frames)} frames"


def ten_poses_of_nerf(bench):
    """10 poses, those of the .chan file, which were made of the same numbers"""
    return _same(_path(bench, "chan/transforms.json"), _path(bench, "chan/c1.chan", "--frames", "1-10"))


def there_and_back(bench):
    """10 poses written as .chan and read again: 10 poses, the same"""
    frames = _path(bench, "chan/c1.chan")
    for rate in ("24", "24000/1001", "30", "59.94", "90"):
        saved = bench.folder / "again.chan"
        _frames(bench, "--camera-path", bench.scene("chan/c1.chan"), "--fps", rate, "--save-camera", saved, "--overwrite")
        good, got = _same(frames, _frames(bench, "--camera-path", saved, "--fps", rate), 1e-9)
        if not good:
            return False, f"at {rate}: {got}"
    return True, got


def colmap(bench):
    """10 pictures, 10 poses, those of the .chan file"""
    return _same(_path(bench, "colmap/good/images.txt"), _path(bench, "chan/c1.chan", "--frames", "1-10"))


def colmap_without_empty_lines(bench):
    """refused: each second picture would pass for the points of the one before"""
    lines = bench.scene("colmap/good/images.txt").read_text().splitlines()
    path = bench.write("images.txt", "\n".join(line for line in lines if line) + "\n")
    return bench.refused(bench.run_program("plan", "--size", "64x36", "--camera-path", path), "images.txt:6", "empty line")


def colmap_names_of_numbers(bench):
    """pictures that are called `1 2 3`: 10 poses with empty lines, refused without, since no quaternion is a point's number"""
    lines = bench.scene("colmap/good/images.txt").read_text().splitlines()
    lines = [" ".join(line.split()[:9]) + f" {i} 2 3" if line and not line.startswith("#") else line for i, line in enumerate(lines)]
    whole = _frames(bench, "--camera-path", bench.write("images.txt", "\n".join(lines) + "\n"), "--camera-format", "colmap")
    cut = bench.write("images.txt", "\n".join(line for line in lines if line) + "\n")
    refused, got = bench.refused(bench.run_program("plan", "--size", "64x36", "--camera-path", cut, "--camera-format", "colmap"), "empty line")
    return refused and len(whole) == 10, f"{len(whole)} frames; {got}"


def path_of_nerfstudio(bench):
    """the poses of the .chan file, and a vertical field of view of 50 degrees"""
    frames = _path(bench, "refused/nerfstudio_camera_path.json")
    good, got = _same(frames, _path(bench, "chan/c1.chan", "--frames", "1-10"))
    return good and abs(frames[0]["camera"]["yfov_deg"] - 50) < 1e-9, got


_LENS = ("camera_angle_x", "camera_angle_y", "fl_x", "fl_y", "w", "h", "cx", "cy")


def _lenses(bench, of_all, of_each, of_the_last=()):
    """A plan of transforms.json with these numbers of its lens."""
    file = json.loads(bench.scene("chan/transforms.json").read_text())
    file = {key: value for key, value in file.items() if key not in _LENS} | of_all
    for frame in file["frames"]:
        frame.update(of_each)
    file["frames"][-1].update(of_the_last)
    return bench.run_program("plan", "--size", "64x36", "--camera-path", bench.write("transforms.json", json.dumps(file)), "--json")


def lens_of_each_frame(bench):
    """fl_y in each frame and h in each or for all, as nerfstudio takes them: a vertical field of view of 2 atan(h / (2 fl_y))"""
    wanted = 2 * math.degrees(math.atan(720 / 1600))
    got = [json.loads(_lenses(bench, *numbers).stdout)["frames"][0]["camera"]["yfov_deg"]
           for numbers in (({}, {"fl_y": 800, "h": 720}), ({"h": 720}, {"fl_y": 800}))]
    return all(abs(value - wanted) < 1e-9 for value in got), f"{got}, {wanted:.4f} degrees by hand"


def distorted_lens_of_a_frame(bench):
    """k1, cx off the centre or a fisheye in one frame alone: said"""
    common = {"fl_y": 800, "w": 1280, "h": 720, "cx": 640, "cy": 360}
    said = [_lenses(bench, common, {}, odd).stderr for odd in ({"k1": 0.1}, {"cx": 700}, {"camera_model": "OPENCV_FISHEYE"}, {})]
    told = ["distorted or off its centre" in text for text in said]
    return told == [True, True, True, False], f"{told} of a distorted, a shifted, a fisheye and a straight one"


def path_of_instant_ngp(bench):
    """by ngp_matrix_to_nerf (scale 0.33, offset 0.5) the places are (4.545, 0, 0) and (3.030, 0, 0), and the first camera looks along +x"""
    frames = _path(bench, "refused/base_cam.json")
    (first, turned), (second, _) = _poses(frames)
    x, y, z, w = turned
    forward = (-2 * (x * z + w * y), -2 * (y * z - w * x), -(1 - 2 * (x * x + y * y)))
    right = math.dist(first, (1.5 / 0.33, 0, 0)) < 1e-9 and math.dist(second, (1 / 0.33, 0, 0)) < 1e-9
    # +z of its own world, where the camera looks unturned, is +x of transforms.json.
    return right and math.dist(forward, (1, 0, 0)) < 1e-9, f"{first}, {second}, looks along {forward}"


def kitti(bench):
    """12 numbers a line: named as KITTI's poses"""
    return _refused(bench, "words/kitti.txt", "KITTI")


def matrices_of_other_forms(bench):
    """16 numbers a line (ScanNet, Replica), and a time before 12 or 16: named as matrices"""
    rows = bench.scene("words/kitti.txt").read_text().splitlines()
    for form in ("{row} 0 0 0 1", "{i} {row}", "{i} {row} 0 0 0 1"):
        path = bench.write("poses.txt", "".join(form.format(i=i, row=row) + "\n" for i, row in enumerate(rows)))
        good, got = bench.refused(bench.run_program("plan", "--size", "64x36", "--camera-path", path), "matrices")
        if not good:
            return False, f"{form}: {got}"
    return True, got


def stamps_that_begin_at_zero(bench):
    """steps of 50,000,000 are 0.05 s in nanoseconds, and 50 s in microseconds: named as nanoseconds; 33,333 are microseconds"""
    pose = " 0 0 0 0 0 0 1\n"
    for step, unit in ((50_000_000, "nanoseconds"), (33_333, "microseconds"), (2_000, "milliseconds")):
        path = bench.write("zero.tum", "".join(f"{i * step}{pose}" for i in range(10)))
        good, got = bench.refused(bench.run_program("plan", "--size", "64x36", "--camera-path", path), unit)
        if not good:
            return False, f"{step}: {got}"
    return True, got


def nanoseconds(bench):
    """TUM lines with nanoseconds: said to look like nanoseconds"""
    return _refused(bench, "words/ns.tum", "nanoseconds", "seconds")
