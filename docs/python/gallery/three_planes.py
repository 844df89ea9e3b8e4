# SPDX-License-Identifier: Apache-2.0
"""Three planes through a volume, with its outline."""
import sightglass as sg

head = sg.tissue_phantom(size=96, noise=2)
scene = sg.scene().add(head, "outline")
for axis in "xyz":
    scene.add(head.slice(axis=axis), "surface", map="gray", lit=False)
scene.render().save("three_planes.png")
