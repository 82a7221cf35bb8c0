"""A solver of one's own as an engine of clothcheck: damped springs by symplectic Euler, in Python.

    clothcheck run SCENE --engine 'mine=python3 adapter.py'
"""
import math
import sys


def begin(lines):
    """The scene in SI units, up to the line "end"."""
    scene = {"substeps": 0}
    for line in lines:
        word, *rest = line.split()
        if word == "end":
            break
        if word == "setting":
            scene[rest[0]] = int(float(rest[1]))
        elif word in ("particles", "springs", "colliders"):
            scene[word] = [next(lines).split() for _ in range(int(rest[0]))]
        elif word in ("step", "gravity", "force", "drag"):
            scene[word] = [float(number) for number in rest]
    return Cloth(scene)


class Cloth:
    def __init__(self, scene):
        numbers = [[float(number) for number in row] for row in scene["particles"]]
        self.x, self.v = [row[0:3] for row in numbers], [row[3:6] for row in numbers]
        self.mass, self.pinned = [row[6] for row in numbers], [row[7] > 0 for row in numbers]
        self.springs = [(int(a), int(b), float(rest), float(k), float(c)) for a, b, rest, k, c, _ in scene["springs"]]
        self.frame, self.drag = scene["step"][0], scene["drag"][0]
        self.gravity, self.force = scene["gravity"], scene["force"]
        rates = [8 * k / min(self.mass[a], self.mass[b]) for a, b, _, k, _ in self.springs]
        self.substeps = scene["substeps"] or max(1, math.ceil(self.frame * math.sqrt(max(rates, default=0))))

    def step(self, dt):
        f = [[m * (g - self.drag * v) + p for g, v, p in zip(self.gravity, speed, self.force)]
             for m, speed in zip(self.mass, self.v)]
        for a, b, rest, k, c in self.springs:
            d = [q - p for p, q in zip(self.x[a], self.x[b])]
            length = math.sqrt(sum(e * e for e in d))
            speed = sum(e / length * (w - v) for e, v, w in zip(d, self.v[a], self.v[b]))
            pull = (k * (length - rest) + c * speed) / length
            for axis in range(3):
                f[a][axis] += pull * d[axis]
                f[b][axis] -= pull * d[axis]
        for i, pinned in enumerate(self.pinned):
            for axis in range(0 if pinned else 3):
                self.v[i][axis] += dt * f[i][axis] / self.mass[i]
                self.x[i][axis] += dt * self.v[i][axis]


def main():
    lines = (line.strip() for line in sys.stdin)
    cloth = None
    for line in lines:
        if line == "quit":
            break
        if line == "clothcheck 1":
            print("clothcheck 1")
        elif line == "hello":
            print("version 1.0\nmodels springs damping gravity force drag velocity release\n"
                  "setting substeps 1 1e6 whole steps a frame\nend")
        elif line == "begin":
            cloth = begin(lines)
            print(f"uses substeps {cloth.substeps}\nready")
        elif line.startswith("release "):
            cloth.pinned[int(line.split()[1])] = False
        elif line == "read":
            for x, v in zip(cloth.x, cloth.v):
                print(*map(repr, x + v))
        else:  # step, ping
            for _ in range(cloth.substeps if line == "step" else 0):
                cloth.step(cloth.frame / cloth.substeps)
            print("ok")
        sys.stdout.flush()


main()
