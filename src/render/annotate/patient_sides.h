// SPDX-License-Identifier: Apache-2.0
// Which sides of the patient lie at the left, right, upper and lower edge of a picture: letters, as on a radiologist's screen.
#pragma once
#include <string>
#include <vector>

#include "render/annotate/annotate.h"
#include "render/annotate/overlay/overlay.h"

namespace sg {

struct PatientSides {
  std::string left, right, top, bottom;  ///< "L", "PR"... of the edges of the picture
};
/// For a world that is the patient frame.
PatientSides patient_sides(const Projection& projection);

/// Draws them in the middle of the edges, away from `taken`; adds what it drew.
void draw_patient_letters(Overlay& overlay, const Projection& projection, double font, std::vector<Rect>& taken);

}  // namespace sg
