# SPDX-License-Identifier: Apache-2.0
"""Line integral convolution: the direction of a flow as a texture over its speed."""
import sightglass as sg

gyre = sg.double_gyre(size=161, time=3)
gyre.plot("surface", field="velocity", lic="velocity", lit=False).save("flow_texture.png")
