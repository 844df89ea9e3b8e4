# SPDX-License-Identifier: Apache-2.0
"""A million points with a colour each: an attractor."""
import numpy as np
import sightglass as sg

n = 1_000_000
xyz = np.empty((n, 3))
x, y, z = np.random.default_rng(1).uniform(-1, 1, (3, n // 1000))
for step in range(1000):  # a thousand points go a thousand steps
    x, y, z = np.sin(1.4 * y) - z * np.cos(1.56 * x), z * np.sin(1.4 * x) - np.cos(-6.56 * y), np.sin(x)
    xyz[step::1000] = np.stack([x, y, z], axis=1)
cloud = sg.points(xyz).with_field("radius", np.linalg.norm(xyz, axis=1))
cloud.plot("points", size=1, map="inferno").save("point_cloud.png")
