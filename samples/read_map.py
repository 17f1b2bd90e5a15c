#!/usr/bin/env python3
"""Reads a .frm map without frm's code, from docs/format.md alone, and says what force it gives in a stream.

usage: read_map.py MAP.frm [x,y,z]

x,y,z is the velocity of the water against the object (m/s, mesh's frame); default: the base speed along +y. The means
are those of the base speed, and fluctuations are added as they come: no repair of docs/model.md is done here. Needs
python3 and the zstd program, and is meant to be read more than to be fast.
"""
import json
import struct
import subprocess
import sys


def require(good, what):
    if not good:
        raise SystemExit(f"read_map: {what}")


def chunks_of(data):
    """{(type, index): contents}. Unknown types are kept; nobody asks for them."""
    magic, version, flags, content_hash, size, count, _ = struct.unpack_from("<8sIIQQII", data)
    require(magic == b"\x89FRM\r\n\x1a\n", "not a .frm file")
    require(version in (1, 2) and flags == 0, f"version {version}, flags {flags}: not known")
    require(size == len(data), "cut off or grown")
    h = 14695981039346656037
    for byte in data[40:]:
        h = (h ^ byte) * 1099511628211 & 0xFFFFFFFFFFFFFFFF
    require(h == content_hash, "content hash does not match")
    at, chunks = 40, {"version": version}
    for _ in range(count):
        kind, index, raw_size, stored_size, _ = struct.unpack_from("<4sIQQQ", data, at)
        require(at + 32 + stored_size <= len(data) and raw_size <= 1 << 28, f"chunk {kind} {index}: its size cannot be")
        frame = data[at + 32:at + 32 + stored_size]
        raw = subprocess.run(["zstd", "-dc"], input=frame, stdout=subprocess.PIPE, check=True).stdout
        require(len(raw) == raw_size and (kind, index) not in chunks, f"chunk {kind} {index} is damaged or comes twice")
        chunks[kind, index] = raw
        at += 32 + stored_size
    require(at == len(data), "bytes after the last chunk")
    return chunks


def floats(raw, at=0):
    return struct.unpack_from(f"<{(len(raw) - at) // 4}f", raw, at)


class DirectionSet:
    """The octahedral lattice of a frequency: 4 n^2 + 2 directions."""

    def __init__(self, n):
        span = range(-n, n + 1)
        self.n = n
        self.points = [(i, j, k) for i in span for j in span for k in span if abs(i) + abs(j) + abs(k) == n]
        self.index = {point: number for number, point in enumerate(self.points)}

    def __len__(self):
        return len(self.points)

    def earlier_neighbours(self, number):
        i, j, k = self.points[number]
        steps = [s for a in (-1, 1) for b in (-1, 1) for s in ((a, b, 0), (a, 0, b), (0, a, b))]
        near = [self.index.get((i + a, j + b, k + c), number) for a, b, c in steps]
        return [other for other in near if other < number]

    def around(self, e):
        """[(direction, weight)]: the three of the lattice around e."""
        n, scale = self.n, self.n / sum(map(abs, e))
        a, b = abs(e[0]) * scale, abs(e[1]) * scale
        c = max(0.0, n - a - b)
        i, j, k = min(int(a), n), min(int(b), n), min(int(c), n)
        fa, fb, rest = a - i, b - j, n - (i + j + k)
        found = {0: [((i, j, k), 1.0)],
                 1: [((i + 1, j, k), fa), ((i, j + 1, k), fb), ((i, j, k + 1), 1 - fa - fb)],
                 2: [((i, j + 1, k + 1), 1 - fa), ((i + 1, j, k + 1), 1 - fb), ((i + 1, j + 1, k), fa + fb - 1)]}[rest]
        return [(self.index[tuple(-p if x < 0 else p for p, x in zip(point, e))], w) for point, w in found]


def differences(raw, at, count):
    """The codes of two planes of bytes, unfolded: 0, 1, 2, 3, ... are 0, -1, 1, -2, ..."""
    require(len(raw) == at + 2 * count, "a chunk has another size")
    codes = (low | high << 8 for low, high in zip(raw[at:at + count], raw[at + count:]))
    return [-(code >> 1) - 1 if code & 1 else code >> 1 for code in codes]


def i16(value):
    return (value + 0x8000) % 0x10000 - 0x8000


class Map:
    def __init__(self, path):
        with open(path, "rb") as file:
            chunks = chunks_of(file.read())
        first = chunks["version"] == 1
        facts = struct.unpack("<8fI" if first else "<8fI3f", chunks[b"FACT", 0])
        self.base_speed, self.period, self.density, self.viscosity, self.length = facts[:5]
        self.samples = facts[8]
        vertices, self.triangles = struct.unpack_from("<II", chunks[b"GEOM", 0])
        require(len(chunks[b"GEOM", 0]) == 8 + 12 * (vertices + self.triangles), "GEOM has another size")
        self.sources = struct.unpack_from("<I", chunks[b"REGN", 0])[0]
        n, m = struct.unpack_from("<II", chunks[b"DIRS", 0])
        self.directions = DirectionSet(n)
        self.swing_directions = self.directions if first else DirectionSet(m)
        if first:
            require(m == len(self.directions), "DIRS does not match its frequency")
            self.speeds = [self.base_speed]
            self.mean = floats(chunks[b"MEAN", 0])
        else:
            count = struct.unpack_from("<I", chunks[b"SPED", 0])[0]
            self.speeds = struct.unpack_from(f"<{count}f", chunks[b"SPED", 0], 4)
            self.mean = self.means(chunks[b"MEAN", self.speeds.index(self.base_speed)])
        self.step, self.series = zip(*(self.fluctuation(chunks[b"FLUC", d]) for d in range(len(self.swing_directions))))
        self.has = [word for kind, word in ((b"SPIN", "spin"), (b"MASS", "added mass")) if (kind, 0) in chunks]
        self.provenance = json.loads(chunks.get((b"PROV", 0), b"{}"))

    def means(self, raw):
        """N, of one speed: six numbers for each source of each direction."""
        steps = floats(raw[:8])
        if steps == (0, 0):
            return floats(raw, 8)
        count = len(self.directions)
        left = differences(raw, 8, 6 * self.sources * count)
        near = [self.directions.earlier_neighbours(d) for d in range(count)]
        out = [0.0] * len(left)
        for row in range(6 * self.sources):
            values = []
            for d in range(count):
                expected = sum(values[k] for k in near[d]) // len(near[d]) if near[d] else 0
                values.append(i16(expected + left[row * count + d]))
                out[d * 6 * self.sources + row] = values[d] * steps[row % 6 // 3]
        return out

    def fluctuation(self, raw):
        values = []
        for i, difference in enumerate(differences(raw, 4, 6 * self.sources * self.samples)):
            values.append(i16(difference + (values[-1] if i % self.samples else 0)))
        return floats(raw[:4])[0], values

    def force(self, source, velocity, time):
        """Pressure and friction on one source (N), six numbers, scaled to the speed by Eq. 6."""
        speed = sum(v * v for v in velocity) ** 0.5
        p = time % self.period / self.period * self.samples
        before = min(int(p), self.samples - 1)
        after, t = (before + 1) % self.samples, p - before
        sums = [0.0] * 6
        for c in range(6):
            for d, weight in self.directions.around(velocity):
                sums[c] += weight * self.mean[(d * self.sources + source) * 6 + c]
            for d, weight in self.swing_directions.around(velocity):
                row = self.series[d][(source * 6 + c) * self.samples:][:self.samples]
                sums[c] += weight * self.step[d] * ((1 - t) * row[before] + t * row[after])
        ratio = speed / self.base_speed
        return [f * ratio * ratio for f in sums[:3]] + [f * ratio for f in sums[3:]]


def main():
    require(len(sys.argv) in (2, 3), __doc__)
    m = Map(sys.argv[1])
    velocity = [float(v) for v in sys.argv[2].split(",")] if len(sys.argv) == 3 else [0, m.base_speed, 0]
    print(f"{m.sources} sources, {len(m.directions)} directions for means at {len(m.speeds)} speeds and "
          f"{len(m.swing_directions)} for fluctuations, {m.samples} samples, {m.triangles} triangles",
          *(f", {word}" for word in m.has), sep="")
    forces = [m.force(l, velocity, 0.0) for l in range(m.sources)]
    print("force at map time 0: %.6g, %.6g, %.6g N" % tuple(sum(f[c] + f[c + 3] for f in forces) for c in range(3)))


if __name__ == "__main__":
    main()
