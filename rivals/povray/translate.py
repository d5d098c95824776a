#!/usr/bin/env python3
"""Translates a scene in the Neutral File Format to POV-Ray 3.7: translate.py SCENE.nff > SCENE.pov

The geometry is the same to the bit that POV-Ray keeps (the corners of meshes it stores in single precision):

    s               sphere
    c               cone { open } or cylinder { open }
    p, pp           opaque triangles: one mesh for each run of a fill; transparent ones: triangle; more corners: polygon
    v               direction, right and up given as vectors, so that the picture is right-handed and the angle exact

So is the light, as far as POV-Ray allows: lights of sqrt(n)/(2n) each, ambient likewise; a mirror of Ks; transmission of
T untinted. POV-Ray takes the transmitted part off the diffuse and ambient light, NFF does not: both are divided by 1 - T.
What cannot be the same: POV-Ray keeps a list of the objects a ray is in, NFF tells the side of a surface by its normal,
so solids of loose transparent polygons (gears) refract otherwise: about 8 % of their pixels differ, of others 0.01 %.
"""
import math
import sys
from pathlib import Path


class Tokens:
    """The words of an NFF file, without comments; line ends mean nothing."""

    def __init__(self, text):
        self.words = [word for line in text.splitlines() for word in line.split("#")[0].split()]
        self.place = 0

    def more(self):
        return self.place < len(self.words)

    def word(self):
        self.place += 1
        return self.words[self.place - 1]

    def number(self):
        return float(self.word())

    def numbers(self, count):
        return [self.number() for _ in range(count)]

    def numbers_to_the_end(self, most):
        """As many numbers as follow, at most `most`."""
        found = []
        while len(found) < most and self.more() and self.words[self.place][0] in "+-.0123456789":
            found.append(self.number())
        return found


def vector(numbers):
    return "<" + ",".join(repr(number) for number in numbers) + ">"


def subtract(a, b):
    return [x - y for x, y in zip(a, b)]


def cross(a, b):
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def scaled(a, length):
    factor = length / math.sqrt(sum(x * x for x in a))
    return [x * factor for x in a]


def camera(view):
    forward = subtract(view["at"], view["from"])
    right = cross(forward, view["up"])
    size = 2 * math.tan(math.radians(view["angle"][0]) / 2)
    return (
        f"camera {{ perspective location {vector(view['from'])} direction {vector(scaled(forward, 1))}"
        f" right {vector(scaled(right, size))} up {vector(scaled(cross(right, forward), size))} }}"
    )


def texture(fill, share):
    """A fill as a texture, and as an interior where light passes."""
    red, green, blue, diffuse, specular, shininess, transmit, ior = fill
    opaque = 1 - transmit if transmit < 1 else 1
    finish = f"ambient {share * diffuse / opaque!r} diffuse {diffuse / opaque!r} specular 0"
    if specular > 0:
        finish += f" phong {specular!r} phong_size {shininess!r} reflection {{ {specular!r} }}"
    text = f"texture {{ pigment {{ color rgbt <{red!r},{green!r},{blue!r},{transmit!r}> }} finish {{ {finish} }} }}"
    return text + (f" interior {{ ior {ior!r} }}" if transmit > 0 and ior > 0 else "")


class Translation:
    def __init__(self):
        self.view, self.background, self.lights, self.objects = {}, [0.0, 0.0, 0.0], [], []
        self.fills, self.fill, self.mesh = {}, (1.0, 1.0, 1.0, 1.0, 0.0, 1.0, 0.0, 1.0), []

    def look(self):
        """The name of the texture of the fill that holds."""
        return self.fills.setdefault(self.fill, f"Fill{len(self.fills)}")

    def add(self, text):
        self.objects.append(f"{text} {self.look()}() }}")

    def end_mesh(self):
        if self.mesh:
            self.add("mesh {\n" + "\n".join(self.mesh) + "\n")
            self.mesh = []

    def polygon(self, corners, normals):
        opaque = self.fill[6] == 0
        if normals is not None:
            # A patch of more than three corners is a fan, as convex patches allow.
            triangles = [(0, k, k + 1) for k in range(1, len(corners) - 1)]
            for corner in triangles:
                text = "smooth_triangle {" + ",".join(vector(corners[k]) + "," + vector(normals[k]) for k in corner)
                self.mesh.append(text + "}") if opaque else self.add(text)
        elif len(corners) == 3:
            text = "triangle {" + ",".join(map(vector, corners))
            self.mesh.append(text + "}") if opaque else self.add(text)
        else:
            closed = corners + corners[:1]
            self.add(f"polygon {{ {len(closed)}," + ",".join(map(vector, closed)))

    def read(self, tokens):
        while tokens.more():
            kind = tokens.word()
            if kind == "v":
                for key, count in ("from", 3), ("at", 3), ("up", 3), ("angle", 1), ("hither", 1), ("resolution", 2):
                    if tokens.word() != key:
                        sys.exit(f"the view lacks {key}")
                    self.view[key] = tokens.numbers(count)
            elif kind == "b":
                self.background = tokens.numbers(3)
            elif kind == "l":
                self.lights.append((tokens.numbers(3), tokens.numbers_to_the_end(3) or [1.0, 1.0, 1.0]))
            elif kind == "f":
                fill = tuple(tokens.numbers(8))
                if fill != self.fill:
                    self.end_mesh()
                    self.fill = fill
            elif kind == "s":
                *center, radius = tokens.numbers(4)
                self.add(f"sphere {{ {vector(center)},{abs(radius)!r}")
            elif kind == "c":
                numbers = tokens.numbers(8)
                base, top, wide, narrow = numbers[0:3], numbers[4:7], abs(numbers[3]), abs(numbers[7])
                if wide == narrow:
                    self.add(f"cylinder {{ {vector(base)},{vector(top)},{wide!r} open")
                else:
                    self.add(f"cone {{ {vector(base)},{wide!r},{vector(top)},{narrow!r} open")
            elif kind in ("p", "pp"):
                rows = [tokens.numbers(3 if kind == "p" else 6) for _ in range(int(tokens.word()))]
                self.polygon([row[:3] for row in rows], [row[3:] for row in rows] if kind == "pp" else None)
            else:
                sys.exit(f"no entity of the Neutral File Format: {kind}")
        self.end_mesh()

    def text(self):
        count = max(1, len(self.lights))
        share = math.sqrt(count) / (2 * count)
        lines = [
            "#version 3.7;",
            "global_settings { assumed_gamma 1 max_trace_level 5 adc_bailout 0 ambient_light rgb 1 }",
            f"background {{ color rgb {vector(self.background)} }}",
            camera(self.view),
        ]
        for place, color in self.lights:
            lines.append(f"light_source {{ {vector(place)} color rgb {vector([share * c for c in color])} }}")
        for fill, name in self.fills.items():
            lines.append(f"#macro {name}() {texture(fill, share)} #end")
        return "\n".join(lines + self.objects) + "\n"


def translate(text):
    """The text of an NFF scene as a text for POV-Ray."""
    translation = Translation()
    translation.read(Tokens(text))
    return translation.text()


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    sys.stdout.write(translate(Path(sys.argv[1]).read_text()))
