# SPDX-License-Identifier: Apache-2.0
"""Not run: mypy reads it (tools/test_python). What a typed program sees of the package."""
import numpy as np

import sightglass as sg

volume: sg.Data = sg.uniform(np.zeros((4, 4, 4)), name="T")
surface: sg.Data = volume.contour(values=[1.0], normals=True)
cut: sg.Data = sg.clip(surface, axis="x")
joined: sg.Data = surface.append(cut, cut)
made: sg.Data = sg.gyroid(size=16)
picture: sg.Picture = surface.plot(size=(100, 100))
pixels: "np.ndarray" = picture.array
page: str = picture.interactive(max="2M").html
names: list[str] = volume.keys()
wrong_type: sg.Data = volume.contour(normals="yes")  # type: ignore[arg-type]
wrong_name: sg.Data = volume.contour(vales=[1.0])  # type: ignore[call-arg]
wrong_word: sg.Data = volume.clip(keep="half")  # type: ignore[arg-type]
