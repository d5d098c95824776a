#!/usr/bin/env python3
"""Scenes of the Standard Procedural Databases: POV-Ray (its better bounding mode) and `rt`, one thread, in turn.

    nff.py [--passes N] [--size PIXELS] [--keep FOLDER] [SCENE.nff ...]

Each scene is translated by translate.py; one ray a pixel, five generations of rays, no cut-off by weight. Compared are
the times of tracing alone that each program gives, without reading, building and writing. The pictures must agree but for
a few pixels (8 of 255). Glass made of loose polygons (gears) is known to differ: translate.py says why.
"""
import argparse
import json
import sys
import tempfile
from pathlib import Path

import measure
from measure import median
from pictures import read_png
from translate import translate

USUAL = ("balls3", "rings3", "lattice5", "shells3", "tree8")

# Solids of loose transparent polygons: their inside is told by other rules, so those pictures are counted, not judged.
LOOSE = ("gears",)
MOST_DIFFERENT = 0.005


def compare(rt, scene, options, folder):
    """One scene: prints its row and says whether the pictures agree."""
    pov, name = folder / f"{scene.stem}.pov", scene.stem
    pov.write_text(translate(scene.read_text()))
    theirs = {"+BM1": ([], []), "+BM2": ([], [])}
    ours, memory = ([], []), []
    ours_picture, statistics = folder / f"{name}-ours.png", folder / f"{name}.json"
    command = [rt, "render", scene, "-o", ours_picture, "--stats", statistics, "--max-depth", 5, "--threads", 1]
    command += ["--aa", "none", "--width", options.size, "--height", options.size, "--quiet"]
    for _ in range(options.passes):
        for mode, (clock, processor) in theirs.items():
            run = measure.povray(pov, options.size, options.size, f"{name}-povray.png", [mode])
            seconds = measure.povray_seconds(run.text, "Trace")
            clock.append(seconds[0])
            processor.append(seconds[1])
        run = measure.run(command)
        counts = json.loads(statistics.read_text())
        ours[0].append(counts["trace_s"])
        ours[1].append(run.processor)
        memory.append(run.memory)
    mode = min(theirs, key=lambda mode: median(theirs[mode][1]))
    clock, processor = map(median, theirs[mode])
    rays = sum(counts[key] for key in ("eye_rays", "shadow_rays", "reflected_rays", "refracted_rays"))
    picture = read_png(ours_picture)
    different = picture.count_different(read_png(folder / f"{name}-povray.png"), 8)
    agree = different <= MOST_DIFFERENT * options.size**2
    loose = name.startswith(LOOSE)
    print(f"{name:10} {mode} {clock:8.3f} {processor:8.3f} {median(ours[0]):8.3f} {median(ours[1]):8.3f}"
          f" {median(ours[0]) / clock:8.3f} {median(ours[1]) / processor:8.3f} {rays / median(ours[0]) / 1e6:8.2f} {max(memory):6.0f}"
          f" {different:8}{'' if agree else '  other rules' if loose else '  DO NOT AGREE'}", flush=True)
    return agree or loose


def main():
    options = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    options.add_argument("--passes", type=int, default=3)
    options.add_argument("--size", type=int, default=512)
    options.add_argument("--keep", type=Path, help="leave translations and pictures in this folder")
    options.add_argument("scenes", nargs="*", type=Path, metavar="SCENE.nff", help="default: five of ../shared/scenes/nff")
    options = options.parse_args()
    if not measure.installed("povray"):
        return 0
    library = measure.SHARED / "scenes" / "nff"
    scenes = options.scenes or [library / f"{name}.nff" for name in USUAL if (library / f"{name}.nff").exists()]
    if not scenes:
        print("skipped: no scenes; name some, as the generators of the Standard Procedural Databases write them (-r, NFF)")
        return 0
    rt = measure.ours()
    print(f"{options.size} x {options.size}, one ray a pixel, five generations, one thread: medians of {options.passes} in turn.")
    print("Seconds of tracing by the clock; 'cpu': seconds of the processor, POV-Ray's of tracing, ours of the whole process.")
    print(f"{'scene':10} {'mode':4} {'POV-Ray':>8} {'cpu':>8} {'rt':>8} {'cpu':>8} {'ratio':>8} {'cpu':>8} {'Mray/s':>8} {'MiB':>6} {'differ':>8}")
    with tempfile.TemporaryDirectory() as temporary:
        folder = options.keep or Path(temporary)
        folder.mkdir(parents=True, exist_ok=True)
        agree = [compare(rt, scene.resolve(), options, folder.resolve()) for scene in scenes]
    return 0 if all(agree) else 1


if __name__ == "__main__":
    sys.exit(main())
