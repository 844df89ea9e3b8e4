# SPDX-License-Identifier: Apache-2.0
"""Isosurfaces inside each other, cut open: a hydrogen orbital at four densities."""
import sightglass as sg

orbital = sg.hydrogen(size=96)
surfaces = orbital.contour(values=[2e-5, 1e-4, 3e-4, 5e-4]).clip(axis="y", keep="outside")
sg.scene().add(surfaces, "surface", map="plasma", scale="log").camera(zoom=1.15).picture(axes=False).render().save("isosurfaces.png")
