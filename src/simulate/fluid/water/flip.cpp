// SPDX-License-Identifier: Apache-2.0
#include "simulate/fluid/water/flip.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include "base/error.h"
#include "base/parallel.h"
#include "simulate/run/frames.h"

namespace sg {

namespace fluid {

namespace {

constexpr size_t particle_grain = 1024;
constexpr double most_steps_of_a_frame = 1000;
constexpr double rim = 1e-3;  // of a cell: particles stay so far inside of the box

SmokeParams as_smoke(const FlipLiquidParams& p) {
  SmokeParams s;
  s.size = p.size, s.bounds = p.bounds.empty() ? std::vector<double>{0, 4, 0, 2, 0, 0} : p.bounds, s.type = FieldType::f64;
  s.obstacle = p.obstacle;
  return s;
}

Vec3 gravity_of(const FlipLiquidParams& p, const MacGrid& g) {
  Vec3 gravity = p.gravity.value_or(g.flat() ? Vec3(0, -9.81, 0) : Vec3(0, 0, -9.81));
  if (g.flat()) gravity.z = 0;
  return gravity;
}

// Evenly spaced, per_axis along each axis of a cell, where the boxes are and no ball is.
std::vector<Particle3> fill(const FlipLiquidParams& p, const MacGrid& g, const std::vector<Ball>& balls) {
  std::vector<double> numbers = p.water;
  if (numbers.empty()) {  // a column in a corner: the dam that is about to break
    const double h = g.h;
    for (int a = 0; a < 3; ++a) {
      const double n = double(g.cells[size_t(a)]), share = a == 0 ? 0.25 : a == (g.flat() ? 1 : 2) ? 0.75 : 1;
      numbers.push_back(g.origin[a]), numbers.push_back(g.origin[a] + (a < g.axes() ? n * h * share : 0));
    }
  }
  const std::vector<Box3> boxes = boxes_of(numbers, g, "water");
  const size_t m = size_t(p.per_axis);
  std::vector<Particle3> out;
  for (size_t k = 0; k < (g.flat() ? 1 : g.cells[2] * m); ++k)
    for (size_t j = 0; j < g.cells[1] * m; ++j)
      for (size_t i = 0; i < g.cells[0] * m; ++i) {
        const auto along = [&](size_t n) { return (double(n) + 0.5) / double(m); };
        const Vec3 x{along(i), along(j), g.flat() ? 0 : along(k)}, at = g.origin + g.h * x;
        const bool inside = std::any_of(boxes.begin(), boxes.end(), [&](const Box3& b) {
          for (int a = 0; a < g.axes(); ++a)
            if (at[a] < b.lo[a] || at[a] >= b.hi[a]) return false;
          return true;
        });
        const bool solid = std::any_of(balls.begin(), balls.end(), [&](const Ball& b) {
          Vec3 way = at - b.middle;
          if (g.flat()) way.z = 0;
          return length(way) < b.radius;
        });
        if (inside && !solid) out.push_back({x, {}, {}});
      }
  if (out.empty()) fail_usage("there is no water", "flip_liquid water", "give x0,x1,y0,y1,z0,z1 of boxes at least a cell large");
  return out;
}

}  // namespace

FlipLiquid::FlipLiquid(const FlipLiquidParams& p, const Context& context)
    : params_(p),
      grid_(smoke_grid(as_smoke(p), context)),
      gravity_(gravity_of(p, grid_)),
      balls_(balls_of(p.obstacle, grid_, "obstacle")),
      projection_(grid_, Solids(as_smoke(p), {}, grid_).walls<double>(Sides{}, 0, context)),
      u_(make_faces<double>(grid_)),
      pressure_(grid_.cells),
      particles_(fill(p, grid_, balls_)) {}

void FlipLiquid::keep_inside(Vec3& x) const {
  for (const Ball& b : balls_) {
    const Vec3 middle = (b.middle - grid_.origin) * (1 / grid_.h);
    Vec3 way = x - middle;
    if (grid_.flat()) way.z = 0;
    const double r = b.radius / grid_.h, l = length(way);
    if (l < r && l > 0) x += (r / l - 1) * way;
  }
  for (int a = 0; a < grid_.axes(); ++a) x[a] = std::clamp(x[a], rim, double(grid_.cells[size_t(a)]) - rim);
}

void FlipLiquid::step(double dt, const Context& context) {
  const std::vector<uint32_t> begin = sort_by_cell(grid_, particles_);
  std::vector<uint8_t> air(begin.size() - 1);
  for (size_t c = 0; c < air.size(); ++c) air[c] = begin[c] == begin[c + 1];
  Faces<double> known = make_faces<double>(grid_);
  particles_to_faces(grid_, particles_, begin, u_, known, context);
  const Faces<double> before = u_;
  for (int a = 0; a < grid_.axes(); ++a)
    for (double& v : u_[size_t(a)].values) v += dt * gravity_[a];
  projection_.set_air(air);
  std::array<Lattice<double>, 5> spare;
  projection_.apply(u_, pressure_, params_.tolerance, spare, context);
  // The flow of the water goes on into the air next to it, as far as particles may move.
  for (int a = 0; a < grid_.axes(); ++a) {
    Lattice<double>& have = known[size_t(a)];
    for (size_t row = 0; row < have.rows(); ++row)
      for (size_t i = 0; i < have.n[0]; ++i) {
        const std::array<size_t, 3> at{i, row % have.n[1], row / have.n[1]};
        const auto wet = [&](bool there, size_t back) {
          std::array<size_t, 3> c = at;
          c[size_t(a)] -= back;
          return there && !air[c[0] + grid_.cells[0] * (c[1] + grid_.cells[1] * c[2])];
        };
        have.row(row)[i] = wet(at[size_t(a)] > 0, 1) || wet(at[size_t(a)] < grid_.cells[size_t(a)], 0) ? 1 : 0;
      }
  }
  for (int a = 0; a < grid_.axes(); ++a) {  // nothing goes through the sides, in air neither
    Lattice<double>& have = known[size_t(a)];
    for (size_t row = 0; row < have.rows(); ++row)
      for (size_t i = 0; i < have.n[0]; ++i) {
        const size_t at = a == 0 ? i : a == 1 ? row % have.n[1] : row / have.n[1];
        if (at == 0 || at + 1 == have.n[size_t(a)]) have.row(row)[i] = 1, u_[size_t(a)].row(row)[i] = 0;
      }
  }
  Faces<double> of_air = known;
  extrapolate(grid_, u_, known, int(std::ceil(params_.cfl)) + 2, context);
  const Faces<double>* changes = nullptr;
  Faces<double> change;
  if (params_.transfer == Transfer::flip) {
    change = u_;
    for (size_t a = 0; a < 3; ++a)
      for (size_t i = 0; i < change[a].values.size(); ++i) change[a].values[i] -= before[a].values[i];
    extrapolate(grid_, change, of_air, 1, context);
    changes = &change;
  }
  const double way = dt / grid_.h;
  parallel_for(
      particles_.size(), particle_grain,
      [&](size_t first, size_t last) {
        for (size_t p = first; p < last; ++p) {
          Particle3& q = particles_[p];
          const Vec3 v = velocity_at(grid_, u_, q.x, params_.transfer == Transfer::apic ? &q.c : nullptr);
          q.v = changes ? params_.flip_share * (q.v + velocity_at(grid_, *changes, q.x)) + (1 - params_.flip_share) * v : v;
          // Ralston's third-order steps, as in advection.
          const Vec3 k2 = velocity_at(grid_, u_, q.x + 0.5 * way * v), k3 = velocity_at(grid_, u_, q.x + 0.75 * way * k2);
          q.x += way / 9 * (2 * v + 3 * k2 + 4 * k3);
          keep_inside(q.x);
        }
      },
      &context);
}

void FlipLiquid::advance(const Context& context) {
  double left = params_.frame;
  const double pull = length(gravity_);
  for (int taken = 0; left > 1e-9 * params_.frame; ++taken) {
    double speed = 0;
    for (const Particle3& q : particles_) {
      const double v = length(q.v);
      speed = v <= speed ? speed : v;  // NaN stays
      if (std::isnan(v)) break;
    }
    const double cells = left * (speed + std::sqrt(pull * grid_.h)) / (params_.cfl * grid_.h), steps = std::max(1.0, std::ceil(cells));
    if (!(steps + taken <= most_steps_of_a_frame))
      fail_data(fmt::format("the water grew to a speed of {:.3g} in frame {} (time {:.6g})", speed, frame_ + 1,
                            double(frame_ + 1) * params_.frame),
                "flip_liquid", "weaker gravity or shorter frames keep it slower");
    const double dt = left / steps;
    step(dt, context);
    left = steps > 1 ? left - dt : 0;
  }
  ++frame_;
}

double FlipLiquid::energy() const {
  double e = 0;
  for (const Particle3& q : particles_) e += 0.5 * dot(q.v, q.v) - grid_.h * dot(gravity_, q.x);
  return e / double(particles_.size());
}

size_t FlipLiquid::bytes() const { return particles_.capacity() * sizeof(Particle3) + 16 * pressure_.values.size() * sizeof(double); }

DatasetPtr FlipLiquid::cloud() const {
  const size_t count = particles_.size();
  std::vector<float> at(3 * count), velocity(3 * count);
  for (size_t p = 0; p < count; ++p) {
    const Vec3 x = grid_.origin + grid_.h * particles_[p].x;
    for (int a = 0; a < 3; ++a) at[3 * p + size_t(a)] = float(x[a]), velocity[3 * p + size_t(a)] = float(particles_[p].v[a]);
  }
  DatasetParts parts;
  parts.mesh = PointCloud{{Array::from_vector(std::move(at), 3), {}}};
  parts.time = double(frame_) * params_.frame;
  parts.fields.add({"velocity", Association::point, Array::from_vector(std::move(velocity), 3), "", Role::vectors});
  return make_dataset(std::move(parts));
}

DatasetPtr FlipLiquid::dataset(const Context& context) const {
  if (params_.show == LiquidShow::particles) return cloud();
  const auto& n = grid_.cells;
  const size_t count = n[0] * n[1] * n[2];
  UniformGrid mesh;
  mesh.dims = n, mesh.spacing = Vec3(grid_.h, grid_.h, grid_.h);
  mesh.origin = grid_.origin + 0.5 * grid_.h * Vec3(1, 1, grid_.flat() ? 0 : 1);
  // Shares of particles in the cells about them, of those that fill one.
  Lattice<double> sum(n);
  std::vector<Vec3> momentum(count);
  const double one = 1 / std::pow(double(params_.per_axis), grid_.axes());
  for (const Particle3& q : particles_) {
    for (size_t k = 0; k < (grid_.flat() ? 1u : 2u); ++k)
      for (size_t j = 0; j < 2; ++j)
        for (size_t i = 0; i < 2; ++i) {
          double w = one;
          std::array<size_t, 3> at{};
          const std::array<size_t, 3> upper{i, j, k};
          bool there = true;
          for (int a = 0; a < grid_.axes(); ++a) {
            const double p = q.x[a] - 0.5, below = std::floor(p), share = p - below;
            const double place = below + double(upper[size_t(a)]);
            w *= upper[size_t(a)] ? share : 1 - share;
            there = there && place >= -1 && place <= double(n[size_t(a)]);
            at[size_t(a)] = size_t(std::clamp(place, 0.0, double(n[size_t(a)]) - 1));  // what lies at a wall fills the cell beside it
          }
          if (!there) continue;
          sum(at[0], at[1], at[2]) += w, momentum[at[0] + n[0] * (at[1] + n[1] * at[2])] += w * q.v;
        }
  }
  context.check();
  DatasetParts parts;
  parts.mesh = mesh;
  parts.time = double(frame_) * params_.frame;
  std::vector<float> water(count), velocity(3 * count);
  for (size_t c = 0; c < count; ++c) {
    water[c] = float(std::min(sum.values[c], 1.0));
    for (int a = 0; a < 3; ++a) velocity[3 * c + size_t(a)] = sum.values[c] > 0 ? float(momentum[c][a] / sum.values[c]) : 0.0f;
  }
  parts.fields.add({"water", Association::point, Array::from_vector(std::move(water)), "", Role::scalars});
  parts.fields.add({"velocity", Association::point, Array::from_vector(std::move(velocity), 3), "", Role::vectors});
  return make_dataset(std::move(parts));
}

}  // namespace fluid

void describe(Schema& s, FlipLiquidParams& p) {
  s("size", p.size, "Cells along the longest side.").range(2, 1024);
  s("bounds", p.bounds, "The basin as x0,x1,y0,y1,z0,z1; default: 0,4,0,2,0,0. Equal z0 and z1: flat, in x and y.").items(6);
  describe(s, static_cast<FrameParams&>(p));
  s("water", p.water, "Boxes of water at the start, as x0,x1,y0,y1,z0,z1 of each; default: a column at the side of low x.");
  s("obstacle", p.obstacle, "Solid balls, as x,y,z,radius of each.");
  s("gravity", p.gravity, "Acceleration of all water; default: 9.81 down along z, of flat basins along y.").unit("length/time^2");
  s("transfer", p.transfer,
    "How particles take the velocity of the grid. pic: what is there; smooths. flip: its change; lively, but noisy. apic: what is there, "
    "and how it varies about them.");
  s("flip_share", p.flip_share, "Share of flip; the rest is pic.").range(0, 1);
  s("cfl", p.cfl, "Cells that the fastest water passes in a step, at most.").positive();
  s("tolerance", p.tolerance, "What may be left of the divergence, as a share of the largest before.").range(1e-12, 0.1);
  s("per_axis", p.per_axis, "Particles of a cell along each axis at the start.").range(1, 4);
  s("show", p.show, "grid: the share of each cell that is full (a surface lies at 0.5). particles: points.");
}

RunCost cost_of_flip(const FlipLiquidParams& p) {
  constexpr double seconds_a_cell = 1.5e-6;
  const fluid::MacGrid g = fluid::smoke_grid(fluid::as_smoke(p), Context());
  const double cells = double(g.count()), height = g.h * double(g.cells[g.flat() ? 1 : 2]);
  const double fall = std::sqrt(length(p.gravity.value_or(Vec3(0, 0, -9.81))) * height);  // from half of the height
  return cost_of_flow(p, "flip_liquid", uint64_t(cells) * 4 * sizeof(float), cells * seconds_a_cell, p.cfl, g.h, fall);
}

DatasetPtr flip_liquid(const FlipLiquidParams& p, Context& context) {
  using Run = fluid::FlipLiquid;
  return frame_of_run<Run>(
      "flip_liquid", p, [&] { return std::make_unique<Run>(p, context); }, context);
}

}  // namespace sg
