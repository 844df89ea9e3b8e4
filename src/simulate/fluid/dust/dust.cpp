// SPDX-License-Identifier: Apache-2.0
#include "simulate/fluid/dust/dust.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "base/error.h"
#include "base/parallel.h"
#include "base/random.h"
#include "base/text/text.h"

namespace sg::fluid {

namespace {

constexpr double margin = 1e-6;      // of a cell: what lies on the floor is so far above it
constexpr double usual_loading = 2;  // weight of the dust beside that of the air in its sources
constexpr double usual_lag = 0.05;   // time within which velocities draw level

double volume_of(const Ball& b, bool flat) {
  return flat ? std::numbers::pi * b.radius * b.radius : 4 * std::numbers::pi / 3 * b.radius * b.radius * b.radius;
}
double volume_of(const Box3& b, bool flat) { return b.size().x * b.size().y * (flat ? 1 : b.size().z); }

double positive(double v, const char* word) {
  if (!(v > 0) || !std::isfinite(v))
    fail_usage(fmt::format("{} is not positive and finite", exact_number(v)), fmt::format("dusty_smoke {}", word));
  return v;
}

DragLaw law_of(const DustParams& p, const MacGrid& g, Vec3 up, double volume) {
  if (!(p.dust_rate >= 0) || !std::isfinite(p.dust_rate) || !std::isfinite(p.dust_gravity))
    fail_usage("dust_rate and dust_gravity are finite numbers", "dusty_smoke", "and the rate is not negative");
  const double count = p.dust > 0 ? p.dust : p.dust_rate;
  if (!(count > 0)) fail_usage("there is no dust", "dusty_smoke", "give dust=COUNT or dust_rate=COUNT per time; without any: smoke");
  DragLaw law;
  law.mass = positive(p.dust_mass.value_or(usual_loading * volume / count), "dust_mass");
  law.drag = positive(p.dust_drag.value_or(law.mass / usual_lag), "dust_drag");
  law.pull = -p.dust_gravity * up;
  if (g.flat()) law.pull.z = 0;
  return law;
}

double volume_of(const std::vector<Ball>& balls, const std::vector<Box3>& boxes, bool flat, std::vector<double>* share = nullptr) {
  double sum = 0;
  for (const Ball& b : balls) {
    sum += volume_of(b, flat);
    if (share) share->push_back(sum);
  }
  for (const Box3& b : boxes) {
    sum += volume_of(b, flat);
    if (share) share->push_back(sum);
  }
  return sum;
}

std::vector<Ball> balls_for(const DustParams& p, const MacGrid& g, Vec3 up, const std::vector<Ball>& sources, bool boxes) {
  if (!p.dust_box.empty()) return {};
  if (!sources.empty() || boxes) return sources;
  const Vec3 size = g.h * Vec3(double(g.cells[0]), double(g.cells[1]), g.flat() ? 0 : double(g.cells[2]));
  Vec3 middle = g.origin + 0.5 * size;
  for (int a = 0; a < 3; ++a) middle[a] += 0.25 * up[a] * size[a];
  return {{middle, 0.2 * std::min({size.x, size.y, g.flat() ? size.x : size.z})}};
}

}  // namespace

template <class T>
Dust<T>::Dust(const DustParams& p, const MacGrid& g, Vec3 up, const std::vector<Ball>& balls, const std::vector<Box3>& boxes,
              const Context& context)
    : params_(p),
      grid_(g),
      balls_(balls_for(p, g, up, balls, !boxes.empty())),
      boxes_(p.dust_box.empty() ? boxes : boxes_of(p.dust_box, g, "dust_box")),
      law_(law_of(p, g, up, volume_of(balls_, boxes_, g.flat()))),
      exchange_(g, law_),
      owed_(make_faces<double>(g)) {
  const double sum = volume_of(balls_, boxes_, g.flat(), &share_);
  for (double& s : share_) s /= sum;
  if (context.memory_limit && double(p.dust) * 4 * sizeof(DustParticle) > double(context.memory_limit))
    fail_usage(fmt::format("{} particles take more memory than there is", p.dust), "dusty_smoke dust", "ask for fewer");
  emit(0);
}

template <class T>
void Dust<T>::emit(double time) {
  const double wanted = params_.dust + std::floor(params_.dust_rate * time * (1 + 1e-12));
  if (!(wanted < 1e9)) fail_usage("more than a billion particles", "dusty_smoke dust_rate", "emit fewer");
  constexpr uint64_t tries = 16, numbers = 4 * tries + 4;
  for (; double(emitted_) < wanted; ++emitted_) {
    const auto chance = [&](uint64_t k) { return random_unit(uint64_t(params_.seed), emitted_ * numbers + k); };
    const size_t source = size_t(std::upper_bound(share_.begin(), share_.end() - 1, chance(0)) - share_.begin());
    Vec3 at;
    bool inside = false;
    for (uint64_t k = 1; !inside && k + 3 < numbers;
         k += 4) {  // evenly in a ball by a box about it; what lies outside of the air is drawn again
      Vec3 q{chance(k), chance(k + 1), grid_.flat() ? 0.5 : chance(k + 2)};
      if (source < balls_.size()) {
        q = 2 * q - Vec3(1, 1, 1);
        inside = dot(q, q) <= 1;
        at = balls_[source].middle + balls_[source].radius * q;
      } else {
        const Box3& b = boxes_[source - balls_.size()];
        inside = true, at = b.lo + q * b.size();
      }
      at = (at - grid_.origin) * (1 / grid_.h);
      for (int a = 0; a < grid_.axes(); ++a) inside = inside && at[a] >= 0 && at[a] <= double(grid_.cells[size_t(a)]);
    }
    if (grid_.flat()) at.z = 0;
    for (int a = 0; a < grid_.axes(); ++a) at[a] = std::clamp(at[a], margin, double(grid_.cells[size_t(a)]) - margin);
    particles_.push_back({at, {}, emitted_});
  }
}

template <class T>
void Dust<T>::drag(double time, double dt, Faces<T>& u, const Walls<T>& walls, const Context& context) {
  for (size_t a = 0; a < 3; ++a)
    for (size_t i = 0; i < u[a].values.size(); ++i) u[a].values[i] -= T(owed_[a].values[i]);
  emit(time + dt);
  begin_ = sort_by_cell(grid_, particles_);
  exchange_.exchange(dt, particles_, begin_, u, walls, context);
}

template <class T>
void Dust<T>::move(double time, double dt, const Faces<T>& u, const Walls<T>& walls, const Solids& solids, const Context& context) {
  exchange_.follow(particles_, begin_, u, owed_, context);
  const double way = dt / grid_.h;
  parallel_for(
      particles_.size(), 4096,
      [&](size_t first, size_t last) {
        for (size_t p = first; p < last; ++p) {
          DustParticle& q = particles_[p];
          q.x += way * q.v;
          Vec3 at = grid_.origin + grid_.h * q.x;
          if (solids.keep_out(at, q.v, time + dt)) q.x = (at - grid_.origin) * (1 / grid_.h);
          for (int a = 0; a < grid_.axes(); ++a) {
            const double end = double(grid_.cells[size_t(a)]);
            for (const bool upper : {false, true}) {
              if (walls.sides[size_t(2 * a + upper)] || (upper ? q.x[a] <= end - margin : q.x[a] >= margin)) continue;
              q.x[a] = upper ? end - margin : margin;
              q.v[a] = upper ? std::min(q.v[a], 0.0) : std::max(q.v[a], 0.0);
            }
          }
        }
      },
      &context);
  std::erase_if(particles_, [&](const DustParticle& q) {
    for (int a = 0; a < grid_.axes(); ++a)
      if (q.x[a] < 0 || q.x[a] > double(grid_.cells[size_t(a)])) return true;
    return false;
  });
}

template <class T>
double Dust<T>::fastest() const {
  double most = 0;
  for (const DustParticle& q : particles_) {
    const double v = length(q.v);
    most = v <= most ? most : v;  // NaN stays
    if (std::isnan(v)) break;
  }
  return most;
}

template <class T>
size_t Dust<T>::bytes() const {
  const size_t faces = owed_[0].values.size() + owed_[1].values.size() + owed_[2].values.size();
  return particles_.capacity() * (sizeof(DustParticle) + sizeof(Vec3)) + 7 * faces * sizeof(double);
}

template <class T>
Lattice<T> Dust<T>::density(const Context& context) const {
  std::vector<DustParticle> sorted = particles_;
  const std::vector<uint32_t> begin = sort_by_cell(grid_, sorted);
  Lattice<double> sum(grid_.cells);
  each_to_places(grid_, begin, context, [&](size_t p) {
    Corners(sum.n, -1, sorted[p].x).each([&](const std::array<size_t, 3>& at, double w, const auto&) { sum(at[0], at[1], at[2]) += w; });
  });
  const double one = law_.mass / std::pow(grid_.h, grid_.axes());
  Lattice<T> out(grid_.cells);
  for (size_t i = 0; i < sum.values.size(); ++i) out.values[i] = T(one * sum.values[i]);
  return out;
}

template <class T>
DatasetPtr Dust<T>::cloud(double time) const {
  std::vector<DustParticle> sorted = particles_;
  std::sort(sorted.begin(), sorted.end(), [](const DustParticle& a, const DustParticle& b) { return a.id < b.id; });
  const size_t n = sorted.size();
  double *xyz = nullptr, *velocity = nullptr;
  int64_t* id = nullptr;
  PointCloud cloud;
  cloud.points.xyz = Array::make<double>(n, 3, &xyz);
  Array velocities = Array::make<double>(n, 3, &velocity), ids = Array::make<int64_t>(n, 1, &id);
  for (size_t i = 0; i < n; ++i) {
    const Vec3 at = grid_.origin + grid_.h * sorted[i].x;
    for (size_t a = 0; a < 3; ++a) xyz[3 * i + a] = at[int(a)], velocity[3 * i + a] = sorted[i].v[int(a)];
    id[i] = int64_t(sorted[i].id);
  }
  DatasetParts parts;
  parts.mesh = std::move(cloud);
  parts.time = time;
  parts.fields.add({"velocity", Association::point, std::move(velocities), "", Role::vectors});
  parts.fields.add({"id", Association::point, std::move(ids), "", Role::global_ids});
  return make_dataset(std::move(parts));
}

template class Dust<float>;
template class Dust<double>;

}  // namespace sg::fluid
