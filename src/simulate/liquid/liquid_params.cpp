// SPDX-License-Identifier: Apache-2.0
#include "simulate/liquid/liquid.h"

namespace sg {

void describe(Schema& s, LiquidParams& p) {
  describe(s, static_cast<FrameParams&>(p));
  s("size", p.size, "Particles along the longest side of the box.").range(4, 2000);
  s("bounds", p.bounds, "The box as x0,x1,y0,y1,z0,z1; default: 0,4,0,2,0,0. Equal z0 and z1: a flat flow in x and y.").items(0, 6);
  s("fill", p.fill,
    "What is full of liquid at the beginning: boxes of six numbers each; default: a column at the lower end of x, a quarter "
    "as wide as the box and as high as its half.");
  s("density", p.density, "Density at rest.").positive();
  s("viscosity", p.viscosity, "Kinematic viscosity, length^2 per time; at least what keeps the particles in order is taken.").at_least(0);
  s("sound", p.sound,
    "Speed of sound; 0: ten times the speed of a fall from the liquid's height, so that it is pressed together by less "
    "than a percent.")
      .at_least(0);
  s("gravity", p.gravity, "Acceleration; default: 9.81 along -z, of flat flows along -y.");
}

}  // namespace sg
