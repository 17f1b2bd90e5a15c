#!/usr/bin/python3
"""Lets a light box fall into water and float at 60 Hz, with and without added mass and damping (docs/stability.md).

    PYTHONPATH=bindings/python samples/float.py box.frm [density ratio, 0.05]

A map of any box-like object that is about its own centre, with added mass (frm bake makes it). The host's rule is
semi-implicit Euler: v += dv, then x += dt v. dv is that of M dv = dt F, or of (M + added mass + dt damping) dv = dt F
less what the part of the surface takes that has just become wet: grown added mass times v.
"""
import math
import sys

import numpy as np

import frm

DT, SECONDS, SPEED = 1 / 60, 10.0, 10.0


def turned(q, w, dt):
    """The rotation q, turned by the angular velocity w for dt."""
    angle = np.linalg.norm(w) * dt
    if angle == 0:
        return q
    x, y, z = w / np.linalg.norm(w) * math.sin(angle / 2)
    s = math.cos(angle / 2)
    a, b, c, d = q
    r = np.array((s * a + x * d + y * c - z * b, s * b - x * c + y * d + z * a, s * c + x * b - y * a + z * d,
                  s * d - x * a - y * b - z * c))
    return r / np.linalg.norm(r)


def matrix(q):
    x, y, z, w = q
    return np.array(((1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)),
                     (2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)),
                     (2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y))))


def fall(path, ratio, coefficients):
    """Yields time, height and speed, tick by tick."""
    with frm.Context() as context:
        world = frm.World(context)
        box_map = frm.Map(context, path)
        info = box_map.info()
        size = np.array([info.bounds_high.x - info.bounds_low.x, info.bounds_high.y - info.bounds_low.y,
                         info.bounds_high.z - info.bounds_low.z])
        edge = float(size.max())
        frm.Water(world, nx=96, ny=96, cell=edge / 8, depth=4 * edge)
        mass = ratio * 1000 * info.volume
        body = frm.Body(world, box_map, mass=mass)
        own = mass / 12 * np.diag((size ** 2).sum() - size ** 2)  # a box of even density, about its centre
        position, velocity, spin = np.array((0, 0, edge)), np.array((0, 0, -SPEED)), np.zeros(3)
        rotation, wet_share = turned(np.array((0, 0, 0, 1.0)), np.array((0.4, 0.1, 0.1)), 1), 0.0
        for n in range(round(SECONDS / DT)):
            speed = float(np.linalg.norm(velocity))
            yield n * DT, float(position[2]), speed
            if not (speed < 1e3 and np.linalg.norm(spin) < 1e3 and np.linalg.norm(position) < 1e6):
                return
            body.set_motion((tuple(position), tuple(rotation)), (tuple(velocity), tuple(spin)))
            world.tick(DT)
            total = body.forces().total
            turn = matrix(rotation)
            inertia = turn @ own @ turn.T
            m = np.zeros((6, 6))
            m[:3, :3], m[3:, 3:] = mass * np.eye(3), inertia
            f, t = total.force, total.torque
            force = np.array((f.x, f.y, f.z, t.x, t.y, t.z))
            force[3:] -= np.cross(spin, inertia @ spin)
            impulse = DT * force
            if coefficients:
                c = body.coefficients()
                added_mass = np.reshape(c.added_mass, (6, 6))
                m += added_mass + DT * np.reshape(c.damping, (6, 6))
                if c.wet_share > wet_share:
                    impulse -= (1 - wet_share / c.wet_share) * added_mass @ np.concatenate((velocity, spin))
                wet_share = c.wet_share
            change = np.linalg.solve(m, impulse)
            velocity, spin = velocity + change[:3], spin + change[3:]
            position, rotation = position + DT * velocity, turned(rotation, spin, DT)


def main():
    if len(sys.argv) not in (2, 3):
        sys.exit(__doc__)
    ratio = float(sys.argv[2]) if len(sys.argv) == 3 else 0.05
    for name, coefficients in (("M dv = dt F", False), ("with added mass and damping", True)):
        ticks = list(fall(sys.argv[1], ratio, coefficients))
        time, height, speed = ticks[-1]
        fastest = max(s for _, _, s in ticks)
        print(f"{name}: fastest {fastest:.1f} m/s; after {time:.1f} s at {height:.3f} m, {speed:.3f} m/s")


if __name__ == "__main__":
    main()
