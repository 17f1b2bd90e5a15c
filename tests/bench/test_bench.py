"""frm bench itself: the names that others follow over time."""
from __future__ import annotations

import json

import pytest

NAMES = {"tick_200_us_median", "tick_200_us_p99", "tick_200_us_p9999", "tick_5khz_us_mean", "tick_128_us_median", "submerged_body_us",
         "dry_body_ns", "ten_bodies_us", "thousand_bodies_us", "body_cut_us", "body_wet_us", "body_calm_us", "body_displacement_us",
         "body_still_us", "body_coupling_us", "lookup_ns_per_source", "lookup_scattered_ns", "coarse_body_ns", "wave_128_roof_share",
         "wave_200_roof_share", "wave_256_roof_share", "wave_512_roof_share", "wave_200_cell_ns", "wave_200_cell_4_ns",
         "wave_2048_stream_ratio", "wave_active64_us", "flow_inplace_bandwidth", "flow_kernel_mlups", "flow_kernel_roof_share",
         "flow_nested_mlups", "flow_nested_share"}
WITH_MUJOCO = {"mujoco_ellipsoid_ns", "mujoco_plate_cd"}


@pytest.mark.full
def test_names_stay(frm):
    done = frm("bench", "--seconds", "0.001", "--json")
    assert done.returncode == 0, done.stderr
    results = json.loads(done.stdout)["results"]
    names = [result["name"] for result in results]
    assert len(names) == len(set(names)) and set(names) - WITH_MUJOCO == NAMES
    for result in results:
        assert set(result) in ({"name", "value", "unit"}, {"name", "value", "unit", "limit", "ratio"})
