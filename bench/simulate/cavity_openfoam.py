#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The lid-driven cavity by Sightglass and by OpenFOAM's icoFoam, by turns: seconds, and how far both are from Ghia, Ghia, Shin (1982).

    bench/simulate/cavity_openfoam.py --program build/sightglass [--foam 'COMMAND in front of blockMesh and icoFoam'] [--folder DIR]

Both take the same steps on the same n x n cells, from rest to time T. One core: icoFoam is serial without a decomposed case; Sightglass is
run with one thread and with all. Needs numpy.
"""
import argparse
import os
import re
import shlex
import shutil
import statistics
import subprocess
import time

import numpy as np

GHIA_Y = np.array([0.9531, 0.8516, 0.7344, 0.6172, 0.5, 0.4531, 0.2813, 0.1719, 0.1016, 0.0547])
GHIA_U = {100: [0.68717, 0.23151, 0.00332, -0.13641, -0.20581, -0.21090, -0.15662, -0.10150, -0.06434, -0.03717],
          400: [0.55892, 0.29093, 0.16256, 0.02135, -0.11477, -0.17119, -0.32726, -0.24299, -0.14612, -0.08186],
          1000: [0.46604, 0.33304, 0.18719, 0.05702, -0.06080, -0.10648, -0.27805, -0.38289, -0.29730, -0.18109]}

HEAD = "FoamFile {{ version 2.0; format ascii; class {}; object {}; }}\n"


def write_case(folder, n, re_number, dt, end):
    """The tutorial's cavity on n x n cells with the standard schemes (linear, PISO with two corrections)."""
    for sub in ("0", "constant", "system"):
        os.makedirs(f"{folder}/{sub}", exist_ok=True)

    def put(path, kind, text):
        with open(f"{folder}/{path}", "w") as f:
            f.write(HEAD.format(kind, os.path.basename(path)) + text)

    put("system/blockMeshDict", "dictionary", f"""scale 1;
vertices ((0 0 0) (1 0 0) (1 1 0) (0 1 0) (0 0 0.1) (1 0 0.1) (1 1 0.1) (0 1 0.1));
blocks (hex (0 1 2 3 4 5 6 7) ({n} {n} 1) simpleGrading (1 1 1));
edges ();
boundary (lid {{ type wall; faces ((3 7 6 2)); }} walls {{ type wall; faces ((0 4 7 3) (2 6 5 1) (1 5 4 0)); }}
 flat {{ type empty; faces ((0 3 2 1) (4 5 6 7)); }});
""")
    put("system/controlDict", "dictionary", f"""application icoFoam; startFrom startTime; startTime 0; stopAt endTime; endTime {end}; deltaT {dt};
writeControl timeStep; writeInterval {round(end / dt)}; purgeWrite 0; writeFormat ascii; writePrecision 8; timeFormat general; timePrecision 6;
""")
    put("system/fvSchemes", "dictionary", """ddtSchemes { default Euler; } gradSchemes { default Gauss linear; }
divSchemes { default none; div(phi,U) Gauss linear; } laplacianSchemes { default Gauss linear orthogonal; }
interpolationSchemes { default linear; } snGradSchemes { default orthogonal; }
""")
    put("system/fvSolution", "dictionary", """solvers {
p { solver GAMG; smoother GaussSeidel; tolerance 1e-6; relTol 0.05; } pFinal { $p; relTol 0; }
U { solver smoothSolver; smoother symGaussSeidel; tolerance 1e-5; relTol 0; } }
PISO { nCorrectors 2; nNonOrthogonalCorrectors 0; pRefCell 0; pRefValue 0; }
""")
    put("constant/transportProperties", "dictionary", f"nu [0 2 -1 0 0 0 0] {1 / re_number};\n")
    put("0/U", "volVectorField", """dimensions [0 1 -1 0 0 0 0]; internalField uniform (0 0 0);
boundaryField { lid { type fixedValue; value uniform (1 0 0); } walls { type noSlip; } flat { type empty; } }
""")
    put("0/p", "volScalarField", """dimensions [0 2 -2 0 0 0 0]; internalField uniform 0;
boundaryField { lid { type zeroGradient; } walls { type zeroGradient; } flat { type empty; } }
""")


def miss(u, n, re_number):
    """Largest difference on the middle line x = 1/2; u: rows from below, n even."""
    column = 0.5 * (u[:, n // 2 - 1] + u[:, n // 2])
    y = np.concatenate([[0], (np.arange(n) + 0.5) / n, [1]])
    return np.abs(np.interp(GHIA_Y, y, np.concatenate([[0], column, [1]])) - GHIA_U[re_number]).max()


def foam(prefix, folder, n, re_number, dt, end):
    shutil.rmtree(folder, ignore_errors=True)
    write_case(folder, n, re_number, dt, end)
    subprocess.run(prefix + ["blockMesh", "-case", folder], check=True, stdout=subprocess.DEVNULL)
    begin = time.perf_counter()
    subprocess.run(prefix + ["icoFoam", "-case", folder], check=True, stdout=subprocess.DEVNULL)
    seconds = time.perf_counter() - begin
    with open(f"{folder}/{end:g}/U") as f:
        numbers = re.findall(r"\(([-+0-9.e]+) ([-+0-9.e]+) [-+0-9.e]+\)", f.read())[: n * n]
    return seconds, miss(np.array(numbers, float)[:, 0].reshape(n, n), n, re_number)


def ours(program, folder, n, re_number, dt, end, threads, more):
    os.makedirs(folder, exist_ok=True)
    out = f"{folder}/u.npy"
    # One step a frame: the time step is that of the other.
    source = (f"smoke size={n} bounds=0,1,0,1,0,0 sides='x0 held; x1 held; y0 held; y1 held 1,0,0' viscosity={1 / re_number!r} density=0 "
              f"temperature=0 weight=0 lift=0 limit=no frame={dt} time={end} cfl=10 {more}")
    begin = time.perf_counter()
    subprocess.run([program, "convert", "-q", "--threads", str(threads), "--source", source, "-f", "component field=velocity component=0", "-f", "select keep=velocity_x",
                    "-o", out], check=True, stderr=subprocess.DEVNULL)
    seconds = time.perf_counter() - begin
    return seconds, miss(np.load(out).reshape(n, n), n, re_number)


def main():
    a = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    a.add_argument("--program", default="build/sightglass")
    a.add_argument("--foam", default="", help="in front of blockMesh and icoFoam, e.g. 'chroot ROOT env -C DIR'")
    a.add_argument("--folder", default="cavity-bench", help="seen by both at the same path")
    a.add_argument("--rounds", type=int, default=3)
    a.add_argument("--re", type=int, action="append", help="this Reynolds number alone; may be repeated")
    a.add_argument("--cells", type=int, help="along each side (even), with steps of 0.64 / cells; default: 64, and 128 from Re 400 on")
    o = a.parse_args()
    folder, prefix = os.path.abspath(o.folder), shlex.split(o.foam)
    print(f"{'Re':>5} {'cells':>7} {'steps':>6} {'':22} {'seconds':>8} {'ms/step':>8} {'difference to Ghia':>19}")
    for re_number, n, dt, end in ((100, 64, 0.01, 10), (400, 128, 0.005, 20), (1000, 128, 0.005, 40)):
        if o.re and re_number not in o.re:
            continue
        if o.cells:
            n, dt = o.cells, 0.64 / o.cells
        tries = {"icoFoam": lambda: foam(prefix, f"{folder}/foam", n, re_number, dt, end),
                 "sightglass, 1 thread": lambda: ours(o.program, folder, n, re_number, dt, end, 1, ""),
                 "sightglass": lambda: ours(o.program, folder, n, re_number, dt, end, 0, ""),
                 "sightglass reflect": lambda: ours(o.program, folder, n, re_number, dt, end, 0, "reflect=yes")}
        results = {name: [] for name in tries}
        for _ in range(o.rounds):
            for name, run in tries.items():
                results[name].append(run())
        for name, runs in results.items():
            seconds = statistics.median(r[0] for r in runs)
            print(f"{re_number:5} {n:4}^2 {round(end / dt):6} {name:22} {seconds:8.2f} {seconds / (end / dt) * 1000:8.2f} {runs[0][1]:19.4f}",
                  flush=True)


if __name__ == "__main__":
    main()
