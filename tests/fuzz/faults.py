#!/usr/bin/env python3
"""Kills taut-compare, and fills its disk, at random moments, and looks at what is left.

    faults.py TAUT_COMPARE kill|term|full [--count N] [--seed S]

Whatever happens: every row that was announced on standard output stands in results.csv, no file is torn, and what the
job could not do it says. kill: SIGKILL, after which the next job clears what the first one left and runs to its end.
term: SIGTERM or SIGINT, which end with 143 or 130 and the report of what there is. full: a small tmpfs, too small from
the start or filled by another file at some moment, which must be named (needs root; ends with 77 without).
"""

import argparse
import csv
import os
import pathlib
import random
import re
import signal
import subprocess
import sys
import tempfile
import time

from fuzz import GOOD, REFERENCE

LOADS = [500 + 50 * i for i in range(12)]
SCENE = GOOD.replace("load = [500, 1000]", f"load = {LOADS}").replace("max_steps = 2000", "max_steps = 500")
TABLE = "load,ux\n" + "".join(f"{load},{2e-6 * load}\n" for load in LOADS)


def start(program, folder, out):
    (folder / "scene.toml").write_text(SCENE)
    (folder / "reference.csv").write_text(TABLE)
    said, wrong = open(folder / "said.txt", "w"), open(folder / "wrong.txt", "w")
    environment = dict(os.environ, OMP_WAIT_POLICY="passive")
    command = [program, "scene.toml", "--out", str(out), "--threads", "1"]
    return subprocess.Popen(command, cwd=folder, stdout=said, stderr=wrong, env=environment)


def announced(folder):
    """Label and load of every case that a whole line tells of."""
    lines = (folder / "said.txt").read_text().split("\n")[:-1]
    found = (re.match(r"\[\d+/\d+\] small, (.*), load (\d+) N: ", line) for line in lines)
    return {match.groups() for match in found if match}


def torn(out):
    """What of the files is not whole."""
    for file in sorted(out.rglob("*")):
        if not file.is_file() or file.name.startswith("."):
            continue
        data = file.read_bytes()
        ends = {".html": b"</html>", ".svg": b"</svg>", ".png": b"IEND\xaeB`\x82"}.get(file.suffix)
        if ends and not data.rstrip().endswith(ends):
            yield f"{file.name} ends in its middle"
        if file.suffix == ".csv":
            rows = list(csv.reader(data.decode().splitlines()))
            if not data.endswith(b"\n") or len({len(row) for row in rows}) != 1:
                yield f"{file.name} is torn"
        if file.suffix == ".vtkhdf":
            # The end of the file as HDF5 wrote it into its head: at byte 40 (version 0) or 28 (2 and 3).
            at = 40 if data[8:9] == b"\0" else 28
            if data[:8] != b"\x89HDF\r\n\x1a\n" or int.from_bytes(data[at : at + 8], "little") > len(data):
                yield f"{file.name} is torn"


def rows_of(out):
    if not (out / "results.csv").exists():
        return set()
    with open(out / "results.csv", newline="") as file:
        return {(row["label"], str(int(float(row["load"])))) for row in csv.DictReader(file)}


def findings(folder, out):
    lost = announced(folder) - rows_of(out)
    if lost:
        yield f"announced, but not in results.csv: {sorted(lost)}"
    yield from torn(out) if out.exists() else ()


def duration(program):
    with tempfile.TemporaryDirectory(prefix="taut-faults-") as name:
        folder = pathlib.Path(name)
        begin = time.monotonic()
        run = start(program, folder, "out")
        if run.wait() != 0:
            sys.exit("the scene does not run: " + (folder / "wrong.txt").read_text())
        return time.monotonic() - begin


def killed(program, rng, whole, number):
    with tempfile.TemporaryDirectory(prefix="taut-faults-") as name:
        folder = pathlib.Path(name)
        out = folder / "out"
        run = start(program, folder, "out")
        time.sleep(rng.uniform(0, whole))
        run.send_signal(number)
        code = run.wait(timeout=60)
        early = code != 0
        yield early, announced(folder)
        yield from findings(folder, out)
        left = [p for p in folder.rglob("*.tmp")]
        wrong = (folder / "wrong.txt").read_text()
        if number == signal.SIGKILL:
            if code not in (0, -number):
                yield f"exit code {code}"
            if start(program, folder, "out").wait() != 0:
                yield "the next job fails: " + (folder / "wrong.txt").read_text()
            left = [p for p in folder.rglob("*.tmp")]
        # Before it listens to signals, one ends it as any program.
        elif code not in (0, 128 + number, -number):
            yield f"exit code {code}"
        elif code == 128 + number and "interrupted" not in wrong:
            yield "it does not say that it was interrupted"
        # Nor does it once all is written: the report comes last.
        elif code == -number and announced(folder) and not (folder / "out" / "report.html").exists():
            yield "it died of the signal"
        if left:
            yield f"left behind: {[p.name for p in left]}"


def filled(program, rng, whole):
    with tempfile.TemporaryDirectory(prefix="taut-faults-") as name:
        folder = pathlib.Path(name)
        disk = folder / "disk"
        disk.mkdir()
        small = rng.randrange(2) == 0
        size = rng.randrange(4, 600) if small else 4096  # kB
        subprocess.run(["mount", "-t", "tmpfs", "-o", f"size={size}k", "tmpfs", str(disk)], check=True)
        try:
            run = start(program, folder, disk / "out")
            if not small:
                time.sleep(rng.uniform(0, whole))
                try:
                    with open(disk / "filler", "wb", buffering=0) as filler:
                        while True:
                            filler.write(b"\0" * 4096)
                except OSError:
                    pass
            code = run.wait(timeout=120)
            yield code != 0, announced(folder)
            yield from findings(folder, disk / "out")
            wrong = (folder / "wrong.txt").read_text()
            if code not in (0, 1):
                yield f"exit code {code}: {wrong}"
            if code == 1 and "No space left on device" not in wrong:
                yield f"the full disk is not named: {wrong}"
            left = [p.name for p in (disk / "out").rglob("*.tmp")] if (disk / "out").exists() else []
            if left:
                yield f"left behind: {left}"
        finally:
            subprocess.run(["umount", str(disk)], check=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("fault", choices=["kill", "term", "full"])
    parser.add_argument("--count", type=int, default=100)
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    program = os.path.abspath(options.program)
    if options.fault == "full":
        with tempfile.TemporaryDirectory() as name:
            if subprocess.run(["mount", "-t", "tmpfs", "tmpfs", name], capture_output=True).returncode != 0:
                print("cannot mount a tmpfs here")
                return 77
            subprocess.run(["umount", name], check=True)
    whole = duration(program)
    bad = early = lines = 0
    for seed in range(options.seed, options.seed + options.count):
        rng = random.Random(seed)
        if options.fault == "full":
            trial = filled(program, rng, whole)
        else:
            number = signal.SIGKILL if options.fault == "kill" else rng.choice([signal.SIGTERM, signal.SIGINT])
            trial = killed(program, rng, whole, number)
        ended, told = next(trial)
        early += ended
        lines += len(told)
        wrong = list(trial)
        bad += bool(wrong)
        for what in wrong:
            print(f"{options.fault}, seed {seed}: {what}", flush=True)
    print(f"{options.fault}: {options.count} trials, {early} ended before their end, {lines} rows announced, {bad} with findings")
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main())
