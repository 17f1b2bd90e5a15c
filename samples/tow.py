#!/usr/bin/python3
"""Tows a map's body through water with each model and prints what it feels and what it leaves (docs/model.md).

    PYTHONPATH=bindings/python samples/tow.py paddle.frm

Upright along y at 0.5 m/s for 3 s, half in the water and wholly under it; 200 x 200 cells of 0.025 m, 2 m deep. The
drag is the pressure part's mean over the last second, also as a share of what the same tow gives under a flat surface.
"""
import math
import sys

import frm

SPEED, SECONDS, DT = 0.5, 3.0, 0.002
MODELS = (("FRM_MODEL_PAPER", 0), ("displacement", 1), ("own waves", 2), ("default: both", 3))


def upright(z, y):
    return (0, y, z), (0, 0, 0, 1)


def tow(path, model, z, waves):
    """Drag (N) and the largest speed of the water (m/s) 2 s after the body was taken out."""
    with frm.Context() as context:
        world = frm.World(context, model=model)
        water = frm.Water(world, nx=200, ny=200, cell=0.025, depth=2.0) if waves else None
        body = frm.Body(world, frm.Map(context, path))
        ticks, drag = round(SECONDS / DT), 0.0
        for n in range(ticks):
            body.set_motion(upright(z, -0.5 * SPEED * SECONDS + SPEED * DT * n), ((0, SPEED, 0), (0, 0, 0)))
            world.tick(DT)
            if n >= ticks - round(1 / DT):
                drag -= body.forces().pressure.force.y * DT
        if not water:
            return drag, 0.0
        body.close()
        for _ in range(round(2 / DT)):
            world.tick(DT)
        state = water.read(velocity_x=True, velocity_y=True)
        return drag, max(math.hypot(u, v) for u, v in zip(state.velocity_x.ravel(), state.velocity_y.ravel()))


def main():
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    path = sys.argv[1]
    with frm.Context() as context:
        info = frm.Map(context, path).info()
        low, high = info.bounds_low.z, info.bounds_high.z
    for name, z in (("half in the water", -0.5 * (low + high)), ("all under water, 0.1 m deep", -0.1 - high)):
        flat, _ = tow(path, 3, z, waves=False)
        print(f"{name}: flat {flat:.2f} N")
        for label, model in MODELS:
            drag, current = tow(path, model, z, waves=True)
            print(f"  {label:16} {drag:8.2f} N  {100 * drag / flat:4.0f} %   current left {current:.4f} m/s")


if __name__ == "__main__":
    main()
