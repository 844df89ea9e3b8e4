# SPDX-License-Identifier: Apache-2.0
"""Stress under a point load: superquadrics on a cut, and its von Mises stress."""
import sightglass as sg

cut = sg.point_load(size=81).slice(axis="y", position=0)
scene = sg.scene().add(cut, "surface", field="von Mises stress", scale="log", map="ember", lit=False)
scene.add(cut.tensor_glyphs(count=250, size=1.3), "surface", color="#c8d8e8").camera(view="front")
scene.picture(title="Stress under a point load").render().save("tensor_glyphs.png")
