// SPDX-License-Identifier: Apache-2.0
#include "scene/show/lic.h"

#include <fmt/core.h>

#include "base/error.h"
#include "base/schema/field_kinds.h"

namespace sg {

void describe(Schema& s, LicShow& p) {
  s("lic", p.lic,
    "Vector field whose direction along the surface is shown as a texture (line integral convolution), multiplied with the colours; 'auto' "
    "takes the active vectors. Where the field is zero or missing, the plain colour is shown.");
  s("lic_steps", p.lic_steps, "Steps of the convolution in each direction.").range(1, 1000);
  s("lic_step", p.lic_step, "Length of a step.").unit("pixels").range(0.05, 1);
  s("lic_grain", p.lic_grain, "Width of the strands: grain size of the noise.").unit("pixels").range(0.5, 100);
  s("lic_contrast", p.lic_contrast, "Contrast between the strands; 1 uses all shades about equally often.").range(0, 100);
  s("lic_strength", p.lic_strength, "How strongly the texture darkens and brightens the colours: 0 not at all, 1 down to black.")
      .range(0, 1);
  s("lic_kernel", p.lic_kernel, "Weights along a line: hann fades out, box is uniform.");
  s("lic_phase", p.lic_phase,
    "Move the texture along the field: pictures with phases from 0 to 1 form a looping animation. Default: no motion.");
}

std::optional<SurfaceTexture> surface_texture_of(const Dataset& d, const LicShow& p) {
  if (p.lic.empty() || p.lic.none()) return {};
  const Field* f = d.fields().find(p.lic.name);
  if (!f && is_automatic(p.lic)) {
    f = d.fields().with_role(Role::vectors);
    if (!f || f->association == Association::whole) f = d.fields().active(3);
    if (!f) f = d.fields().active(2);
    if (!f) fail_usage("there is no vector field to follow", "lic", "the texture needs a field of 3 components, or 2 in the xy plane");
  }
  if (!f) f = &d.fields().require(p.lic.name);
  if (f->association == Association::whole)
    fail_usage(fmt::format("field '{}' belongs to the whole dataset, not to points or cells", f->name), "lic");
  if (f->components() != 3 && f->components() != 2)
    fail_usage(
        fmt::format("field '{}' has {} component{}, so no vectors to follow", f->name, f->components(), f->components() == 1 ? "" : "s"),
        "lic", "name a field of 3 components, or 2 in the xy plane");
  SurfaceTexture t;
  t.field = f->name, t.association = f->association;
  t.steps = p.lic_steps, t.step = p.lic_step, t.grain = p.lic_grain, t.contrast = p.lic_contrast, t.strength = p.lic_strength;
  t.kernel = p.lic_kernel;
  t.phase = p.lic_phase;
  return t;
}

}  // namespace sg
