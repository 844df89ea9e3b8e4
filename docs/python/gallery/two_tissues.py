# SPDX-License-Identifier: Apache-2.0
"""Two tissues of a scan: soft tissue faint, what is bright opaque."""
import sightglass as sg

head = sg.tissue_phantom(size=128)
lo, hi = head.range(head.keys()[0])
shares = {0.25: 0, 0.4: 0.02, 0.8: 0.03, 1: 0.7}
head.plot("volume", opacity={lo + share * (hi - lo): o for share, o in shares.items()}).save("two_tissues.png")
