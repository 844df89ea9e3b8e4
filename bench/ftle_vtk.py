#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""FTLE of the double gyre with VTK, as a script would do it: particles of a grid of seeds through 61 steps (vtkParticleTracer, its Runge-Kutta
4(5)), derivatives of where they went (vtkGradientFilter), eigenvalues with NumPy. Prints a JSON line beside our task `ftle_double_gyre`."""
import json
import sys
import time

import numpy as np
import vtk
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.util.vtkAlgorithm import VTKPythonAlgorithmBase

NX, NY, T, STEPS, SX, SY = 201, 101, 15.0, 61, 512, 256
TIMES = [T * k / (STEPS - 1) for k in range(STEPS)]


def gyre(t):
    x, y = np.meshgrid(np.linspace(0, 2, NX), np.linspace(0, 1, NY))
    e = 0.25 * np.sin(2 * np.pi / 10 * t)
    f, slope = e * x * x + (1 - 2 * e) * x, 2 * e * x + 1 - 2 * e
    u = -np.pi * 0.1 * np.sin(np.pi * f) * np.cos(np.pi * y)
    v = np.pi * 0.1 * np.cos(np.pi * f) * np.sin(np.pi * y) * slope
    a = numpy_to_vtk(np.stack([u, v, 0 * u], -1).astype(np.float32).reshape(-1, 3), deep=1)
    a.SetName("velocity")
    d = vtk.vtkImageData()
    d.SetDimensions(NX, NY, 2)  # its interpolation wants cells with a volume
    d.SetSpacing(2.0 / (NX - 1), 1.0 / (NY - 1), 0.1)
    d.SetOrigin(0, 0, -0.05)
    both = numpy_to_vtk(np.concatenate([vtk_to_numpy(a)] * 2), deep=1)
    both.SetName("velocity")
    d.GetPointData().SetVectors(both)
    return d


class Source(VTKPythonAlgorithmBase):
    def __init__(self, steps):
        super().__init__(nInputPorts=0, nOutputPorts=1, outputType="vtkImageData")
        self.steps = steps

    def RequestInformation(self, request, inputs, outputs):
        info, ex = outputs.GetInformationObject(0), vtk.vtkStreamingDemandDrivenPipeline
        info.Set(ex.TIME_STEPS(), TIMES, len(TIMES))
        info.Set(ex.TIME_RANGE(), [TIMES[0], TIMES[-1]], 2)
        info.Set(ex.WHOLE_EXTENT(), [0, NX - 1, 0, NY - 1, 0, 1], 6)
        return 1

    def RequestData(self, request, inputs, outputs):
        info = outputs.GetInformationObject(0)
        t = info.Get(vtk.vtkStreamingDemandDrivenPipeline.UPDATE_TIME_STEP())
        k = int(round((t or 0) / (TIMES[1] - TIMES[0])))
        out = vtk.vtkImageData.GetData(outputs)
        out.ShallowCopy(self.steps[min(max(k, 0), STEPS - 1)])
        out.GetInformation().Set(vtk.vtkDataObject.DATA_TIME_STEP(), TIMES[k])
        return 1


def run(steps):
    x, y = np.meshgrid(np.linspace(0, 2, SX), np.linspace(0, 1, SY))
    seeds = vtk.vtkPolyData()
    points = vtk.vtkPoints()
    points.SetData(numpy_to_vtk(np.stack([x, y, 0 * x], -1).reshape(-1, 3), deep=1))
    seeds.SetPoints(points)
    producer = vtk.vtkTrivialProducer()
    producer.SetOutput(seeds)
    source = Source(steps)
    tracer = vtk.vtkParticleTracer()
    tracer.SetInputConnection(0, source.GetOutputPort())
    tracer.AddSourceConnection(producer.GetOutputPort())
    tracer.SetInputArrayToProcess(0, 0, 0, 0, "velocity")
    tracer.SetComputeVorticity(False)
    tracer.SetStartTime(0.0)
    tracer.UpdateTimeStep(T)
    out = tracer.GetOutput()
    went = np.full((SX * SY, 3), np.nan)
    ids = vtk_to_numpy(out.GetPointData().GetArray("InjectedPointId"))
    went[ids] = vtk_to_numpy(out.GetPoints().GetData())
    grid = vtk.vtkImageData()
    grid.SetDimensions(SX, SY, 1)
    grid.SetSpacing(2.0 / (SX - 1), 1.0 / (SY - 1), 1)
    a = numpy_to_vtk(went, deep=1)
    a.SetName("map")
    grid.GetPointData().AddArray(a)
    gradient = vtk.vtkGradientFilter()
    gradient.SetInputData(grid)
    gradient.SetInputScalars(0, "map")
    gradient.Update()
    g = vtk_to_numpy(gradient.GetOutput().GetPointData().GetArray("Gradients")).reshape(-1, 3, 3)[:, :2, :2]
    c = np.einsum("nki,nkj->nij", g, g)
    c[~np.isfinite(c)] = 0
    return np.log(np.sqrt(np.linalg.eigvalsh(c)[:, 1].clip(1e-30))) / T


def main():
    vtk.vtkSMPTools.Initialize(2)
    steps = [gyre(t) for t in TIMES]
    seconds = []
    for _ in range(int(sys.argv[1]) if len(sys.argv) > 1 else 3):
        start = time.perf_counter()
        f = run(steps)
        seconds.append(time.perf_counter() - start)
    print(json.dumps({"task": "ftle_double_gyre", "size": "512x256 seeds x 60 intervals", "peer": "vtk%s:vtkParticleTracer+gradient" %
                      vtk.vtkVersion().GetVTKVersion(), "min_s": min(seconds), "median_s": float(np.median(seconds)), "runs": len(seconds),
                      "output_count": int(np.isfinite(f).sum()), "note": "max %.4f mean %.4f" % (np.nanmax(f), np.nanmean(f))}))


if __name__ == "__main__":
    main()
