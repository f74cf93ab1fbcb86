"""Opens the field files of taut-compare with VTK's own reader and compares with results.csv.

Usage: check_vtkhdf.py TAUT_COMPARE SMALL CONFINED FOLDER, with the scenes small.toml and confined.toml. Exit 77
(skipped) where VTK or field output is missing."""

import csv
import math
import pathlib
import subprocess
import sys

try:
    from vtkmodules.vtkIOHDF import vtkHDFReader
except ImportError:
    print("VTK's Python module with vtkHDFReader is not installed (Debian: python3-vtk9)")
    sys.exit(77)

compare, small, confined, folder = sys.argv[1], sys.argv[2], sys.argv[3], pathlib.Path(sys.argv[4])


def run(scene, out):
    """Rows of results.csv that are of probes, and the grid of the first field file."""
    subprocess.run([compare, scene, "--out", str(out), "--quiet"], check=True)
    with open(out / "results.csv") as table:
        rows = [row for row in csv.DictReader(table) if not row["quantity"].startswith("health_")]
    if not (out / "fields").is_dir():
        print("this build has no field output")
        sys.exit(77)
    files = sorted((out / "fields").glob("*.vtkhdf"))
    assert files, "no field file was written"
    reader = vtkHDFReader()
    reader.SetFileName(str(files[0]))
    reader.Update()
    return rows, reader.GetOutput()


def von_mises(s):
    direct = (s[0] - s[4]) ** 2 + (s[4] - s[8]) ** 2 + (s[8] - s[0]) ** 2
    return math.sqrt(direct / 2 + 3 * (s[1] * s[3] + s[2] * s[6] + s[5] * s[7]))


def close(a, b, relative=1e-3):
    return abs(a - b) <= relative * abs(b)


rows, grid = run(small, folder / "small")
row = rows[0]
assert grid.GetClassName() == "vtkUnstructuredGrid", grid.GetClassName()
particles = int(row["particles"])
assert grid.GetNumberOfPoints() == particles, (grid.GetNumberOfPoints(), particles)
assert grid.GetNumberOfCells() == particles

data = grid.GetPointData()
components = {"displacement": 3, "velocity": 3, "cauchy_stress": 9, "von_mises": 1, "mass": 1, "id": 1}
for name, count in components.items():
    array = data.GetArray(name)
    assert array is not None, f"{name} is missing"
    assert array.GetNumberOfComponents() == count, name
    assert array.GetNumberOfTuples() == particles, name

# The particle at the probe: reference position (0.2, 0.025), displacement as in results.csv.
best = min(
    range(particles),
    key=lambda i: sum((grid.GetPoint(i)[d] - data.GetArray("displacement").GetTuple(i)[d] - (0.2, 0.025, 0)[d]) ** 2 for d in range(3)),
)
ux = data.GetArray("displacement").GetTuple(best)[0]
assert abs(ux - float(row["value"])) < 1e-9, (ux, row["value"])
assert sorted(int(data.GetArray("id").GetTuple(i)[0]) for i in range(particles)) == list(range(particles))
for i in range(particles):
    sigma = data.GetArray("cauchy_stress").GetTuple(i)
    assert sigma[8] == 0, "plane stress has none across the plane"
    assert close(data.GetArray("von_mises").GetTuple(i)[0], von_mises(sigma), 1e-9)
print(f"small: {particles} particles, ux = {ux:.6g} m at the probe, as in results.csv")

rows, grid = run(confined, folder / "confined")
data = grid.GetPointData()
exact = {"sxx": -17114.09, "szz": -16442.95, "von_mises": 671.141, "pressure": 16666.67}
assert {row["quantity"] for row in rows} == set(exact), rows
for row in rows:
    assert row["unit"] == "Pa" and row["status"] == "ok", row
    assert close(float(row["value"]), exact[row["quantity"]]), row
for i in range(grid.GetNumberOfPoints()):
    sigma = data.GetArray("cauchy_stress").GetTuple(i)
    assert close(sigma[0], exact["sxx"]) and close(sigma[4], exact["szz"]) and close(sigma[8], exact["szz"]), sigma
    assert max(abs(sigma[k]) for k in (1, 2, 3, 5, 6, 7)) < 1, sigma
    assert close(data.GetArray("von_mises").GetTuple(i)[0], exact["von_mises"], 1e-2)
print("confined: von Mises 2 mu |e| in the file and in results.csv")
