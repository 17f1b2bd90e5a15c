"""Small .glb files, sound and broken."""
import json
import struct

CUBE = [(x, y, z) for z in (0, 0.1) for y in (0, 0.1) for x in (0, 0.1)]
SIDES = [(0, 2, 1), (1, 2, 3), (4, 5, 6), (5, 7, 6), (0, 1, 4), (1, 5, 4), (2, 6, 3), (3, 6, 7),
         (0, 4, 2), (2, 4, 6), (1, 3, 5), (3, 7, 5)]


def glb(vertices=CUBE, triangles=SIDES, **extra):
    data = b"".join(struct.pack("<3f", *v) for v in vertices)
    split = len(data)
    data += b"".join(struct.pack("<3I", *t) for t in triangles)
    low, high = ([f(v[i] for v in vertices) for i in range(3)] for f in (min, max))
    text = json.dumps({
        "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
        "accessors": [{"bufferView": 0, "componentType": 5126, "count": len(vertices), "type": "VEC3",
                       "min": low, "max": high},
                      {"bufferView": 1, "componentType": 5125, "count": 3 * len(triangles), "type": "SCALAR"}],
        "bufferViews": [{"buffer": 0, "byteOffset": 0, "byteLength": split},
                        {"buffer": 0, "byteOffset": split, "byteLength": len(data) - split}],
        "buffers": [{"byteLength": len(data)}], **extra}).encode()
    text += b" " * (-len(text) % 4)
    return b"".join([struct.pack("<4sII", b"glTF", 2, 28 + len(text) + len(data)),
                     struct.pack("<I4s", len(text), b"JSON"), text, struct.pack("<I4s", len(data), b"BIN\0"), data])
