// SPDX-License-Identifier: Apache-2.0
#include "scene/items/volume_item.h"

#include "base/schema/schema.h"

namespace sg {

void describe(Schema& s, VolumeSampling& p) {
  ParamDecl& tolerance = s("tolerance", p.tolerance,
                           "Largest error of a pixel in linear light, as a share of full scale; rays are sampled as finely as that takes. "
                           "Opacity and colours of the value keep it; light by the gradient, second axes and volumes in one place are "
                           "estimated, and single pixels of rough fields may be over it.");
  tolerance.positive().hi = 1;
  s("step", p.step, "Length of fixed steps along the rays instead of a tolerance; 0 is by the tolerance.").unit("world length").at_least(0);
  s("classify", p.classify,
    "With step: colours of the interpolated value (post), interpolated colours (pre), the integral over the step (integrated), or that "
    "integral from a table by the values at both ends and the length (table).");
  s("jitter", p.jitter, "With step: the first sample lies anywhere in the first step, so that rings become noise.");
  s("kernel", p.kernel,
    "What the field is between its samples. bspline and catmull_rom pass through them, mitchell and bspline_smooth smooth.");
  s("gradient", p.gradient, "How gradients are taken: differences, or the kernel's own derivative.");
  s("antialias", p.antialias,
    "Where cells are smaller than a pixel: none, split, rays that divide (right for any colours and mesh; slower the farther away), or "
    "mip, "
    "means of the values of uniform grids (before the colours).");
}

void describe(Schema& s, VolumeLight& p) {
  s("ambient", p.ambient, "Light that comes from everywhere (linear light).").range(0, 10);
  s("diffuse", p.diffuse, "Light by the angle between gradient and lamp.").range(0, 10);
  s("specular", p.specular, "Strength of highlights.").range(0, 10);
  s("power", p.power, "Sharpness of highlights: the exponent of Blinn and Phong.").range(1, 10000);
  s("shadows", p.shadows, "How much of the light the volume itself takes away before it arrives; 0 none, 1 all of it.").range(0, 1);
  s("occlusion", p.occlusion, "How much of the ambient light matter nearby takes away; 0 none, 1 all of it.").range(0, 1);
  s("depth_cue", p.depth_cue, "How far the far end fades into the background; 0 none, 1 wholly.").range(0, 1);
  s("style", p.style, "Illustrative pictures: dark silhouettes, warm-to-cool tones, or hatching.");
  s("ink", p.ink, "Opacity per unit length that silhouettes and strokes of hatching add of their own.").range(0, 1);
}

}  // namespace sg
