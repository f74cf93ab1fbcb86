#!/usr/bin/env python3
"""Fails on a parallel region that an exception could leave, which would end the program.

Loops that call what is the user's (materials, functions, whatever is virtual) or take memory go through
<taut/base/parallel.hpp>. The regions named here do neither, with the reason; a new one has to be added to the
list by who has looked."""
import pathlib
import re
import sys

ARITHMETIC, GUARDED = "arithmetic on arrays only", "guards itself with a ParallelError"
REGIONS = {
    "core/base/include/taut/base/parallel.hpp": (4, GUARDED),
    "core/base/src/fields.cpp": (1, ARITHMETIC),
    "core/geometry/src/geometry_lattice.cpp": (2, ARITHMETIC),
    "core/operators/internal/taut/operators/closure_system.hpp": (6, ARITHMETIC),
    "core/operators/src/antisymmetric_operator.cpp": (1, ARITHMETIC),
    "core/operators/src/block_dictionary.cpp": (1, ARITHMETIC),
    "core/operators/src/compatible_operator.cpp": (1, ARITHMETIC),
    "core/operators/src/patch_fit.cpp": (2, ARITHMETIC),
    "core/operators/src/shared_vectors.cpp": (2, ARITHMETIC),
    "core/formulations/internal/taut/formulations/power_iteration.hpp": (2, ARITHMETIC),
    "core/formulations/internal/taut/formulations/updated_lagrangian.hpp": (2, ARITHMETIC),
    "core/formulations/src/formulation.cpp": (1, ARITHMETIC),
    "core/formulations/src/health_neighbours.cpp": (1, ARITHMETIC),
    "core/formulations/src/health_pairs.cpp": (3, ARITHMETIC),
    "core/formulations/src/health_updated.cpp": (1, ARITHMETIC),
    "core/formulations/src/tl_bond_associated.cpp": (3, ARITHMETIC),
    "core/formulations/src/tl_displacement.cpp": (3, ARITHMETIC),
    "core/formulations/src/tl_stress_points.cpp": (1, ARITHMETIC),
    "core/formulations/src/ul_artificial_stress.cpp": (1, ARITHMETIC),
    "boundary/src/loads.cpp": (1, ARITHMETIC),
    "integrators/src/relax.cpp": (2, ARITHMETIC),
    "integrators/src/vector_ops.cpp": (6, ARITHMETIC),
    "neighbors/src/cell_grid.cpp": (4, ARITHMETIC),
    "neighbors/src/clusters.cpp": (2, ARITHMETIC),
    "neighbors/src/filter.cpp": (1, GUARDED),
    "neighbors/src/locality_order.cpp": (3, ARITHMETIC),
    "neighbors/src/pair_list_builder.cpp": (1, ARITHMETIC),
    "neighbors/src/point_check.cpp": (1, ARITHMETIC),
    "neighbors/src/sort_by_key.cpp": (3, ARITHMETIC),
    "neighbors/src/verlet_list.cpp": (1, ARITHMETIC),
    "bench/scaling/compressed_pairs.cpp": (1, ARITHMETIC),
    "bench/scaling/csr_gather.cpp": (3, ARITHMETIC),
    "bench/scaling/eigen_sparse.cpp": (3, "arithmetic, and one that guards itself"),
    "bench/scaling/lists.cpp": (1, GUARDED),
    "bench/scaling/stream.cpp": (4, ARITHMETIC),
}

root = pathlib.Path(__file__).resolve().parent.parent
faults, seen = [], set()
for folder in ["core", "neighbors", "materials", "boundary", "integrators", "bench"]:
    for source in sorted((root / folder).rglob("*.[ch]pp")):
        name = str(source.relative_to(root))
        regions = len(re.findall(r"(?:#\s*pragma\s+|TAUT_OMP\()omp\s+parallel", source.read_text()))
        allowed = REGIONS.get(name, (0, ""))[0]
        seen.add(name)
        if regions > allowed:
            faults.append(f"{name}: {regions} parallel regions, {allowed} of them known to let nothing out; "
                          "loop with <taut/base/parallel.hpp>, or add to the list in .ci/check_parallel.py")
        elif regions < allowed:
            faults.append(f"{name}: {regions} parallel regions; .ci/check_parallel.py lists {allowed}")
faults += [f"{name}: in the list of .ci/check_parallel.py, but not in the tree" for name in REGIONS if name not in seen]
print("\n".join(faults) if faults else "no exception leaves a parallel region")
sys.exit(bool(faults))
