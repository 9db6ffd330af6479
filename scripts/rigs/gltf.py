"""Rigs, and what is none, as glTF."""
import base64
import json
import struct

from rigs.vectors import add, cross, mul, sub, turned, unit


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
