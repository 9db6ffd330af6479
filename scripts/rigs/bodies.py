"""Bodies: bones with a name, a parent, a place, a thickness and an end."""
from rigs.vectors import add, mul, sub, turned


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
