# SPDX-License-Identifier: Apache-2.0
"""Twelve decades on a logarithmic scale, and zeros that have no place on it."""
import numpy as np
import sightglass as sg

y, x = np.mgrid[0:1:200j, 0:1:300j]
values = 10.0 ** (12 * x * y - 6)
values[x < 0.05] = 0
sg.uniform(values, name="concentration", unit="mol/l", spacing=(1 / 299, 1 / 299, 1)).plot("surface", scale="log", lit=False).save("log_scale.png")
