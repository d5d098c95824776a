#!/usr/bin/env python3
"""Many objects: N random spheres or tori, one shadowing light, one thread; POV-Ray, Tachyon (spheres) and `rt` in turn.

    scaling.py [--passes N] [--count N] [--size PIXELS] [sphere] [torus]

Compared are the times of tracing that each program gives, by the clock; 'cpu' is the processor's: POV-Ray's as it prints
it, of the others that of the whole process less that of a run of one pixel, which reads and builds all the same. Reading
and building together are printed beside. Every program must hit something in the same number of pixels: the background
is black, nothing else is.
"""
import argparse
import json
import math
import re
import sys
import tempfile
from pathlib import Path

import measure
from measure import median
from pictures import read_png, read_ppm
from translate import cross, scaled

SIDE = 100.0
EYE, LAMP, ANGLE = (0.0, 0.0, -330.0), (400.0, 600.0, -500.0), 45.0
COLOR = (0.8, 0.7, 0.6)

# Asked of our time by the time of the best: a fifth for tori, a third for spheres.
ASKED = {"sphere": 1 / 3, "torus": 1 / 5}

# Rays that graze may end differently, and Tachyon lays its raster otherwise by a part of a pixel.
MOST_DIFFERENT = 0.002


def random_numbers(seed):
    """SplitMix64 (Steele, Lea, Flood 2014), the upper 53 bits as a number in [0, 1)."""
    mask = (1 << 64) - 1
    while True:
        seed = (seed + 0x9E3779B97F4A7C15) & mask
        mixed = ((seed ^ (seed >> 30)) * 0xBF58476D1CE4E5B9) & mask
        mixed = ((mixed ^ (mixed >> 27)) * 0x94D049BB133111EB) & mask
        yield ((mixed ^ (mixed >> 31)) >> 11) * 2.0**-53


def objects(count):
    """(centre, size, axis) of each object: sizes shrink as the cube root of the count, so the picture stays as full."""
    number = random_numbers(1)
    for _ in range(count):
        center = [2 * SIDE * next(number) - SIDE for _ in range(3)]
        size = 60 * count ** (-1 / 3) * (0.5 + 0.5 * next(number))
        z, angle = 2 * next(number) - 1, 2 * math.pi * next(number)
        across = math.sqrt(max(0.0, 1 - z * z))
        yield center, size, [across * math.cos(angle), across * math.sin(angle), z]


def row(numbers, between=","):
    return between.join(repr(number) for number in numbers)


def mirrored(vector):
    """POV-Ray's frame is left-handed, ours right-handed: seen in it, the same picture has z turned round."""
    return [vector[0], vector[1], -vector[2]]


def for_povray(kind, count):
    yield "#version 3.7;\nglobal_settings { assumed_gamma 1 max_trace_level 1 ambient_light rgb 1 }\n"
    yield f"#default {{ pigment {{ color rgb <{row(COLOR)}> }} finish {{ ambient 0.5 diffuse 1 specular 0 }} }}\n"
    yield f"camera {{ perspective location <{row(EYE)}> look_at 0 right x up y angle {ANGLE} }}\n"
    yield f"light_source {{ <{row(LAMP)}> color rgb 0.5 }}\n"
    for center, size, axis in objects(count):
        if kind == "sphere":
            yield f"sphere{{<{row(center)}>,{size!r}}}\n"
        else:
            aside = scaled(cross([1, 0, 0] if abs(axis[0]) < 0.6 else [0, 1, 0], axis), 1)
            yield f"torus{{{size!r},{size / 4!r} matrix<{row(aside + axis + cross(aside, axis) + center)}>}}\n"


def for_tachyon(count, size):
    zoom = 0.5 / math.tan(math.radians(ANGLE) / 2)
    yield f"BEGIN_SCENE\nRESOLUTION {size} {size}\nCAMERA\nZOOM {zoom!r}\nASPECTRATIO 1\nANTIALIASING 0\nRAYDEPTH 1\n"
    yield f"CENTER {row(EYE, ' ')}\nVIEWDIR 0 0 1\nUPDIR 0 1 0\nEND_CAMERA\nBACKGROUND 0 0 0\n"
    yield f"LIGHT CENTER {row(LAMP, ' ')} RAD 0.1 COLOR 0.5 0.5 0.5\n"
    texture = f"TEXTURE AMBIENT 0.5 DIFFUSE 1 SPECULAR 0 OPACITY 1 COLOR {row(COLOR, ' ')} TEXFUNC 0"
    for center, radius, _ in objects(count):
        yield f"SPHERE CENTER {row(center, ' ')} RAD {radius!r} {texture}\n"
    yield "END_SCENE\n"


def for_nff(count, size):
    yield f"b 0 0 0\nv\nfrom {row(mirrored(EYE), ' ')}\nat 0 0 0\nup 0 1 0\nangle {ANGLE}\nhither 0\nresolution {size} {size}\n"
    yield f"l {row(mirrored(LAMP), ' ')}\nf {row(COLOR, ' ')} 1 0 1 0 1\n"
    for center, radius, _ in objects(count):
        yield f"s {row(mirrored(center), ' ')} {radius!r}\n"


def for_toml(count, size):
    yield f"version = 1\n[image]\nwidth = {size}\nheight = {size}\nbackground = [0.0, 0.0, 0.0]\n"
    yield f"[camera]\neye = [{row(mirrored(EYE))}]\nlook_at = [0.0, 0.0, 0.0]\nup = [0.0, 1.0, 0.0]\nfov = {ANGLE}\n"
    yield "[render]\nambient = [0.5, 0.5, 0.5]\n"
    yield f"[[light]]\npoint = {{ position = [{row(mirrored(LAMP))}], color = [0.5, 0.5, 0.5] }}\n"
    yield f"[material.clay]\ncolor = [{row(COLOR)}]\n"
    for number, (center, size, axis) in enumerate(objects(count)):
        yield f"[[object]]\nname = \"{number}\"\nmaterial = \"clay\"\nshape.torus = {{ center = [{row(mirrored(center))}], "
        yield f"axis = [{row(mirrored(axis))}], major = {size!r}, minor = {size / 4!r} }}\n"


def run_povray(folder, size, mode):
    """One run as (seconds of reading and building, of tracing, the same of the processor; the picture)."""
    run = measure.povray(folder / "scene.pov", size, size, f"povray{mode}.png", [mode])
    parse, bound, trace = (measure.povray_seconds(run.text, phase) for phase in ("Parse", "Bounding", "Trace"))
    return parse[0] + bound[0], *trace, folder / f"povray{mode}.png"


def run_tachyon(folder, size):
    picture = folder / "tachyon.ppm"
    command = ["tachyon", folder / "scene.dat", "-format", "PPM", "-numthreads", 1, "+V"]
    idle = measure.run([*command, "-o", folder / "one.ppm", "-res", 1, 1])
    run = measure.run([*command, "-o", picture, "-res", size, size])
    trace = re.search(r"Ray Tracing Time:\s+([\d.]+)", run.text)
    if trace is None:
        sys.exit(f"Tachyon printed no Ray Tracing Time:\n{run.text[-2000:]}")
    return idle.wall, float(trace[1]), run.processor - idle.processor, picture


def run_ours(rt, scene, size):
    picture, statistics = scene.with_name("ours.png"), scene.with_name("ours.json")
    command = [rt, "render", scene, "--stats", statistics, "--threads", 1, "--aa", "none", "--max-depth", 1, "--quiet"]
    idle = measure.run([*command, "-o", scene.with_name("one.png"), "--width", 1, "--height", 1])
    run = measure.run([*command, "-o", picture, "--width", size, "--height", size])
    counts = json.loads(statistics.read_text())
    return counts["load_s"] + counts["build_s"], counts["trace_s"], run.processor - idle.processor, picture


def compare(kind, options, programs, folder):
    (folder / "scene.pov").write_text("".join(for_povray(kind, options.count)))
    ours = folder / ("scene.nff" if kind == "sphere" else "scene.toml")
    ours.write_text("".join((for_nff if kind == "sphere" else for_toml)(options.count, options.size)))
    runs = {}
    if "povray" in programs:
        runs["POV-Ray +BM1"] = lambda: run_povray(folder, options.size, "+BM1")
        runs["POV-Ray +BM2"] = lambda: run_povray(folder, options.size, "+BM2")
    if "tachyon" in programs and kind == "sphere":
        (folder / "scene.dat").write_text("".join(for_tachyon(options.count, options.size)))
        runs["Tachyon"] = lambda: run_tachyon(folder, options.size)
    runs["rt"] = lambda: run_ours(programs["rt"], ours, options.size)
    if len(runs) == 1:
        print(f"skipped: {kind}, for no rival is here that has it")
        return True
    results = {name: [] for name in runs}
    for _ in range(options.passes):
        for name, once in runs.items():
            results[name].append(once())

    read = lambda path: (read_ppm if path.suffix == ".ppm" else read_png)(path)
    hits = {name: read(rows[0][3]).count_not((0, 0, 0)) for name, rows in results.items()}
    build, trace, cpu = ({name: median([once[k] for once in rows]) for name, rows in results.items()} for k in range(3))
    print(f"{options.count} of kind {kind}, {options.size} x {options.size}, one thread: medians of {options.passes} in turn")
    print(f"  {'program':14} {'trace s':>9} {'cpu s':>9} {'read+build s':>13} {'ours / its':>11} {'cpu':>8} {'pixels hit':>11}")
    agree = True
    for name in runs:
        close = abs(hits[name] - hits["rt"]) <= MOST_DIFFERENT * hits["rt"]
        agree = agree and close
        print(f"  {name:14} {trace[name]:9.3f} {cpu[name]:9.3f} {build[name]:13.3f} {trace['rt'] / trace[name]:11.3f}"
              f" {cpu['rt'] / cpu[name]:8.3f} {hits[name]:11}{'' if close else '  DO NOT AGREE'}")
    best, best_cpu = (min(seconds[name] for name in runs if name != "rt") for seconds in (trace, cpu))
    print(f"  ours / the best: {trace['rt'] / best:.3f}, of the processor {cpu['rt'] / best_cpu:.3f}"
          f"   (asked: {ASKED[kind]:.3f})", flush=True)
    return agree


def main():
    options = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    options.add_argument("--passes", type=int, default=3)
    options.add_argument("--count", type=int, default=100_000)
    options.add_argument("--size", type=int, default=512)
    options.add_argument("kinds", nargs="*", metavar="KIND", help="sphere, torus; both if none is named")
    options = options.parse_args()
    if unknown := set(options.kinds) - set(ASKED):
        sys.exit(f"no such kind: {', '.join(sorted(unknown))}; there are {', '.join(ASKED)}")
    programs = {name: name for name in ("povray", "tachyon") if measure.installed(name)}
    if not programs:
        return 0
    programs["rt"] = measure.ours()
    agree = True
    for kind in options.kinds or ASKED:
        with tempfile.TemporaryDirectory() as folder:
            agree = compare(kind, options, programs, Path(folder)) and agree
    return 0 if agree else 1


if __name__ == "__main__":
    sys.exit(main())
