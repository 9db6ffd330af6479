"""Rigs as Collada and BVH, which say their units and axes or do not."""
from rigs.gltf import boxes, matrix
from rigs.vectors import mul, sub, unit


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
