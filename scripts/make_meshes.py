#!/usr/bin/python3
"""Writes the sample meshes to samples/meshes: closed shapes in metres, the same bytes on every machine.

    make_meshes.py            write them
    make_meshes.py --check    compare them with the files there; exit code 1 when one differs

Coordinates are rounded to a micrometre before they become floats, so that the last bit of a machine's sine does not
matter.
"""

import json
import math
import pathlib
import struct
import sys

FOLDER = pathlib.Path(__file__).resolve().parent.parent / "samples" / "meshes"


class Mesh:
    def __init__(self, name):
        self.name = name
        self.vertices = []
        self.triangles = []

    def add(self, x, y, z):
        self.vertices.append(tuple(round(c, 6) + 0.0 for c in (x, y, z)))
        return len(self.vertices) - 1

    def quad(self, a, b, c, d):
        """Two triangles over the shorter diagonal of a, b, c, d (counter-clockwise from outside)."""
        if self.distance(a, c) <= self.distance(b, d):
            self.triangles += [(a, b, c), (a, c, d)]
        else:
            self.triangles += [(b, c, d), (b, d, a)]

    def distance(self, a, b):
        return math.dist(self.vertices[a], self.vertices[b])

    def volume(self):
        total = 0.0
        for a, b, c in self.triangles:
            (ax, ay, az), (bx, by, bz), (cx, cy, cz) = self.vertices[a], self.vertices[b], self.vertices[c]
            total += ax * (by * cz - bz * cy) + ay * (bz * cx - bx * cz) + az * (bx * cy - by * cx)
        return total / 6

    def check(self):
        """Closed, one way round, outward."""
        sides = {(t[i], t[(i + 1) % 3]) for t in self.triangles for i in range(3)}
        assert len(sides) == 3 * len(self.triangles), self.name + ": a side is used twice"
        assert all((b, a) in sides for a, b in sides), self.name + ": open"
        assert all(len(set(t)) == 3 for t in self.triangles), self.name + ": degenerate"
        assert self.volume() > 0, self.name + ": inside out"

    def glb(self):
        self.check()
        positions = b"".join(struct.pack("<3f", *v) for v in self.vertices)
        assert len(self.vertices) < 65535
        indices = b"".join(struct.pack("<3H", *t) for t in self.triangles)
        floats = [struct.unpack("<3f", positions[i:i + 12]) for i in range(0, len(positions), 12)]
        text = json.dumps({
            "asset": {"version": "2.0", "generator": "frm make_meshes.py"},
            "scene": 0,
            "scenes": [{"nodes": [0]}],
            "nodes": [{"name": self.name, "mesh": 0}],
            "meshes": [{"name": self.name,
                        "primitives": [{"attributes": {"POSITION": 0}, "indices": 1, "material": 0}]}],
            "materials": [{"name": "plain", "pbrMetallicRoughness": {"metallicFactor": 0, "roughnessFactor": 0.8}}],
            "accessors": [
                {"bufferView": 0, "componentType": 5126, "count": len(self.vertices), "type": "VEC3",
                 "min": [min(p[i] for p in floats) for i in range(3)],
                 "max": [max(p[i] for p in floats) for i in range(3)]},
                {"bufferView": 1, "componentType": 5123, "count": 3 * len(self.triangles), "type": "SCALAR"},
            ],
            "bufferViews": [
                {"buffer": 0, "byteOffset": 0, "byteLength": len(positions), "target": 34962},
                {"buffer": 0, "byteOffset": len(positions), "byteLength": len(indices), "target": 34963},
            ],
            "buffers": [{"byteLength": len(positions) + len(indices)}],
        }, separators=(",", ":")).encode()
        text += b" " * (-len(text) % 4)
        data = positions + indices
        data += b"\0" * (-len(data) % 4)
        return b"".join([struct.pack("<4sII", b"glTF", 2, 28 + len(text) + len(data)),
                         struct.pack("<I4s", len(text), b"JSON"), text,
                         struct.pack("<I4s", len(data), b"BIN\0"), data])


def box(name, x, y, z):
    mesh = Mesh(name)
    for i in range(8):
        mesh.add((i & 1 or -1) * x / 2, (i & 2 and 1 or -1) * y / 2, (i & 4 and 1 or -1) * z / 2)
    for face in ((0, 4, 6, 2), (1, 3, 7, 5), (0, 1, 5, 4), (2, 6, 7, 3), (0, 2, 3, 1), (4, 5, 7, 6)):
        mesh.quad(*face)
    return mesh


def sphere(radius, subdivisions):
    """An icosahedron with its triangles halved `subdivisions` times, corners on the sphere."""
    g = (1 + math.sqrt(5)) / 2
    points = [(-1, g, 0), (1, g, 0), (-1, -g, 0), (1, -g, 0), (0, -1, g), (0, 1, g),
              (0, -1, -g), (0, 1, -g), (g, 0, -1), (g, 0, 1), (-g, 0, -1), (-g, 0, 1)]
    triangles = [(0, 11, 5), (0, 5, 1), (0, 1, 7), (0, 7, 10), (0, 10, 11), (1, 5, 9), (5, 11, 4), (11, 10, 2),
                 (10, 7, 6), (7, 1, 8), (3, 9, 4), (3, 4, 2), (3, 2, 6), (3, 6, 8), (3, 8, 9), (4, 9, 5),
                 (2, 4, 11), (6, 2, 10), (8, 6, 7), (9, 8, 1)]
    for _ in range(subdivisions):
        middles, finer = {}, []

        def middle(a, b):
            key = (min(a, b), max(a, b))
            if key not in middles:
                middles[key] = len(points)
                points.append(tuple((p + q) / 2 for p, q in zip(points[a], points[b])))
            return middles[key]

        for a, b, c in triangles:
            ab, bc, ca = middle(a, b), middle(b, c), middle(c, a)
            finer += [(a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca)]
        triangles = finer
    mesh = Mesh("sphere")
    for p in points:
        scale = radius / math.hypot(*p)
        mesh.add(*(c * scale for c in p))
    mesh.triangles = triangles
    return mesh


def smooth(x):
    x = min(max(x, 0.0), 1.0)
    return x * x * (3 - 2 * x)


def mix(a, b, share):
    return a + (b - a) * share


class Tube:
    """A closed tube swept along +z through rings of points, counter-clockwise seen from +z."""

    def __init__(self, mesh):
        self.mesh = mesh
        self.last = None

    def ring(self, points, z):
        ring = [self.mesh.add(x, y, z) for x, y in points]
        if self.last is None:
            self.close_flat(ring)
        elif len(ring) == len(self.last):
            for i in range(len(ring)):
                j = (i + 1) % len(ring)
                self.mesh.quad(self.last[i], self.last[j], ring[j], ring[i])
        else:
            self.halve(ring)
        self.last = ring

    def halve(self, ring):
        """To a ring of half as many points: point i meets point 2 i of the ring before."""
        before = self.last
        assert len(before) == 2 * len(ring)
        for i in range(len(ring)):
            j = (i + 1) % len(ring)
            a, b, c = before[2 * i], before[2 * i + 1], before[(2 * i + 2) % len(before)]
            self.mesh.triangles += [(a, b, ring[i]), (b, ring[j], ring[i]), (b, c, ring[j])]

    def close_flat(self, ring):
        """The thin first ring: upper and lower points face each other."""
        n = len(ring)
        self.mesh.triangles += [(ring[1], ring[0], ring[n - 1]), (ring[n // 2], ring[n // 2 - 1], ring[n // 2 + 1])]
        for i in range(1, n // 2 - 1):
            self.mesh.quad(ring[i + 1], ring[i], ring[n - i], ring[n - i - 1])

    def close_point(self, z):
        pole = self.mesh.add(0, 0, z)
        for i in range(len(self.last)):
            self.mesh.triangles.append((self.last[i], self.last[(i + 1) % len(self.last)], pole))


def paddle():
    """A canoe paddle, 1.4 m: blade towards -z facing +-y, pear grip at +z, the origin in the middle of the shaft."""
    blade, shaft, grip = 0.48, 0.83, 0.09
    radius = 0.015
    sides = 12                          # of the shaft; the blade has twice as many
    neck = -shaft / 2                   # where the blade ends and the shaft begins
    tip = neck - blade
    tube = Tube(Mesh("paddle"))

    def ellipse(a, b):
        return [(a * math.cos(2 * math.pi * k / sides), b * math.sin(2 * math.pi * k / sides)) for k in range(sides)]

    def section(s, n):
        """The outline at a distance s from the tip: a lens with a round rim that becomes the shaft's circle."""
        rounding = 0.17                 # the round end of the plan outline
        width = 0.1 * (1 - max(0.0, 1 - s / rounding) ** 2.6) ** (1 / 2.6)
        width = mix(width, radius, smooth((s - 0.26) / (blade - 0.26)))
        round_ = smooth((s - 0.34) / (blade - 0.34))
        spine = mix(0.0042, 0.009, smooth(s / 0.2))
        rim = 0.003
        points = []
        for i in range(n):
            angle = 2 * math.pi * i / n
            c, v = math.cos(angle), math.sin(angle)
            lens = rim * math.sqrt(abs(v)) + (spine - rim) * v * v
            points.append((width * c, mix(math.copysign(lens, v), radius * v, round_)))
        return points

    rounds = 8                          # close rings where the outline turns, wider ones along the sides
    distances = [0.17 * (1 - math.cos(math.pi / 2 * (i + 1) / rounds)) for i in range(rounds)]
    distances += [mix(0.17, blade, (i + 1) / 16) for i in range(16)]
    for s in distances[:-1]:
        tube.ring(section(s, 2 * sides), tip + s)
    steps = 64
    for i in range(steps + 1):
        tube.ring(ellipse(radius, radius), mix(neck, -neck, i / steps))
    for i in range(1, 10):
        u = math.sin(math.pi / 2 * i / 10)
        bulge, end = smooth(u / 0.7), math.sqrt(1 - max(0.0, (u - 0.6) / 0.4) ** 2)
        a, b = mix(radius, 0.032, bulge) * end, mix(radius, 0.019, bulge) * end
        tube.ring(ellipse(a, b), -neck + grip * u)
    tube.close_point(-neck + grip)
    return tube.mesh


def canoe():
    """An open canoe, 4.5 m along x, z up, the gunwale amidships at z = 0: two hulls, outer and inner, joined by the rim."""
    stations, points = 49, 17           # along the hull; from gunwale over keel to gunwale, odd
    mesh = Mesh("canoe")

    def hull(length, beam, wall):
        grid = []
        for i in range(stations):
            part = i / (stations - 1)
            u = mix(-math.cos(math.pi * part), 2 * part - 1, 0.5)   # closer stations towards the stems
            x = length / 2 * u
            half = beam / 2 * (1 - abs(u) ** 2.2)
            rail = 0.2 * (abs(x) / 2.25) ** 3
            keel = -0.36 + wall + 0.05 * (abs(x) / 2.25) ** 4
            ends = i in (0, stations - 1)
            row = []
            for j in range(points):
                angle = math.pi * j / (points - 1)
                y = math.copysign(abs(math.cos(angle)) ** 0.8, math.cos(angle)) * half
                z = mix(rail, keel, math.sin(angle) ** 0.75)
                # A stem is a line: its two sides are one.
                if ends and j > points // 2:
                    row.append(row[points - 1 - j])
                else:
                    row.append(mesh.add(x, 0 if j == points // 2 else y, z))
            grid.append(row)
        return grid

    outer, inner = hull(4.5, 0.86, 0), hull(4.2, 0.81, 0.025)
    for i in range(stations - 1):
        for j in range(points - 1):
            mesh.quad(outer[i][j], outer[i][j + 1], outer[i + 1][j + 1], outer[i + 1][j])
            mesh.quad(inner[i][j], inner[i + 1][j], inner[i + 1][j + 1], inner[i][j + 1])
        mesh.quad(outer[i][0], outer[i + 1][0], inner[i + 1][0], inner[i][0])
        mesh.quad(inner[i][-1], inner[i + 1][-1], outer[i + 1][-1], outer[i][-1])
    if mesh.volume() < 0:
        mesh.triangles = [(a, c, b) for a, b, c in mesh.triangles]
    return mesh


def main():
    check = sys.argv[1:] == ["--check"]
    if sys.argv[1:] and not check:
        sys.exit(__doc__)
    meshes = [paddle(), sphere(0.05, 3), box("plate", 0.08, 0.01, 0.30), box("box", 0.4, 0.3, 0.2), canoe()]
    different = False
    for mesh in meshes:
        path = FOLDER / (mesh.name + ".glb")
        content = mesh.glb()
        if not check:
            FOLDER.mkdir(parents=True, exist_ok=True)
            path.write_bytes(content)
        elif not path.is_file() or path.read_bytes() != content:
            print(f"{path} is not what this script makes; run scripts/make_meshes.py", file=sys.stderr)
            different = True
            continue
        print(f"{path.name}: {len(mesh.triangles)} triangles, {mesh.volume() * 1000:.3f} litres, {len(content)} bytes")
    sys.exit(1 if different else 0)


if __name__ == "__main__":
    main()
