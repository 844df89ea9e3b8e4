# SPDX-License-Identifier: Apache-2.0
"""What tools/vtk_roundtrip and its modes share: reading with VTK, and comparing numbers. Importing it needs VTK and numpy."""
import math

import numpy as np
from vtkmodules import vtkCommonDataModel as dm
from vtkmodules import vtkIOLegacy, vtkIOXML
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkIdList

EXTENSION = {"uniform": "vti", "rectilinear": "vtr", "curvilinear": "vts", "unstructured": "vtu", "surface": "vtp", "points": "vtp",
             "collection": "vtm", "amr": "vthb"}
VTK_XML = {"vti", "vtr", "vts", "vtu", "vtp", "pvti", "pvtr", "pvts", "pvtu", "pvtp", "vtm", "vthb"}


def read_vtk(path):
    ext = path.rsplit(".", 1)[-1].lower()
    if ext in ("vtk", "myvtk"):
        reader = vtkIOLegacy.vtkGenericDataObjectReader()
        for what in ("Scalars", "Vectors", "Normals", "Tensors", "TCoords", "Fields", "ColorScalars"):
            getattr(reader, f"ReadAll{what}On")()
    elif ext == "vthb":
        reader = vtkIOXML.vtkXMLUniformGridAMRReader()
        reader.SetMaximumLevelsToReadByDefault(0)
    else:
        reader = vtkIOXML.vtkXMLGenericDataObjectReader()
    errors = []
    reader.AddObserver("ErrorEvent", lambda *a: errors.append("VTK reports an error"))
    reader.SetFileName(path)
    reader.Update()
    data = reader.GetOutputDataObject(0)
    if errors or data is None:
        raise RuntimeError("VTK cannot read it")
    return data


def leaves(data):
    """Datasets in order."""
    if data is None:
        return []
    if data.IsA("vtkUniformGridAMR"):
        return [data.GetDataSet(l, i) for l in range(data.GetNumberOfLevels()) for i in range(data.GetNumberOfDataSets(l))
                if data.GetDataSet(l, i) is not None]
    if data.IsA("vtkDataObjectTree"):
        it = data.NewTreeIterator()
        it.VisitOnlyLeavesOn()
        it.SkipEmptyNodesOn()
        found = []
        it.InitTraversal()
        while not it.IsDoneWithTraversal():
            found += leaves(it.GetCurrentDataObject())
            it.GoToNextItem()
        return found
    return [data]


def same_numbers(a, b):
    if a.shape != b.shape:
        return False
    if a.dtype.kind == "f" or b.dtype.kind == "f":
        return bool(np.array_equal(a, b, equal_nan=True))
    return bool(np.array_equal(a, b))


def arrays(attributes):
    r = {}
    for i in range(attributes.GetNumberOfArrays()):
        a = attributes.GetArray(i)
        if a is not None and a.GetName():
            if a.IsA("vtkBitArray"):
                r[a.GetName()] = np.array([a.GetValue(k) for k in range(a.GetNumberOfValues())])
            else:
                r[a.GetName()] = vtk_to_numpy(a)
    return r


def cell_lists(d):
    def one(cells):
        return [vtk_to_numpy(cells.GetConnectivityArray()).astype(np.int64), vtk_to_numpy(cells.GetOffsetsArray()).astype(np.int64)]
    if d.IsA("vtkUnstructuredGrid"):
        lists = {"cells": one(d.GetCells())}
        if d.GetNumberOfCells():
            lists["types"] = [vtk_to_numpy(d.GetCellTypesArray())]
            if d.GetFaces() is not None:
                faces = []
                for c in range(d.GetNumberOfCells()):
                    if d.GetCellType(c) == 42:
                        stream = vtkIdList()
                        d.GetFaceStream(c, stream)
                        faces += [stream.GetId(k) for k in range(stream.GetNumberOfIds())]
                if faces:
                    lists["faces"] = [np.array(faces)]
        return lists
    if d.IsA("vtkPolyData"):
        return {"vertices": one(d.GetVerts()), "lines": one(d.GetLines()), "polygons": one(d.GetPolys()), "strips": one(d.GetStrips())}
    return {}


def compare_leaf(a, b, where):
    """What differs between VTK's readings of the original (a) and of the conversion (b)."""
    bad = []
    if a.GetNumberOfPoints() != b.GetNumberOfPoints() or a.GetNumberOfCells() != b.GetNumberOfCells():
        return [f"{where}: {a.GetNumberOfPoints()} points, {a.GetNumberOfCells()} cells became {b.GetNumberOfPoints()}, {b.GetNumberOfCells()}"]
    if a.IsA("vtkImageData"):
        if a.GetDimensions() != b.GetDimensions():
            bad.append(f"{where}: dimensions {a.GetDimensions()} became {b.GetDimensions()}")
        for k in range(a.GetNumberOfPoints() and 8):
            d = a.GetDimensions()
            i = sum((d[x] - 1) * (k >> x & 1) * int(np.prod(d[:x])) for x in range(3))
            p, q = a.GetPoint(i), b.GetPoint(i)
            if any(abs(x - y) > 1e-9 * max(1, abs(x)) for x, y in zip(p, q)):
                bad.append(f"{where}: corner {p} became {q}")
    elif a.IsA("vtkRectilinearGrid"):
        for axis in "XYZ":
            if not same_numbers(vtk_to_numpy(getattr(a, f"Get{axis}Coordinates")()), vtk_to_numpy(getattr(b, f"Get{axis}Coordinates")())):
                bad.append(f"{where}: {axis} coordinates differ")
    elif a.GetNumberOfPoints():
        if not same_numbers(vtk_to_numpy(a.GetPoints().GetData()), vtk_to_numpy(b.GetPoints().GetData())):
            bad.append(f"{where}: points differ")
    la, lb = cell_lists(a), cell_lists(b)
    for name, lists in la.items():
        if name not in lb or any(not same_numbers(x, y) for x, y in zip(lists, lb[name])):
            bad.append(f"{where}: {name} differ")
    for kind, get in (("point", "GetPointData"), ("cell", "GetCellData"), ("whole", "GetFieldData")):
        have = arrays(getattr(b, get)())
        for name, values in arrays(getattr(a, get)()).items():
            if values.size == 0 or (kind == "whole" and name in ("TimeValue", "TIME")):
                continue
            if name not in have:
                bad.append(f"{where}: {kind} array '{name}' is missing")
            elif not same_numbers(values, have[name]):
                bad.append(f"{where}: {kind} array '{name}' differs")
    return bad


def info_leaves(info):
    if info["kind"] == "collection":
        return [x for part in info["parts"] for x in info_leaves(part)]
    return [] if info["kind"] == "table" else [info]


def compare_info(info, d, where):
    """What differs between what sightglass says and what VTK reads of the conversion."""
    bad = []
    cells = d.GetNumberOfCells()
    if info["kind"] == "points":
        cells = 0
    if info["points"] != d.GetNumberOfPoints() or (info["cells"] != cells):
        bad.append(f"{where}: {info['points']} points, {info['cells']} cells became {d.GetNumberOfPoints()}, {cells}")
    if info["dims"] and list(d.GetDimensions()) != info["dims"]:
        bad.append(f"{where}: dims {info['dims']} became {d.GetDimensions()}")
    counts = {}
    for c in range(cells) if cells <= 200000 and info["kind"] != "points" else ():
        name = dm.vtkCellTypes.GetClassNameFromTypeId(d.GetCellType(c))[3:]
        counts[name] = counts.get(name, 0) + 1
    # Words and numbers of types that only later versions of VTK know are not compared.
    if counts and sum(counts.values()) != sum(info["cell_types"].values()):
        bad.append(f"{where}: cell types {info['cell_types']} became {counts}")
    if info["bounds"] and d.GetNumberOfPoints():
        for x, y in zip(info["bounds"], d.GetBounds()):
            if abs(x - y) > 1e-6 * max(1.0, abs(x)):
                bad.append(f"{where}: bounds {info['bounds']} became {d.GetBounds()}")
                break
    return bad + compare_ranges(info, [d], where)


GHOSTS = {"point": 1 | 2, "cell": 1 | 8 | 32, "whole": 0}  # bits of values that do not count


def compare_ranges(info, datasets, where):
    """Fields that info tells, over one dataset or all patches of one."""
    bad = []
    get = {"point": "GetPointData", "cell": "GetCellData", "whole": "GetFieldData"}
    have = {k: [arrays(getattr(d, g)()) for d in datasets] for k, g in get.items()}
    for f in info["fields"]:
        kind = f["association"]
        parts = []
        for h in have[kind][: 1 if kind == "whole" else None]:
            if f["name"] in h:
                v = h[f["name"]]
                if "vtkGhostType" in h and GHOSTS[kind]:
                    v = v[(h["vtkGhostType"] & GHOSTS[kind]) == 0]
                parts.append(v)
        if not parts:
            if f["range"] and any(f["range"]) and (info["cells"] or kind != "cell"):
                bad.append(f"{where}: {kind} array '{f['name']}' is missing")
            continue
        values = np.concatenate(parts)
        columns = values.reshape(len(values), -1) if values.size else values.reshape(0, f["components"])
        if columns.shape[1] != f["components"]:
            bad.append(f"{where}: '{f['name']}' has {columns.shape[1]} components, not {f['components']}")
            continue
        for c, r in enumerate(f["range"]):
            column = columns[:, c]
            if column.dtype.kind == "f":
                column = column[np.isfinite(column)]
            want = None if len(column) == 0 else [float(column.min()), float(column.max())]
            if (r is None) != (want is None) or (r and any(not math.isclose(x, y, rel_tol=1e-12) for x, y in zip(r, want))):
                bad.append(f"{where}: range of '{f['name']}' {r} became {want}")
    return bad
