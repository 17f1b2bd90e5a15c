#!/usr/bin/python3
"""Writes samples/devices/*.json: SPIDAR-G configurations from the tables of their makers (docs/devices.md).

usage: make_spidar_g_configurations.py [--check]   (--check: compare with the files that are there)
"""
import json
import pathlib
import sys

FOLDER = pathlib.Path(__file__).resolve().parent.parent / "samples" / "devices"

# Motor: signs of its corner of the half box, signs of its attachment in half lengths of the grip.
CORNERS = [(-1, -1, 1), (1, -1, 1), (1, -1, -1), (-1, -1, -1), (-1, 1, 1), (1, 1, 1), (1, 1, -1), (-1, 1, -1)]
ATTACHED = [(-1, 0, 0), (1, 0, 0), (0, -1, 0), (0, -1, 0), (-1, 0, 0), (1, 0, 0), (0, 1, 0), (0, 1, 0)]

VERIFIED_NOT = "Not yet run on hardware."
PATTERN = " The attachments are SpidarG6X3R's: the table that was printed for this frame has no wrench closure."
UNITS = " Metres per pulse and volts per newton are SpidarG6X3R's: none were published for this frame."

DEVICES = {
    # name: half box, half length of the grip, turned by -45 degrees about y, m/pulse, V/N, tensions, comment
    "SpidarG6X3R": ((0.060, 0.076, 0.060), 0.0225, True, 1.66555e-5, 0.365296803653, (0.3, 20), VERIFIED_NOT),
    "SpidarG6X3F": ((0.060, 0.073, 0.060), 0.016, False, 1.66555e-5, 0.365296803653, (0.3, 20),
                    VERIFIED_NOT + PATTERN + UNITS),
    "SpidarG6X4": ((0.069, 0.095, 0.069), 0.0225, True, 3.485e-5, 0.08, (0.2, 20), VERIFIED_NOT + PATTERN),
    "SpidarG645": ((0.195, 0.1975, 0.2025), 0.0325, False, 2.924e-5, 0.3, (1, 20), VERIFIED_NOT),
}


def turned(v):
    """By -45 degrees about y."""
    root = 0.5 ** 0.5
    return [round(root * (v[0] - v[2]), 10) + 0.0, v[1], round(root * (v[0] + v[2]), 10) + 0.0]


def configuration(name, box, grip, turn, metres_per_pulse, volts_per_newton, tension, comment):
    place = turned if turn else list
    motors = []
    for index, (corner, attached) in enumerate(zip(CORNERS, ATTACHED)):
        motors.append({
            "anchor": place([c * b for c, b in zip(corner, box)]),
            "attachment": place([a * grip + 0.0 for a in attached]),
            "metres_per_pulse": -metres_per_pulse if 2 <= index <= 5 else metres_per_pulse,
            "volts_per_newton": volts_per_newton,
            "tension": list(tension),
        })
    head = {"format": "frm-spidar-g", "version": 1, "name": name, "comment": comment, "amplifier": "sh4",
            "digits_per_volt": 415, "lever": grip}
    lines = ["  " + json.dumps(key) + ": " + json.dumps(value) for key, value in head.items()]
    lines.append('  "motors": [\n    ' + ",\n    ".join(json.dumps(m) for m in motors) + "\n  ]")
    return "{\n" + ",\n".join(lines) + "\n}\n"


def main():
    wrong = 0
    for name, facts in DEVICES.items():
        path, text = FOLDER / f"{name}.json", configuration(name, *facts)
        if "--check" in sys.argv:
            if not path.is_file() or path.read_text(encoding="utf-8") != text:
                print(f"{path} is not what this script makes")
                wrong = 1
        else:
            FOLDER.mkdir(exist_ok=True)
            path.write_text(text, encoding="utf-8")
    return wrong


if __name__ == "__main__":
    sys.exit(main())
