#!/usr/bin/env python3
"""Runs taut-compare on mutated scenes, clouds and references, and holds it to its contract.

    fuzz.py TAUT_COMPARE SCENE_FOLDER [--count N] [--seed S] [--keep DIR] [--sanitized]

Every mutation must end with exit code 0, 1 or 2 within limits of time and memory, or, where a job is long, with 143
when SIGTERM tells it to; exit code 2 says what is wrong at
file:line:column (a table or cloud at file:line, a missing file by its name) and writes nothing; nothing is written
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
CLOUD = "x,y,volume\n" + "".join(
    f"{0.0125 * i},{0.0125 * j},0.00015625\n" for i in range(17) for j in range(5)
)

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


def findings(code, out, err, folder, before):
    if code not in (0, 1, 2):
        yield f"exit code {code}"
    if any(c < " " and c not in "\n\t" or "\x7f" <= c <= "\x9f" or c == "\u202e" for c in out + err):
        yield "control characters on the terminal"
    after = {str(p.relative_to(folder)) for p in folder.rglob("*")}
    extra = {p for p in after - before if p != "out" and not p.startswith("out/")}
    if extra:
        yield f"written outside --out: {sorted(extra)[:5]}"
    if any(pathlib.PurePath(p).name == "canary" for p in after):
        yield "something was executed"
    if any(p.endswith(".tmp") for p in after):
        yield "a temporary file was left"
    if code == 2:
        if "out" in after:
            yield "exit code 2, but files were written"
        if not re.search(r"scene\.toml:\d+:\d+: |\.csv:\d+: |scene\.toml: cannot open", err):
            yield f"exit code 2 without a place: {err[:300]}"
    elif code == 1 and not err.strip():
        yield "exit code 1 without a word"
    results = folder / "out" / "results.csv"
    if code == 0 and not (folder / "out" / "report.html").exists():
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


def try_one(program, scenes, seed, keep, sanitized):
    rng = random.Random(seed)
    with tempfile.TemporaryDirectory(prefix="taut-fuzz-") as name:
        folder = pathlib.Path(name)
        scene, reference, cloud = GOOD, REFERENCE, CLOUD
        what = rng.randrange(10)
        if what == 0:  # shipped ones are long: changed more, so that few of them run
            scene = mutate(rng, rng.choice(scenes).read_text(), rng.randrange(4, 9))
        elif what == 1:
            reference = mutate(rng, reference, rng.randrange(1, 3))
        elif what == 2:
            scene = scene.replace('type = "box"\nmin = [0.0, 0.0]\nmax = [0.2, 0.05]\n[lattice]\ndx = 0.0125', 'type = "csv"\nfile = "cloud.csv"')
            scene = scene.replace('[[run]]\nlabel = "points"\nformulation = "tl_stress_points"\n', "")
            cloud = mutate(rng, cloud, rng.randrange(1, 4))
        else:
            scene = mutate(rng, scene, rng.randrange(1, 4))
        for file, text in (("scene.toml", scene), ("reference.csv", reference), ("cloud.csv", cloud)):
            (folder / file).write_bytes(text.encode("utf-8", "surrogatepass"))
        before = {str(p.relative_to(folder)) for p in folder.rglob("*")}
        command = [program, "scene.toml", "--quick", "--out", "out", "--threads", "1"]
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
        bad = list(findings(code, out, err, folder, before))
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
