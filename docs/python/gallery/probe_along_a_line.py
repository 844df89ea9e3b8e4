# SPDX-License-Identifier: Apache-2.0
"""Values along a line: numbers for numpy, and where the line runs."""
import numpy as np
import sightglass as sg

field = sg.marschner_lobb(size=64)
line = field.probe_at(**{"from": (-1, 0, 0), "to": (1, 0, 0)}, count=200)
values = line[field.keys()[0]]
print(f"{len(values)} values between {values.min():.3f} and {values.max():.3f}, the first maximum at x = {line.points[np.argmax(values), 0]:.3f}")
sg.scene().add(field.slice(axis="z", position=0), "surface", lit=False).add(line, "lines", color="black", width=3).render().save("probe_along_a_line.png")
