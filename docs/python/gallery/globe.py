# SPDX-License-Identifier: Apache-2.0
"""A field on a sphere: a curvilinear grid of longitudes and latitudes."""
import numpy as np
import sightglass as sg

lat, lon = np.radians(np.mgrid[-90:90:91j, 0:360:181j])
xyz = np.stack([np.cos(lat) * np.cos(lon), np.cos(lat) * np.sin(lon), np.sin(lat)], axis=-1)
wave = np.sin(4 * lon) * np.cos(lat) ** 4 * np.sin(lat)

ds = sg.curvilinear(xyz, wave, name="Rossby-Haurwitz wave")
ds.plot("surface", map="RdBu", camera={"elevation": 25}, picture={"axes": False}).save("globe.png")
