#!/usr/bin/env python3
"""Writes the small rigs of tests/data/rigs, and what is true of them: expected.json.

Each is a body made of boxes around its bones, in one of the ways that bodies come: posed, half rigged, with a tail, in
inches. Run without arguments from anywhere; what it writes is the same every time.
"""
import copy
import json
import pathlib

from rigs.bodies import addFingers, addTail, bird, human, insect, quadruped, snake
from rigs.gltf import gltf, prop, rounded, stage
from rigs.units import bvh, dae
from rigs.variants import (centimetresBelowAScaledRoot, controls, legsBeside, scaled, sitting, striding, withCape,
                           withTwist, withWings)

OUT = pathlib.Path(__file__).resolve().parent.parent / "tests" / "data" / "rigs"


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
