# SPDX-License-Identifier: Apache-2.0
"""The same kind of array as terrain: points moved up by their height."""
import numpy as np
import sightglass as sg

rng = np.random.default_rng(7)
k = np.hypot(*np.meshgrid(np.fft.fftfreq(256), np.fft.fftfreq(256)))
spectrum = np.fft.fft2(rng.standard_normal((256, 256))) / np.maximum(k, 1 / 256) ** 2
height = np.real(np.fft.ifft2(spectrum))
height = 1500 * (height - height.min()) / np.ptp(height)

ds = sg.uniform(height, spacing=(30, 30, 1), name="height", unit="m")
ds.warp(field="height", scale=2).plot("surface", map="batlow", picture={"title": "Heights drawn twice as high"}).save("terrain.png")
