"""A few vectors, as lists of three numbers, and rotations."""
import math


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
