#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Whose rounding is it? Streamlines of ours and of VTK's stream tracer against the same Runge-Kutta steps in extended precision (64 bits of
mantissa), through exactly the same interpolant: trilinear on a 128^3 grid, linear on a million tetrahedra.

  python3 bench/paths_vtk.py --data FOLDER --program build/sightglass [--seeds 1000] [--scratch FOLDER]

FOLDER holds abc_128.npy, tets_pts_1M.npy and tets_con_1M.npy of the peers' scripts. Two equations have the same curves: dx/dt = v with steps
of h / |v|, and dx/ds = v / |v| with steps of h, which both programs solve for steps in length. Their Runge-Kutta steps differ by the error
of the method: each program is measured against both, and the two exact paths against each other.
"""
import argparse
import os
import subprocess
import tempfile

import numpy as np

L = np.longdouble
STEPS, H = 1000, 2.0 / 127


def seeds(n):
    g = 1.22074408460575947536
    a = np.array([1 / g, 1 / g ** 2, 1 / g ** 3])
    return (1.8 * ((0.5 + np.arange(1, n + 1)[:, None] * a[None, :]) % 1.0) - 0.9).astype(np.float32)


def abc(x, y, z):
    a, b, c = 3 ** 0.5, 2 ** 0.5, 1.0
    x, y, z = (np.pi * (p + 1) for p in (x, y, z))
    return np.stack([a * np.sin(z) + c * np.cos(y), b * np.sin(x) + a * np.cos(z), c * np.sin(y) + b * np.cos(x)], -1)


class Grid:
    name = "grid of 128^3"

    def __init__(self, data):
        self.v = np.load(os.path.join(data, "abc_128.npy"))
        self.h = L(2.0 / 127)

    def vtk(self):
        import vtk
        from vtk.util import numpy_support as ns
        d = vtk.vtkImageData()
        d.SetDimensions(128, 128, 128)
        d.SetSpacing(*[2.0 / 127] * 3)
        d.SetOrigin(-1, -1, -1)
        a = ns.numpy_to_vtk(self.v.reshape(-1, 3), deep=1)
        a.SetName("abc")
        d.GetPointData().SetVectors(a)
        return d

    def begin(self, x):
        pass

    def velocity(self, x, live):
        q = (x + 1) / self.h
        inside = ((q >= 0) & (q <= 127)).all(1)
        c = np.clip(np.floor(np.where(inside[:, None], q, 0)), 0, 126)
        f = (np.where(inside[:, None], q, 0) - c).astype(L)
        i, j, k = (c[:, a].astype(np.int64) for a in range(3))
        out = np.zeros((len(x), 3), L)
        for n in range(8):
            a, b, e = n & 1, n >> 1 & 1, n >> 2
            w = (f[:, 0] if a else 1 - f[:, 0]) * (f[:, 1] if b else 1 - f[:, 1]) * (f[:, 2] if e else 1 - f[:, 2])
            out += w[:, None] * self.v[k + e, j + b, i + a].astype(L)
        return out, inside


class Tets:
    name = "1 M tetrahedra"

    def __init__(self, data):
        self.p = np.load(os.path.join(data, "tets_pts_1M.npy"))
        self.c = np.load(os.path.join(data, "tets_con_1M.npy")).astype(np.int64)
        x = self.p.astype(np.float64)
        self.v = abc(x[:, 0], x[:, 1], x[:, 2]).astype(np.float32)
        # Neighbours: equal faces stand side by side when they are sorted.
        n = len(self.c)
        face = np.sort(np.concatenate([np.delete(self.c, k, 1) for k in range(4)]), 1)
        key = (face[:, 0] << 42) | (face[:, 1] << 21) | face[:, 2]
        order = np.argsort(key, kind="stable")
        same = np.nonzero(key[order][1:] == key[order][:-1])[0]
        self.across = np.full(4 * n, -1)
        a, b = order[same], order[same + 1]
        self.across[a], self.across[b] = b % n, a % n
        self.across = self.across.reshape(4, n)

    def vtk(self):
        import vtk
        from vtk.util import numpy_support as ns
        g = vtk.vtkUnstructuredGrid()
        p = vtk.vtkPoints()
        p.SetData(ns.numpy_to_vtk(self.p, deep=1))
        g.SetPoints(p)
        ca = vtk.vtkCellArray()
        ca.SetData(ns.numpy_to_vtkIdTypeArray(np.arange(0, self.c.size + 1, 4, dtype=np.int64), deep=1),
                   ns.numpy_to_vtkIdTypeArray(self.c.reshape(-1), deep=1))
        g.SetCells(vtk.VTK_TETRA, ca)
        a = ns.numpy_to_vtk(self.v, deep=1)
        a.SetName("abc")
        g.GetPointData().SetVectors(a)
        return g

    def begin(self, x):
        middle = self.p[self.c].astype(np.float64).mean(1)
        from_x = np.asarray(x, np.float64)
        self.cell = np.empty(len(x), np.int64)
        for i in range(len(x)):
            self.cell[i] = np.argmin(((middle - from_x[i]) ** 2).sum(1))

    def barycentric(self, cell, x):
        p = self.p[self.c[cell]].astype(L)
        u, v, w, d = p[:, 1] - p[:, 0], p[:, 2] - p[:, 0], p[:, 3] - p[:, 0], x - p[:, 0]
        vw = np.cross(v, w)
        det = (u * vw).sum(1)
        r1, r2, r3 = (d * vw).sum(1) / det, (d * np.cross(w, u)).sum(1) / det, (d * np.cross(u, v)).sum(1) / det
        return np.stack([1 - r1 - r2 - r3, r1, r2, r3], 1)

    def velocity(self, x, live):
        n = len(x)
        out, inside = np.zeros((n, 3), L), np.zeros(n, bool)
        todo = np.nonzero(live)[0]
        while len(todo):
            r = self.barycentric(self.cell[todo], x[todo])
            worst = r.argmin(1)
            ok = r[np.arange(len(todo)), worst] >= 0
            at = todo[ok]
            out[at] = (r[ok][:, :, None] * self.v[self.c[self.cell[at]]].astype(L)).sum(1)
            inside[at] = True
            bad = todo[~ok]
            to = self.across[worst[~ok], self.cell[bad]]
            gone = to < 0
            bad, to = bad[~gone], to[~gone]  # the others are outside
            self.cell[bad] = to
            todo = bad
        return out, inside


def exact(mesh, start, by_length, keep_all=True):
    """Points of each line until a step leaves the mesh; rows of NaN after that."""
    x = start.astype(L)
    mesh.begin(x)
    live = np.ones(len(x), bool)
    h = L(0.5 * H)
    path = np.full((STEPS + 1, len(x), 3), np.nan)
    path[0] = x
    norm = lambda v: np.sqrt((v * v).sum(1, keepdims=True))

    def slope(at):
        v, ok = mesh.velocity(at, live)
        n = norm(v)
        n[n == 0] = 1
        return (v / n if by_length else v), ok, n

    for s in range(STEPS):
        k1, ok, n = slope(x)
        live &= ok
        d = h if by_length else h / n
        k2, ok, _ = slope(x + d / 2 * k1)
        live &= ok
        k3, ok, _ = slope(x + d / 2 * k2)
        live &= ok
        k4, ok, _ = slope(x + d * k3)
        live &= ok
        x = np.where(live[:, None], x + d / 6 * (k1 + 2 * k2 + 2 * k3 + k4), x)
        path[s + 1][live] = x[live]
        if not live.any():
            break
    return path


def vtk_lines(data, start):
    import vtk
    from vtk.util import numpy_support as ns
    d = vtk.vtkPolyData()
    p = vtk.vtkPoints()
    p.SetData(ns.numpy_to_vtk(start, deep=1))
    d.SetPoints(p)
    f = vtk.vtkStreamTracer()
    f.SetInputData(data)
    f.SetSourceData(d)
    f.SetInputArrayToProcess(0, 0, 0, 0, "abc")
    f.SetIntegratorTypeToRungeKutta4()
    if data.IsA("vtkUnstructuredGrid"):
        f.SetInterpolatorTypeToCellLocator()
    f.SetIntegrationDirectionToForward()
    f.SetIntegrationStepUnit(1)
    f.SetInitialIntegrationStep(0.5 * H)
    f.SetMinimumIntegrationStep(0.05 * H)
    f.SetMaximumIntegrationStep(2 * H)
    f.SetMaximumNumberOfSteps(STEPS)
    f.SetMaximumPropagation(1e6)
    f.SetTerminalSpeed(1e-12)
    f.SetComputeVorticity(False)
    f.Update()
    return lines_of(f.GetOutput(), "SeedIds")


def lines_of(poly, ids):
    from vtk.util import numpy_support as ns
    at = ns.vtk_to_numpy(poly.GetPoints().GetData()).astype(np.float64)
    begin = ns.vtk_to_numpy(poly.GetLines().GetOffsetsArray())
    con = ns.vtk_to_numpy(poly.GetLines().GetConnectivityArray())
    seed = ns.vtk_to_numpy(poly.GetCellData().GetArray(ids)).astype(int)
    return {seed[i]: at[con[begin[i]:begin[i + 1]]] for i in range(len(seed))}


def our_lines(program, data, start, scratch):
    import vtk
    grid = data.IsA("vtkImageData")
    w = vtk.vtkXMLImageDataWriter() if grid else vtk.vtkXMLUnstructuredGridWriter()
    file = os.path.join(scratch, "flow.vti" if grid else "flow.vtu")
    w.SetInputData(data)
    w.SetFileName(file)
    w.SetCompressorTypeToNone()
    w.EncodeAppendedDataOff()
    w.Write()
    out = os.path.join(scratch, "lines.vtp")
    op = ("streamlines direction=forward integrator=rk4 step=%.17g min_step=%.17g step_unit=length max_steps=%d max_length=1e6 "
          "min_speed=1e-12 closed=false attributes=none points=%s"
          % (0.5 * H, 0.05 * H, STEPS, ",".join("%.17g" % p for p in start.reshape(-1).astype(float))))
    subprocess.check_call([program, "convert", "-q", file, "-f", op, "-o", out])
    r = vtk.vtkXMLPolyDataReader()
    r.SetFileName(out)
    r.Update()
    return lines_of(r.GetOutput(), "seed")


def distances(lines, path):
    """Largest distance along each line, leaving out the last two points (ends at the border differ) and what lies beyond the exact path."""
    worst = {}
    for s, at in lines.items():
        n = min(len(at) - 2, len(path))
        if n < 2:
            continue
        d = np.linalg.norm(at[:n] - path[:n, s], axis=1)
        d = d[np.isfinite(d)]
        worst[s] = d.max()
    return worst


def curve_distances(lines, others):
    """Largest distance of a line's points from the other curve: a cubic through four of its points, at the nearest place."""
    worst = {}
    for s, at in lines.items():
        if s not in others or len(at) < 6 or len(others[s]) < 6:
            continue
        c = others[s]
        n = min(len(at), len(c)) - 4  # what lies before the end of the other
        x = at[1:n]
        # The nearest point near the same number of steps; the curves run side by side.
        k = np.arange(1, n)
        for _ in range(60):
            d = [((x - c[np.clip(k + j, 1, len(c) - 3)]) ** 2).sum(1) for j in (-1, 0, 1)]
            move = np.argmin(d, 0) - 1
            if not move.any():
                break
            k = np.clip(k + move, 1, len(c) - 3)
        best = np.full(len(x), np.inf)
        for first in (k - 1, k):
            i = np.clip(first, 1, len(c) - 3)
            p = [c[i + j] for j in (-1, 0, 1, 2)]
            lo, hi = np.zeros(len(x)), np.ones(len(x))
            place = lambda t: sum(w[:, None] * q for w, q in zip((-t * (t - 1) * (t - 2) / 6, (t + 1) * (t - 1) * (t - 2) / 2,
                                                                     -(t + 1) * t * (t - 2) / 2, (t + 1) * t * (t - 1) / 6), p))
            far = lambda t: ((place(t) - x) ** 2).sum(1)
            for _ in range(40):
                a, b = lo + (hi - lo) / 3, hi - (hi - lo) / 3
                left = far(a) < far(b)
                hi, lo = np.where(left, b, hi), np.where(left, lo, a)
            best = np.minimum(best, far((lo + hi) / 2))
        # Places beyond the other's end have no neighbour.
        best = best[(k > 1) & (k < len(c) - 4)]
        if len(best):
            worst[s] = np.sqrt(best.max())
    return worst


def row(name, worst):
    w = np.array(list(worst.values()))
    print("  %-52s median %.1e  99%% %.1e  largest %.1e  within 1e-5: %.1f %%  within 1e-6: %.1f %%"
          % (name, np.median(w), np.quantile(w, 0.99), w.max(), 100 * (w < 1e-5).mean(), 100 * (w < 1e-6).mean()))


def main():
    a = argparse.ArgumentParser()
    a.add_argument("--data", required=True)
    a.add_argument("--program", default="build/sightglass")
    a.add_argument("--seeds", type=int, default=1000)
    a.add_argument("--scratch", default=os.path.join(tempfile.gettempdir(), "sightglass-paths"))
    o = a.parse_args()
    os.makedirs(o.scratch, exist_ok=True)
    start = seeds(o.seeds)
    for kind in (Grid, Tets):
        mesh = kind(o.data)
        data = mesh.vtk()
        theirs = vtk_lines(data, start)
        ours = our_lines(o.program, data, start, o.scratch)
        by_time, by_length = (cached_exact(mesh, start, b, o) for b in (False, True))
        print("%s, %d lines of up to %d steps" % (mesh.name, o.seeds, STEPS))
        row("ours to the exact path of dx/dt = v", distances(ours, by_time))
        row("ours to the exact path of dx/ds = v/|v|", distances(ours, by_length))
        row("VTK to the exact path of dx/ds = v/|v|", distances(theirs, by_length))
        row("VTK to the exact path of dx/dt = v", distances(theirs, by_time))
        exact_lines = [{s: p[np.isfinite(p[:, 0])] for s, p in enumerate(np.swapaxes(e, 0, 1))} for e in (by_time, by_length)]
        print(" as curves:")
        row("exact dx/dt = v to exact dx/ds = v/|v|", curve_distances(*exact_lines))
        row("ours to VTK's", curve_distances(ours, theirs))


def cached_exact(mesh, start, by_length, o):
    file = os.path.join(o.scratch, "%s_%d_%s.npy" % (type(mesh).__name__, len(start), "length" if by_length else "time"))
    if not os.path.exists(file):
        np.save(file, exact(mesh, start, by_length))
    return np.load(file)


if __name__ == "__main__":
    main()
