#!/usr/bin/python3
"""Compares a map with direct runs of the flow, in directions it was baked in and between them (docs/flow.md).

    samples/held_out.py build/release/frm samples/meshes/plate.glb draft

Bakes the mesh, then for each direction prints the error of the mean force (of the vector, as a share), the direct
run's own uncertainty, and how strongly the force across the stream swings in the map and in the run.
"""
import json
import math
import subprocess
import sys
import tempfile

DIRECTIONS = ((0, 1, 0), (1, 1, 0), (0.414, 1, 0), (0.6, 1, 0.6), (0, 1, 0.414), (2.414, 1, 0))
PRESETS = {"draft": (12, 6, 10), "standard": (24, 10, 25), "high": (36, 12, 50)}  # cells, start-up, duration; docs/flow.md


def run(*command):
    return json.loads(subprocess.run([*map(str, command), "--json"], check=True, capture_output=True, text=True).stdout)


def main():
    if len(sys.argv) != 4 or sys.argv[3] not in PRESETS:
        sys.exit(__doc__)
    frm, mesh, quality = sys.argv[1:]
    resolution, start_up, duration = PRESETS[quality]
    with tempfile.TemporaryDirectory() as folder:
        file = f"{folder}/map.frm"
        run(frm, "bake", mesh, "-o", file, "--quality", quality)
        info = run(frm, "info", file)
        baked = [flow["direction"] for flow in info["provenance"]["directions"]]
        for direction in DIRECTIONS:
            unit = [c / math.hypot(*direction) for c in direction]
            speed = info["base_speed"]
            velocity = ",".join(str(-speed * c) for c in unit)
            map_force = run(frm, "force", file, "--velocity", velocity)
            along = ",".join(map(str, unit))
            # The same cells as in the bake: its reference length is one for all directions, a run's is its own shadow's.
            area = run(frm, "flow", mesh, "--direction", along, "--speed", speed, "--resolution", 4, "--no-grid-error",
                       "--start-up", 0.5, "--duration", 0.5)["area"]
            ratio = math.sqrt(area) / info["reference_length"]
            flow = run(frm, "flow", mesh, "--direction", along, "--speed", speed, "--resolution",
                       max(4, resolution * ratio), "--no-grid-error", "--start-up", start_up / ratio, "--duration", duration / ratio)
            error = math.dist(map_force["force_mean"], flow["force_mean"]) / math.hypot(*flow["force_mean"])
            known = any(math.dist(unit, one) < 1e-3 for one in baked)
            print(f"({', '.join(f'{c:6.3f}' for c in unit)})  {'baked' if known else 'between':8} mean off {100 * error:5.1f} %"
                  f"  (run uncertain by {100 * flow['uncertainty']:.1f} %)   rms map {math.hypot(*map_force['force_rms']):.3f} N,"
                  f" run {math.hypot(*flow['force_rms']):.3f} N", flush=True)


if __name__ == "__main__":
    main()
