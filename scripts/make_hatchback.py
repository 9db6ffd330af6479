#!/usr/bin/env python3
"""Writes the model of the shipped hatchback: assets/data/vehicles/hatchback.obj, hatchback_wheel.obj, hatchback.mtl.

    scripts/make_hatchback.py [folder]

Metres; x left, y up, z forward, the origin on the ground midway between the axles, as in hatchback.car.json. The body
is a loft: half cross-sections at stations along z, each with the same rows from the sill up over shoulder, windows and
roof edge to the middle of the roof. Faces get their material from where they are in that grid. The right half is the
mirror image. Wheel arches are stations whose lowest row follows a circle.
"""

import math
import sys
from pathlib import Path

WHEEL_RADIUS, WHEEL_WIDTH, HUB, AXLES = 0.30, 0.195, 0.30, (1.26, -1.26)
ARCH_RADIUS, SILL, WELL = 0.355, 0.19, 0.50
CREASE = math.cos(math.radians(38))

# name: sRGB colour, opacity, roughness, metalness
MATERIALS = {
    "paint": ((0.17, 0.43, 0.78), 1, 0.35, 0.0),
    "glass": ((0.17, 0.21, 0.25), 1, 0.12, 0.0),
    "plastic": ((0.17, 0.17, 0.18), 1, 0.75, 0.0),
    "gap": ((0.03, 0.03, 0.04), 1, 0.9, 0.0),
    "lamp": ((0.93, 0.95, 0.97), 1, 0.15, 0.0),
    "tail": ((0.80, 0.07, 0.07), 1, 0.25, 0.0),
    "plate": ((0.90, 0.90, 0.86), 1, 0.6, 0.0),
    "rubber": ((0.11, 0.11, 0.115), 1, 0.9, 0.0),
    "rim": ((0.66, 0.68, 0.70), 1, 0.35, 0.2),
}


def curve(*points):
    """A piecewise cubic through (z, value) points without overshoot [Fritsch and Butland, 1984]."""
    points = sorted(points)
    zs, vs = [p[0] for p in points], [p[1] for p in points]
    slopes = [(vs[i + 1] - vs[i]) / (zs[i + 1] - zs[i]) for i in range(len(zs) - 1)]
    tangents = [slopes[0]]
    for a, b in zip(slopes, slopes[1:]):
        tangents.append(0 if a * b <= 0 else 2 * a * b / (a + b))
    tangents.append(slopes[-1])

    def value(z):
        z = min(max(z, zs[0]), zs[-1])
        i = max(j for j in range(len(zs) - 1) if zs[j] <= z)
        h = zs[i + 1] - zs[i]
        t = (z - zs[i]) / h
        return ((1 + 2 * t) * (1 - t) ** 2 * vs[i] + t * (1 - t) ** 2 * h * tangents[i]
                + t * t * (3 - 2 * t) * vs[i + 1] + t * t * (t - 1) * h * tangents[i + 1])

    return value


# Half width at the widest row, height of the shoulder, and height and half width of the top, along the car.
HALF_WIDTH = curve((-1.92, 0.60), (-1.88, 0.69), (-1.78, 0.755), (-1.5, 0.79), (0, 0.80), (1.45, 0.79), (1.72, 0.745),
                   (1.86, 0.66), (1.92, 0.56))
SHOULDER = curve((-1.92, 0.86), (-1.80, 0.93), (-1.4, 0.935), (0.2, 0.905), (0.80, 0.875), (1.4, 0.79), (1.78, 0.70),
                 (1.92, 0.62))
MIDDLE = curve((-1.92, 0.88), (-1.86, 0.95), (-1.80, 0.99), (-1.46, 1.27), (-1.20, 1.345), (-0.5, 1.385), (0.02, 1.36),
               (0.22, 1.29), (0.86, 0.925), (1.2, 0.885), (1.6, 0.79), (1.82, 0.70), (1.92, 0.63))
# The lower edge of bumpers, higher at the ends than the sill.
FLOOR = curve((-1.92, 0.30), (-1.75, 0.24), (-1.5, SILL), (1.5, SILL), (1.75, 0.22), (1.92, 0.27))

WINDSCREEN, ROOF_FRONT, ROOF_REAR, HATCH = 0.86, 0.16, -1.28, -1.80
DOOR_GAPS = (0.66, -0.30, -1.06)
GAP = 0.010
SIDE_GLASS = ((0.60, -0.24), (-0.36, -1.22))
ROWS = 9  # sill, bumper edge, waist, shoulder, window foot, window head, roof edge, beside the middle, middle


def stations():
    zs = {1.92, 1.90, 1.86, 1.80, 1.72, WINDSCREEN, WINDSCREEN + 0.03, 1.05, ROOF_FRONT, 0.0, -0.6, -0.85, ROOF_REAR,
          -1.36, -1.46, HATCH, -1.72, -1.84, -1.88, -1.91, -1.92, 0.5, 0.36}
    for start, end in SIDE_GLASS:
        zs |= {start, end}
    for gap in DOOR_GAPS:
        zs |= {gap, gap - GAP}
    for axle in AXLES:
        for i in range(15):
            zs.add(axle + ARCH_RADIUS * math.cos(math.pi * i / 14))
        zs |= {axle + ARCH_RADIUS + 0.03, axle - ARCH_RADIUS - 0.03}
    zs = sorted(zs, reverse=True)
    kept = [zs[0]]
    for z in zs[1:]:
        if kept[-1] - z > 0.006:
            kept.append(z)
    return kept


def arch(z):
    """Height of the wheel arch over z, or None."""
    for axle in AXLES:
        if abs(z - axle) < ARCH_RADIUS + 1e-6:
            return HUB + math.sqrt(max(ARCH_RADIUS ** 2 - (z - axle) ** 2, 0))
    return None


def section(z):
    """The rows of the left half at z, as (x, y)."""
    w, shoulder, top = HALF_WIDTH(z), SHOULDER(z), MIDDLE(z)
    opening = arch(z)
    low = max(FLOOR(z), opening or 0)
    flare = 0.0 if opening is None else 0.014 * min(1, (opening - HUB) / 0.12)
    edge = max(0.36 if abs(z) < 1.5 else 0.46, low + 0.025)
    waist = max(0.62 if z < 1.3 else 0.58, edge + 0.02)
    waist = min(waist, shoulder - 0.03)
    edge = min(edge, waist - 0.015)
    low = min(low, edge - 0.010)
    rows = [(w - 0.035 + flare, low), (w - 0.008 + flare, edge), (w, waist), (w - 0.030, shoulder)]
    # How far the greenhouse has risen over the shoulder here: 0 on the bonnet.
    rise = top - shoulder
    lean = 0.30
    if HATCH <= z <= WINDSCREEN and rise > 0.02:
        foot = (w - 0.055, shoulder + min(0.03, 0.3 * rise))
        head_y = top - min(0.075, 0.25 * rise) - 0.012
        head = (foot[0] - lean * (head_y - foot[1]), max(head_y, foot[1] + 0.004))
        edge_row = (head[0] - 0.035, top - min(0.030, 0.12 * rise))
        beside = (0.5 * edge_row[0], top - 0.006)
        return rows + [foot, head, edge_row, beside, (0, top)]
    inner = w - 0.030
    crown = [(inner * f, shoulder + rise * (1 - f ** 2)) for f in (0.96, 0.90, 0.82, 0.42)]
    return rows + crown + [(0, top)]


class Mesh:
    """Faces by material; `mirrored` adds each of them on the other side too."""

    def __init__(self):
        self.faces = []

    def add(self, material, *points):
        points = [p for i, p in enumerate(points) if math.dist(p, points[i - 1]) > 1e-6]
        if len(points) >= 3:
            self.faces.append((material, points))

    def mirrored(self, material, *points):
        self.add(material, *points)
        self.add(material, *[(-x, y, z) for x, y, z in reversed(points)])

    def write(self, path, heading):
        normals = [normal(points) for _, points in self.faces]
        around = {}
        for i, (_, points) in enumerate(self.faces):
            for p in points:
                around.setdefault(key(p), []).append(i)
        lines, vertices, directions, last = [], {}, {}, None
        body = []
        for (material, points), own in sorted(zip(self.faces, normals), key=lambda f: f[0][0]):
            if material != last:
                body.append(f"usemtl {material}")
                last = material
            corners = []
            for p in points:
                n = [0.0, 0.0, 0.0]
                for i in around[key(p)]:
                    if sum(a * b for a, b in zip(own[0], normals[i][0])) >= CREASE:
                        n = [a + normals[i][1] * b for a, b in zip(n, normals[i][0])]
                length = math.sqrt(sum(a * a for a in n)) or 1
                n = tuple(round(a / length, 3) + 0.0 for a in n)
                v = vertices.setdefault(key(p), len(vertices) + 1)
                d = directions.setdefault(n, len(directions) + 1)
                corners.append(f"{v}//{d}")
            body.append("f " + " ".join(corners))
        lines += [f"# {heading}", "# Made by scripts/make_hatchback.py; do not edit.", "mtllib hatchback.mtl"]
        lines += ["v " + " ".join(f"{c:.4g}" for c in v) for v in vertices]
        lines += ["vn " + " ".join(f"{c:g}" for c in n) for n in directions]
        path.write_text("\n".join(lines + body) + "\n")


def key(p):
    return tuple(round(c, 4) + 0.0 for c in p)


def normal(points):
    """Unit normal and area of a plane polygon [Newell]."""
    n = [0.0, 0.0, 0.0]
    for a, b in zip(points, points[1:] + points[:1]):
        n[0] += (a[1] - b[1]) * (a[2] + b[2])
        n[1] += (a[2] - b[2]) * (a[0] + b[0])
        n[2] += (a[0] - b[0]) * (a[1] + b[1])
    length = math.sqrt(sum(c * c for c in n)) or 1
    return [c / length for c in n], length / 2


def body_material(front, back, row):
    middle = (front + back) / 2
    if row == 0:
        return "plastic"
    if row in (1, 2) and any(gap - GAP - 1e-6 <= middle <= gap + 1e-6 for gap in DOOR_GAPS):
        return "gap"
    if row == 4 and any(end < middle < start for start, end in SIDE_GLASS):
        return "glass"
    if row == 4 and -0.36 < middle < -0.24:
        return "plastic"
    if row >= 6 and (ROOF_FRONT < middle < WINDSCREEN or HATCH + 0.05 < middle < ROOF_REAR - 0.05):
        return "glass"
    if row == 2 and middle > 1.72:
        return "lamp"
    if row == 2 and middle < -1.76:
        return "tail"
    return "paint"


def add_shell(mesh, zs):
    sections = [section(z) for z in zs]
    for (front, rows), (back, next_rows) in zip(zip(zs, sections), zip(zs[1:], sections[1:])):
        for i in range(ROWS - 1):
            a, b = (*rows[i], front), (*rows[i + 1], front)
            c, d = (*next_rows[i + 1], back), (*next_rows[i], back)
            mesh.mirrored(body_material(front, back, i), a, d, c, b)
        well = arch(front) is not None and arch(back) is not None
        floor = [FLOOR(front), FLOOR(back)]
        edge = [rows[0][0], next_rows[0][0]]
        if well:
            low = [(*rows[0], front), (*next_rows[0], back)]
            roof = [(WELL, y, z) for x, y, z in low]
            mesh.mirrored("gap", low[0], roof[0], roof[1], low[1])
            mesh.mirrored("gap", roof[0], (WELL, floor[0], front), (WELL, floor[1], back), roof[1])
            edge = [WELL, WELL]
        mesh.mirrored("plastic", (edge[0], floor[0], front), (0, floor[0], front), (0, floor[1], back),
                      (edge[1], floor[1], back))
    # The ends of the wheel wells.
    for axle in AXLES:
        for z, side in ((axle + ARCH_RADIUS, 1), (axle - ARCH_RADIUS, -1)):
            x = section(z)[0][0]
            corners = [(WELL, SILL, z), (x, SILL, z), (x, HUB + 0.02, z), (WELL, HUB + 0.02, z)]
            mesh.mirrored("gap", *(corners if side < 0 else corners[::-1]))


def add_end(mesh, z, lights, out):
    """Closes the nose or the tail: strips from side to side, split where lights and grille are."""
    rows = section(z)
    splits = (1, 0.52, 0)
    for i in range(ROWS - 1):
        (x0, y0), (x1, y1) = rows[i], rows[i + 1]
        for outer, inner in zip(splits, splits[1:]):
            material = "paint"
            if i == 0:
                material = "plastic"
            if i == 2:
                material = lights if outer == 1 else ("gap" if out > 0 else "paint")
            corners = [(x0 * outer, y0, z), (x1 * outer, y1, z), (x1 * inner, y1, z), (x0 * inner, y0, z)]
            mesh.mirrored(material, *(corners if out > 0 else corners[::-1]))


def add_box(mesh, material, center, half, both=True):
    (cx, cy, cz), (hx, hy, hz) = center, half
    p = [(cx + sx * hx, cy + sy * hy, cz + sz * hz) for sx in (-1, 1) for sy in (-1, 1) for sz in (-1, 1)]
    for face in ((0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)):
        (mesh.mirrored if both else mesh.add)(material, *[p[i] for i in face])


def make_body():
    mesh = Mesh()
    zs = stations()
    add_shell(mesh, zs)
    add_end(mesh, zs[0], "lamp", 1)
    add_end(mesh, zs[-1], "tail", -1)
    # Mirrors, door handles, plates.
    add_box(mesh, "paint", (0.845, 0.965, 0.55), (0.075, 0.050, 0.045))
    add_box(mesh, "plastic", (0.765, 0.935, 0.55), (0.03, 0.014, 0.02))
    for z in (-0.16, -0.92):
        add_box(mesh, "plastic", (HALF_WIDTH(z) - 0.006, 0.775, z), (0.012, 0.012, 0.07))
    add_box(mesh, "plate", (0, 0.42, 1.925), (0.25, 0.055, 0.006), both=False)
    add_box(mesh, "plate", (0, 0.62, -1.925), (0.25, 0.055, 0.006), both=False)
    return mesh


def make_wheel():
    """A lathe about x: the tire, and a rim of five spokes; the outside is +x."""
    mesh = Mesh()
    r, half = WHEEL_RADIUS, WHEEL_WIDTH / 2
    tire = [(0.62 * r, -half + 0.01), (0.70 * r, -half), (0.92 * r, -half), (r, -half + 0.025), (r, half - 0.025),
            (0.92 * r, half), (0.70 * r, half), (0.66 * r, half - 0.012)]
    sides = 30

    def point(radius, x, i):
        angle = 2 * math.pi * i / sides
        return (x, radius * math.cos(angle), radius * math.sin(angle))

    def ring(material, inner, outer, i):
        mesh.add(material, point(*inner, i), point(*outer, i), point(*outer, i + 1), point(*inner, i + 1))

    for i in range(sides):
        for a, b in zip(tire, tire[1:]):
            ring("rubber", b, a, i)
        ring("rim", (0.60 * r, half - 0.02), (0.66 * r, half - 0.012), i)
        spoke = i % 6 in (0, 1, 2)
        ring("rim" if spoke else "gap", (0.20 * r, half - 0.012 if spoke else half - 0.06),
             (0.60 * r, half - 0.02 if spoke else half - 0.06), i)
        if not spoke:
            ring("gap", (0.60 * r, half - 0.06), (0.60 * r, half - 0.02), i)
        mesh.add("rim", point(0.20 * r, half - 0.012, i + 1), (half - 0.006, 0, 0), point(0.20 * r, half - 0.012, i))
        # The faces of a spoke that look along the rim.
        if i % 6 in (0, 3):
            corners = [point(0.20 * r, half - 0.012, i), point(0.60 * r, half - 0.02, i), point(0.60 * r, half - 0.06, i),
                       point(0.20 * r, half - 0.06, i)]
            mesh.add("rim", *(corners if i % 6 == 3 else corners[::-1]))
        mesh.add("gap", point(0.62 * r, -half + 0.01, i), (-half + 0.02, 0, 0), point(0.62 * r, -half + 0.01, i + 1))
    return mesh


def write_materials(path):
    lines = ["# Made by scripts/make_hatchback.py; do not edit."]
    for name, (color, opacity, roughness, metalness) in MATERIALS.items():
        lines += [f"newmtl {name}", "Kd " + " ".join(f"{c:g}" for c in color), f"d {opacity}", f"Pr {roughness}",
                  f"Pm {metalness}"]
    path.write_text("\n".join(lines) + "\n")


def main():
    folder = Path(sys.argv[1]) if len(sys.argv) > 1 else Path(__file__).resolve().parent.parent / "assets/data/vehicles"
    make_body().write(folder / "hatchback.obj", "A hatchback, for hatchback.car.json.")
    make_wheel().write(folder / "hatchback_wheel.obj", "A wheel; the axle is x, the outside +x.")
    write_materials(folder / "hatchback.mtl")


if __name__ == "__main__":
    main()
