#!/usr/bin/env python3
"""Fails where the name of a formulation, operator, kernel, material or neighbour search is compared with a string outside of the file
that registers it: what others need to know of it is a trait of its entry. Left out: the rules of `auto`, the tests, and lists of names."""
import pathlib
import re
import sys

root = pathlib.Path(__file__).resolve().parent.parent
FOLDERS = ["core", "materials", "neighbors", "boundary", "integrators", "bench"]
RULES = "core/formulations/src/auto_method.cpp"
# Values of parameters that are words like the names.
PARAMETERS = r"velocity_gradient\s*[!=]=\s*$"

sources = [s for folder in FOLDERS for s in sorted((root / folder).rglob("*.[ch]pp"))]
# Entries are `.name = "…"` in the files of what they name, or rows of a table in that of the registry.
home = {}
for source in sources:
    text = source.read_text()
    if re.search(r"\w+Entry\b", text):
        for name in re.findall(r'\.name = "(\w+)"', text):
            home.setdefault(name, set()).add(source)
for table, pattern in (("core/kernels/src/kernel.cpp", r'\{"(\w+)",\s*"'), ("neighbors/src/search.cpp", r'\{"(\w+)",\s*"')):
    for name in re.findall(pattern, (root / table).read_text()):
        home.setdefault(name, set()).add(root / table)

faults = []
for known in ("tl_displacement", "corrected", "wendland_c2", "neo_hookean", "kd_tree"):
    if known not in home:
        faults.append(f"{known} is registered nowhere that this script looks: it no longer knows how entries are written")
names = "|".join(sorted(home))
compared = re.compile(
    rf'(?P<before>[^"\n]*[!=]=\s*(?:std::string(?:_view)?\()?)"(?P<right>{names})"|"(?P<left>{names})"\)?\s*[!=]=|'
    rf'(?:starts_with|ends_with|compare|contains|find)\(\s*"(?P<call>{names}|tl_|ul_)"')
for source in sources:
    if source == root / RULES:
        continue
    for number, line in enumerate(source.read_text().splitlines(), 1):
        for match in compared.finditer(line):
            name = match["right"] or match["left"] or match["call"]
            if source in home.get(name, ()) or re.search(PARAMETERS, match["before"] or ""):
                continue
            faults.append(f'{source.relative_to(root)}:{number}: compares with "{name}"; ask a trait of its entry')
print("\n".join(faults) if faults else f"{len(home)} names, compared nowhere")
sys.exit(bool(faults))
