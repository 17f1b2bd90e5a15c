"""What scripts/validate-flow runs: the bodies, what is known of them, and the cases.

To tune a case, edit its line in CASES: what is measured with other numbers is measured again, the rest stays.
"""
from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Callable

import make_meshes

VISCOSITY = 1e-6  # water, m^2/s: the speed follows from the Reynolds number


# ---- bodies: the stream goes along x, a section's or a spin's axis is z ----

@dataclass(frozen=True)
class Body:
    title: str
    length: float  # of the Reynolds and Strouhal numbers, m
    make: Callable[[], make_meshes.Mesh]
    direction: str = "1,0,0"


def scaled(mesh, factor):
    mesh.vertices, vertices = [], mesh.vertices
    for x, y, z in vertices:
        mesh.add(x * factor, y * factor, z * factor)
    return mesh


def sphere(diameter):
    """20,480 triangles, as large as makes its volume the sphere's; no corner is off its surface by 0.05 %."""
    radius = diameter / 2
    mesh = make_meshes.sphere(radius, 5)
    return scaled(mesh, (4 / 3 * math.pi * radius ** 3 / mesh.volume()) ** (1 / 3))


def cylinder(diameter, height, sides=512):
    """Along z; a prism as wide as makes its cut the circle's in area."""
    radius = diameter / 2 * math.sqrt(2 * math.pi / (sides * math.sin(2 * math.pi / sides)))
    mesh = make_meshes.Mesh("cylinder")
    rings = [[mesh.add(radius * math.cos(2 * math.pi * i / sides), radius * math.sin(2 * math.pi * i / sides), z)
              for i in range(sides)] for z in (-height / 2, height / 2)]
    below, above = mesh.add(0, 0, -height / 2), mesh.add(0, 0, height / 2)
    for i in range(sides):
        j = (i + 1) % sides
        mesh.quad(rings[0][i], rings[0][j], rings[1][j], rings[1][i])
        mesh.triangles += [(below, rings[0][j], rings[0][i]), (above, rings[1][i], rings[1][j])]
    return mesh


def box(x, y, z):
    return lambda: make_meshes.box("box", x, y, z)


BODIES = {
    "sphere": Body("sphere", 0.1, lambda: sphere(0.1)),
    "cylinder": Body("circular cylinder", 0.1, lambda: cylinder(0.1, 0.4)),
    "square": Body("square section", 0.1, box(0.1, 0.1, 0.4)),
    "section_5": Body("rectangular section, B/H = 5", 0.1, box(0.5, 0.1, 0.4)),
    "section_0.2": Body("rectangular section, B/H = 0.2", 0.1, box(0.02, 0.1, 0.4)),
    "cube": Body("cube face-on", 0.1, box(0.1, 0.1, 0.1)),
    # The references of plates are for thin ones. Twice as thin is 16 times the work where two cells must fit in.
    "plate_1": Body("square plate face-on, 1/20 thick", 0.1, box(0.005, 0.1, 0.1)),
    "plate_5": Body("plate 1 : 5 face-on, 1/10 of the short side thick", 0.1, box(0.01, 0.1, 0.5)),
    "box_8_1_30": Body("box 8 x 1 x 30 cm on its 8 x 30 face", 0.08, box(0.08, 0.01, 0.3), "0,1,0"),
}


# ---- what is known ----

@dataclass(frozen=True)
class Reference:
    value: float
    low: float
    high: float
    source: str
    checked: str  # one of CHECKED


CHECKED = {
    "seen": "the number was seen in the source or in a public copy of it",
    "formula": "computed from the formula of the source",
    "memory": "as remembered; the original was not looked up",
}

HOERNER = "Hoerner 1965, Fluid-Dynamic Drag, ch. 3; White, Fluid Mechanics, table 7.3"
DENNIS = "Dennis, Singh and Ingham 1980, J. Fluid Mech. 101: 6.45 Re^-1/2 + 32.1 / Re"

REFERENCES = {
    ("sphere", 100, "cd"): Reference(
        1.087, 1.06, 1.10, "Clift, Grace and Weber 1978, Bubbles, Drops and Particles, 1.087; Johnson and Patel 1999, "
        "J. Fluid Mech. 378, 1.08; Schiller and Naumann 1933, 1.092", "seen"),
    ("sphere", 300, "cd"): Reference(
        0.656, 0.650, 0.671, "Johnson and Patel 1999, 0.656; Kim, Kim and Choi 2001, J. Comput. Phys. 171, 0.657; "
        "Constantinescu and Squires, 0.655; Tomboulides and Orszag 2000, J. Fluid Mech. 416, 0.671", "seen"),
    ("sphere", 300, "cl"): Reference(
        0.067, 0.065, 0.069, "Johnson and Patel 1999, 0.069; Kim, Kim and Choi 2001, 0.067; Constantinescu and "
        "Squires, 0.065", "seen"),
    ("sphere", 300, "strouhal"): Reference(
        0.137, 0.133, 0.137, "Johnson and Patel 1999, 0.137; Kim, Kim and Choi 2001, 0.134; Constantinescu and "
        "Squires, 0.136; Tomboulides and Orszag 2000, 0.136", "seen"),
    ("sphere", 1000, "cd"): Reference(
        0.47, 0.45, 0.49, "Clift, Grace and Weber 1978, 0.471; Ploumhans et al. 2002, J. Comput. Phys. 178, 0.48; Poon "
        "2009, 0.46", "memory"),
    ("sphere", 10000, "cd"): Reference(
        0.40, 0.385, 0.42, "Constantinescu and Squires 2004, Phys. Fluids 16, 0.393; Achenbach 1972, J. Fluid Mech. "
        "54, 0.40", "memory"),
    ("cylinder", 100, "cd"): Reference(
        1.34, 1.32, 1.36, "Park, Kwon and Choi 1998, KSME Int. J. 12, 1.33; Liu, Zheng and Sung 1998, J. Comput. Phys. "
        "139, 1.350", "seen"),
    ("cylinder", 100, "cl_amplitude"): Reference(
        0.333, 0.32, 0.34, "Park, Kwon and Choi 1998, 0.33; Liu, Zheng and Sung 1998, 0.339", "seen"),
    ("cylinder", 100, "strouhal"): Reference(
        0.1645, 0.163, 0.167, "Williamson 1996, Annu. Rev. Fluid Mech. 28, 0.164; Liu, Zheng and Sung 1998, 0.164; "
        "Park, Kwon and Choi 1998, 0.165", "seen"),
    ("square", 100, "cd"): Reference(
        1.49, 1.45, 1.58, "Sohankar, Norberg and Davidson 1998, Int. J. Numer. Meth. Fluids 26, 1.48; Sharma and "
        "Eswaran 2004, Numer. Heat Transfer A 45, 1.494; Sen, Mittal and Biswas 2011, Int. J. Numer. Meth. Fluids 67, "
        "1.53 (5 % blockage)", "seen"),
    ("square", 100, "strouhal"): Reference(
        0.146, 0.141, 0.153, "Okajima 1982, J. Fluid Mech. 123, 0.141 to 0.153; Sohankar, Norberg and Davidson 1998, "
        "0.146; Sen, Mittal and Biswas 2011, 0.145; Sharma and Eswaran 2004, 0.149", "seen"),
    ("section_5", 10000, "cd"): Reference(
        1.03, 0.96, 1.10, "Bruno, Salvetti and Ricciardelli 2014 (BARC), J. Wind Eng. Ind. Aerodyn. 126; Schewe 2013, "
        "J. Fluids Struct. 39, 1.03; at Re 2e4 to 1e5", "memory"),
    ("section_5", 10000, "strouhal"): Reference(
        0.111, 0.105, 0.118, "the same, 0.111; at Re 1e3 to 4e3 Okajima 1982 has 0.10 to 0.13", "memory"),
    ("section_0.2", 10000, "cd"): Reference(
        2.2, 2.05, 2.4, "Nakaguchi, Hashimoto and Muto 1968, J. Japan Soc. Aero. Eng. 16; Norberg 1993, J. Wind Eng. "
        "Ind. Aerodyn. 49; at Re 1e4 to 5e4", "memory"),
    ("section_0.2", 10000, "strouhal"): Reference(0.145, 0.135, 0.155, "Norberg 1993; at Re 1e4 to 5e4", "memory"),
    ("cube", 10000, "cd"): Reference(1.05, 1.00, 1.10, HOERNER + " (1.07); at Re 1e4 to 1e6", "seen"),
    ("plate_1", 10000, "cd"): Reference(
        1.17, 1.10, 1.20, HOERNER + " (1.17, 1.18); DNV-RP-C205, 1.16; thin, above Re 1e3", "seen"),
    ("plate_5", 10000, "cd"): Reference(
        1.20, 1.15, 1.25, HOERNER + "; DNV-RP-C205, 1.20; thin, above Re 1e3", "memory"),
    ("box_8_1_30", 20000, "cd"): Reference(
        1.19, 1.14, 1.25, "between the plates of side ratio 1 and 5 of " + HOERNER + "; thin, above Re 1e3", "memory"),
    ("sphere", 50, "torque_coefficient"): Reference(1.554, 1.51, 1.60, DENNIS, "formula"),
    ("sphere", 200, "torque_coefficient"): Reference(0.6166, 0.598, 0.635, DENNIS, "formula"),
    ("sphere", 1000, "torque_coefficient"): Reference(0.2361, 0.229, 0.243, DENNIS, "formula"),
}


# ---- the cases ----

@dataclass(frozen=True)
class Target:
    """What a case must reach: within so many per cent of its reference, or (`at_most`) below a number."""
    quantity: str  # a key of the program's JSON
    percent: float = 0
    aim: float = 0  # per cent; what is hoped for beyond it
    at_most: float = 0


@dataclass(frozen=True)
class Case:
    name: str
    body: str
    reynolds: float  # on the body's length; of a spin: angular speed * radius^2 / viscosity
    resolution: float  # cells over the reference length: the root of the projected area, of a section its height
    start_up: float  # reference lengths travelled
    duration: float
    targets: list[Target] = field(default_factory=list)
    section: bool = False
    slab: float = 0  # of the section's span, in reference lengths; 0: two dimensions
    spin: bool = False  # in still water
    turn: float = 0  # degrees of the lattice about the stream
    like: str = ""  # a turned case: the one it must agree with
    percent: float = 0  # how well
    quick: bool = False
    options: tuple[str, ...] = ()  # further ones of the program: ("--confidence", "1")
    note: str = ""

    @property
    def mesh(self):
        return f"meshes/{self.body}.glb"

    @property
    def title(self):
        title = BODIES[self.body].title + (", spinning in still water" if self.spin else "")
        title += f", a slab of {self.slab:g} H" if self.slab else ""
        return title + (f", lattice turned by {self.turn:g} degrees" if self.turn else "")

    def command(self):
        """The program's arguments; the mesh is relative to the folder of the results."""
        body = BODIES[self.body]
        length = body.length / 2 if self.spin else body.length
        speed = 0 if self.spin else self.reynolds * VISCOSITY / length
        words = ["flow", self.mesh, "--direction", body.direction, "--speed", speed, "--viscosity", VISCOSITY,
                 "--length", length, "--resolution", self.resolution, "--start-up", self.start_up, "--duration",
                 self.duration]
        if self.section:
            words += ["--section", "0,0,1"]
        if self.slab:
            words += ["--slab", self.slab]
        if self.spin:
            words += ["--spin", f"0,0,{self.reynolds * VISCOSITY / length ** 2:g}"]
        if self.turn:
            words += ["--turn", self.turn]
        return [word if isinstance(word, str) else f"{word:.6g}" for word in [*words, *self.options, "--json"]]


def drag(percent, aim=0):
    return Target("cd", percent, aim)


def strouhal(percent):
    return Target("strouhal", percent)


SECTION = {"section": True}
SLAB = {"section": True, "slab": 4}
SPIN = {"spin": True}
TORQUE = [Target("torque_coefficient", 5)]
QUICK = {"quick": True}

CASES = [
    #    name            body           Re     cells start lasts  what must be reached
    Case("sphere-100", "sphere",        100,    32,   12,   8, [drag(3), Target("seconds", at_most=60)], **QUICK),
    Case("sphere-300", "sphere",        300,    36,   60, 120, [drag(3), Target("cl", 10), strouhal(3)]),
    Case("sphere-1000", "sphere",       1000,   32,   25,  50, [drag(7)]),
    Case("sphere-10000", "sphere",      10000,  72,   20,  15, [drag(10)]),
    Case("cylinder-100", "cylinder",    100,    32,  100, 100, [drag(2), Target("cl_amplitude", 4), strouhal(1.5)],
         **SECTION, **QUICK),
    Case("square-100", "square",        100,    32,  100, 100, [drag(3), strouhal(3)], **SECTION, **QUICK),
    Case("cube-10000", "cube",          10000,  32,   12,  40, [drag(7, aim=5)], **QUICK),
    Case("plate-1", "plate_1",          10000,  40,   12,  30, [drag(7, aim=5)], note="2 cells thick"),
    Case("plate-5", "plate_5",          10000,  46,   10,  20, [drag(7, aim=5)], note="2 cells thick"),
    Case("box-8-1-30", "box_8_1_30",    20000,  32,   12,  60, [drag(7, aim=5)], note="2 cells thick"),
    Case("section-5", "section_5",      10000,  24,   40,  60, [drag(10), strouhal(10)], **SLAB),
    # The mode of 24 cells goes, the drag stays, and what the run says of itself is no longer enough (docs/flow.md).
    Case("section-5-at-36", "section_5", 10000, 36,   60, 100, [drag(10), strouhal(10)], **SLAB),
    Case("section-0.2", "section_0.2",  10000,  36,   60, 120, [drag(10), strouhal(10)], **SLAB, note="7 cells thick"),
    Case("spin-50", "sphere",           50,     32,   30,  10, TORQUE, **SPIN),
    Case("spin-200", "sphere",          200,    32,   30,  10, TORQUE, **SPIN, **QUICK),
    Case("spin-1000", "sphere",         1000,   32,   40,  20, TORQUE, **SPIN),
    # One body on a lattice that lies otherwise.
    Case("sphere-100-turned", "sphere", 100,    32,   12,   8, turn=30, like="sphere-100", percent=3),
    Case("cube-10000-turned", "cube",   10000,  32,   12,  40, turn=30, like="cube-10000", percent=3),
    # 32 cells are too few for it to hold of the cube.
    Case("cube-10000-at-48-turned", "cube", 10000, 48, 12,  60, turn=30, like="cube-10000-at-48", percent=3),
    Case("box-8-1-30-turned", "box_8_1_30", 20000, 32, 12, 60, turn=30, like="box-8-1-30", percent=3),
    # One body with other cells: the rest of SERIES.
    Case("sphere-100-at-12", "sphere",  100,    12,   12,   8),
    Case("sphere-100-at-16", "sphere",  100,    16,   12,   8),
    Case("sphere-100-at-24", "sphere",  100,    24,   12,   8),
    Case("sphere-100-at-48", "sphere",  100,    48,   12,   8),
    Case("cube-10000-at-12", "cube",    10000,  12,   12,  40),
    Case("cube-10000-at-16", "cube",    10000,  16,   12,  40),
    Case("cube-10000-at-24", "cube",    10000,  24,   12,  40),
    Case("cube-10000-at-48", "cube",    10000,  48,   12,  60),
]

# Drag against the cell, coarse to fine: the order of convergence.
SERIES = {
    "sphere at Re 100": ["sphere-100-at-12", "sphere-100-at-16", "sphere-100-at-24", "sphere-100", "sphere-100-at-48"],
    "cube face-on at Re 10,000": ["cube-10000-at-12", "cube-10000-at-16", "cube-10000-at-24", "cube-10000",
                                  "cube-10000-at-48"],
}


def reference(case, target):
    return REFERENCES[case.body, case.reynolds, target.quantity]


def mesh_of(body):
    return BODIES[body].make().glb()
