# SPDX-License-Identifier: Apache-2.0
"""The largest value along each ray, on black as radiologists have it."""
import sightglass as sg

orbital = sg.hydrogen(size=96, n=3, l=2, m=1)
orbital.plot("volume", mode="maximum", map="gray", camera={"zoom": 2}, picture={"background": "black", "axes": False}).save("maximum_projection.png")
