// SPDX-License-Identifier: Apache-2.0
#include "render/trace/media/media_walk.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "render/volume/medium/cubic.h"
#include "render/volume/medium/detail.h"

namespace sg::trace {

namespace {

using volume::DepthRay;
using volume::Span;
using volume::Stretch;

/// Expected questions to the field from which on a brick is gone through cell by cell: that costs about as much.
constexpr double dense = 6;
/// Shares of light below this go on by chance.
constexpr double faint = 0.05;
/// Nothing passes behind this optical depth.
constexpr double deepest = 40;

/// Calls f(stretch) from near to far while it returns true.
template <class F>
void each_stretch(volume::RayField& cells, const DepthRay& ray, double from, double to, F&& f) {
  cells.start(ray.origin, ray.direction, from, to);
  Stretch ahead[16];
  for (size_t count; (count = cells.next(ahead)) > 0;)
    for (size_t i = 0; i < count; ++i)
      if (!f(ahead[i])) return;
}

/// The place in a stretch of optical depth `all` up to which it is `depth`: the secant where it brackets (Illinois), else halves.
double place_of_depth(const volume::DepthIntegral& integral, const Stretch& s, volume::RayField& cells, double depth, double all) {
  double lo = s.from, hi = s.to, below = -depth, above = all - depth;
  for (int i = 0; i < 60 && hi - lo > 1e-9 * (s.to - s.from); ++i) {
    const double t = std::clamp(hi - above * (hi - lo) / (above - below), lo, hi);
    if (!(t > s.from && t < s.to)) return t;
    const double off = integral.over(volume::part_of(s, s.from, t), cells) - depth;
    if (std::abs(off) < 1e-6 * depth + 1e-9) return t;
    if (off < 0) lo = t, below = off, above *= 0.5;
    else hi = t, above = off, below *= 0.5;
  }
  return 0.5 * (lo + hi);
}

}  // namespace

MediaWalk::MediaWalk(std::span<const ParticipatingMedium> media, const Placement& placement) : placement_(placement) {
  for (const ParticipatingMedium& m : media) {
    const volume::RaySource& source = *m.volume().source;
    const bool ask_spans = !m.volume().detail && (m.tracking() == Tracking::mixed || m.tracking() == Tracking::delta);
    Walker& w = walkers_.emplace_back();
    w.medium = &m, w.cells = source.walker(), w.spans = ask_spans ? source.spans() : nullptr;
  }
}

bool MediaWalk::in_cells(const Walker& w, const DepthRay& ray, double from, double to, double& left, Place& place) {
  bool found = false;
  each_stretch(*w.cells, ray, from, to, [&](const Stretch& s) {
    const double depth = w.medium->depth().over(s, *w.cells);
    found = depth > left;
    if (found) place.t = place_of_depth(w.medium->depth(), s, *w.cells, left, depth), place.stretch = s, place.in_stretch = true;
    else left -= depth;
    return !found;
  });
  return found;
}

bool MediaWalk::by_majorant(const Walker& w, const Span& span, float majorant, double& left, RandomStream& random, Place& place) {
  for (double t = span.from;;) {
    const double next = t + left / double(majorant);
    if (!(next < span.to)) {
      left -= double(majorant) * (span.to - t);
      return false;
    }
    t = next;
    const float value = w.spans->value(t), tau = value == value ? w.medium->volume().medium->tau(value) : 0;
    if (random.next() * majorant < tau) {
      place.t = t, place.in_stretch = false, place.value = value, place.tau = tau;
      return true;
    }
    left = random.exponential();
  }
}

bool MediaWalk::in_cells_by_majorant(const Walker& w, const DepthRay& ray, double& left, RandomStream& random, Place& place) {
  const volume::Medium& medium = *w.medium->volume().medium;
  bool found = false;
  each_stretch(*w.cells, ray, ray.from, ray.to, [&](const Stretch& s) {
    const auto majorant = double(medium.most_tau(s.lowest(), s.highest()));
    for (double t = s.from; majorant > 0;) {
      t += left / majorant;
      if (!(t < s.to)) {
        left = (t - s.to) * majorant;
        break;
      }
      if (double(random.next()) * majorant < double(medium.tau(s.value(t)))) {
        place.t = t, place.stretch = s, place.in_stretch = found = true;
        return false;
      }
      left = random.exponential();
    }
    return true;
  });
  return found;
}

bool MediaWalk::in_steps(const Walker& w, const DepthRay& ray, double& left, Place& place) {
  const volume::CastVolume& v = w.medium->volume();
  std::vector<Stretch> all;
  each_stretch(*w.cells, ray, ray.from, ray.to, [&](const Stretch& s) {
    all.push_back(s);
    return true;
  });
  if (all.empty()) return false;
  // Whole steps from end to end.
  const double first = all.front().from, steps = std::ceil((all.back().to - first) / v.step), h = (all.back().to - first) / steps;
  size_t i = 0;
  for (double k = 0; k < steps; ++k) {
    const double from = first + k * h, middle = from + 0.5 * h;
    while (i + 1 < all.size() && all[i].to <= middle) ++i;
    const Stretch& s = all[i];
    if (middle < s.from || middle > s.to) continue;  // a gap
    const auto tau = double(v.detail ? place_at(*v.detail, s, middle, *w.cells).tau : v.medium->tau(s.value(middle)));
    if (tau * h > left) {
      place.t = from + left / tau, place.stretch = s, place.in_stretch = true;
      return true;
    }
    left -= tau * h;
  }
  return false;
}

bool MediaWalk::reaches(const Walker& w, const DepthRay& ray, double left, RandomStream& random, Place& place) {
  if (!(ray.from < ray.to)) return false;
  if (w.medium->tracking() == Tracking::march) return in_steps(w, ray, left, place);
  if (!w.spans && w.medium->tracking() == Tracking::delta && !w.medium->volume().detail)
    return in_cells_by_majorant(w, ray, left, random, place);
  if (!w.spans) return in_cells(w, ray, ray.from, ray.to, left, place);
  w.spans->start(ray.origin, ray.direction, ray.from, ray.to);
  for (Span s; w.spans->next_span(s);) {
    const float majorant = w.medium->volume().medium->most_tau(s.lo, s.hi);
    if (!(majorant > 0)) continue;
    const bool exactly = w.medium->tracking() == Tracking::mixed && double(majorant) * (s.to - s.from) > dense;
    if (exactly ? in_cells(w, ray, s.from, s.to, left, place) : by_majorant(w, s, majorant, left, random, place)) return true;
  }
  return false;
}

Collision MediaWalk::collision_at(const Walker& w, const DepthRay& ray, const Place& place, RandomStream& random) const {
  const volume::CastVolume& v = w.medium->volume();
  const bool may_be_surface = v.item->shaded;
  Stretch s = place.stretch;
  if (!place.in_stretch && may_be_surface) {
    s.from = place.t, s.to = place.t + 1e-3 * v.source->edge;
    each_stretch(*w.cells, ray, s.from, s.to, [&](const Stretch& around) {
      s = around;
      return false;
    });
  }
  Vec3f color;
  float tau = place.tau, coloring;
  if (v.detail) {
    const volume::DetailPlace p = place_at(*v.detail, s, std::clamp(place.t, s.from, s.to), *w.cells);
    tau = p.tau, color = {p.sample.r, p.sample.g, p.sample.b};
    coloring = v.item->detail.color_by_second ? p.second : p.value + v.source->base;
  } else {
    const float value = place.in_stretch ? s.value(std::clamp(place.t, s.from, s.to)) : place.value;
    const volume::Optics o = v.medium->at(value);
    color = o.color, tau = place.in_stretch ? o.tau : tau, coloring = value + v.source->base;
  }
  Collision c = w.medium->collision(color, coloring);
  c.t = w.medium->outward(place.t, placement_);
  if (may_be_surface && !(c.albedo == Vec3f())) {
    const Vec3f gradient = w.cells->gradient(s, std::clamp(place.t, s.from, s.to));
    const float square = dot(gradient, gradient);
    if (square > 0 && square < 1e30f && random.next() < w.medium->surface(tau, gradient)) {
      const float across = dot(gradient, Vec3f(ray.direction));
      c.on_surface = true, c.normal = gradient * ((across > 0 ? -1.f : 1.f) / std::sqrt(square));
      c.clear = w.medium->outward(0.5 * v.source->edge, placement_);
    }
  }
  return c;
}

std::optional<Collision> MediaWalk::collide(const Ray& ray, float u, RandomStream& random) {
  std::optional<Collision> first;
  Ray rest = ray;
  double left = -std::log1p(-double(u));
  for (const Walker& w : walkers_) {
    const DepthRay inner = w.medium->inward(rest, placement_);
    Place place{};
    if (reaches(w, inner, left, random, place)) {
      first = collision_at(w, inner, place, random);
      first->t = std::min(first->t, rest.t_max), rest.t_max = first->t;
    }
    left = random.exponential();
  }
  return first;
}

bool MediaWalk::exact() const {
  return std::none_of(walkers_.begin(), walkers_.end(), [](const Walker& w) { return w.medium->tracking() == Tracking::march; });
}

float MediaWalk::passes_exactly(const Ray& ray) {
  double all = 0;
  for (Walker& w : walkers_) {
    w.ray = w.medium->inward(ray, placement_);
    w.stretches.clear(), w.depth.clear();
    if (!(w.ray.from < w.ray.to)) continue;
    double depth = 0;
    each_stretch(*w.cells, w.ray, w.ray.from, w.ray.to, [&](const Stretch& s) {
      const double more = w.medium->depth().over(s, *w.cells);
      if (more > 0) w.stretches.push_back(s), w.depth.push_back(depth += more);
      return depth < deepest;
    });
    all += depth;
  }
  return all < deepest ? float(std::exp(-all)) : 0;
}

std::optional<Collision> MediaWalk::collide_surely(float u, RandomStream& random) {
  double all = 0;
  for (const Walker& w : walkers_) all += w.all();
  // The first medium in which something is met: it is met there with the chance 1 - exp(-depth), and not in those before it.
  double rest = double(u) * -std::expm1(-all);
  std::optional<Collision> first;
  bool chosen = false;
  for (const Walker& w : walkers_) {
    const double meets = -std::expm1(-w.all());
    double left;
    if (!chosen && rest < meets) left = -std::log1p(-rest), chosen = true;
    else if (chosen) left = random.exponential();
    else {
      rest = (rest - meets) / (1 - meets);
      continue;
    }
    const auto i = size_t(std::upper_bound(w.depth.begin(), w.depth.end(), left) - w.depth.begin());
    if (i == w.depth.size()) continue;
    const double before = i > 0 ? w.depth[i - 1] : 0;
    Place place{};
    place.t = place_of_depth(w.medium->depth(), w.stretches[i], *w.cells, left - before, w.depth[i] - before);
    place.stretch = w.stretches[i], place.in_stretch = true;
    if (first && !(w.medium->outward(place.t, placement_) < first->t)) continue;
    // Gradients and second fields are asked of a walker that is there.
    each_stretch(*w.cells, w.ray, place.stretch.from, place.stretch.to, [&](const Stretch& s) {
      place.stretch = s;
      return s.to < place.t;
    });
    first = collision_at(w, w.ray, place, random);
  }
  return first;
}

float MediaWalk::passes(const Ray& ray, RandomStream& random) {
  double share = 1;
  const auto goes_on = [&] {  // by chance where little passes
    if (share >= faint) return true;
    const bool lucky = double(random.next()) * faint < share;
    share = lucky ? faint : 0;
    return lucky;
  };
  for (const Walker& w : walkers_) {
    const DepthRay inner = w.medium->inward(ray, placement_);
    if (!(inner.from < inner.to)) continue;
    const volume::Medium& medium = *w.medium->volume().medium;
    const auto through_cells = [&](double from, double to) {
      double left = deepest;
      Place place{};
      const bool steps = w.medium->tracking() == Tracking::march;
      const bool stops = steps ? in_steps(w, inner, left, place) : in_cells(w, inner, from, to, left, place);
      share *= stops ? 0 : std::exp(left - deepest);
    };
    if (!w.spans) {
      if (w.medium->tracking() == Tracking::delta && !w.medium->volume().detail) {
        Place place{};  // one number decides, as on a path that goes straight
        share *= reaches(w, inner, random.exponential(), random, place) ? 0 : 1;
      } else {
        through_cells(inner.from, inner.to);
      }
      if (!(share > 0)) return 0;
      continue;
    }
    w.spans->start(inner.origin, inner.direction, inner.from, inner.to);
    for (Span s; w.spans->next_span(s);) {
      const auto majorant = double(medium.most_tau(s.lo, s.hi));
      if (!(majorant > 0)) continue;
      if (w.medium->tracking() == Tracking::mixed && majorant * (s.to - s.from) > dense) {
        through_cells(s.from, s.to);
      } else {
        for (double t = s.from + random.exponential() / majorant; t < s.to && share > 0; t += random.exponential() / majorant) {
          const float value = w.spans->value(t);
          if (value == value) share *= 1 - std::min(1.0, double(medium.tau(value)) / majorant);
          if (!goes_on()) return 0;
        }
      }
      if (!goes_on()) return 0;
    }
  }
  return float(share);
}

}  // namespace sg::trace
