// SPDX-License-Identifier: Apache-2.0
#include "filter/flow/unsteady/particles.h"

#include "base/parallel.h"
#include "filter/flow/unsteady/advance_one.h"
#include "filter/flow/unsteady/flat_advance.h"

namespace sg {

namespace {

constexpr size_t particles_per_chunk = 256;

void add(Way& way, size_t i, const Particle& p) {
  way.particle.push_back(i), way.x.push_back(p.x), way.v.push_back(p.v), way.t.push_back(p.t);
}

template <class T>
void append(std::vector<T>& to, const std::vector<T>& from) {
  to.insert(to.end(), from.begin(), from.end());
}

void advance_some(const UnsteadyFlow& flow, std::span<Particle> particles, size_t begin, size_t end, double until, int sign,
                  const TraceOptions& o, Way* way) {
  UnsteadyCursor cursor(flow);
  for (size_t i = begin; i < end; ++i) {
    Particle& p = particles[i];
    if (p.ended || (until - p.t) * sign < 0) continue;
    if (!p.started) {
      if (!detail::start_particle(cursor, p)) continue;
      if (way) add(*way, i, p);
    } else {
      // The cursor has to know its cell; where two intervals meet they may differ in what is inside.
      Vec3 v;
      if (!cursor(p.x, p.t, v)) {
        p.ended = true, p.why = StopReason::outside;
        continue;
      }
      p.v = v;
    }
    detail::advance_one(cursor, p, until, o, [&](const Particle& now) {
      if (way) add(*way, i, now);
    });
  }
}

}  // namespace

void advance(const UnsteadyFlow& flow, std::span<Particle> particles, double until, int sign, const TraceOptions& options, Context& context,
             Way* way) {
  const auto job = lattice_advance::job_of(flow, options);
  std::vector<Way> parts(way ? (particles.size() + particles_per_chunk - 1) / particles_per_chunk : 0);
  parallel_for(
      particles.size(), particles_per_chunk,
      [&](size_t begin, size_t end) {
        Way* part = way ? &parts[begin / particles_per_chunk] : nullptr;
        const auto some = particles.subspan(begin, end - begin);
        if (job && flat_advance::takes(*job)) flat_advance::run(*job, some, begin, until, sign, options, part);
        else if (job) lattice_advance::run(*job, some, begin, until, sign, options, part);
        else advance_some(flow, particles, begin, end, until, sign, options, part);
      },
      &context);
  if (!way) return;
  for (Way& p : parts) {
    append(way->particle, p.particle), append(way->x, p.x), append(way->v, p.v), append(way->t, p.t);
    p = {};
  }
}

std::vector<size_t> space_order(std::span<const Vec3> places) {
  Box3 box;
  for (const Vec3& p : places) box.add(p);
  const auto spread = [](uint64_t v) {  // 20 bits, two free places behind each
    v = (v | v << 32) & 0x1F00000000FFFF;
    v = (v | v << 16) & 0x1F0000FF0000FF;
    v = (v | v << 8) & 0x100F00F00F00F00F;
    v = (v | v << 4) & 0x10C30C30C30C30C3;
    return (v | v << 2) & 0x1249249249249249;
  };
  std::vector<std::pair<uint64_t, size_t>> keys(places.size());
  for (size_t i = 0; i < places.size(); ++i) {
    uint64_t key = 0;
    for (int a = 0; a < 3; ++a) {
      const double s = box.hi[a] > box.lo[a] ? (places[i][a] - box.lo[a]) / (box.hi[a] - box.lo[a]) : 0;
      key |= spread(uint64_t((s > 0 ? std::min(s, 1.0) : 0.0) * double((1 << 20) - 1))) << a;
    }
    keys[i] = {key, i};
  }
  std::sort(keys.begin(), keys.end());
  std::vector<size_t> order(keys.size());
  for (size_t i = 0; i < keys.size(); ++i) order[i] = keys[i].second;
  return order;
}

void CarriedFields::open(const UnsteadyFlow& flow) {
  if (known_) return;
  known_ = true;
  const FlowField& first = flow.steps().front();
  for (const Field& f : first.dataset()->fields()) {
    if (f.association == Association::whole || f.name == first.field().name) continue;
    const bool twice = std::any_of(columns_.begin(), columns_.end(), [&](const Column& c) { return c.name == f.name; });
    if (!twice) columns_.push_back({f.name, f.unit, f.association, f.components(), {}});
  }
}

void CarriedFields::sample(const UnsteadyFlow& flow, std::span<const Vec3> x, std::span<const double> t, Context& context) {
  open(flow);
  if (columns_.empty() || x.empty()) return;
  std::vector<std::vector<Array>> values(columns_.size());
  std::vector<size_t> first(columns_.size());
  for (size_t c = 0; c < columns_.size(); ++c) {
    Column& column = columns_[c];
    for (const FlowField& s : flow.steps()) {
      const Field* f = s.dataset()->fields().find(column.name, column.association);
      values[c].push_back(f && f->components() == column.components ? f->array : Array());
    }
    first[c] = column.values.size();
    column.values.resize(first[c] + x.size() * size_t(column.components), NAN);
  }
  parallel_for(
      x.size(), particles_per_chunk,
      [&](size_t begin, size_t end) {
        UnsteadyCursor cursor(flow);
        Vec3 v;
        for (size_t i = begin; i < end; ++i) {
          if (!cursor(x[i], t[i], v)) continue;
          for (size_t c = 0; c < columns_.size(); ++c) {
            Column& column = columns_[c];
            for (int k = 0; k < column.components; ++k)
              column.values[first[c] + i * size_t(column.components) + size_t(k)] = float(cursor.value(values[c], column.association, k));
          }
        }
      },
      &context);
}

FieldSet CarriedFields::take(std::span<const size_t> place) {
  FieldSet fields;
  for (Column& c : columns_) {
    const size_t n = size_t(c.components);
    float* out = nullptr;
    Array a = Array::make<float>(place.size(), c.components, &out);
    for (size_t i = 0; i < place.size(); ++i)
      for (size_t k = 0; k < n; ++k) out[i * n + k] = c.values[place[i] * n + k];
    fields.add({c.name, Association::point, std::move(a), c.unit, Role::none});
    c.values = {};
  }
  return fields;
}

}  // namespace sg
