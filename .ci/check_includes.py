#!/usr/bin/env python3
"""Fails on an include that runs the wrong way: a room sees those named beside it, and itself."""
import pathlib
import re
import sys

LEAVES = ["neighbors", "materials", "integrators", "boundary"]
CORE = ["kernels", "geometry", "particles", "operators", "formulations", "simulation", "output"]
SEES = {"base": []}
SEES.update({leaf: ["base"] for leaf in LEAVES})
SEES["boundary"].append("neighbors")
for place, room in enumerate(CORE):
    SEES[room] = ["base", *LEAVES, *CORE[:place]]

root = pathlib.Path(__file__).resolve().parent.parent
faults = []
for room in SEES:
    folder = root / room if room in LEAVES else root / "core" / room
    sources = sorted(folder.rglob("*.[ch]pp"))
    if not sources:
        faults.append(f"{folder.relative_to(root)}: no sources; the rooms named here are not those of the tree")
    for source in sources:
        for number, line in enumerate(source.read_text().splitlines(), 1):
            include = re.match(r'\s*#\s*include\s*["<]taut/(\w+)/', line)
            seen = include and include[1]
            if seen and seen != room and seen not in SEES[room]:
                valid = ", ".join(SEES[room]) or "none"
                faults.append(f"{source.relative_to(root)}:{number}: {room} includes {seen}; it may include: {valid}")
print("\n".join(faults) if faults else "includes run one way")
sys.exit(bool(faults))
