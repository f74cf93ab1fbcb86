"""Opens the field files of a taut-compare run with VTK's own reader and compares with results.csv.

Usage: check_vtkhdf.py TAUT_COMPARE SCENE FOLDER. Exit 77 (skipped) where VTK or field output is missing."""

import csv
import pathlib
import subprocess
import sys

try:
    from vtkmodules.vtkIOHDF import vtkHDFReader
except ImportError:
    print("VTK's Python module with vtkHDFReader is not installed (Debian: python3-vtk9)")
    sys.exit(77)

compare, scene, folder = sys.argv[1], sys.argv[2], pathlib.Path(sys.argv[3])
subprocess.run([compare, scene, "--out", str(folder), "--quiet"], check=True)
with open(folder / "results.csv") as table:
    row = next(csv.DictReader(table))
if not (folder / "fields").is_dir():
    print("this build has no field output")
    sys.exit(77)

files = sorted((folder / "fields").glob("*.vtkhdf"))
assert files, "no field file was written"
reader = vtkHDFReader()
reader.SetFileName(str(files[0]))
reader.Update()
grid = reader.GetOutput()
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
print(f"{files[0].name}: {particles} particles, ux = {ux:.6g} m at the probe, as in results.csv")
