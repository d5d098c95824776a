"""What the comparisons share: run a program and measure it, read what it says of itself, find what is installed.

Standard library only. Wall times count what the machine did beside; so every run also gives the processor seconds of
its process, which a loaded machine disturbs much less. Compare the ratios of one run, never times of two.
"""
import os
import re
import shutil
import statistics
import subprocess
import sys
import tempfile
import time
from dataclasses import dataclass
from pathlib import Path

RIVALS = Path(__file__).resolve().parent.parent
ROOT = RIVALS.parent
SHARED = ROOT.parent / "shared"

INSTALL = {
    "povray": "Debian and Ubuntu: apt-get install povray (3.7 or later)",
    "tachyon": "Debian and Ubuntu: apt-get install tachyon",
}


@dataclass
class Run:
    """One run of a program: what it printed, seconds by the clock, seconds of the processor, peak memory in MiB."""

    text: str
    wall: float
    processor: float
    memory: float


def installed(program):
    """Whether the program is here; if not, says what is skipped and how to install it."""
    if shutil.which(program):
        return True
    print(f"skipped: {program} is not installed. {INSTALL[program]}", flush=True)
    return False


def run(command, folder=None):
    """Runs a command to its end; what it prints, on either stream, is kept. Stops everything if it fails."""
    with tempfile.TemporaryFile() as printed:
        start = time.perf_counter()
        child = subprocess.Popen([str(word) for word in command], cwd=folder, stdout=printed, stderr=subprocess.STDOUT)
        # Of this child alone, where the sums over all children that `resource` gives would keep the greatest memory.
        _, status, usage = os.wait4(child.pid, 0)
        wall = time.perf_counter() - start
        child.returncode = os.waitstatus_to_exitcode(status)
        printed.seek(0)
        text = printed.read().decode(errors="replace")
    if child.returncode != 0:
        sys.exit(f"{' '.join(map(str, command))}\nended with {child.returncode}:\n{text[-2000:]}")
    return Run(text, wall, usage.ru_utime + usage.ru_stime, usage.ru_maxrss / 1024)


def ours():
    """The path of our program `rt`: the variable RT if set, else built here in release mode as everyone gets it."""
    if given := os.environ.get("RT"):
        return given
    environment = {key: value for key, value in os.environ.items() if key != "RUSTFLAGS"}
    subprocess.run(["cargo", "build", "--release", "--quiet", "-p", "rt-cli"], cwd=ROOT, env=environment, check=True)
    target = Path(environment.get("CARGO_TARGET_DIR", ROOT / "target"))
    return str(target / "release" / "rt")


def povray(scene, width, height, picture=None, options=()):
    """POV-Ray on one thread, without anti-aliasing; see `povray_seconds` for the times of the run."""
    output = [f"+O{picture}", "+FN8"] if picture else ["-O-", "-F"]
    command = ["povray", f"+I{scene.name}", *output, "-D", "-V", "-A", "-J", "+WT1", f"+W{width}", f"+H{height}", *options]
    return run(command, scene.parent)


def povray_seconds(text, phase):
    """What POV-Ray prints of its phase "Parse", "Bounding" or "Trace": seconds by the clock, and of the processor."""
    pattern = phase + r" Time:.*?\(([\d.]+) seconds\)(?:\s+using \d+ thread\(s\) with ([\d.]+) CPU-seconds)?"
    found = re.search(pattern, text)
    if found is None:
        sys.exit(f"POV-Ray printed no {phase} Time:\n{text[-2000:]}")
    return float(found[1]), float(found[2] or found[1])


def median(numbers):
    return statistics.median(numbers)


def spread(numbers):
    """The median, and in brackets the least and the greatest."""
    return f"{median(numbers):.3f} ({min(numbers):.3f}-{max(numbers):.3f})"
