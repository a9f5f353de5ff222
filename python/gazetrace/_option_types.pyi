# SPDX-License-Identifier: Apache-2.0
# Written by python/tools/write_stubs.py from the schemas of the library.
import os
from collections.abc import Iterable, Sequence
from typing import TypeAlias, TypedDict

Value: TypeAlias = str | float | os.PathLike[str]

class JobOptions(TypedDict, total=False):
    preset: Value | None
    output: str | Sequence[Value] | None
    exr_pixels: Value | None
    exr_space: Value | None
    exr_compression: Value | None
    alpha: bool | None
    aov: Value | Sequence[Value] | None
    exr_parts: Value | None
    sky_depth: Value | None
    crypto_ranks: Value | None
    crypto_samples: Value | None
    map: Value | None
    bits: Value | None
    jpeg_quality: Value | None
    overwrite: bool | None
    resume: bool | None
    scene: Value | None
    animation: Value | None
    cull_back_faces: bool | None
    env: Value | None
    env_rotation: Value | None
    env_ev: Value | None
    camera: Value | None
    camera_path: Value | None
    camera_from_gaze: bool | None
    camera_format: Value | None
    camera_axes: Value | None
    camera_rotation_order: Value | None
    camera_fps: Value | None
    camera_up: Value | None
    camera_turn: Value | None
    camera_scale: Value | None
    camera_start: Value | Sequence[Value] | None
    camera_interpolation: Value | None
    camera_extrapolation: Value | None
    camera_keep_time: bool | None
    eye: Value | Sequence[Value] | None
    target: Value | Sequence[Value] | None
    up: Value | Sequence[Value] | None
    yfov: Value | None
    aperture: Value | None
    focus_distance: Value | None
    sensor_height: Value | None
    shutter: Value | None
    gaze_recording: Value | None
    gaze_eye: Value | None
    trial: Value | None
    gaze_at: Value | Sequence[Value] | None
    gaze_mode: Value | None
    gaze_missing: Value | None
    gaze_max_missing_frames: Value | None
    gaze_max_age: Value | None
    gaze_max_gap: Value | None
    gaze_offset: Value | None
    gaze_scale: Value | None
    gaze_start: Value | None
    gaze_latency: Value | None
    keep_ids: bool | None
    gaze_anchor: str | Sequence[Value] | None
    gaze_process: str | Sequence[Value] | None
    screen: Value | None
    screen_px: Value | Sequence[Value] | None
    screen_cm: Value | Sequence[Value] | None
    screen_distance_cm: Value | None
    screen_eye_cm: Value | Sequence[Value] | None
    screen_ppd: Value | None
    recording_screen: Value | None
    gaze_transfer: Value | None
    size: str | Sequence[int] | None
    fps: Value | None
    frames: Value | Iterable[int] | None
    first_frame: Value | None
    start: Value | None
    crop: Value | Sequence[Value] | None
    frame_rect: Value | Sequence[Value] | None
    sampling: Value | None
    spp: Value | None
    region_samples: Value | Sequence[Value] | None
    region_blocks: Value | Sequence[Value] | None
    region_eccentricities: Value | Sequence[Value] | None
    block_samples: Value | None
    max_block: Value | None
    min_spp: Value | None
    max_spp: Value | None
    target_relmse: Value | None
    target_jod: Value | None
    filter: Value | None
    accumulate: Value | None
    accumulate_past: Value | None
    accumulate_future: Value | None
    bounces: Value | None
    russian_roulette: bool | None
    diffuse: Value | None
    light_sampling: Value | None
    guiding: bool | None
    clamp_indirect: Value | None
    pixel_filter: Value | None
    seed: Value | None
    threads: Value | None
    only_pixel: Value | Sequence[Value] | None
    exposure: Value | None
    exposure_key: Value | None
    ocio: Value | None
    ocio_input: Value | None
    display: Value | None
    view: Value | None
    look: Value | None
    progress: Value | None
    quiet: bool | None
    allow_outside: bool | None
    allow_missing: bool | None
    strict: bool | None
    confine: bool | None
    max_memory: Value | None
    chunk: Value | None
    trust_files: bool | None
    grace: Value | None
    max_time: Value | None

class GazeOptions(TypedDict, total=False):
    gaze_recording: Value | None
    gaze_eye: Value | None
    trial: Value | None
    time_column: Value | None
    x_column: Value | None
    y_column: Value | None
    z_column: Value | None
    validity_column: Value | None
    valid_values: Value | Sequence[Value] | None
    confidence_column: Value | None
    pupil_column: Value | None
    eye_column: Value | None
    recording_column: Value | None
    columns: Value | None
    format: Value | None
    time_unit: Value | None
    unit: Value | None
    origin: Value | None
    corner: Value | Sequence[Value] | None
    axes: Value | None
    frame: Value | None
    min_confidence: Value | None
    missing_value: Value | None
    order: Value | None
    swap_xy: bool | None
    flip_x: bool | None
    flip_y: bool | None
    events: Value | None
    trial_start: Value | None
    trial_end: Value | None
    trial_nth: Value | None
    trial_per_block: bool | None
    trial_table: Value | None
    screen: Value | None
    screen_px: Value | Sequence[Value] | None
    screen_cm: Value | Sequence[Value] | None
    screen_distance_cm: Value | None
    screen_eye_cm: Value | Sequence[Value] | None
    screen_ppd: Value | None

class MeasureOptions(TypedDict, total=False):
    response: Value | None
    relmse_epsilon: Value | None
    flip_tone_mapper: Value | None
    flip_start: Value | None
    flip_stop: Value | None
    flip_count: Value | None
    peak_cd_m2: Value | None
    contrast: Value | None
    ambient_lux: Value | None
    reflectivity: Value | None
    correct_border: bool | None
    pooling_weights: Value | None
    fail_above: str | Sequence[Value] | None
    fail_below: str | Sequence[Value] | None
    frames: Value | Iterable[int] | None
    anyway: bool | None
    gaze_at: Value | Sequence[Value] | None
    gaze_mode: Value | None
    gaze_offset: Value | None
    gaze_start: Value | None
    region_eccentricities: Value | Sequence[Value] | None
    frame_rect: Value | Sequence[Value] | None
    gaze_recording: Value | None
    gaze_eye: Value | None
    trial: Value | None
    screen: Value | None
    screen_px: Value | Sequence[Value] | None
    screen_cm: Value | Sequence[Value] | None
    screen_distance_cm: Value | None
    screen_eye_cm: Value | Sequence[Value] | None
    screen_ppd: Value | None
    ocio: Value | None
    ocio_input: Value | None
    csv: Value | None
    json: Value | None
    map_overlay: bool | None
    overwrite: bool | None
