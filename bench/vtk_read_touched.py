#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""vtk_read_touched.py FILE...: VTK's time to read a file, its bounds and the ranges of all arrays: what our reading tasks do.

The peers' own reading records stop at Update(), which maps or copies bytes without a look at the numbers. Median of nine runs, in
milliseconds. Needs python3-vtk9.
"""
import sys
import time

import vtk

READERS = {"vti": vtk.vtkXMLImageDataReader, "vtu": vtk.vtkXMLUnstructuredGridReader, "vtp": vtk.vtkXMLPolyDataReader, "vtk": vtk.vtkGenericDataObjectReader}


def touch(data):
    data.GetBounds()
    for fields in (data.GetPointData(), data.GetCellData()):
        for i in range(fields.GetNumberOfArrays()):
            array = fields.GetArray(i)
            parts = range(array.GetNumberOfComponents())
            for c in list(parts) + ([-1] if len(parts) > 1 else []):
                array.GetRange(c)


for path in sys.argv[1:]:
    times = []
    for _ in range(9):
        reader = READERS[path.rsplit(".", 1)[-1]]()
        reader.SetFileName(path)
        begin = time.perf_counter()
        reader.Update()
        touch(reader.GetOutput())
        times.append(time.perf_counter() - begin)
    print(f"{sorted(times)[4] * 1e3:9.2f} ms  {path}")
