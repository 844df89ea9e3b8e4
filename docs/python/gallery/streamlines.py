# SPDX-License-Identifier: Apache-2.0
"""Streamlines as tubes, coloured by the speed."""
import sightglass as sg

flow = sg.abc(size=48)
lines = flow.streamlines(seeds="random", count=120)
sg.scene().add(flow, "outline").add(lines.tubes(radius=0.04), "surface", map="turbo").render().save("streamlines.png")
