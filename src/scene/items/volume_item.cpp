// SPDX-License-Identifier: Apache-2.0
#include "scene/items/volume_item.h"

#include "base/schema/schema.h"

namespace sg {

void describe(Schema& s, VolumeSampling& p) {
  ParamDecl& tolerance =
      s("tolerance", p.tolerance,
        "Largest error of a pixel in linear light, as a share of full scale; rays are sampled as finely as needed. "
        "Opacity and colours of the value stay within it; gradient lighting, second axes and overlapping volumes are "
        "estimated, and single pixels of rough fields may exceed it. Default: 1/512; where lit, rough data would take very long for "
        "that, fixed steps whose error is measured on some rays and told.");
  tolerance.positive().hi = 1;
  s("step", p.step, "Fixed step length along the rays; 0 samples by the tolerance.").unit("world length").at_least(0);
  s("classify", p.classify,
    "With step: classify the interpolated value (post), interpolate colours (pre), integrate over the step (integrated), or look that "
    "integral up by the values at both ends and the length (table).");
  s("jitter", p.jitter, "With step: start each ray at a random position in its first step, which turns rings into noise.");
  s("kernel", p.kernel,
    "Reconstruction kernel between the samples. bspline and catmull_rom interpolate, mitchell and bspline_smooth smooth.");
  s("gradient", p.gradient, "How gradients are computed: differences, or the derivative of the kernel.");
  s("antialias", p.antialias,
    "Where cells are smaller than a pixel: none; split, rays that subdivide (correct for any colours and mesh, slower the farther away); "
    "or mip, averages of the values of uniform grids (before colouring).");
}

void describe(Schema& s, VolumeLight& p) {
  s("ambient", p.ambient, "Ambient light (linear).").range(0, 10);
  s("diffuse", p.diffuse, "Diffuse light, by the angle between gradient and light.").range(0, 10);
  s("specular", p.specular, "Strength of specular highlights.").range(0, 10);
  s("power", p.power, "Sharpness of highlights: the Blinn-Phong exponent.").range(1, 10000);
  s("shadows", p.shadows, "Strength of the shadows that the volume casts on itself: 0 none, 1 full.").range(0, 1);
  s("occlusion", p.occlusion, "Strength of ambient occlusion: 0 none, 1 full.").range(0, 1);
  s("depth_cue", p.depth_cue, "Depth cue: how far the far end fades into the background; 0 not at all, 1 completely.").range(0, 1);
  s("style", p.style, "Illustrative pictures: dark silhouettes, warm-to-cool tones, or hatching.");
  s("ink", p.ink, "Opacity per unit length added by silhouettes and hatching strokes.").range(0, 1);
}

}  // namespace sg
