// SPDX-License-Identifier: Apache-2.0
#include "simulate/fluid/dust/dust_params.h"

namespace sg {

void describe(Schema& s, DustParams& p) {
  s("dust", p.dust, "Particles of dust at the beginning, at rest and evenly at random where they appear.").range(0, 100000000);
  s("dust_rate", p.dust_rate, "Particles that appear per time.").at_least(0);
  s("dust_box", p.dust_box,
    "Boxes in which dust appears, as x0,x1,y0,y1,z0,z1 of each; default: the sources of the smoke, or a ball high up where there are none "
    "and no smoke.");
  s("dust_mass", p.dust_mass,
    "Mass of each particle; a volume of 1 of air (of flat air an area) has mass 1. Default: the dust weighs twice as much as the air where "
    "it appears.")
      .positive();
  s("dust_drag", p.dust_drag,
    "Force on each particle per velocity of the air past it; the air feels the opposite one. In still air velocities fade by "
    "exp(-time*dust_drag/dust_mass), and dust falls at dust_mass*dust_gravity/dust_drag. Default: dust_mass/0.05.")
      .positive();
  s("dust_gravity", p.dust_gravity, "Acceleration of the dust downwards.").unit("length/time^2");
  s("seed", p.seed, "Of the places at random.").at_least(0);
  s("show", p.show, "grid: the air, with the mass of the dust per volume. particles: the dust as points.");
}

void describe(Schema& s, DustySmokeParams& p) {
  describe(s, static_cast<DustParams&>(p));
  describe(s, static_cast<SmokeParams&>(p));
}

}  // namespace sg
