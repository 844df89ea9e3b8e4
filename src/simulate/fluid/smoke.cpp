// SPDX-License-Identifier: Apache-2.0
#include "simulate/fluid/smoke.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

#include "base/error.h"
#include "base/parallel.h"
#include "simulate/fluid/forces.h"
#include "simulate/fluid/lattice_sums.h"

namespace sg::fluid {

namespace {

constexpr double most_steps = 1000;  // of a frame

Vec3 up_of(const SmokeParams& p, const MacGrid& g) {
  if (!p.up) return g.flat() ? Vec3(0, 1, 0) : Vec3(0, 0, 1);
  const double l = length(*p.up);
  if (!(l > 0) || !std::isfinite(l) || (g.flat() && std::abs(p.up->z) >= l))
    fail_usage("up has no direction in the flow", "smoke up", "give a vector such as 0,0,1");
  return *p.up * (1 / l);
}

}  // namespace

template <class T>
Smoke<T>::Smoke(const SmokeParams& p, SmokeInput given, const Context& context)
    : params_(p),
      grid_(smoke_grid(p, context)),
      up_(up_of(p, grid_)),
      sides_(sides_of(p, grid_, up_)),
      emission_(p, grid_, up_, given, context),
      solids_(p, given.role == SurfaceRole::obstacle ? std::move(given.surface) : TriangleSoup(), grid_),
      projection_(grid_, solids_.walls<T>(sides_, 0, context)),
      velocity_(make_faces<T>(grid_)),
      density_(grid_.cells),
      temperature_(grid_.cells),
      pressure_(grid_.cells) {
  // Lattices change places: each has room for the largest.
  const size_t most = std::max({velocity_[0].values.size(), velocity_[1].values.size(), velocity_[2].values.size()});
  for (Lattice<T>* l : {&velocity_[0], &velocity_[1], &velocity_[2], &density_, &temperature_}) l->values.reserve(most);
  for (Lattice<T>& l : spare_) l.values.reserve(most);
  if (given.dust) {
    if (p.reflect) fail_usage("dust is not dragged in mirrored steps", "dusty_smoke reflect", "leave it out");
    dust_.emplace(*given.dust, grid_, up_, emission_.balls(), emission_.boxes(), context);
  }
  give_off(0);
}

template <class T>
void Smoke<T>::give_off(double dt) {
  emission_.give_off(dt, density_, temperature_, velocity_);
}

template <class T>
double Smoke<T>::fastest(const Context& context) const {
  double most = solids_.speed();
  for (const Side& s : sides_) most = std::max(most, length(s.velocity));
  for (const Lattice<T>& l : velocity_) {
    const double v = largest(l, context);
    most = v <= most ? most : v;  // NaN stays
    if (std::isnan(v)) return v;
  }
  if (!dust_) return most;
  const double v = dust_->fastest();
  return v <= most ? most : v;
}

template <class T>
void Smoke<T>::carry_scalars(double dt, const Context& context) {
  const Carrier<T> carrier{grid_, velocity_, dt, params_.advection, params_.trace, true};
  const std::array<Lattice<T>*, 2> scalars{&density_, &temperature_};
  for (Lattice<T>& l : spare_) shaped(l, grid_.cells);
  const std::array<Carried<T>, 2> carried{{{scalars[0], &spare_[0], &spare_[2]}, {scalars[1], &spare_[1], &spare_[3]}}};
  advect<T>(carrier, -1, carried, spare_[4], context);
  for (size_t f = 0; f < 2; ++f) std::swap(*scalars[f], spare_[f]);
  const T fade = T(std::exp(-params_.fading * dt)), cool = T(std::exp(-params_.cooling * dt));
  if (fade != 1)
    for (T& v : density_.values) v *= fade;
  if (cool != 1)
    for (T& v : temperature_.values) v *= cool;
}

// v, by the flow of velocity_, which may be v.
template <class T>
void Smoke<T>::carry_velocity(double dt, Faces<T>& v, const Context& context) {
  const Carrier<T> carrier{grid_, velocity_, dt, params_.advection, params_.trace, params_.limit};
  for (size_t a = 0; a < size_t(grid_.axes()); ++a) {
    for (const size_t s : {a, size_t(3), size_t(4)}) shaped(spare_[s], v[a].n);
    const Carried<T> component{&v[a], &spare_[a], &spare_[3]};
    advect<T>(carrier, int(a), {&component, 1}, spare_[4], context);
  }
  for (size_t a = 0; a < size_t(grid_.axes()); ++a) std::swap(v[a], spare_[a]);
}

template <class T>
void Smoke<T>::push(double dt, const Context& context) {
  add_buoyancy(grid_, projection_.walls().sides, density_, temperature_, up_, params_.weight, params_.lift, dt, velocity_, context);
  confine_vortices<T>(grid_, params_.swirl, dt, velocity_, spare_, context);
  if (dust_) dust_->drag(time_ - dt, dt, velocity_, projection_.walls(), context);
  diffuse_velocity<T>(grid_, projection_.walls(), sides_, params_.viscosity, dt, velocity_, spare_, context);
  solved_ = projection_.apply(velocity_, pressure_, params_.tolerance, spare_, context);
  if (dust_) dust_->move(time_ - dt, dt, velocity_, projection_.walls(), solids_, context);
}

template <class T>
void Smoke<T>::step(double dt, const Context& context) {
  time_ += dt;
  if (solids_.move()) projection_ = Projection<T>(grid_, solids_.walls<T>(sides_, time_, context));
  if (!params_.reflect) {
    carry_scalars(dt, context), carry_velocity(dt, velocity_, context);
    give_off(dt);
    push(dt, context);
    return;
  }
  // What forces and pressure did in the first half is done once more before the second is carried: u becomes 2 u - (u before).
  const double half = dt / 2;
  carry_scalars(half, context), carry_velocity(half, velocity_, context);
  reflected_ = velocity_;
  give_off(half);
  push(half, context);
  for (size_t a = 0; a < 3; ++a)
    for (size_t i = 0; i < reflected_[a].values.size(); ++i) {
      T& v = reflected_[a].values[i];
      v = 2 * velocity_[a].values[i] - v;
    }
  carry_scalars(half, context), carry_velocity(half, reflected_, context);
  std::swap(velocity_, reflected_);
  give_off(half);
  solved_ = projection_.apply(velocity_, pressure_, params_.tolerance, spare_, context);
}

template <class T>
void Smoke<T>::advance(const Context& context) {
  const double push =
      std::abs(params_.lift * params_.temperature) + std::abs(params_.weight * params_.density) + (dust_ ? length(dust_->law().pull) : 0);
  double left = params_.frame;
  for (int taken = 0; left > 1e-9 * params_.frame; ++taken) {
    const double speed = fastest(context);
    // In equal steps, none of which takes the fastest air, or what the forces make of air at rest, through more than cfl cells.
    const double cells = left * std::max(speed, std::sqrt(push * grid_.h)) / (params_.cfl * grid_.h),
                 steps = std::max(1.0, std::ceil(cells));
    if (!(steps + taken <= most_steps))
      fail_data(fmt::format("the flow grew to a speed of {:.3g} in frame {} (time {:.6g})", speed, frame_ + 1,
                            double(frame_ + 1) * params_.frame),
                "smoke",
                params_.advection == Advection::explicit_euler ? "explicit advection is unstable: take another one"
                                                               : "weaker forces or shorter frames keep it slower");
    const double dt = left / steps;
    step(dt, context);
    ++steps_;
    left = steps > 1 ? left - dt : 0;
  }
  ++frame_;
  time_ = double(frame_) * params_.frame;
}

template <class T>
size_t Smoke<T>::bytes() const {
  size_t numbers = 0;
  const auto add = [&](const auto& lattices) {
    for (const Lattice<T>& l : lattices) numbers += l.values.capacity();
  };
  add(velocity_), add(reflected_), add(spare_), add(projection_.walls().open), add(projection_.walls().solid);
  add(std::array{std::cref(density_), std::cref(temperature_), std::cref(pressure_)});
  return numbers * sizeof(T) + emission_.bytes() + (dust_ ? dust_->bytes() : 0);
}

template <class T>
DatasetPtr Smoke<T>::dataset(const Context& context) const {
  if (dust_ && dust_->shown()) return dust_->cloud(double(frame_) * params_.frame);
  const auto& n = grid_.cells;
  const size_t count = n[0] * n[1] * n[2];
  UniformGrid mesh;
  mesh.dims = n;
  mesh.spacing = Vec3(grid_.h, grid_.h, grid_.h);
  mesh.origin = grid_.origin + 0.5 * grid_.h * Vec3(1, 1, grid_.flat() ? 0 : 1);
  DatasetParts parts;
  parts.mesh = mesh;
  parts.time = double(frame_) * params_.frame;
  const auto add = [&](const char* name, const Lattice<T>& l) {
    T* to = nullptr;
    Array values = Array::make<T>(count, 1, &to);
    std::copy(l.values.begin(), l.values.end(), to);
    parts.fields.add({name, Association::point, std::move(values), "", Role::scalars});
  };
  add("density", density_), add("temperature", temperature_);
  T* to = nullptr;
  Array velocity = Array::make<T>(count, 3, &to);
  const auto& u = velocity_;
  parallel_for(
      n[1] * n[2], 16,
      [&](size_t begin, size_t end) {
        for (size_t row = begin; row < end; ++row)
          for (size_t i = 0; i < n[0]; ++i) {
            const size_t j = row % n[1], k = row / n[1];
            T* const v = to + 3 * (i + row * n[0]);
            v[0] = (u[0](i, j, k) + u[0](i + 1, j, k)) / 2, v[1] = (u[1](i, j, k) + u[1](i, j + 1, k)) / 2;
            v[2] = grid_.flat() ? T(0) : (u[2](i, j, k) + u[2](i, j, k + 1)) / 2;
          }
      },
      &context);
  parts.fields.add({"velocity", Association::point, std::move(velocity), "", Role::vectors});
  add("pressure", pressure_);
  if (dust_) {
    const Lattice<T> dust = dust_->density(context);
    Field f{"dust", Association::point, Array::from_vector(std::vector<T>(dust.values.begin(), dust.values.end())), "", Role::scalars};
    f.look.result = true;
    parts.fields.add(std::move(f));
  }
  if (const Walls<T>& w = projection_.walls(); w.obstacles()) {  // share of the cells about each that is solid, by their faces
    Lattice<T> solid(n);
    for (size_t k = 0; k < n[2]; ++k)
      for (size_t j = 0; j < n[1]; ++j)
        for (size_t i = 0; i < n[0]; ++i) {
          T open = 0, faces = 0;
          for (size_t a = 0; a < size_t(grid_.axes()); ++a)
            for (size_t side = 0; side < 2; ++side) {
              std::array<size_t, 3> f{i, j, k};
              f[a] += side;
              if (f[a] == 0 || f[a] == n[a]) continue;  // walls of the box are no obstacles
              open += w.open[a](f[0], f[1], f[2]), ++faces;
            }
          solid(i, j, k) = faces > 0 ? 1 - open / faces : T(0);
        }
    add("solid", solid);
  }
  return make_dataset(std::move(parts));
}

template class Smoke<float>;
template class Smoke<double>;

}  // namespace sg::fluid
