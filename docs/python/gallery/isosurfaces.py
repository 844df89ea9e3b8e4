# SPDX-License-Identifier: Apache-2.0
"""Isosurfaces inside each other: a hydrogen orbital at three densities."""
import sightglass as sg

orbital = sg.hydrogen(size=96)
surfaces = orbital.contour(count=3)
sg.scene().add(surfaces, "surface", opacity=0.45, map="plasma").picture(axes=False).render().save("isosurfaces.png")
