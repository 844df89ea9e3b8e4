# SPDX-License-Identifier: Apache-2.0
# bench/vtk_volume_picture.py FIELD.npy N SCENE OUT.raw: the picture of VTK's fixed-point ray caster that `sg_bench --only volume_error`
# compares with brute force: half-voxel steps, colours from black at -3 to white at 4, 1024x1024, red bytes from the top row down.
import math
import sys

import numpy as np
import vtk
from vtk.util import numpy_support as ns

path, n, scene, out = sys.argv[1], int(sys.argv[2]), sys.argv[3], sys.argv[4]
SCENES = {
    "bands": [(-3, 0), (-.9, 0), (-.6, .15), (-.3, 0), (.2, 0), (.5, .3), (.8, 0), (1.6, 0), (2, .8), (4, .8)],
    "lit": [(-3, 0), (-.9, 0), (-.6, .15), (-.3, 0), (.2, 0), (.5, .3), (.8, 0), (1.6, 0), (2, .8), (4, .8)],
    "fog": [(-3, .002), (4, .01)],
}
image = vtk.vtkImageData()
h = 2.0 / (n - 1)
image.SetDimensions(n, n, n)
image.SetSpacing(h, h, h)
image.SetOrigin(-1, -1, -1)
values = np.load(path).ravel()
image.GetPointData().SetScalars(ns.numpy_to_vtk(values))
mapper = vtk.vtkFixedPointVolumeRayCastMapper()
mapper.SetInputData(image)
mapper.SetAutoAdjustSampleDistances(0)
mapper.SetLockSampleDistanceToInputSpacing(0)
mapper.SetSampleDistance(0.5 * h)
mapper.SetImageSampleDistance(1.0)
mapper.SetIntermixIntersectingGeometry(0)
color, opacity = vtk.vtkColorTransferFunction(), vtk.vtkPiecewiseFunction()
color.AddRGBPoint(-3, 0, 0, 0)
color.AddRGBPoint(4, 1, 1, 1)
for v, a in SCENES[scene]:
    opacity.AddPoint(v, a)
prop = vtk.vtkVolumeProperty()
prop.SetColor(color)
prop.SetScalarOpacity(opacity)
prop.SetScalarOpacityUnitDistance(2.0 / 255)
prop.SetInterpolationTypeToLinear()
prop.SetShade(scene == "lit")
prop.SetAmbient(0.2)
prop.SetDiffuse(0.7)
prop.SetSpecular(0.3)
prop.SetSpecularPower(20)
volume = vtk.vtkVolume()
volume.SetMapper(mapper)
volume.SetProperty(prop)
window = vtk.vtkRenderWindow()
window.SetOffScreenRendering(1)
window.SetMultiSamples(0)
window.SetSize(1024, 1024)
renderer = vtk.vtkRenderer()
window.AddRenderer(renderer)
renderer.AddVolume(volume)
renderer.SetBackground(0, 0, 0)
camera = renderer.GetActiveCamera()
camera.SetPosition(2.2, 2.6, 3.6)
camera.SetFocalPoint(0, 0, 0)
camera.SetViewUp(0, 1, 0)
camera.SetViewAngle(40)
renderer.ResetCameraClippingRange(-1.05, 1.05, -1.05, 1.05, -1.05, 1.05)
window.Render()
pixels = vtk.vtkUnsignedCharArray()
window.GetPixelData(0, 0, 1023, 1023, 0, pixels, 0)
rgb = ns.vtk_to_numpy(pixels).reshape(1024, 1024, -1)
rgb[::-1, :, 0].tofile(out)
