// SPDX-License-Identifier: Apache-2.0
#include "simulate/fluid/smoke_params.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/text/text.h"

namespace sg {

void describe(Schema& s, SmokeParams& p) {
  s("size", p.size, "Cells along the longest side.").range(2, 4096);
  s("bounds", p.bounds, "Box of the air as x0,x1,y0,y1,z0,z1; default: 0,1,0,1,0,2. Equal z0 and z1: a flat flow in x and y.").items(6);
  s("type", p.type, "Number type of the computation.");
  describe(s, static_cast<FrameParams&>(p));
  s("cfl", p.cfl, "Cells that the fastest air passes in a step, at most: a frame takes as many steps as that needs.").positive();
  s("advection", p.advection,
    "How quantities are carried. explicit: forward in time with central differences, which blows up. semi_lagrangian: stable, but "
    "smooths. maccormack and bfecc: corrected to second order.");
  s("trace", p.trace, "How the way back along the flow is found.");
  s("limit", p.limit,
    "Hold corrected values between those that they are mixed from: no ringing, but first order at crests. no: for smooth flows whose "
    "figures matter. Density and temperature are always held.");
  s("reflect", p.reflect,
    "Two half steps, between which the change by forces and pressure is mirrored: second order in time, vortices live longer, at twice "
    "the work.");
  s("source", p.source, "Balls that give off smoke, as x,y,z,radius of each; default: one above the ground.");
  s("box", p.box, "Boxes that give off smoke, as x0,x1,y0,y1,z0,z1 of each.");
  s("density", p.density, "Density of the smoke in the sources.").at_least(0);
  s("temperature", p.temperature, "Temperature in the sources above that of the air.");
  s("rate", p.rate, "Shares of density and temperature that the sources give off per time; default: they are held at them.").at_least(0);
  s("jet", p.jet, "Velocity of the air in the sources.");
  s("obstacle", p.obstacle, "Solid balls, as x,y,z,radius of each.");
  s("obstacle_velocity", p.obstacle_velocity, "Velocity at which the obstacles move.");
  s("obstacle_spin", p.obstacle_spin, "Angular velocity of the obstacles about their middle, radians per time along the axis.");
  s("up", p.up, "Away from the ground; default: z, of flat flows y.");
  s("lift", p.lift, "Acceleration upwards per temperature.");
  s("weight", p.weight, "Acceleration downwards per density.");
  s("swirl", p.swirl, "Strength of vorticity confinement, which gives vortices back what the grid takes from them.").at_least(0);
  s("viscosity", p.viscosity, "Kinematic viscosity, length^2 per time.").at_least(0);
  s("cooling", p.cooling, "Share of the temperature that is lost per time.").at_least(0);
  s("fading", p.fading, "Share of the density that is lost per time.").at_least(0);
  s("open", p.open, "The side of the box through which air comes and goes; default: the one away from the ground. none: a closed box.");
  s("sides", p.sides,
    "What lies at the sides of the box, as 'SIDE KIND [VX,VY,VZ]; ...'. slip: a wall (default). held: a wall at which friction holds the "
    "flow, and which may move along itself. inflow: air comes in. open: as 'open'. Example: 'x0 inflow 1,0,0; x1 open'.");
  s("tolerance", p.tolerance, "What may be left of the divergence, as a share of the largest before.").range(1e-12, 0.1);
}

namespace fluid {

MacGrid smoke_grid(const SmokeParams& p, const Context& context) {
  Box3 box{{0, 0, 0}, {1, 1, 2}};
  if (!p.bounds.empty())
    for (int a = 0; a < 3; ++a) box.lo[a] = p.bounds[size_t(2 * a)], box.hi[a] = p.bounds[size_t(2 * a + 1)];
  const Vec3 extent = box.size();
  for (int a = 0; a < 3; ++a)
    if (!(a == 2 ? extent[a] >= 0 : extent[a] > 0) || !std::isfinite(extent[a]) || !std::isfinite(box.lo[a]))
      fail_usage(fmt::format("the box extends from {} to {} along {}", exact_number(box.lo[a]), exact_number(box.hi[a]), "xyz"[a]),
                 "smoke bounds", "give finite numbers, the lower one first; z may be equal");
  MacGrid g;
  g.origin = box.lo, g.h = std::max({extent.x, extent.y, extent.z}) / p.size;
  double cells = 1;
  for (int a = 0; a < 3; ++a) {
    g.cells[size_t(a)] = a == 2 && extent.z == 0 ? 1 : size_t(std::max(2.0, std::round(extent[a] / g.h)));
    cells *= double(g.cells[size_t(a)]);
  }
  const double bytes = cells * (p.type == FieldType::f64 ? 130 : 65);
  if (cells > 2e9 || (context.memory_limit && bytes > double(context.memory_limit)))
    fail_usage(fmt::format("{:.3g} cells take about {}, more than there is", cells, human_bytes(uint64_t(std::min(bytes, 1e18)))), "smoke",
               "ask for a smaller size");
  return g;
}

Sides sides_of(const SmokeParams& p, const MacGrid& g, const Vec3& up) {
  Sides sides{};
  std::optional<size_t> open;
  if (p.open) {
    if (*p.open != BoxSide::none) open = size_t(*p.open);
  } else if (p.sides.find("open") == std::string::npos) {
    size_t axis = 0;
    for (size_t a = 1; a < 3; ++a)
      if (std::abs(up[int(a)]) > std::abs(up[int(axis)])) axis = a;
    open = 2 * axis + (up[int(axis)] > 0);
  }
  if (open && int(*open / 2) < g.axes()) sides[*open].kind = SideKind::open;
  return sides_of_text(p.sides, sides, "smoke sides");
}

std::vector<Box3> boxes_of(const std::vector<double>& numbers, const MacGrid& g, const char* word) {
  const std::string who = fmt::format("smoke {}", word);
  if (numbers.size() % 6 != 0) fail_usage(fmt::format("{} numbers are no boxes", numbers.size()), who, "give x0,x1,y0,y1,z0,z1 of each");
  std::vector<Box3> boxes;
  for (size_t i = 0; i < numbers.size(); i += 6) {
    Box3 box;
    for (int a = 0; a < 3; ++a) {
      const double lo = numbers[i + size_t(2 * a)], hi = numbers[i + size_t(2 * a + 1)];
      if (!std::isfinite(lo) || !std::isfinite(hi) || !(a == 2 && g.flat() ? lo <= hi : lo < hi))
        fail_usage(fmt::format("a box from {} to {} along {}", exact_number(lo), exact_number(hi), "xyz"[a]), who,
                   "give finite numbers, the lower one first");
      box.lo[a] = lo, box.hi[a] = hi;
      if (a < g.axes() && (hi <= g.origin[a] || lo >= g.origin[a] + g.h * double(g.cells[size_t(a)])))
        fail_usage(fmt::format("the box from {} to {} along {} lies outside of the air", exact_number(lo), exact_number(hi), "xyz"[a]), who,
                   "move it, or change the bounds");
    }
    boxes.push_back(box);
  }
  return boxes;
}

std::vector<Ball> balls_of(const std::vector<double>& numbers, const MacGrid& g, const char* word) {
  if (numbers.size() % 4 != 0)
    fail_usage(fmt::format("{} numbers are no balls", numbers.size()), fmt::format("smoke {}", word), "give x,y,z,radius of each");
  std::vector<Ball> balls;
  for (size_t i = 0; i < numbers.size(); i += 4) {
    const Ball b{{numbers[i], numbers[i + 1], numbers[i + 2]}, numbers[i + 3]};
    if (!(b.radius > 0) || !std::isfinite(b.radius) || !std::isfinite(dot(b.middle, b.middle)))
      fail_usage(fmt::format("a ball of radius {}", exact_number(b.radius)), fmt::format("smoke {}", word),
                 "give positive, finite numbers");
    double beyond = 0;
    for (int a = 0; a < g.axes(); ++a) {
      const double hi = g.origin[a] + g.h * double(g.cells[size_t(a)]);
      beyond = std::max({beyond, g.origin[a] - b.middle[a], b.middle[a] - hi});
    }
    if (beyond >= b.radius)
      fail_usage(fmt::format("the ball about {}, {}, {} lies outside of the box", exact_number(b.middle.x), exact_number(b.middle.y),
                             exact_number(b.middle.z)),
                 fmt::format("smoke {}", word), "move it, or change the bounds");
    balls.push_back(b);
  }
  return balls;
}

}  // namespace fluid
}  // namespace sg
