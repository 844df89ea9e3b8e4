// SPDX-License-Identifier: Apache-2.0
#include "simulate/pde/room.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/error.h"
#include "base/text/text.h"

namespace sg::pde {

void describe(Schema& s, RoomParams& p) {
  s("size", p.size, "Cells along the longest side.").range(1, 65536);
  s("bounds", p.bounds, "Box as x0,x1,y0,y1,z0,z1; default: 0,1,0,1,0,0. Equal bounds of an axis: a flat box; of two: a line.").items(6);
  s("type", p.type, "Number type of the fields; computed in f64.");
  s("sides", p.sides,
    "What happens at all sides: insulated (nothing passes; waves are reflected), periodic, absorbing (waves leave), or values as an "
    "expression of x, y, z and time, at which a side is held: 0 or sin(pi*y).");
  s("x0", p.x0, "The lower side along x, if it differs from the others. Likewise x1, y0, y1, z0, z1.");
  s("x1", p.x1, "The upper side along x.");
  s("y0", p.y0, "The lower side along y.");
  s("y1", p.y1, "The upper side along y.");
  s("z0", p.z0, "The lower side along z.");
  s("z1", p.z1, "The upper side along z.");
}

double Axis::h() const {
  if (flat()) return 1;
  return length / (lo.wall() && hi.wall() ? double(n) + 1 : lo.wall() || hi.wall() ? double(n) + 0.5 : double(n));
}

double Axis::first() const { return flat() ? 0 : lo.wall() ? h() : h() / 2; }

double Axis::least_eigenvalue() const {
  if (flat()) return 0;
  const int walls = int(lo.wall()) + int(hi.wall());
  const double m = double(n);
  const double angle = walls == 2                      ? 1 / (2 * (m + 1))
                       : walls == 1                    ? 1 / (2 * (2 * m + 1))
                       : lo.kind == SideKind::periodic ? 1 / m
                                                       : 1 / (2 * m);
  const double s = std::sin(std::numbers::pi * angle);
  return 4 * coupling() * s * s;
}

double Room::smallest_h() const {
  double h = HUGE_VAL;
  for (const Axis& a : axes)
    if (!a.flat()) h = std::min(h, a.h());
  return h;
}

bool Room::held() const {
  return std::any_of(axes.begin(), axes.end(), [](const Axis& a) { return !a.flat() && (a.lo.wall() || a.hi.wall()); });
}

UniformGrid Room::grid() const {
  UniformGrid g;
  g.dims = n();
  for (int a = 0; a < 3; ++a) {
    const Axis& axis = axes[size_t(a)];
    g.origin[a] = corner[a] + axis.first(), g.spacing[a] = axis.h();
  }
  return g;
}

Room make_room(const RoomParams& p, const std::string& who, double bytes, bool waves, const Context& context) {
  const std::array<double, 6> own{0, 1, 0, 1, 0, 0};
  const auto bound = [&](size_t i) { return p.bounds.empty() ? own[i] : p.bounds[i]; };
  const std::array<const std::string*, 6> words{&p.x0, &p.x1, &p.y0, &p.y1, &p.z0, &p.z1};
  Room room;
  double longest = 0, count = 1;
  for (size_t a = 0; a < 3; ++a) {
    const double lo = bound(2 * a), hi = bound(2 * a + 1);
    if (!(hi >= lo) || !std::isfinite(hi - lo))
      fail_usage(fmt::format("the box extends from {} to {} along {}", exact_number(lo), exact_number(hi), "xyz"[a]), who + " bounds",
                 "give finite numbers, the lower one first");
    room.corner[int(a)] = lo, room.axes[a].length = hi - lo;
    longest = std::max(longest, hi - lo);
  }
  if (longest == 0) fail_usage("the box has no extent", who + " bounds", "give x0,x1,y0,y1,z0,z1, such as 0,1,0,1,0,0");
  for (size_t a = 0; a < 3; ++a) {
    Axis& axis = room.axes[a];
    for (size_t end = 0; end < 2; ++end) {
      Side& side = end ? axis.hi : axis.lo;
      const std::string& word = words[2 * a + end]->empty() ? p.sides : *words[2 * a + end];
      if (const auto kind = value_of_word<SideKind>(word)) side.kind = *kind;
      else side = {SideKind::held, word};
      if (word.empty()) fail_usage("nothing is said of the sides", who + " sides", "insulated, periodic, or values such as 0");
      if (side.kind == SideKind::absorbing && !waves && !axis.flat())
        fail_usage("absorbing sides are for waves", who + " sides", "insulated, periodic, or values such as 0");
    }
    if (axis.flat()) continue;
    if ((axis.lo.kind == SideKind::periodic) != (axis.hi.kind == SideKind::periodic))
      fail_usage(fmt::format("one side along {} is periodic, but not the other", "xyz"[a]), who + " sides", "make both periodic");
    const double cells = std::max(1.0, std::round(axis.length / longest * p.size));
    const bool periodic = axis.lo.kind == SideKind::periodic;
    axis.n = size_t(periodic                           ? std::max(2.0, 2 * std::ceil(cells / 2))  // even: a chessboard of two colours
                    : axis.lo.wall() && axis.hi.wall() ? std::max(1.0, cells - 1)
                                                       : cells);
    count *= double(axis.n);
    if (!std::isfinite(axis.coupling()) || !(axis.coupling() > 0))
      fail_usage(fmt::format("cells of {} along {} are too small or large to compute with", exact_number(axis.h()), "xyz"[a]),
                 who + " bounds", "choose other units");
  }
  if (count > 4e9 || (context.memory_limit && count * bytes > double(context.memory_limit)))
    fail_usage(fmt::format("{:.3g} cells take about {}, more than there is", count, human_bytes(uint64_t(std::min(count * bytes, 1e18)))),
               who, "ask for a smaller size");
  return room;
}

}  // namespace sg::pde
