"""frm info, verify and force on a map made from a formula."""
import math
import struct
import subprocess

import pytest


def damaged(map_path, tmp_path, at):
    data = bytearray(map_path.read_bytes())
    data[at] ^= 0x40
    path = tmp_path / "damaged.frm"
    path.write_bytes(data)
    return path


def test_info(good, map_path):
    text = good("info", map_path).out
    for word in ("haptic sources", "directions", "Reynolds", "bounds", "hash"):
        assert word in text
    j = good("info", "--json", map_path).json
    for key in ("format_version", "content_hash", "sources", "directions", "samples", "triangles", "period",
                "base_speed", "density", "viscosity", "reynolds", "reynolds_solved", "area", "volume", "centroid",
                "bounds_low", "bounds_high", "provenance"):
        assert key in j
    assert len(j["content_hash"]) == 16 and j["volume"] == pytest.approx(0.2 * 0.04 * 0.3, rel=1e-4)


def test_verify(good, map_path):
    j = good("verify", "--json", map_path).json
    assert j["sound"] is True and j["kind"] == "map" and j["file"] == str(map_path)
    assert "sound" in good("verify", map_path).out


@pytest.fixture
def full(map_path):
    """A map with all that a map can have; its unrounded tables beside it."""
    return map_path.parent / "full_map.frm"


def test_info_of_a_full_map(good, full):
    j = good("info", "--json", full).json
    assert (j["format_version"], j["directions"], j["fluctuation_directions"], j["speeds"]) == (2, 38, 18, 3)
    assert j["has_spin"] is True and j["has_added_mass"] is True
    assert j["direction_error_rms"] == pytest.approx(0.02) and j["direction_error_worst"] == pytest.approx(0.07)
    assert j["uncertainty"] == pytest.approx(0.015) and 0 < j["quantisation_error"] <= 3e-3
    text = good("info", full).out
    for words in ("38 for means, 18 for fluctuations", "means at 3 speeds", "2 % of the peak", "7 % of the peak",
                  "1.5 % of the peak force (the mean drag"):
        assert words in text


def test_verify_against_the_unrounded_tables(good, refused, full, map_path, tmp_path):
    raw = full.with_suffix(".frmraw")
    j = good("verify", full, "--against", raw, "--json").json
    stated = good("info", "--json", full).json["quantisation_error"]
    assert j["quantisation_error_stated"] == pytest.approx(stated)
    assert 0 < j["quantisation_error"] <= stated * (1 + 1e-6) and j["raw_bytes"] == raw.stat().st_size
    assert "as stated" in good("verify", full, "--against", raw).out
    refused(1, "full_map.frmraw|another map", "verify", map_path, "--against", raw)
    refused(1, "Is a directory", "verify", full, "--against", tmp_path)
    refused(1, "no.frmraw|No such file", "verify", full, "--against", tmp_path / "no.frmraw")
    refused(1, "full_map.frm|not a .frmraw", "verify", full, "--against", full)
    refused(1, "damaged.frm", "verify", full, "--against", damaged(raw, tmp_path, raw.stat().st_size // 2))


def test_a_map_that_states_too_small_an_error_is_found_out(refused, full, tmp_path):
    data = bytearray(full.read_bytes())
    at = 40  # the first chunk is FACT; one that states a millionth of the error takes its place
    kind, index, raw_size, stored, _ = struct.unpack_from("<4sIQQQ", data, at)
    assert kind == b"FACT"
    frame = bytes(data[at + 32:at + 32 + stored])
    facts = bytearray(subprocess.run(["zstd", "-dc"], input=frame, stdout=subprocess.PIPE, check=True).stdout)
    struct.pack_into("<f", facts, 28, 1e-6)
    path = tmp_path / "facts"
    path.write_bytes(facts)
    frame = subprocess.run(["zstd", "-c", str(path)], stdout=subprocess.PIPE, check=True).stdout
    body = struct.pack("<4sIQQQ", kind, index, raw_size, len(frame), 0) + frame + bytes(data[at + 32 + stored:])
    h = 14695981039346656037
    for byte in body:
        h = (h ^ byte) * 1099511628211 & 0xFFFFFFFFFFFFFFFF
    head = data[:16] + struct.pack("<QQ", h, 40 + len(body)) + data[32:40]
    liar = tmp_path / "liar.frm"
    liar.write_bytes(head + body)
    line = refused(1, "liar.frm|states 0.0001 %", "verify", liar, "--against", full.with_suffix(".frmraw"))
    assert "peak force" in line


@pytest.mark.parametrize("command", [["verify"], ["verify", "--json"], ["info"], ["force", "--velocity", "1,0,0"]])
def test_damage_is_found_wherever_it_is(refused, map_path, tmp_path, command):
    size = map_path.stat().st_size
    for at in (0, 9, 40, size // 3, size // 2, size - 5):
        refused(1, "damaged.frm", command[0], damaged(map_path, tmp_path, at), *command[1:])


def test_damage_names_the_chunk(refused, map_path, tmp_path):
    line = refused(1, "damaged.frm", "verify", damaged(map_path, tmp_path, map_path.stat().st_size // 2))
    assert any(chunk in line for chunk in ("META", "SURF", "SRCS", "MEAN", "FLUC", "PROV", "DIRS", "chunk")), line


@pytest.mark.parametrize("size", [0, 3, 20, 100, -1])
def test_a_truncated_map(refused, map_path, tmp_path, size):
    path = tmp_path / "cut.frm"
    path.write_bytes(map_path.read_bytes()[:size])
    refused(1, "cut.frm", "verify", path)


def test_not_a_map(refused, box, tmp_path):
    refused(1, "box.glb|not a .frm file", "verify", box)
    refused(1, str(tmp_path), "info", tmp_path)


def force(good, map_path, *options):
    return good("force", map_path, *options, "--json").json


def test_force_is_against_the_motion(good, map_path):
    backward = force(good, map_path, "--velocity", "-0.5,0,0")
    forward = force(good, map_path, "--velocity=0.5,0,0")
    assert backward["force_mean"][0] > 0 > forward["force_mean"][0]
    for key in ("force_mean", "force_rms", "torque_mean"):
        assert len(forward[key]) == 3 and all(math.isfinite(v) for v in forward[key])
    assert forward["seconds"] > 0
    assert "N m about the mesh's origin" in good("force", map_path, "--velocity", "1,0,0").out


def test_pressure_goes_with_the_square_of_the_speed_and_friction_with_the_speed(good, map_path):
    # F = p u^2 + f u at u = 1/4, 1/2, 1: three equations for two unknowns.
    f1, f2, f4 = (force(good, map_path, "--velocity", f"{u},0,0")["force_mean"][0] for u in (0.25, 0.5, 1))
    p, f = (f2 - 2 * f1) / 0.125, (16 * f1 - 4 * f2) / 2
    assert f4 == pytest.approx(p + f, rel=1e-5)
    assert abs(p) > abs(f)


def test_scale_and_density(good, map_path):
    one = force(good, map_path, "--velocity", "0.5,0,0")["force_mean"][0]
    heavy = force(good, map_path, "--velocity", "0.5,0,0", "--density", "2000")["force_mean"][0]
    assert heavy == pytest.approx(2 * one, rel=1e-6)
    assert abs(force(good, map_path, "--velocity", "0.5,0,0", "--scale", "2")["force_mean"][0]) > 2 * abs(one)


def test_spin_gives_a_torque_against_it(good, map_path):
    for axis, (forward, backward) in enumerate((("1,0,0", "-1,0,0"), ("0,1,0", "0,-1,0"), ("0,0,1", "0,0,-1"))):
        assert force(good, map_path, "--velocity", "0,0,0", "--spin", forward)["torque_mean"][axis] < 0
        assert force(good, map_path, "--velocity", "0,0,0", "--spin", backward)["torque_mean"][axis] > 0


def test_seconds(good, refused, map_path):
    assert force(good, map_path, "--velocity", "1,0,0", "--seconds", "0.25")["seconds"] == pytest.approx(0.25, rel=1e-3)
    refused(1, "--seconds", "force", map_path, "--velocity", "100,0,0", "--seconds", "1e9")
    refused(1, "--seconds", "force", map_path, "--velocity", "1e-7,0,0")


def test_bench(good):
    results = good("bench", "--seconds", "0.02", "--json").json["results"]
    assert len(results) >= 5 and len({r["name"] for r in results}) == len(results)
    for r in results:
        assert isinstance(r["name"], str) and r["unit"] in ("us", "ns", "GB/s", "kB/s", "M/s", "")
    by_name = {r["name"]: r["value"] for r in results}
    for name in ("tick_200_us_median", "tick_200_us_p9999", "tick_128_us_median", "lookup_ns_per_source", "dry_body_ns",
                 "thousand_bodies_us"):
        limited = next(r for r in results if r["name"] == name)
        assert limited["ratio"] == pytest.approx(limited["value"] / limited["limit"], rel=1e-6)
    assert by_name["flow_kernel_mlups"] > 0 and 0 < by_name["flow_nested_share"] < 2
    assert "two-way tick" in good("bench", "--seconds", "0.01").out
