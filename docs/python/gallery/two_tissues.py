# SPDX-License-Identifier: Apache-2.0
"""Two tissues of a scan: soft tissue faint, what is bright opaque."""
import sightglass as sg

head = sg.tissue_phantom(size=128, bias=0, noise=1)
lo, hi = head.range(head.keys()[0])
shares = {0.25: 0, 0.4: 0.05, 0.8: 0.06, 1: 0.7}
head.plot("volume", opacity={lo + share * (hi - lo): o for share, o in shares.items()}).save("two_tissues.png")
