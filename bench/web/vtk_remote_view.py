# SPDX-License-Identifier: Apache-2.0
"""What a browser's view of VTK costs on the server: python3 bench/web/vtk_remote_view.py [FRAMES] [WIDTHxHEIGHT] [FOLDER]

trame's and PyVista's server-side views, as ParaView's web server, take their pictures from vtkWebApplication: it renders without a screen,
encodes JPEG and hands it on as text. This times that loop, without the socket and the browser that come on top: a drag of a lit 256^3 volume
and of a surface of 1 million triangles. VTK lowers the quality of volumes by itself to reach the frame rate that is asked for (30 per
second), as those views ask. Prints one line of JSON for each: milliseconds, median and 95 %.
"""
import json
import math
import sys
import time

import numpy
import vtkmodules.vtkInteractionStyle  # noqa: F401 (factories)
import vtkmodules.vtkRenderingOpenGL2  # noqa: F401
import vtkmodules.vtkRenderingVolumeOpenGL2  # noqa: F401
from vtkmodules.util.numpy_support import numpy_to_vtk
from vtkmodules.vtkCommonDataModel import vtkImageData, vtkPiecewiseFunction
from vtkmodules.vtkFiltersCore import vtkFlyingEdges3D
from vtkmodules.vtkIOPLY import vtkPLYWriter
from vtkmodules.vtkIOXML import vtkXMLImageDataWriter
from vtkmodules.vtkRenderingCore import (vtkActor, vtkColorTransferFunction, vtkPolyDataMapper, vtkRenderer, vtkRenderWindow,
                                         vtkRenderWindowInteractor, vtkVolume, vtkVolumeProperty)
from vtkmodules.vtkRenderingVolume import vtkFixedPointVolumeRayCastMapper
from vtkmodules.vtkRenderingVolumeOpenGL2 import vtkSmartVolumeMapper
from vtkmodules.vtkWebCore import vtkWebApplication

frames = int(sys.argv[1]) if len(sys.argv) > 1 else 60
width, height = map(int, (sys.argv[2] if len(sys.argv) > 2 else "1280x720").split("x"))


def grid(n: int) -> vtkImageData:
    """A field with structure at all sizes: 0 in empty corners, 255 at most."""
    x = numpy.linspace(-1, 1, n, dtype=numpy.float32)
    z, y, x = numpy.meshgrid(x, x, x, indexing="ij")
    f = numpy.exp(-3 * (x * x + y * y + z * z)) * (1 + 0.4 * numpy.sin(9 * x) * numpy.sin(11 * y) * numpy.sin(10 * z))
    image = vtkImageData(dimensions=(n, n, n))
    values = numpy_to_vtk((255 * f / f.max()).astype(numpy.uint8).ravel(), deep=True)
    values.SetName("f")
    image.GetPointData().SetScalars(values)
    return image


def volume(image: vtkImageData, mapper) -> vtkVolume:
    mapper.SetInputData(image)
    color = vtkColorTransferFunction()
    color.AddRGBPoint(0, 0.1, 0.1, 0.4)
    color.AddRGBPoint(255, 1, 0.8, 0.5)
    opacity = vtkPiecewiseFunction()
    opacity.AddPoint(40, 0)
    opacity.AddPoint(255, 0.3)
    p = vtkVolumeProperty()
    p.SetColor(color)
    p.SetScalarOpacity(opacity)
    p.ShadeOn()
    p.SetInterpolationTypeToLinear()
    v = vtkVolume()
    v.SetMapper(mapper)
    v.SetProperty(p)
    return v


def surface(image: vtkImageData):
    contour = vtkFlyingEdges3D()
    contour.SetInputData(image)
    contour.ComputeNormalsOn()
    for level in (30, 60, 90, 120, 150):
        contour.SetValue(contour.GetNumberOfContours(), level)
    contour.Update()
    return contour.GetOutput()


def shown(mesh) -> vtkActor:
    mapper = vtkPolyDataMapper()
    mapper.SetInputData(mesh)
    actor = vtkActor()
    actor.SetMapper(mapper)
    return actor


def keep(writer, data, name: str) -> None:
    writer.SetInputData(data)
    writer.SetFileName(f"{sys.argv[3]}/{name}")
    writer.Write()


def drag(name: str, prop, **more) -> None:
    renderer = vtkRenderer()
    renderer.SetBackground(0.1, 0.1, 0.12)
    renderer.AddViewProp(prop)
    window = vtkRenderWindow()
    window.SetOffScreenRendering(True)
    window.SetSize(width, height)
    window.AddRenderer(renderer)
    interactor = vtkRenderWindowInteractor()
    interactor.SetRenderWindow(window)
    interactor.SetDesiredUpdateRate(30)
    window.SetDesiredUpdateRate(30)
    renderer.ResetCamera()
    web = vtkWebApplication()
    web.SetImageEncoding(vtkWebApplication.ENCODING_BASE64)
    web.SetImageCompression(vtkWebApplication.COMPRESSION_JPEG)
    times = []
    for i in range(frames + 5):
        begin = time.perf_counter()
        renderer.GetActiveCamera().Azimuth(3)
        renderer.ResetCameraClippingRange()
        web.InvalidateCache(window)
        jpeg = web.InteractiveRender(window)
        if i >= 5:
            times.append(1000 * (time.perf_counter() - begin))
    times.sort()
    print(json.dumps({"task": name, "median_ms": round(times[len(times) // 2], 1), "p95_ms": round(times[math.floor(0.95 * (len(times) - 1))], 1),
                      "frames": len(times), "size": f"{width}x{height}", "bytes": jpeg.GetNumberOfValues() if jpeg else 0, **more}), flush=True)


big = grid(256)
mesh = surface(grid(231))  # 1 million triangles
if len(sys.argv) > 3:
    keep(vtkXMLImageDataWriter(), big, "volume.vti")
    keep(vtkPLYWriter(), mesh, "surface.ply")
drag("surface", shown(mesh), triangles=mesh.GetNumberOfPolys())
drag("volume, fixed point rays", volume(big, vtkFixedPointVolumeRayCastMapper()))
drag("volume, OpenGL rays", volume(big, vtkSmartVolumeMapper()))
