# SPDX-License-Identifier: Apache-2.0
"""The largest value along each ray, on black as radiologists have it."""
import sightglass as sg

sg.hydrogen(size=96, n=3, l=2, m=1).plot("volume", mode="maximum", map="gray", picture={"background": "black"}).save("maximum_projection.png")
