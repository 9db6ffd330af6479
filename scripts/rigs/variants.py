"""The ways that bodies come: posed, half rigged, with more than a body has."""
from rigs.bodies import SIDES, Rig, human
from rigs.vectors import add, mul, sub


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
