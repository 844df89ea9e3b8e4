# SPDX-License-Identifier: Apache-2.0
"""The four checks of tools/vtk_roundtrip: VTK's own forms, everything as cells, our other writers, and parallel files.

Each check(sightglass, path, believes_vtk) gives (result, lines): "same", "agrees", "differs" with what differs, "table", "empty",
"unread".
"""
import json, os, subprocess

import numpy as np
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules import vtkIOXML
from vtkmodules.vtkFiltersVerdict import vtkCellSizeFilter

from vtk_compare import (EXTENSION, VTK_XML, arrays, compare_info, compare_leaf, compare_ranges, info_leaves, leaves, read_vtk,
                         same_numbers)

MOST_CSV_POINTS = 200000
# What a format cannot hold, and our writers refuse in these words: a stated loss, no difference.
STATED = ("there is no point field of 1 or 3 components to write",)
WRITERS = {"uniform": "vtkhdf nrrd mha nii vdb npy csv", "rectilinear": "csv", "curvilinear": "csv", "unstructured": "vtkhdf csv",
           "surface": "vtkhdf stl ply obj csv", "points": "vtkhdf ply npy csv", "amr": "vtkhdf"}


class Sightglass:
    """The program, and a folder for what it writes."""

    def __init__(self, program, folder, options):
        self.program, self.folder, self.options = program, folder, options

    def run(self, *words):
        return subprocess.run([self.program, *words], capture_output=True, text=True)

    def info(self, path, *words):
        told = self.run("info", "--json", path, *words)
        if told.returncode:
            raise ValueError(told.stderr.strip()[:300])
        return json.loads(told.stdout)

    def convert(self, path, name, ext, *words):
        """The path of the new file; ValueError with the message when it cannot be written."""
        out = os.path.join(self.folder, f"{name}{os.getpid()}.{ext}")
        done = self.run("convert", path, "-o", out, *words)
        if done.returncode:
            raise ValueError(f".{ext}: {done.stderr.strip()[-300:]}")
        return out

    def as_vtk(self, path, name, kind, *words):
        return leaves(read_vtk(self.convert(path, name, EXTENSION[kind], *self.options, *words)))


def table_leaves(info):
    if info["kind"] == "collection":
        return [x for part in info["parts"] for x in table_leaves(part)]
    return [info] if info["kind"] == "table" else []


def check_tables(sightglass, path, info):
    """A table to .csv and back: the same columns, rows and ranges, and the same bytes when it is written again."""
    if info["kind"] != "table":
        return "table", ["several tables, which one .csv cannot hold"]
    once = sightglass.convert(path, "once", "csv")
    again = sightglass.convert(once, "again", "csv")
    bad = [] if open(once, "rb").read() == open(again, "rb").read() else ["the second .csv is another than the first"]
    for a, b in zip(info["columns"], (back := sightglass.info(once))["columns"]):
        for key in ("name", "rows", "range"):
            if a.get(key) != b.get(key):
                bad.append(f"column '{a['name']}': {key} {a.get(key)} became {b.get(key)}")
    if len(info["columns"]) != len(back["columns"]):
        bad.append(f"{len(info['columns'])} columns became {len(back['columns'])}")
    return ("differs", bad) if bad else ("table", [])


def start(sightglass, path):
    """(info, None), or (None, result) when there is no mesh."""
    try:
        info = sightglass.info(path)
    except ValueError as e:
        return None, ("unread", [str(e)[:200]])
    if not info_leaves(info):
        return (None, check_tables(sightglass, path, info)) if table_leaves(info) else (None, ("empty", []))
    return info, None


def check_vtk(sightglass, path, believes_vtk):
    info, done = start(sightglass, path)
    if done:
        return done
    kind = info["kind"]
    after = sightglass.as_vtk(path, "out", kind)
    told = info_leaves(info)
    bad = []
    if kind == "amr":
        cells = sum(d.GetNumberOfCells() for d in after)
        if cells != info["cells"]:
            bad.append(f"{info['cells']} cells became {cells}")
        bad += compare_ranges(info, after, "all patches")
    elif len(after) != len(told):
        bad.append(f"{len(told)} parts became {len(after)}")
    else:
        for i, (x, y) in enumerate(zip(told, after)):
            bad += compare_info(x, y, f"part {i}")
    exact = False
    if believes_vtk and path.rsplit(".", 1)[-1].lower() in VTK_XML | {"vtk", "myvtk"}:
        before = leaves(read_vtk(path))
        exact = True
        if len(before) != len(after):
            bad.append(f"VTK reads {len(before)} parts of the original and {len(after)} of the conversion")
        for i, (x, y) in enumerate(zip(before, after)):
            if x.GetClassName() != y.GetClassName():
                if not (x.IsA("vtkImageData") and y.IsA("vtkImageData")):
                    bad.append(f"part {i}: a {x.GetClassName()} became a {y.GetClassName()}")
                    continue
            bad += compare_leaf(x, y, f"part {i}")
    return ("differs", bad) if bad else ("same" if exact else "agrees", [])


def sizes(datasets):
    """Length, area and volume of every cell, by VTK."""
    found = []
    for d in datasets:
        if d.GetNumberOfCells() == 0:
            continue
        if d.GetCellData().HasArray("vtkGhostType"):  # hidden cells count here as well
            whole = d.NewInstance()
            whole.ShallowCopy(d)
            whole.GetCellData().RemoveArray("vtkGhostType")
            d = whole
        f = vtkCellSizeFilter()
        f.SetInputDataObject(d)
        f.ComputeVertexCountOff()
        f.Update()
        data = f.GetOutputDataObject(0).GetCellData()
        found.append(np.stack([vtk_to_numpy(data.GetArray(n)) for n in ("Length", "Area", "Volume")], axis=1))
    return np.concatenate(found) if found else np.zeros((0, 3))


def close(a, b):
    scale = float(np.nanmax(np.abs(a))) if a.size and np.isfinite(a).any() else 0.0
    return a.shape == b.shape and bool(np.allclose(a, b, rtol=1e-5, atol=1e-6 * scale, equal_nan=True))


def in_order(rows):
    return rows[np.lexsort(rows.T)] if len(rows) else rows


def check_unstructured(sightglass, path, believes_vtk):
    """As cells: the counts, ranges and bounds that info tells, and each cell as long, large and voluminous as in its own kind of mesh.
    Then in two halves, whose cells together are all of them."""
    info, done = start(sightglass, path)
    if done:
        return done if done[0] == "unread" else ("table", [])
    kind = info["kind"]
    form = "collection" if kind == "collection" else "unstructured"
    before = sightglass.as_vtk(path, "own", kind)
    after = sightglass.as_vtk(path, "cells", form, "-f", "unstructured")
    told = info_leaves(info)
    if len(after) != len(told):
        return "differs", [f"{len(told)} parts became {len(after)}"]
    bad = []
    for i, (x, y) in enumerate(zip(told, after)):
        x = dict(x, dims=None)
        if x["kind"] == "points":
            x.update(kind="cells", cells=x["points"], cell_types={"vertex": x["points"]})
        bad += compare_info(x, y, f"part {i}")
    n = [sizes(before), sizes(after)]
    if kind != "points" and not close(*n):
        bad.append(f"cells are of other sizes: {n[0].sum(axis=0)} became {n[1].sum(axis=0)} in all")
    halves = []
    for k in range(2):
        halves += sightglass.as_vtk(path, f"half{k}", form, "-f", "unstructured", "-f", f"piece piece={k} pieces=2")
    together = sizes(halves)
    if not close(in_order(np.round(n[1], 9)).sum(axis=0), in_order(np.round(together, 9)).sum(axis=0)) or len(together) != len(n[1]):
        bad.append(f"two halves have {len(together)} cells of {together.sum(axis=0)}, the whole {len(n[1])} of {n[1].sum(axis=0)}")
    for association in ("GetPointData", "GetCellData"):
        names = lambda parts: {n for d in parts for n in arrays(getattr(d, association)()) if d.GetNumberOfCells()}
        if names(after) != names(halves):
            bad.append(f"halves have the arrays {sorted(names(halves))}, not {sorted(names(after))}")
    return ("differs", bad) if bad else ("agrees", [])


def triangles(d):
    """Corners of all triangles, (n, 9); polygons as fans, strips turned."""
    xyz = vtk_to_numpy(d.GetPoints().GetData()).astype(np.float32)
    rows = []
    for cells, strip in ((d.GetPolys(), False), (d.GetStrips(), True)):
        ids, at = vtk_to_numpy(cells.GetConnectivityArray()), vtk_to_numpy(cells.GetOffsetsArray())
        for b, e in zip(at[:-1], at[1:]):
            for k in range(e - b - 2):
                rows.append((ids[b + k], ids[b + k + 1 + k % 2], ids[b + k + 2 - k % 2]) if strip
                            else (ids[b], ids[b + k + 1], ids[b + k + 2]))
    return xyz[np.array(rows, dtype=np.int64).reshape(-1, 3)].reshape(-1, 9) + 0.0  # no -0


def corners(d):
    n = d.GetDimensions()
    return np.array([d.GetPoint(sum((n[x] - 1) * (k >> x & 1) * int(np.prod(n[:x])) for x in range(3))) for k in range(8)])


def same_values(ext, a, b):
    if ext == "vdb" and a.dtype != np.float64:  # these are held as f32
        a, b = a.astype(np.float32), b.astype(np.float32)
    return a.reshape(len(a), -1).shape == b.reshape(len(b), -1).shape and same_numbers(a.reshape(len(a), -1), b.reshape(len(b), -1))


def compare_arrays(ext, a, b, all_of_them):
    """Point arrays: those that came back are among those that went in; all of them, or one at least."""
    went, came = arrays(a.GetPointData()), arrays(b.GetPointData())
    if ext == "vdb":
        went = {k: v for k, v in went.items() if v.ndim == 1 or v.shape[1] in (1, 3)}
    went = {k: v for k, v in went.items() if k != "vtkGhostType" and len(v)}
    bad = [f"'{name}' came back otherwise" for name, v in came.items()
           if len(v) and not (same_values(ext, went[name], v) if name in went else any(same_values(ext, x, v) for x in went.values()))]
    missing = set(went) - set(came) if all_of_them else ()
    if missing or (went and not came):
        bad.append(f"{sorted(missing or went)} did not come back")
    return bad


def compare_grid(ext, a, b):
    if ext == "npy":
        return compare_arrays(ext, a, b, False)
    if a.GetDimensions() != b.GetDimensions():
        return [f"dimensions {a.GetDimensions()} became {b.GetDimensions()}"]
    p, q = corners(a), corners(b)
    tolerance = (1e-5 if ext == "nii" else 1e-9) * max(1e-30, float(np.abs(p).max()))
    turned = [np.array(s) for s in ((1, 1, 1), (-1, -1, 1), (-1, 1, 1), (1, -1, 1))][: 4 if ext == "nii" else 1]  # LPS to RAS
    bad = [] if any(np.abs(p * s - q).max() <= tolerance for s in turned) else [f"corners {p[0]} {p[7]} became {q[0]} {q[7]}"]
    return bad + compare_arrays(ext, a, b, ext == "vdb")


def compare_surface(ext, a, b):
    p, q = triangles(a), triangles(b)
    bad = [] if p.shape == q.shape and np.array_equal(p, q) else [f"{len(p)} triangles came back as {len(q)} others"]
    if ext == "ply":
        if not same_numbers(vtk_to_numpy(a.GetPoints().GetData()), vtk_to_numpy(b.GetPoints().GetData())):
            bad.append("points differ")
        bad += compare_arrays(ext, a, b, True)
    return bad


def check_csv(sightglass, path, info):
    once = sightglass.convert(path, "once", "csv")
    again = sightglass.convert(once, "again", "csv")
    bad = [] if open(once, "rb").read() == open(again, "rb").read() else ["the second .csv is another than the first"]
    columns = {c["name"]: c for c in sightglass.info(once)["columns"]}
    for f in info["fields"]:
        ends = "xyz" if f["components"] <= 3 and f"{f['name']}_x" in columns else "0123456789"  # vectors by axes, others by numbers
        for c, r in enumerate(f["range"]) if f["association"] == "point" else ():
            name = f["name"] if f["components"] == 1 else f"{f['name']}_{ends[c] if c < len(ends) else c}"
            if name not in columns:
                bad.append(f"no column '{name}'")
            elif r and not np.allclose(r, columns[name]["range"][0], rtol=1e-6, atol=0):  # f32 is written with as many digits as it needs
                bad.append(f"column '{name}': {r} became {columns[name]['range'][0]}")
    return bad


def through(sightglass, path, info, ext):
    kind = info["kind"]
    if ext == "csv":
        return check_csv(sightglass, path, info)
    written = sightglass.convert(path, "written", ext)
    back = sightglass.info(written)
    before, after = sightglass.as_vtk(path, "before", kind), sightglass.as_vtk(written, "after", back["kind"])
    if len(before) != len(after):
        return [f"{len(before)} parts became {len(after)}"]
    if ext == "vtkhdf":
        if back["kind"] != kind:
            return [f"{kind} became {back['kind']}"]
        return [line for i, (a, b) in enumerate(zip(before, after)) for line in compare_leaf(a, b, f"part {i}")]
    a, b = before[0], after[0]
    if kind == "uniform":
        return compare_grid(ext, a, b)
    if kind == "points":
        return [] if ext == "npy" else compare_arrays(ext, a, b, True)
    return compare_surface(ext, a, b)


def check_writers(sightglass, path, believes_vtk):
    info, done = start(sightglass, path)
    if done:
        return done
    bad, good = [], []
    if info["kind"] == "collection":
        return "table", ["a collection; .vtm holds it"]
    fields = [f for f in info["fields"] if f["association"] == "point"]
    for ext in WRITERS[info["kind"]].split():
        if (ext in ("nrrd", "mha", "nii", "vdb", "npy") and not fields) or (ext == "csv" and info["points"] > MOST_CSV_POINTS):
            continue
        if ext in ("stl", "ply", "obj") and not info["cells"]:
            continue
        try:
            found = through(sightglass, path, info, ext)
        except ValueError as e:
            if any(s in str(e) for s in STATED):
                good.append(f"({ext}: cannot hold it)")
                continue
            found = [str(e)]
        bad += [f".{ext}: {line}" for line in found[:4]]
        good += [] if found else [ext]
    return ("differs", bad) if bad else ("agrees", [" ".join(good)] if good else [])


PARALLEL = {"uniform": "pvti", "rectilinear": "pvtr", "curvilinear": "pvts", "unstructured": "pvtu", "surface": "pvtp", "points": "pvtp"}
READERS = {"pvti": "Image", "pvtr": "RectilinearGrid", "pvts": "StructuredGrid", "pvtu": "UnstructuredGrid", "pvtp": "PolyData"}


def read_parallel(path):
    ext = path.rsplit(".", 1)[-1]
    reader = getattr(vtkIOXML, f"vtkXMLP{READERS[ext]}{'Data' if ext == 'pvti' else ''}Reader")()
    reader.SetFileName(path)
    reader.Update()
    return reader.GetOutput()


def check_pieces(sightglass, path, believes_vtk):
    """A mesh in three pieces: VTK's parallel reader and ours find what a lone file holds; grids number for number."""
    info, done = start(sightglass, path)
    if done:
        return done if done[0] == "unread" else ("table", [])
    if info["kind"] not in PARALLEL:
        return "table", [f"no parallel file holds a mesh of kind {info['kind']}"]
    ext = PARALLEL[info["kind"]]
    written = sightglass.convert(path, "pieces", ext, "--pieces", "3", *sightglass.options)
    one = sightglass.convert(path, "one", ext[1:], *sightglass.options)
    told, lone, read, whole = sightglass.info(written), sightglass.info(one), read_parallel(written), read_vtk(one)
    bad = []
    for key in ("kind", "dims", "cells", "cell_types", "origin", "spacing", "direction"):
        if told.get(key) != lone.get(key):
            bad.append(f"{key}: {lone.get(key)} became {told.get(key)}")
    if info["dims"]:
        if whole.IsA("vtkImageData"):  # VTK 9.1 leaves the direction out of parallel files
            read.SetDirectionMatrix(whole.GetDirectionMatrix())
        return ("differs", bad) if (bad := bad + compare_leaf(whole, read, "VTK")) else ("agrees", [])
    # Points at the seams stand in both pieces; those of no cell in none.
    bad += compare_info(dict(told, kind=lone["kind"]), read, "VTK")
    cells = {f["name"]: f for f in told["fields"] if f["association"] == "cell"}
    bad += [f"cell array '{f['name']}' became {cells.get(f['name'])}" for f in lone["fields"]
            if f["association"] == "cell" and cells.get(f["name"]) != f]
    names = lambda i: {(f["name"], f["association"], f["type"], f["components"]) for f in i["fields"]}
    if names(told) != names(lone):
        bad.append(f"the fields {sorted(names(lone))} became {sorted(names(told))}")
    if not close(in_order(np.round(sizes([whole]), 9)).sum(axis=0), in_order(np.round(sizes([read]), 9)).sum(axis=0)):
        bad.append("cells are of other sizes")
    return ("differs", bad) if bad else ("agrees", [])
