#!/usr/bin/env python3
"""Writes the small rigs of tests/data/rigs, and what is true of them: expected.json.

Each is a body made of boxes around its bones, in one of the ways that bodies come: posed, half rigged, with a tail, in
inches. Run without arguments from anywhere; what it writes is the same every time.
"""
import base64
import copy
import json
import math
import pathlib
import struct

OUT = pathlib.Path(__file__).resolve().parent.parent / "tests" / "data" / "rigs"


# -- a few vectors and rotations

def add(a, b): return [x + y for x, y in zip(a, b)]
def sub(a, b): return [x - y for x, y in zip(a, b)]
def mul(s, a): return [s * x for x in a]
def dot(a, b): return sum(x * y for x, y in zip(a, b))
def cross(a, b): return [a[1]*b[2] - a[2]*b[1], a[2]*b[0] - a[0]*b[2], a[0]*b[1] - a[1]*b[0]]
def norm(a): return math.sqrt(dot(a, a))
def unit(a): return mul(1 / norm(a), a) if norm(a) > 0 else [0.0, 1.0, 0.0]


def turned(v, axis, degrees):
    """Rodrigues' formula."""
    a, c, s = unit(axis), math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
    return add(add(mul(c, v), mul(s, cross(a, v))), mul((1 - c) * dot(a, v), a))


# -- bodies: bones with a name, a parent, a place, a thickness and an end

class Rig:
    def __init__(self, plan, names=True):
        self.plan, self.bones, self.roles, self.named = plan, [], {}, names

    def bone(self, name, parent, place, role=None, side="middle", end=None, thick=0.05, skin=True):
        self.bones.append(dict(name=name, parent=self.index(parent), place=list(map(float, place)), end=end,
                               thick=thick, skin=skin))
        if role:
            self.roles[name] = (role, side)
        return self

    def index(self, name):
        return next((i for i, b in enumerate(self.bones) if b["name"] == name), -1)

    def get(self, name):
        return self.bones[self.index(name)]

    def below(self, name):
        found = [self.index(name)]
        for i, b in enumerate(self.bones):
            if b["parent"] in found:
                found.append(i)
        return found

    def without(self, *names):
        """Leaves out bones with all below them."""
        gone = {i for name in names for i in self.below(name)}
        kept = [i for i in range(len(self.bones)) if i not in gone]
        for i in gone:
            self.roles.pop(self.bones[i]["name"], None)
        bones = [self.bones[i] for i in kept]
        for b in bones:
            b["parent"] = kept.index(b["parent"]) if b["parent"] >= 0 else -1
        self.bones = bones
        return self

    def turn(self, name, axis, degrees):
        """Turns a bone with all below it about its joint."""
        pivot = self.get(name)["place"]
        for i in self.below(name):
            b = self.bones[i]
            b["place"] = add(pivot, turned(sub(b["place"], pivot), axis, degrees))
            if b["end"]:
                b["end"] = add(pivot, turned(sub(b["end"], pivot), axis, degrees))
        return self

    def map(self, f):
        for b in self.bones:
            b["place"] = f(b["place"])
            if b["end"]:
                b["end"] = f(b["end"])
        return self

    def anonymous(self, pattern="b%d"):
        names = {b["name"]: (pattern % i if "%" in pattern else pattern) for i, b in enumerate(self.bones)}
        self.numbers = {self.index(name): role for name, role in self.roles.items()}
        for b in self.bones:
            b["name"] = names[b["name"]]
        self.roles = None
        return self

    def rolesByIndex(self):
        if self.roles is None:
            return self.numbers
        return {self.index(name): role for name, role in self.roles.items()}

    def ends(self, i):
        b = self.bones[i]
        if b["end"]:
            return b["end"]
        children = [c for c in self.bones if c["parent"] == i and c["skin"]]
        if not children:
            return b["place"]
        return mul(1 / len(children), [sum(c["place"][k] for c in children) for k in range(3)])


SIDES = (("left", "Left", 1), ("right", "Right", -1))


def human(fingers=True, height=1.75):
    """A person in T-pose who faces z, after Winter 2009."""
    r = Rig("human")
    r.bone("Hips", None, [0, .96, 0], "pelvis", thick=.13)
    r.bone("Spine", "Hips", [0, 1.06, 0], "abdomen", thick=.12)
    r.bone("Chest", "Spine", [0, 1.20, 0], "chest", end=[0, 1.45, 0], thick=.14)
    r.bone("Neck", "Chest", [0, 1.47, 0], "head", thick=.05)
    r.bone("Head", "Neck", [0, 1.56, .02], end=[0, 1.75, .02], thick=.09)
    for side, s, x in SIDES:
        r.bone(s + "Shoulder", "Chest", [.03*x, 1.42, 0], thick=.05)
        r.bone(s + "Arm", s + "Shoulder", [.19*x, 1.43, 0], "upperArm", side, thick=.05)
        r.bone(s + "ForeArm", s + "Arm", [.50*x, 1.43, 0], "forearm", side, thick=.04)
        r.bone(s + "Hand", s + "ForeArm", [.75*x, 1.43, 0], "hand", side, end=[.93*x, 1.43, 0], thick=.025)
        if fingers:
            addFingers(r, s, x)
        r.bone(s + "UpLeg", "Hips", [.10*x, .92, 0], "thigh", side, thick=.08)
        r.bone(s + "Leg", s + "UpLeg", [.10*x, .50, .01], "shank", side, thick=.055)
        r.bone(s + "Foot", s + "Leg", [.10*x, .08, -.02], "foot", side, thick=.04)
        r.bone(s + "Toe", s + "Foot", [.10*x, .03, .12], end=[.10*x, .03, .20], thick=.03)
    return r.map(lambda p: mul(height / 1.75, p)) if height != 1.75 else r


def addFingers(r, s, x):
    for i, finger in enumerate(("Index", "Middle", "Ring", "Pinky")):
        z = .03 - .02 * i
        r.bone(f"{s}Hand{finger}1", s + "Hand", [.84*x, 1.43, z], thick=.009)
        r.bone(f"{s}Hand{finger}2", f"{s}Hand{finger}1", [.88*x, 1.43, z], end=[.93*x, 1.43, z], thick=.008)


def quadruped(neck=.25, leg=.5, body=.6, tail=True):
    """Stands along z; shoulders and hips at the height of its legs."""
    r = Rig("quadruped")
    h = leg * 1.1
    r.bone("Pelvis", None, [0, h, -body/2], "pelvis", thick=.25*body)
    r.bone("Spine1", "Pelvis", [0, h + .02, -body/6], "abdomen", thick=.25*body)
    r.bone("Spine2", "Spine1", [0, h + .02, body/6], "chest", end=[0, h, body/2], thick=.27*body)
    if neck > .4:
        r.bone("Neck1", "Spine2", [0, h + .1, body/2], "neck", thick=.1*body)
        r.bone("Neck2", "Neck1", [0, h + .1 + .35*neck, body/2 + .25*neck], thick=.09*body)
        r.bone("Head", "Neck2", [0, h + .1 + .7*neck, body/2 + .5*neck], "head", end=[0, h + .7*neck, body/2 + .9*neck],
               thick=.1*body)
    else:
        r.bone("Neck1", "Spine2", [0, h + .05, body/2], "head", thick=.12*body)
        r.bone("Head", "Neck1", [0, h + .05 + .4*neck, body/2 + .4*neck], end=[0, h + .05 + .4*neck, body/2 + neck],
               thick=.13*body)
    for side, s, x in SIDES:
        w = .12 * body * x / .6
        r.bone(s + "FrontScapula", "Spine2", [w, h, .42*body], thick=.05*leg)
        r.bone(s + "FrontUpperLeg", s + "FrontScapula", [w, h - .12*leg, .5*body], "upperArm", side, thick=.1*leg)
        r.bone(s + "FrontLowerLeg", s + "FrontUpperLeg", [w, .62*leg, .42*body], "forearm", side, thick=.08*leg)
        r.bone(s + "FrontPaw", s + "FrontLowerLeg", [w, .25*leg, .44*body], "hand", side, end=[w, 0, .5*body],
               thick=.07*leg)
        r.bone(s + "HindUpperLeg", "Pelvis", [w, h - .05*leg, -.5*body], "thigh", side, thick=.12*leg)
        r.bone(s + "HindLowerLeg", s + "HindUpperLeg", [w, .65*leg, -.4*body], "shank", side, thick=.09*leg)
        r.bone(s + "HindPaw", s + "HindLowerLeg", [w, .3*leg, -.56*body], "foot", side, end=[w, 0, -.48*body],
               thick=.07*leg)
    if tail:
        addTail(r, "Pelvis", [0, h, -.55*body], [0, -.05, -.12*body/.6], 4)
    return r


def addTail(r, parent, start, step, count):
    for i in range(count):
        place = add(start, mul(i, step))
        end = add(place, step) if i + 1 == count else None
        r.bone(f"Tail{i+1}", parent, place, "tail", end=end, thick=.03)
        parent = f"Tail{i+1}"


def bird():
    r = Rig("bird")
    r.bone("Pelvis", None, [0, .30, -.06], "pelvis", thick=.06)
    r.bone("Chest", "Pelvis", [0, .34, .02], "chest", end=[0, .38, .14], thick=.08)
    r.bone("Neck", "Chest", [0, .40, .14], "head", thick=.03)
    r.bone("Head", "Neck", [0, .48, .18], end=[0, .48, .28], thick=.03)
    for side, s, x in SIDES:
        r.bone(s + "Wing1", "Chest", [.05*x, .38, .08], "upperArm", side, thick=.025)
        r.bone(s + "Wing2", s + "Wing1", [.20*x, .38, .05], "forearm", side, thick=.02)
        r.bone(s + "Wing3", s + "Wing2", [.38*x, .38, .08], "hand", side, end=[.62*x, .38, .02], thick=.015)
        r.bone(s + "Thigh", "Pelvis", [.05*x, .29, -.04], "thigh", side, thick=.025)
        r.bone(s + "Shin", s + "Thigh", [.05*x, .20, .01], "shank", side, thick=.015)
        r.bone(s + "Tarsus", s + "Shin", [.05*x, .09, -.04], "foot", side, end=[.05*x, .005, .03], thick=.01)
    return r


def insect(pairs=3, names=True):
    r = Rig("hexapod")
    n = "%s%s%d"
    r.bone("Thorax", None, [0, .10, 0], "pelvis", end=[0, .10, .08], thick=.05)
    r.bone("Head", "Thorax", [0, .10, .14], "head", end=[0, .10, .22], thick=.04)
    r.bone("Abdomen", "Thorax", [0, .10, -.14], end=[0, .12, -.34], thick=.06)
    for i in range(pairs):
        z = .10 - .20 * i / (pairs - 1)
        for side, s, x in SIDES:
            spread = (i - (pairs - 1) / 2) * -.08
            r.bone(n % (s, "Coxa", i), "Thorax", [.05*x, .10, z], None, side, thick=.012)
            r.bone(n % (s, "Femur", i), n % (s, "Coxa", i), [.08*x, .10, z + .1*spread], "thigh", side, thick=.012)
            r.bone(n % (s, "Tibia", i), n % (s, "Femur", i), [.22*x, .17, z + spread], "shank", side, thick=.01)
            r.bone(n % (s, "Tarsus", i), n % (s, "Tibia", i), [.34*x, .04, z + 1.5*spread], "foot", side,
                   end=[.38*x, 0, z + 1.6*spread], thick=.008)
    return r


def snake():
    r = Rig("other")
    for i in range(10):
        r.bone(f"s{i}", f"s{i-1}" if i else None, [0, .03, .15*i], end=[0, .03, 1.5] if i == 9 else None, thick=.03)
    return r


# -- glTF

class Buffer:
    def __init__(self):
        self.bytes, self.views, self.accessors = b"", [], []

    def put(self, values, form, kind, component, bounds=False):
        width = {"SCALAR": 1, "VEC3": 3, "VEC4": 4, "MAT4": 16}[kind]
        flat = [x for v in values for x in (v if isinstance(v, (list, tuple)) else [v])]
        data = struct.pack("<%d%s" % (len(flat), form), *flat)
        self.bytes += b"\0" * (-len(self.bytes) % 4)
        self.views.append(dict(buffer=0, byteOffset=len(self.bytes), byteLength=len(data)))
        self.bytes += data
        entry = dict(bufferView=len(self.views) - 1, componentType=component, count=len(flat) // width, type=kind)
        if bounds:
            entry["min"] = [min(v[k] for v in values) for k in range(width)]
            entry["max"] = [max(v[k] for v in values) for k in range(width)]
        self.accessors.append(entry)
        return len(self.accessors) - 1


RING = [(-1, -1), (1, -1), (1, 1), (-1, 1)]


def boxes(rig):
    """A box around each bone with skin, of two halves: vertices, owners, triangles."""
    vertices, owners, triangles = [], [], []
    for i, b in enumerate(rig.bones):
        if not b["skin"]:
            continue
        start, end = b["place"], rig.ends(i)
        along = unit(sub(end, start))
        side = unit(cross(along, [0, 0, 1] if abs(along[2]) < .9 else [1, 0, 0]))
        other = cross(along, side)
        first = len(vertices)
        for t in (0, .5, 1):
            for u, v in RING:
                middle = add(start, mul(t, sub(end, start)))
                vertices.append(add(middle, add(mul(u * b["thick"], side), mul(v * b["thick"], other))))
                owners.append(i)
        quads = [(4*t + k, 4*t + (k + 1) % 4, 4*t + 4 + (k + 1) % 4, 4*t + 4 + k) for t in range(2) for k in range(4)]
        for q in quads + [(3, 2, 1, 0), (8, 9, 10, 11)]:
            triangles += [first + q[0], first + q[1], first + q[2], first + q[0], first + q[2], first + q[3]]
    return vertices, owners, triangles


def matrix(place, scale=1.0):
    """Column by column: the inverse of a bone that is not turned."""
    return [1 / scale, 0, 0, 0, 0, 1 / scale, 0, 0, 0, 0, 1 / scale, 0, *mul(-1 / scale, place), 1]


def gltf(rig, weights=1.0, root=None, rootBack=None, posed=None, extra=(), meshName="body", animated=()):
    """`root`: a node above all; `rootBack`: what its map makes of a place in the scene, reversed; `posed`: places that the
    nodes have instead of those of the bind pose."""
    buffer = Buffer()
    vertices, owners, triangles = boxes(rig)
    back = rootBack or (lambda p: p)
    primitive = dict(attributes=dict(
        POSITION=buffer.put([back(v) for v in vertices], "f", "VEC3", 5126, True),
        JOINTS_0=buffer.put([[o, 0, 0, 0] for o in owners], "B", "VEC4", 5121),
        WEIGHTS_0=buffer.put([[weights, 0, 0, 0]] * len(owners), "f", "VEC4", 5126)),
        indices=buffer.put(triangles, "H", "SCALAR", 5123))
    # Bones in the space of the mesh, which hangs on the same root.
    binds = buffer.put([matrix(back(b["place"])) for b in rig.bones], "f", "MAT4", 5126)
    nodes, tops = [], []
    places = posed or [b["place"] for b in rig.bones]
    for i, b in enumerate(rig.bones):
        parent = b["parent"]
        node = dict(name=b["name"], translation=sub(back(places[i]), back(places[parent]) if parent >= 0 else [0, 0, 0]))
        children = [k for k, c in enumerate(rig.bones) if c["parent"] == i]
        if children:
            node["children"] = children
        nodes.append(node)
        if parent < 0:
            tops.append(i)
    nodes.append(dict(name=meshName, mesh=0, skin=0))
    tops.append(len(nodes) - 1)
    if root:
        nodes.append(dict(name="Armature", children=tops, **root))
        tops = [len(nodes) - 1]
    for node in extra:
        nodes.append(node)
        tops.append(len(nodes) - 1)
    asset = dict(asset=dict(version="2.0", generator="scripts/make_rigs.py"), scene=0, scenes=[dict(nodes=tops)],
                 nodes=nodes, meshes=[dict(name=meshName, primitives=[primitive])],
                 skins=[dict(joints=list(range(len(rig.bones))), inverseBindMatrices=binds)])
    if any("camera" in node for node in extra):
        asset["cameras"] = [dict(type="perspective", perspective=dict(yfov=.8, znear=.1))]
    return finished(asset, buffer)


def finished(asset, buffer):
    asset["accessors"], asset["bufferViews"] = buffer.accessors, buffer.views
    uri = "data:application/octet-stream;base64," + base64.b64encode(buffer.bytes).decode()
    asset["buffers"] = [dict(byteLength=len(buffer.bytes), uri=uri)]
    return json.dumps(rounded(asset), separators=(",", ":")) + "\n"


def rounded(value):
    if isinstance(value, float):
        return round(value, 7)
    if isinstance(value, dict):
        return {key: rounded(v) for key, v in value.items()}
    return [rounded(v) for v in value] if isinstance(value, (list, tuple)) else value


def prop():
    """A lamp whose arm turns: a mesh on nodes, no skin."""
    buffer = Buffer()
    primitive = dict(attributes=dict(POSITION=buffer.put([[0, 0, 0], [.1, 0, 0], [0, .3, 0]], "f", "VEC3", 5126, True)))
    nodes = [dict(name="foot", mesh=0, children=[1]), dict(name="arm", mesh=0, translation=[0, .3, 0], children=[2]),
             dict(name="shade", mesh=0, translation=[0, .3, 0])]
    times = buffer.put([0.0, 1.0], "f", "SCALAR", 5126, False)
    buffer.accessors[times].update(min=[0.0], max=[1.0])
    turns = buffer.put([[0, 0, 0, 1], [0, 0, .3827, .9239]], "f", "VEC4", 5126)
    asset = dict(asset=dict(version="2.0"), scene=0, scenes=[dict(nodes=[0])], nodes=nodes,
                 meshes=[dict(primitives=[primitive])],
                 animations=[dict(channels=[dict(sampler=0, target=dict(node=1, path="rotation"))],
                                  samplers=[dict(input=times, output=turns)])])
    return finished(asset, buffer)


def stage():
    """Cameras and a light on a rig of their own."""
    nodes = [dict(name="dolly", children=[1, 2]), dict(name="Camera", camera=0, translation=[0, 1, 4]),
             dict(name="crane", translation=[0, 2, 0], children=[3]), dict(name="Camera2", camera=0)]
    return json.dumps(dict(asset=dict(version="2.0"), scene=0, scenes=[dict(nodes=[0])], nodes=nodes,
                           cameras=[dict(type="perspective", perspective=dict(yfov=.8, znear=.1))])) + "\n"


# -- Collada and BVH, which say their units and axes or do not

def dae(rig, meter, up):
    turn = {"Y_UP": lambda p: p, "Z_UP": lambda p: [p[0], -p[2], p[1]], "X_UP": lambda p: [p[1], -p[0], p[2]]}[up]
    place = lambda p: mul(1 / meter, turn(p))
    vertices, owners, triangles = boxes(rig)
    numbers = lambda values: " ".join("%.6g" % x for x in values)
    flat = lambda rows: [x for row in rows for x in row]
    row = lambda t: [1, 0, 0, t[0], 0, 1, 0, t[1], 0, 0, 1, t[2], 0, 0, 0, 1]

    def node(i, indent):
        b = rig.bones[i]
        above = place(rig.bones[b["parent"]]["place"]) if b["parent"] >= 0 else [0, 0, 0]
        lines = [f'{indent}<node id="j{i}" sid="j{i}" name="{b["name"]}" type="JOINT">',
                 f'{indent} <matrix>{numbers(row(sub(place(b["place"]), above)))}</matrix>']
        for k, c in enumerate(rig.bones):
            if c["parent"] == i:
                lines += node(k, indent + " ")
        return lines + [f"{indent}</node>"]

    source = lambda name, kind, values, stride, count, params: (
        f'<source id="{name}"><{kind} id="{name}a" count="{len(values) if kind != "Name_array" else count}">'
        f'{numbers(values) if kind != "Name_array" else " ".join(values)}</{kind}><technique_common>'
        f'<accessor source="#{name}a" count="{count}" stride="{stride}">{params}</accessor></technique_common></source>')
    names = [f"j{i}" for i in range(len(rig.bones))]
    binds = flat([row(mul(-1, place(b["place"]))) for b in rig.bones])
    xyz = '<param name="X" type="float"/><param name="Y" type="float"/><param name="Z" type="float"/>'
    return "\n".join([
        '<?xml version="1.0" encoding="utf-8"?>',
        '<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">',
        f'<asset><unit name="unit" meter="{meter}"/><up_axis>{up}</up_axis></asset>',
        '<library_geometries><geometry id="g"><mesh>',
        source("p", "float_array", flat([place(v) for v in vertices]), 3, len(vertices), xyz),
        '<vertices id="v"><input semantic="POSITION" source="#p"/></vertices>',
        f'<triangles count="{len(triangles) // 3}"><input semantic="VERTEX" source="#v" offset="0"/>'
        f'<p>{" ".join(map(str, triangles))}</p></triangles>',
        '</mesh></geometry></library_geometries>',
        '<library_controllers><controller id="c"><skin source="#g">',
        f'<bind_shape_matrix>{numbers(row([0, 0, 0]))}</bind_shape_matrix>',
        source("cj", "Name_array", names, 1, len(names), '<param name="JOINT" type="name"/>'),
        source("cb", "float_array", binds, 16, len(names), '<param name="TRANSFORM" type="float4x4"/>'),
        source("cw", "float_array", [1.0], 1, 1, '<param name="WEIGHT" type="float"/>'),
        '<joints><input semantic="JOINT" source="#cj"/><input semantic="INV_BIND_MATRIX" source="#cb"/></joints>',
        f'<vertex_weights count="{len(owners)}"><input semantic="JOINT" source="#cj" offset="0"/>'
        '<input semantic="WEIGHT" source="#cw" offset="1"/>'
        f'<vcount>{" ".join("1" for _ in owners)}</vcount><v>{" ".join("%d 0" % o for o in owners)}</v></vertex_weights>',
        '</skin></controller></library_controllers>',
        '<library_visual_scenes><visual_scene id="s">', *node(0, " "),
        ' <node id="m"><instance_controller url="#c"><skeleton>#j0</skeleton></instance_controller></node>',
        '</visual_scene></library_visual_scenes><scene><instance_visual_scene url="#s"/></scene>', '</COLLADA>', ''])


def bvh(rig, unit_):
    def node(i, indent):
        b = rig.bones[i]
        above = rig.bones[b["parent"]]["place"] if b["parent"] >= 0 else [0, 0, 0]
        offset = " ".join("%.5f" % x for x in mul(1 / unit_, sub(b["place"], above)))
        root = b["parent"] < 0
        channels = "6 Xposition Yposition Zposition " if root else "3 "
        lines = [f'{indent}{"ROOT" if root else "JOINT"} {b["name"]}', indent + "{", f"{indent} OFFSET {offset}",
                 f"{indent} CHANNELS {channels}Zrotation Xrotation Yrotation"]
        children = [k for k, c in enumerate(rig.bones) if c["parent"] == i]
        for k in children:
            lines += node(k, indent + " ")
        if not children:
            tip = " ".join("%.5f" % x for x in mul(1 / unit_, sub(rig.ends(i), b["place"])))
            lines += [indent + " End Site", indent + " {", f"{indent}  OFFSET {tip}", indent + " }"]
        return lines + [indent + "}"]

    channels = 3 * len(rig.bones) + 3
    start = " ".join("%.5f" % x for x in mul(1 / unit_, rig.bones[0]["place"]))
    frame = start + " 0" * (channels - 3)
    bend = start + " 5" * (channels - 3)
    return "\n".join(["HIERARCHY", *node(0, ""), "MOTION", "Frames: 2", "Frame Time: 0.04", frame, bend, ""])


# -- the set

def scaled(rig, head=1.0, limbs=1.0):
    """A stylised body: limbs shortened towards their joints at the trunk, head enlarged."""
    for side, s, x in SIDES:
        for top in (s + "UpLeg", s + "Arm"):
            pivot = list(rig.get(top)["place"])
            for i in rig.below(top):
                b = rig.bones[i]
                b["place"] = add(pivot, mul(limbs, sub(b["place"], pivot)))
                if b["end"]:
                    b["end"] = add(pivot, mul(limbs, sub(b["end"], pivot)))
    pivot = list(rig.get("Head")["place"])
    b = rig.get("Head")
    b["end"] = add(pivot, mul(head, sub(b["end"], pivot)))
    b["thick"] *= head
    return rig


def sitting():
    r = human()
    for side, s, x in SIDES:
        r.turn(s + "UpLeg", [1, 0, 0], -90).turn(s + "Leg", [1, 0, 0], 90).turn(s + "Arm", [0, 0, 1], -70 * x)
    return r


def striding():
    r = human()
    r.turn("Spine", [1, 0, 0], 15).turn("Chest", [0, 1, 0], 20)
    r.turn("LeftUpLeg", [1, 0, 0], -35).turn("LeftLeg", [1, 0, 0], 20)
    r.turn("RightUpLeg", [1, 0, 0], 25).turn("RightLeg", [1, 0, 0], 40)
    r.turn("LeftArm", [0, 0, 1], -75).turn("LeftForeArm", [1, 0, 0], -60)
    r.turn("RightArm", [0, 0, 1], -40).turn("RightForeArm", [0, 1, 0], 80)
    return r


def legsBeside():
    r = Rig("human")
    r.bone("Root", None, [0, .96, 0], thick=.02)
    r.bone("Pelvis", "Root", [0, .96, 0], "pelvis", thick=.13)
    r.bone("LegRoot", "Root", [0, .95, 0], thick=.05)
    h = human()
    for i, b in enumerate(h.bones):
        if b["parent"] < 0:
            continue
        parent = h.bones[b["parent"]]["name"]
        if parent == "Hips":
            parent = "LegRoot" if "Leg" in b["name"] else "Pelvis"
        role = h.roles.get(b["name"], (None, "middle"))
        r.bone(b["name"], parent, b["place"], role[0], role[1], b["end"], b["thick"])
    return r


def withTwist():
    r = human()
    for side, s, x in SIDES:
        r.bone(s + "UpLegTwist", s + "UpLeg", [.10*x, .71, 0], thick=.08)
        r.bone(s + "ForeArmTwist", s + "ForeArm", [.62*x, 1.43, 0], thick=.04)
    return r


def withWings(r, parent, place, named=True):
    for side, s, x in SIDES:
        base = s + ("Wing" if named else "Extra")
        at = [place[0]*x, place[1], place[2]]
        r.bone(base + "A", parent, at, "wing", side, thick=.03)
        r.bone(base + "B", base + "A", add(at, [.45*x, .25, -.15]), "wing", side, thick=.03)
        r.bone(base + "C", base + "B", add(at, [.95*x, .20, -.35]), "wing", side, end=add(at, [1.5*x, -.1, -.45]), thick=.02)
    return r


def withCape(r):
    for i in range(5):
        x = .08 * (i - 2)
        for k in range(3):
            name = f"Cape{i}{k}"
            r.bone(name, f"Cape{i}{k-1}" if k else "Chest", [x, 1.4 - .3*k, -.16], thick=.02,
                   end=[x, .5, -.2] if k == 2 else None)
    return r


def controls(r):
    for name, place in (("LeftFootIK", [.1, .08, -.02]), ("LeftKneePole", [.1, .5, .6]), ("RightHandIK", [-.75, 1.43, 0])):
        r.bone(name, "Hips", place, thick=.01, skin=False)
    return r


def centimetresBelowAScaledRoot(r):
    return dict(root=dict(scale=[.01, .01, .01]), rootBack=lambda p: mul(100, p))


def main():
    OUT.mkdir(parents=True, exist_ok=True)
    expected = {}

    def note(file, rig, **more):
        entry = dict(plan=rig.plan, bones=[dict(name=b["name"], place=rounded(b["place"])) for b in rig.bones if b["skin"]])
        skinned = [i for i, b in enumerate(rig.bones) if b["skin"]]
        entry["roles"] = [dict(bone=skinned.index(i), role=role, side=side)
                          for i, (role, side) in sorted(rig.rolesByIndex().items())]
        entry.update(more)
        expected[file] = entry

    def write(name, rig, text, extension="gltf", **more):
        (OUT / f"{name}.{extension}").write_text(text)
        note(f"{name}.{extension}", rig, **more)

    def asGltf(name, rig, more=None, **options):
        write(name, rig, gltf(rig, **options), **(more or {}))

    asGltf("human", human())
    asGltf("human_nameless", human().anonymous())
    asGltf("human_equal_names", human().anonymous("bone"), meshName="bone")
    asGltf("human_sitting", sitting())
    asGltf("human_sitting_nameless", sitting().anonymous())
    asGltf("human_striding", striding())
    asGltf("human_striding_nameless", striding().anonymous())
    oneHanded = human(fingers=False)
    addFingers(oneHanded, "Left", 1)
    asGltf("human_one_handed", oneHanded)
    asGltf("human_one_handed_nameless", copy.deepcopy(oneHanded).anonymous())

    def skinOnly(names, rig=None):
        rig = rig or human()
        for name in names:
            child = rig.get(name)
            parent = rig.bones[child["parent"]]
            tip = rig.bones[rig.below(name)[-1]]
            parent["end"] = tip["end"] or tip["place"]
        return rig.without(*names)

    def cutOff(names):
        rig = human()
        for name in names:
            child = rig.get(name)
            rig.bones[child["parent"]]["end"] = child["place"]
        return rig.without(*names)

    hands, feet = ("LeftHand", "RightHand"), ("LeftFoot", "RightFoot")
    asGltf("human_no_hands", cutOff(hands))
    asGltf("human_no_feet", cutOff(feet))
    asGltf("human_no_hands_no_feet", cutOff(hands + feet))
    asGltf("human_hands_of_skin", skinOnly(hands))
    asGltf("human_feet_of_skin", skinOnly(feet))
    asGltf("human_one_hand_of_skin", skinOnly(hands[:1]))
    asGltf("human_one_foot_of_skin_nameless", skinOnly(feet[:1]).anonymous())
    asGltf("human_legs_beside_pelvis", legsBeside())
    asGltf("human_twist_bones", withTwist())
    tailed = human()
    addTail(tailed, "Hips", [0, .95, -.12], [0, -.08, -.12], 4)
    asGltf("human_tail", tailed)
    asGltf("human_wings", withWings(human(), "Chest", [.08, 1.4, -.12]))
    asGltf("human_cape", withCape(human()))
    oneArmed = human().without("RightShoulder")
    asGltf("human_one_armed", oneArmed, more=dict(warns="one arm is missing"))
    asGltf("human_one_legged", human().without("RightUpLeg"), more=dict(warns="one leg is missing"))
    asGltf("human_cameras", human(), extra=[
        dict(name="Camera", camera=0, translation=[0, 1, 4]), dict(name="Camera.Target", translation=[0, 1, 0])])
    asGltf("human_controls", controls(human()), more=dict(warns="move no vertex"))
    asGltf("human_scaled_root", human(), **centimetresBelowAScaledRoot(human()))
    asGltf("human_mirrored_root", human(), root=dict(scale=[-1, 1, 1]), rootBack=lambda p: [-p[0], p[1], p[2]])
    asGltf("human_posed_nodes", human(), posed=[b["place"] for b in striding().bones],
           more=dict(warns="do not stand in the bind pose"))
    asGltf("human_weights_low", human(), weights=.2, more=dict(warns="normalised"))
    asGltf("human_weights_high", human(), weights=1.4, more=dict(warns="normalised"))
    asGltf("human_toddler", scaled(human(height=.85), 1.6, .75))
    asGltf("human_stylised", scaled(human(), 3.5, .55))
    for name, meter, up in (("human_centimetres", .01, "Y_UP"), ("human_millimetres_z_up", .001, "Z_UP"),
                            ("human_inches_x_up", .0254, "X_UP")):
        write(name, human(), dae(human(), meter, up), "dae")
    for name, unit_ in (("human_motion_centimetres", .01), ("human_motion_inches", .0254)):
        write(name, human(fingers=False), bvh(human(fingers=False), unit_), "bvh", guessed=unit_)
    asGltf("dog", quadruped())
    asGltf("dog_nameless", quadruped().anonymous())
    asGltf("horse", quadruped(neck=.9, leg=1.1, body=1.2))
    dragon = withWings(quadruped(leg=.7, body=1.0), "Spine2", [.1, .85, .2])
    asGltf("dragon", dragon)
    asGltf("bird", bird())
    asGltf("bird_nameless", bird().anonymous())
    asGltf("insect", insect())
    asGltf("spider", insect(pairs=4))
    asGltf("snake", snake(), more=dict(warns="no limbs leave its trunk"))
    (OUT / "lamp.gltf").write_text(prop())
    expected["lamp.gltf"] = dict(refused="no bones")
    (OUT / "cameras.gltf").write_text(stage())
    expected["cameras.gltf"] = dict(refused="no bones")
    (OUT / "expected.json").write_text(json.dumps(expected, indent=1) + "\n")
    print(len(expected), "rigs")


main()
