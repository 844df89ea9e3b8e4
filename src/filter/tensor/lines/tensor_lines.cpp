// SPDX-License-Identifier: Apache-2.0
#include "filter/tensor/lines/tensor_lines.h"

#include <fmt/core.h>

#include "base/error.h"
#include "base/parallel.h"
#include "data/field_ops.h"
#include "data/memory/memory_budget.h"
#include "filter/flow/integrator.h"
#include "filter/probe/field_sampler.h"
#include "filter/tensor/tensor_shape.h"

namespace sg {

namespace {

struct Half {
  std::vector<Vec3> points, tangent;
  std::vector<Eigen3> eigen;
  std::vector<double> arc;
  TensorStop stop = TensorStop::outside;
};

Vec3 turned_to(Vec3 v, Vec3 reference) { return dot(v, reference) < 0 ? -v : v; }

// The eigenvector field with signs: a flow in the sense of flow_field.h.
struct DirectionFlow {
  TensorCursor* cursor;
  int k;
  Vec3 reference;
  bool operator()(Vec3 x, double, Vec3& v) {
    Eigen3 e;
    if (!cursor->eigen(x, e)) return false;
    v = turned_to(e.vector[k], reference);
    return true;
  }
};

// Why a line may not be at this place, if so.
std::optional<TensorStop> refused(const Eigen3& e, const TensorLineOptions& o, int dimension) {
  const int k = o.eigenvector, last = dimension - 1;
  double gap = HUGE_VAL, largest = 0;
  for (int j = 0; j <= last; ++j) {
    if (j != k) gap = std::min(gap, std::abs(e.value[j] - e.value[k]));
    largest = std::max(largest, std::abs(e.value[j]));
  }
  if (!(gap > o.min_gap * largest)) return TensorStop::degenerate;
  if (std::abs(e.value[k]) < o.min_eigenvalue) return TensorStop::eigenvalue;
  if (o.min_fa > 0 && (dimension == 2 ? fractional_anisotropy_2d(e.value) : fractional_anisotropy(e.value)) < o.min_fa)
    return TensorStop::anisotropy;
  return std::nullopt;
}

// The points after the seed in one direction.
Half trace_half(TensorCursor& cursor, Vec3 seed, const Eigen3& at_seed, double sign, const TensorLineOptions& o, int dimension) {
  Half h;
  const double cos_limit = std::cos(o.max_angle * M_PI / 180);
  Vec3 x = seed, dir = at_seed.vector[o.eigenvector] * sign;
  Eigen3 e = at_seed;
  cursor.eigen(seed, e);
  const Vec3 start_dir = dir;
  const double first_cell = cursor.cell_length();
  double arc = 0;
  bool away = false;
  for (int64_t n = 0; n < o.max_steps; ++n) {
    double step = std::min(o.step * cursor.cell_length(), o.max_length - arc);
    if (!(step > 1e-9 * cursor.cell_length())) {
      h.stop = TensorStop::length;
      return h;
    }
    DirectionFlow flow{&cursor, o.eigenvector, dir};
    Vec3 next;
    Eigen3 next_e;
    bool done = false, shortened = false;
    for (int halving = 0; halving <= 10 && !done; ++halving) {
      done = fixed_step(Scheme::rk4, flow, x, 0, step, dir, next) && cursor.eigen(next, next_e);
      if (!done) step /= 2, shortened = true;
    }
    if (!done) {
      h.stop = TensorStop::outside;
      return h;
    }
    next = cursor.snap(next);
    const Vec3 next_dir = turned_to(next_e.vector[o.eigenvector], dir);
    if (const auto why = refused(next_e, o, dimension)) {
      h.stop = *why;
      return h;
    }
    if (dot(next_dir, dir) < cos_limit) {
      h.stop = TensorStop::angle;
      return h;
    }
    const double moved = step;  // the length of the curve; that of the chord is of order 2 only
    away = away || length(next - seed) > first_cell;
    const double before = dot(x - seed, start_dir), after = dot(next - seed, start_dir);
    if (away && before < 0 && after >= 0 && length(lerp(x, next, before / (before - after)) - seed) < 0.01 * first_cell) {
      h.points.push_back(seed), h.tangent.push_back(start_dir), h.eigen.push_back(at_seed),
          h.arc.push_back(arc + moved * before / (before - after));
      h.stop = TensorStop::closed;
      return h;
    }
    arc += moved, x = next, dir = next_dir;
    h.points.push_back(x), h.tangent.push_back(dir), h.eigen.push_back(next_e), h.arc.push_back(arc);
    if (shortened && step < 2e-3 * o.step * cursor.cell_length()) {
      h.stop = TensorStop::outside;
      return h;
    }
  }
  h.stop = TensorStop::steps;
  return h;
}

struct Line {
  bool there = false;
  Vec3 seed;
  Eigen3 eigen;
  Half back, front;
};

Line trace_one(TensorCursor& cursor, Vec3 seed, const TensorLineOptions& o, int dimension) {
  Line l;
  l.seed = seed;
  if (!cursor.eigen(seed, l.eigen) || refused(l.eigen, o, dimension)) return l;
  l.there = true;
  if (o.direction != LineDirection::backward) l.front = trace_half(cursor, seed, l.eigen, 1, o, dimension);
  const bool closed = l.front.stop == TensorStop::closed;
  if (o.direction != LineDirection::forward && !closed) l.back = trace_half(cursor, seed, l.eigen, -1, o, dimension);
  return l;
}

void append(TensorLines& out, const Line& l, int64_t number, int k) {
  for (size_t i = l.back.points.size(); i-- > 0;) {
    out.points.push_back(l.back.points[i]), out.tangent.push_back(-l.back.tangent[i]);
    out.eigen.push_back(l.back.eigen[i]), out.arc.push_back(-l.back.arc[i]);
  }
  out.points.push_back(l.seed), out.tangent.push_back(l.eigen.vector[k]), out.eigen.push_back(l.eigen), out.arc.push_back(0);
  out.points.insert(out.points.end(), l.front.points.begin(), l.front.points.end());
  out.tangent.insert(out.tangent.end(), l.front.tangent.begin(), l.front.tangent.end());
  out.eigen.insert(out.eigen.end(), l.front.eigen.begin(), l.front.eigen.end());
  out.arc.insert(out.arc.end(), l.front.arc.begin(), l.front.arc.end());
  out.begin.push_back(out.points.size());
  out.seed.push_back(number);
  out.stop_forward.push_back(l.front.stop);
  out.stop_backward.push_back(l.back.stop);
}

}  // namespace

std::string_view tensor_stop_name(TensorStop s) {
  constexpr std::string_view names[] = {"outside", "length", "steps", "degenerate", "eigenvalue", "anisotropy", "angle", "closed"};
  return names[int(s)];
}

TensorLines trace_tensor_lines(const TensorSampler& sampler, std::span<const Vec3> seeds, const TensorLineOptions& options, Context& ctx) {
  need_memory(double(seeds.size()) * double(sizeof(Line)), fmt::format("{} seeds", seeds.size()), "seeds", "use fewer: count, seeds");
  std::vector<Line> lines(seeds.size());
  parallel_for(
      seeds.size(), 8,
      [&](size_t begin, size_t end) {
        TensorCursor cursor(sampler);
        for (size_t i = begin; i < end; ++i) lines[i] = trace_one(cursor, seeds[i], options, sampler.dimension());
      },
      &ctx);
  TensorLines out;
  for (size_t i = 0; i < lines.size(); ++i)
    if (lines[i].there) {
      append(out, lines[i], int64_t(i), options.eigenvector);
      lines[i] = {};
    }
  return out;
}

std::vector<Vec3> even_places(const Box3& box, int64_t count) {
  std::vector<Vec3> r;
  if (box.empty() || count < 1) return r;
  const Vec3 size = box.size();
  const double largest = std::max({size.x, size.y, size.z});
  if (!(largest > 0 && largest < HUGE_VAL)) return {box.center()};
  const Vec3 part{size.x / largest, size.y / largest, size.z / largest};  // whose product is a number, however small or large the box
  double volume = 1;
  int dimension = 0;
  for (int a = 0; a < 3; ++a)
    if (part[a] > 1e-9) volume *= part[a], ++dimension;
  // The finest even lattice with no more than a tenth above `count` places.
  double d = std::pow(volume / double(count), 1.0 / dimension);
  size_t n[3];
  for (;; d *= 1.02) {
    double total = 1;
    for (int a = 0; a < 3; ++a) {
      const double along = part[a] > 1e-9 ? std::max(1.0, std::round(part[a] / d)) : 1;
      n[a] = size_t(along), total *= along;
    }
    if (total <= 1.1 * double(count)) break;
  }
  for (size_t k = 0; k < n[2]; ++k)
    for (size_t j = 0; j < n[1]; ++j)
      for (size_t i = 0; i < n[0]; ++i)
        r.push_back(box.lo +
                    size * Vec3((double(i) + 0.5) / double(n[0]), (double(j) + 0.5) / double(n[1]), (double(k) + 0.5) / double(n[2])));
  return r;
}

std::vector<Vec3> listed_places(const std::vector<double>& numbers, std::string_view who) {
  if (numbers.size() % 3 != 0)
    fail_usage(fmt::format("seeds has {} numbers, not a multiple of three", numbers.size()), std::string(who), "x,y,z,x,y,z,...");
  std::vector<Vec3> r;
  for (size_t i = 0; i < numbers.size(); i += 3) r.push_back({numbers[i], numbers[i + 1], numbers[i + 2]});
  return r;
}

void carry_along(FieldSet& out, const TensorSampler& sampler, const std::vector<Vec3>& points, const std::vector<std::string>& fields,
                 size_t repeat, Context& ctx) {
  DatasetParts wanted = sampler.dataset()->parts();
  const FieldSet& all = sampler.dataset()->fields();
  wanted.fields = {};
  for (const std::string& name : fields) wanted.fields.add(all.require(name));
  if (fields.empty())
    for (const Field& f : all)
      if (f.association != Association::whole && f.name != sampler.tensors().field.name) wanted.fields.add(f);
  if (wanted.fields.empty() || points.empty()) return;
  FieldSampler values(*make_dataset(std::move(wanted)), points.size());
  parallel_for(
      points.size(), 1024,
      [&](size_t begin, size_t end) {
        TensorCursor cursor(sampler);
        SampleBlock block;
        SymTensor ignored;
        for (size_t i = begin; i < end; ++i) {
          const bool found = cursor.tensor(points[i], ignored) || cursor.cell() >= 0;
          if (found) block.add(i, cursor.cell(), cursor.ids(), cursor.weights());
          else block.add_missing(i);
          if (block.full()) values.write(block), block.count = 0;
        }
        values.write(block);
      },
      &ctx);
  std::vector<int64_t> ids;
  if (repeat > 1) {
    ids.resize(points.size() * repeat);
    for (size_t i = 0; i < ids.size(); ++i) ids[i] = int64_t(i / repeat);
  }
  for (Field f : values.take()) {
    if (f.name == "valid" || f.association != Association::point || out.find(f.name, Association::point)) continue;
    if (repeat > 1) f.array = gather(f.array, ids);
    out.add(std::move(f));
  }
}

}  // namespace sg
