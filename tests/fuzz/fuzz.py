#!/usr/bin/env python3
"""Runs taut-compare on mutated scenes, clouds, references and command lines, and holds it to its contract.

    fuzz.py TAUT_COMPARE SCENE_FOLDER [--count N] [--seed S] [--keep DIR] [--sanitized]

Every mutation must end with exit code 0, 1 or 2 within limits of time and memory, or, where a job is long, with 143
when SIGTERM tells it to; exit code 2 says what is wrong at
file:line:column (a table or cloud at file:line, a missing file by its name; of command lines, what is wrong with
them) and writes nothing; nothing is written
outside --out; nothing of the input is executed; no value that is not finite stands in results.csv, and no row with
status ok lacks one. What breaks the contract is kept, with the seed that makes it again.
"""

import argparse
import csv
import math
import os
import pathlib
import random
import re
import resource
import shutil
import subprocess
import sys
import tempfile
import time

SECONDS = 20  # of one run; a mutation may well ask for a long one, which then has to end when it is told to
BYTES = 4 << 30  # of address space

GOOD = """[scene]
name = "small"
title = "A small one"
dimension = 2
[geometry]
type = "box"
min = [0.0, 0.0]
max = [0.2, 0.05]
[lattice]
dx = 0.0125
[material]
model = "st_venant_kirchhoff"
E = 2e6
nu = 0.3
density = 1000.0
plane = "stress"
[[boundary]]
type = "clamp"
on = "x_min"
[[boundary]]
type = "load"
on = "x_max"
force = 1000.0
direction = [1.0, 0.0]
[solve]
mode = "relax"
tolerance = 1e-2
max_steps = 2000
[[probe]]
name = "tip_ux"
type = "displacement"
axis = "x"
at = [0.2, 0.025]
reference = { file = "reference.csv", column = "ux", keys = { load = "load" } }
[[run]]
label = "total"
formulation = "tl_displacement"
[[run]]
label = "points"
formulation = "tl_stress_points"
[[run]]
label = "updated"
formulation = "ul_basic"
material = "hypoelastic"
support_dx = 2.4
[sweep]
load = [500, 1000]
[[picture]]
title = "Pulled"
"""
REFERENCE = "load,ux\n500,0.001\n1000,0.002\n"
DX = 0.0125


def nodes():
    """Nodes of a lattice with their share of cells and their area vectors."""
    for i in range(17):
        for j in range(5):
            share = (0.5 if i in (0, 16) else 1) * (0.5 if j in (0, 4) else 1)
            high = DX * (0.5 if j in (0, 4) else 1)
            wide = DX * (0.5 if i in (0, 16) else 1)
            area = ((i == 16) - (i == 0)) * high, ((j == 4) - (j == 0)) * wide
            yield DX * i, DX * j, share * DX * DX, *area


def cells():
    """Middles of cells with their facets, a corner's two in rows of their own."""
    for i in range(16):
        for j in range(4):
            x, y = DX * (i + 0.5), DX * (j + 0.5)
            facets = []
            for side, at in (((i == 15) - (i == 0), x), ((j == 3) - (j == 0), y)):
                if side and at == x:
                    facets.append((side * DX, 0, x + side * DX / 2, y))
                elif side:
                    facets.append((0, side * DX, x, y + side * DX / 2))
            rows = facets or [(0, 0, x, y)]
            for k, row in enumerate(rows):
                yield (x, y, DX * DX if k == 0 else "", *row)


def table(head, rows):
    return head + "\n" + "".join(",".join(str(v) for v in row) + "\n" for row in rows)


CLOUDS = [
    table("x,y", ((x, y) for x, y, *_ in nodes())),
    table("x,y,volume", ((x, y, v) for x, y, v, *_ in nodes())),
    table("x,y,volume,bx,by", nodes()),
    table("x,y,volume,bx,by,fx,fy", cells()),
    table("x,y,volume", ((x, y, DX * DX) for x, y, v, *_ in cells() if v)),
]
# Instead of the box, with each kind of particles.
GEOMETRIES = [
    'type = "sphere"\ncentre = [0.1, 0.025]\nradius = 0.1\n[lattice]\ndx = 0.02',
    'type = "ring"\ncentre = [0.0, 0.0]\ninner_radius = 0.1\nouter_radius = 0.2\n[lattice]\ndx = 0.025',
    'type = "difference"\nof = [{ type = "box", min = [0.0, 0.0], max = [0.2, 0.05] }, '
    '{ type = "sphere", centre = [0.1, 0.025], radius = 0.02 }]\n[lattice]\nkind = "cell_centred"\ndx = 0.0125\njitter = 0.2',
]
BOX = 'type = "box"\nmin = [0.0, 0.0]\nmax = [0.2, 0.05]\n[lattice]\ndx = 0.0125'
RUNS = [
    'formulation = "auto"',
    'formulation = "tl_displacement"\noperators = "antisymmetric"\njitter = 0.2\nseed = 7',
    'formulation = "tl_displacement"\noperators = "quadratic"\nsupport_dx = 2.4\nzero_energy_control = 1.0',
    'formulation = "tl_bond_associated"\nneighbours = "kd_tree"\npair_precision = "single"',
    'formulation = "ul_artificial_stress"\nmaterial = "hypoelastic"\nsupport_dx = 2.4\nviscosity = 1.0\nskin = 0.3',
]
SWEEPS = [
    "load = [500, 1000]\nnu = [0.0, 0.3, 0.49]",
    "load = [500, 1000]\ndx = [0.025, 0.0125]",
    "load = [-1000, 500]",
]
SOLID = """[scene]
name = "solid"
dimension = 3
[geometry]
type = "cylinder"
from = [0.0, 0.0, 0.0]
to = [0.2, 0.0, 0.0]
radius = 0.05
[lattice]
dx = 0.025
[material]
model = "neo_hookean"
E = 2e6
nu = 0.3
density = 1000.0
[[region]]
where = { x = [0.1, 0.2] }
density = 2000.0
[[boundary]]
type = "prescribed"
on = "x_min"
axis = "x"
displacement = 0.01
history = { type = "raised_cosine", start = 1e-4, duration = 1e-3 }
[[boundary]]
type = "body_force"
acceleration = [0.0, 0.0, -9.81]
[[initial]]
where = { x = [0.1, 0.2] }
velocity = [0.0, 0.1, 0.0]
[solve]
mode = "dynamic"
duration = 2e-3
integrator = "central_difference"
samples = 50
[[probe]]
name = "end_ux"
type = "displacement"
axis = "x"
at = [0.2, 0.0, 0.0]
measure = "peak"
window = [0.0, 1e-3]
[[probe]]
name = "arrival"
type = "velocity"
axis = "x"
at = [0.1, 0.0, 0.0]
measure = "arrival_time"
[[probe]]
name = "stress"
type = "cauchy_stress"
component = "xx"
at = [0.1, 0.0, 0.0]
over = "end_ux"
measure = "peak"
[[run]]
label = "total"
formulation = "tl_displacement"
[[run]]
label = "points"
formulation = "tl_stress_points"
[sweep]
region_density = [1000, 4000]
[[picture]]
title = "From a corner"
view = "corner"
field = "cauchy_zz"
[[picture]]
title = "From somewhere"
view = [1.0, 2.0, -3.0]
runs = ["total"]
[quick]
duration = 1e-3
"""
ARGUMENTS = ["--threads", "0", "-1", "99999999999", "2", "--max-memory", "1kb", "8GB", "-5GB", "1e400", "--dry-run",
             "--tolerance", "1%", "0", "nan", "-3%", "--quick", "--quiet", "--no-fields", "--out", "", "out", "out/deep/er",
             "/dev/null", "/proc/none", ".", "scene.toml", "cloud.csv", "reference.csv", ".", "nowhere.toml", "--help",
             "--version", "--wrong", "--", "-x.toml", "\x1b[31m", "`touch canary`", "a" * 5000, "--out=out", "\udcff"]

TRAPS = ["`touch canary`", "$(touch canary)", "'; system(\"touch canary\") '", "|touch canary", "\\\\", "'", "<script>"]
NUMBERS = ["0", "-1", "1e308", "-1e308", "1e-320", "nan", "inf", "-inf", "5", "0.5", "1e-9", "1e9", "9223372036854775807"]
STRINGS = ["", "x", "\\u0000", "\\u001b[2J", "\\u202e", "a" * 300, "ν", "..", "/", "../../up", "tl_displacement", "x_max"]


def mutate_line(rng, lines):
    i = rng.randrange(len(lines))
    kind = rng.randrange(8)
    line = lines[i]
    if kind == 0:
        del lines[i]
    elif kind == 1:
        lines.insert(i, lines[rng.randrange(len(lines))])
    elif kind == 2:
        lines[i] = re.sub(r"-?\d+(\.\d+)?(e-?\d+)?", lambda m: rng.choice(NUMBERS), line, count=1)
    elif kind == 3:
        lines[i] = re.sub(r'"[^"]*"', lambda m: '"' + rng.choice(STRINGS) + '"', line, count=1)
    elif kind == 4:
        trap = rng.choice(TRAPS).replace("\\", "\\\\").replace('"', '\\"')
        lines[i] = re.sub(r'"[^"]*"', lambda m: '"' + trap + '"', line, count=1)
    elif kind == 5 and line:
        at = rng.randrange(len(line))
        lines[i] = line[:at] + chr(rng.choice([0, 27, 34, 39, 44, 46, 61, 91, 93, 123, 125, 0x202E])) + line[at + 1 :]
    elif kind == 6 and line:
        at = rng.randrange(len(line))
        lines[i] = line[:at] + line[at + rng.randrange(1, 6) :]
    else:
        lines[i] = line + rng.choice([" = 1", "]", " # \x1b", "." * 40 + "a = 1", ", 1", "0"])


def mutate(rng, text, times):
    lines = text.split("\n")
    for _ in range(times):
        if lines:
            mutate_line(rng, lines)
    return "\n".join(lines)


def small_scenes(folder):
    """Shipped scenes that are quick; they are mutated as they are, and most of the mutations are refused."""
    return [p for p in sorted(pathlib.Path(folder).glob("*.toml")) if p.stat().st_size < 20000]


def limits(sanitized):
    if not sanitized:  # the sanitizers' own maps take terabytes of addresses
        resource.setrlimit(resource.RLIMIT_AS, (BYTES, BYTES))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    resource.setrlimit(resource.RLIMIT_FSIZE, (1 << 28, 1 << 28))


def findings(code, out, err, folder, before, command=None):
    if code not in (0, 1, 2):
        yield f"exit code {code}"
    if any(c < " " and c not in "\n\t" or "\x7f" <= c <= "\x9f" or c == "\u202e" for c in out + err):
        yield "control characters on the terminal"
    after = {str(p.relative_to(folder)) for p in folder.rglob("*")}
    extra = {p for p in after - before if p != "out" and not p.startswith("out/")}
    if command:  # may name any folder, or none: then it is out/taut-compare
        named = {w.removeprefix("--out=") for w in command if w.startswith("--out=")}
        named |= {b for a, b in zip(command, command[1:]) if a == "--out"}
        tops = {(pathlib.PurePath(n).parts or (".",))[0] for n in named if not n.startswith("/")}
        extra = {p for p in extra if not tops & {".", pathlib.PurePath(p).parts[0]}}
        if not {"scene.toml", "reference.csv", "cloud.csv"} <= after:
            yield "a file of the user is gone"
    if extra:
        yield f"written outside --out: {sorted(extra)[:5]}"
    if any(pathlib.PurePath(p).name.startswith("canary") for p in after):
        yield "something was executed"
    if any(p.endswith(".tmp") for p in after):
        yield "a temporary file was left"
    if code == 2:
        if after - before:
            yield "exit code 2, but files were written"
        if command and err.startswith("taut-compare: ") and err.count("\n") <= 2 and len(err) < 1000:
            return
        if not re.search(r"scene\.toml:\d+:\d+: |\.csv:\d+: |scene\.toml: cannot open", err):
            yield f"exit code 2 without a place: {err[:300]}"
    elif code == 1 and not err.strip():
        yield "exit code 1 without a word"
    results = folder / "out" / "results.csv"
    if code == 0 and not command and not (folder / "out" / "report.html").exists():
        yield "no report"
    if results.exists():
        with open(results, encoding="utf-8", errors="surrogateescape", newline="") as file:
            for row in csv.DictReader(file):
                for key in ("value", "reference", "error"):
                    if row[key] and not math.isfinite(float(row[key])):
                        yield f"{key} is {row[key]} with status {row['status']}"
                if row["status"] == "ok" and not row["value"]:
                    yield "status ok without a value"
                if row["status"] == "broke" and row["value"]:
                    yield "status broke with a value"


def command_line(rng, program):
    """A good one with arguments that are left out, put in or repeated. Where it says --out, that is known."""
    words = ["scene.toml", "--quick", "--out", "out", "--threads", "1"]
    for _ in range(rng.randrange(1, 4)):
        i = rng.randrange(len(words) + 1)
        if rng.randrange(3) and i < len(words):
            words[i] = rng.choice(ARGUMENTS)
        elif rng.randrange(2) and words:
            del words[rng.randrange(len(words))]
        else:
            words.insert(i, rng.choice(ARGUMENTS))
    return [program, *words]


def try_one(program, scenes, seed, keep, sanitized):
    rng = random.Random(seed)
    with tempfile.TemporaryDirectory(prefix="taut-fuzz-") as name:
        folder = pathlib.Path(name)
        scene, reference, cloud = GOOD, REFERENCE, rng.choice(CLOUDS)
        what = rng.randrange(14)
        if rng.randrange(2):
            scene = scene.replace('formulation = "tl_displacement"', rng.choice(RUNS), 1)
        if rng.randrange(3) == 0:
            scene = scene.replace("load = [500, 1000]", rng.choice(SWEEPS))
        command = [program, "scene.toml", "--quick", "--out", "out", "--threads", "1"]
        if what == 0:  # shipped ones are long: changed more, so that few of them run
            scene = mutate(rng, rng.choice(scenes).read_text(), rng.randrange(4, 9))
        elif what == 1:
            reference = mutate(rng, reference, rng.randrange(1, 3))
        elif what in (2, 3):
            scene = scene.replace(BOX, 'type = "csv"\nfile = "cloud.csv"')
            scene = scene.replace('[[run]]\nlabel = "points"\nformulation = "tl_stress_points"\n', "")
            cloud = mutate(rng, cloud, rng.randrange(0, 4))
            if rng.randrange(3) == 0:
                scene = mutate(rng, scene, 1)
        elif what == 4:
            scene = mutate(rng, SOLID, rng.randrange(0, 3))
        elif what == 5:
            scene = mutate(rng, scene.replace(BOX, rng.choice(GEOMETRIES)), rng.randrange(0, 3))
        elif what == 6:
            command = command_line(rng, program)
        else:
            scene = mutate(rng, scene, rng.randrange(1, 4))
        for file, text in (("scene.toml", scene), ("reference.csv", reference), ("cloud.csv", cloud)):
            (folder / file).write_bytes(text.encode("utf-8", "surrogatepass"))
        before = {str(p.relative_to(folder)) for p in folder.rglob("*")}
        environment = dict(os.environ, OMP_WAIT_POLICY="passive")
        if sanitized:  # by default they leave with 1, as a run that failed does
            environment["ASAN_OPTIONS"] = f"exitcode=99:hard_rss_limit_mb={BYTES >> 20}"
            environment["UBSAN_OPTIONS"] = "exitcode=99:print_stacktrace=1"
        seconds = SECONDS * (5 if sanitized else 1)
        if rng.randrange(4):
            environment["TAUT_GNUPLOT"] = ""  # charts are slow: in every fourth
        run = subprocess.Popen(command, cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.PIPE, preexec_fn=lambda: limits(sanitized), env=environment)
        told = False
        try:
            streams = run.communicate(timeout=seconds)
        except subprocess.TimeoutExpired:
            told = True
            run.terminate()
            try:
                streams = run.communicate(timeout=3 * seconds)
            except subprocess.TimeoutExpired:
                run.kill()
                streams = run.communicate()
        out, err = (s.decode("utf-8", "surrogateescape") for s in streams)
        code = 0 if told and run.returncode == 143 else run.returncode
        bad = list(findings(code, out, err, folder, before, None if what != 6 else command))
        for finding in bad:
            print(f"seed {seed}: {finding}", flush=True)
        if sanitized and code == 99:
            print(err[:4000], flush=True)
        if bad and keep:
            target = pathlib.Path(keep) / f"seed_{seed}"
            shutil.rmtree(target, ignore_errors=True)
            shutil.copytree(folder, target, symlinks=True)
        return bad


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("scenes")
    parser.add_argument("--count", type=int, default=10000, help="mutations")
    parser.add_argument("--seconds", type=float, default=math.inf, help="stop after this long")
    parser.add_argument("--seed", type=int, default=1, help="of the first mutation; each has the next")
    parser.add_argument("--keep", help="folder for what breaks the contract")
    parser.add_argument("--sanitized", action="store_true", help="the program is built with sanitizers")
    options = parser.parse_args()
    program = os.path.abspath(options.program)
    scenes = small_scenes(options.scenes)
    start = time.monotonic()
    found = tried = 0
    for seed in range(options.seed, options.seed + options.count):
        if time.monotonic() - start > options.seconds:
            break
        tried += 1
        found += bool(try_one(program, scenes, seed, options.keep, options.sanitized))
    print(f"{tried} mutations, {found} with findings, {time.monotonic() - start:.0f} s")
    return 1 if found or not tried else 0


if __name__ == "__main__":
    sys.exit(main())
