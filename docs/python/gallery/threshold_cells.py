# SPDX-License-Identifier: Apache-2.0
"""The cells with high values of a mesh, in the outline of all of it."""
import sightglass as sg

flow = sg.abc(size=33)
vortices = flow.vortex_measures()
hot = vortices.threshold(field="Q", min=0.5 * vortices.range("Q")[1])
sg.scene().add(flow, "outline").add(hot, "surface", field="Q", edges=True).render().save("threshold_cells.png")
