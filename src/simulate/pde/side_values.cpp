// SPDX-License-Identifier: Apache-2.0
#include "simulate/pde/side_values.h"

#include <utility>

#include "base/error.h"
#include "simulate/pde/expressions.h"

namespace sg::pde {

namespace {

constexpr const char* side_names[6] = {"x0", "x1", "y0", "y1", "z0", "z1"};

std::array<bool, 6> walls_of(const Room& room) {
  std::array<bool, 6> walls{};
  for (size_t a = 0; a < 3; ++a)
    if (!room.axes[a].flat()) walls[2 * a] = room.axes[a].lo.wall(), walls[2 * a + 1] = room.axes[a].hi.wall();
  return walls;
}

}  // namespace

UniformGrid side_grid(const Room& room, size_t side) {
  UniformGrid g = room.grid();
  const size_t a = side / 2;
  g.dims[a] = 1;
  g.origin[int(a)] = room.corner[int(a)] + (side % 2 ? room.axes[a].length : 0);
  return g;
}

SideValues::SideValues(const Room& room, std::string who, double time, const Context& context)
    : room_(room), who_(std::move(who)), time_(time) {
  const Sides sides = room.sides();
  const auto walls = walls_of(room);
  for (size_t s = 0; s < 6; ++s) {
    if (!walls[s]) continue;
    if (sides[s].kind == SideKind::absorbing) {
      values_[s] = Values(side_grid(room, s).dims);
      continue;
    }
    moves_[s] = depends_on_time(sides[s].value);
    evaluate(s, time, context);
  }
}

void SideValues::evaluate(size_t side, double time, const Context& context) {
  const std::string where = who_ + " " + side_names[side];
  try {
    values_[side] = values_of(room_.sides()[side].value, side_grid(room_, side), time, where, context);
  } catch (const Error& e) {
    if (e.kind() != ErrorKind::usage) throw;
    fail_usage(e.problem(), where, "a side is insulated, periodic, absorbing (waves), or held at an expression such as 0 or sin(pi*y)");
  }
}

bool SideValues::update(double time, const Context& context) {
  time_ = time;
  bool any = false;
  for (size_t s = 0; s < 6; ++s)
    if (moves_[s]) evaluate(s, time, context), any = true;
  return any;
}

void SideValues::add_to(Values& out, double scale) const {
  for (size_t s = 0; s < 6; ++s) {
    if (values_[s].values.empty()) continue;
    const double c = scale * room_.axes[s / 2].coupling();
    each(out.n, s, [&](size_t place, size_t at) { out.values[place] += c * values_[s].values[at]; });
  }
}

UniformGrid whole_grid(const Room& room) {
  UniformGrid g = room.grid();
  const auto walls = walls_of(room);
  for (size_t a = 0; a < 3; ++a) {
    g.dims[a] += size_t(walls[2 * a]) + size_t(walls[2 * a + 1]);
    if (walls[2 * a] || room.axes[a].flat()) g.origin[int(a)] = room.corner[int(a)];
  }
  return g;
}

namespace {

// Where walls meet: the mean of what the held ones hold there and of what lies beside it on the others.
void fill_edges(const Room& room, const SideValues& sides, Values& all, const Context& context) {
  const auto walls = walls_of(room);
  const UniformGrid whole = whole_grid(room);
  std::array<Values, 6> held;
  int walled_axes = 0;
  for (size_t a = 0; a < 3; ++a) walled_axes += walls[2 * a] || walls[2 * a + 1];
  if (walled_axes < 2) return;
  for (size_t s = 0; s < 6; ++s) {
    if (!walls[s] || room.sides()[s].kind != SideKind::held) continue;
    UniformGrid g = whole;
    g.dims[s / 2] = 1;
    g.origin[int(s / 2)] = room.corner[int(s / 2)] + (s % 2 ? room.axes[s / 2].length : 0);
    held[s] = values_of(room.sides()[s].value, g, sides.time(), side_names[s], context);
  }
  for (int meet = 2; meet <= 3; ++meet)
    for (size_t k = 0; k < all.n[2]; ++k)
      for (size_t j = 0; j < all.n[1]; ++j) {
        const bool at_wall =
            (walls[2] && j == 0) || (walls[3] && j + 1 == all.n[1]) || (walls[4] && k == 0) || (walls[5] && k + 1 == all.n[2]);
        for (size_t i = 0; at_wall && i < all.n[0]; ++i) {
          const std::array<size_t, 3> q{i, j, k};
          double sum = 0;
          int count = 0;
          for (size_t a = 0; a < 3; ++a) {
            const bool low = walls[2 * a] && q[a] == 0, high = walls[2 * a + 1] && q[a] + 1 == all.n[a];
            if (!low && !high) continue;
            auto beside = q;
            const Values& h = held[2 * a + (high ? 1 : 0)];
            beside[a] = h.values.empty() ? (low ? q[a] + 1 : q[a] - 1) : 0;
            sum += (h.values.empty() ? all : h)(beside[0], beside[1], beside[2]), ++count;
          }
          if (count == meet) all(i, j, k) = sum / count;
        }
      }
}

}  // namespace

Field whole_field(const Room& room, const Values& u, const SideValues& sides, const char* name, FieldType type, const Context& context) {
  const auto walls = walls_of(room);
  Values all(whole_grid(room).dims);
  const auto n = u.n;
  const std::array<size_t, 3> shift{walls[0], walls[2], walls[4]};
  for (size_t row = 0; row < u.rows(); ++row)
    for (size_t i = 0; i < n[0]; ++i) all(i + shift[0], row % n[1] + shift[1], row / n[1] + shift[2]) = u.values[i + row * n[0]];
  for (size_t s = 0; s < 6; ++s) {
    if (!walls[s]) continue;
    SideValues::each(n, s, [&](size_t place, size_t at) {
      std::array<size_t, 3> q{place % n[0] + shift[0], place / n[0] % n[1] + shift[1], place / (n[0] * n[1]) + shift[2]};
      q[s / 2] = s % 2 ? all.n[s / 2] - 1 : 0;
      all(q[0], q[1], q[2]) = sides.of(s).values[at];
    });
  }
  fill_edges(room, sides, all, context);
  if (type == FieldType::f64) {
    double* to = nullptr;
    Array a = Array::make<double>(all.values.size(), 1, &to);
    for (size_t i = 0; i < all.values.size(); ++i) to[i] = all.values[i];
    return {name, Association::point, std::move(a), "", Role::scalars};
  }
  float* to = nullptr;
  Array a = Array::make<float>(all.values.size(), 1, &to);
  for (size_t i = 0; i < all.values.size(); ++i) to[i] = float(all.values[i]);
  return {name, Association::point, std::move(a), "", Role::scalars};
}

}  // namespace sg::pde
