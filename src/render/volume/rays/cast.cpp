// SPDX-License-Identifier: Apache-2.0
#include "render/volume/rays/cast.h"
#include "render/shade/exp.h"

#include <algorithm>
#include <cmath>

#include "render/volume/effects/effects.h"
#include "render/volume/medium/transfer.h"
#include "render/volume/rays/joined_field.h"

namespace sg::volume {

Vec3f CastVolume::color_at(float stored, float second) const {
  if (!item->detail.color_by_second) return medium->at(stored).color;
  const TransferFunction::Sample s = transfer->at(stored, second);
  return {s.r, s.g, s.b};
}

/// Fixed steps over whatever stretches come: each step has one sample, taken in its middle (or its two ends, pre-integrated), and counts
/// with the length on which there is a volume. Of a step that is cut short the sample lies in the middle of what there is.
struct Caster::Steps {
  double origin = 0;  // where step 0 begins
  double covered = 0, from = 0;
  long step = 0;
  bool open = false;
  float value = 0, first = 0, last = 0;
  Optics optics;  // classified before
  Lit lit;
  struct Part {
    Stretch stretch;
    double from, to;
  };
  std::vector<Part> parts;  // of this step
};

struct Caster::Active {
  const CastVolume* volume = nullptr;
  std::unique_ptr<RayField> walker;
  LitRay lights;
  Look look;
  Steps steps;
  Stretch ahead[32];
  size_t next = 0, count = 0;

  Active(const CastVolume& v, std::unique_ptr<RayField> field)
      : volume(&v),
        walker(std::move(field)),
        look{*v.medium, v.budget, v.id, nullptr, v.per_scale, float(v.source->edge), v.detail.get()} {}

  /// Whether there is a stretch to draw. Reads on when all that were read ahead are drawn.
  bool peek() {
    if (next < count) return true;
    next = 0, count = walker->next(ahead);
    return count > 0;
  }
  Stretch& front() { return ahead[next]; }

  /// Limits of the ray by the planes that clip the volume.
  void start(const CastRay& ray) {
    double from = ray.from, to = ray.to;
    for (const ClipPlane& p : volume->item->clip) {
      const double d = dot(p.normal, ray.direction), rest = p.offset - dot(p.normal, ray.origin);
      if (d > 0) to = std::min(to, rest / d);
      else if (d < 0) from = std::max(from, rest / d);
      else if (rest < 0) to = from - 1;
    }
    next = count = 0;
    walker->start(ray.origin, ray.direction, from, to);
    if ((volume->item->shaded || volume->effects) && ray.lights) {
      lights = *ray.lights, lights.material = volume->material, look.lit = &lights;
      lights.effects = volume->effects.get();
    }
    steps = {};
    // Whatever is passed over, steps are counted from where the ray enters.
    if (volume->step > 0) steps.origin = walker->entry() - (volume->item->sampling.jitter ? ray.jitter * volume->step : 0);
  }

  void flush(RayState& state) {
    if (!steps.open) return;
    steps.open = false;
    if (!(steps.covered > 0)) return;
    double rest = 0.5 * steps.covered;
    for (const Steps::Part& p : steps.parts) {
      if (rest <= p.to - p.from || &p == &steps.parts.back()) {
        take_sample(p.stretch, std::min(p.from + rest, p.to));
        break;
      }
      rest -= p.to - p.from;
    }
    const Lit* lit = look.lit ? &steps.lit : nullptr;
    if (volume->table)
      composite_segment(look, steps.from, steps.covered, volume->table->at(steps.first, steps.last, float(steps.covered)), lit, state);
    else if (volume->item->sampling.classify == VolumeClassify::integrated)
      composite_straight(look, steps.from, steps.from + steps.covered, steps.first, steps.last, lit, state);
    else if (volume->item->sampling.classify == VolumeClassify::pre)
      composite_optics(look, steps.from, steps.covered, steps.optics, lit, state);
    else composite_sample(look, steps.from, steps.covered, steps.value, lit, state);
  }

  /// Opacities and associated colours of the samples around, interpolated.
  Optics classified_before(const Stretch& s, double t, float value) {
    float values[8], shares[8];
    const int n = walker->samples(s, t, values, shares);
    if (n == 0) return look.medium.at(value);
    double opacity = 0;
    Vec3 glow{0, 0, 0};
    for (int i = 0; i < n; ++i) {
      const Optics o = look.medium.at(values[i]);
      const double a = double(shares[i]) * (1 - exp_negative(double(o.tau) * volume->unit));
      opacity += a, glow += Vec3(o.color) * a;
    }
    if (!(opacity > 0)) return {};
    return {float(opacity < 1 ? minus_log_one_minus(opacity) / volume->unit : 1e6), Vec3f(glow / opacity)};
  }

  void take_sample(const Stretch& s, double t) {
    steps.value = s.value(t);
    const bool before = volume->item->sampling.classify == VolumeClassify::pre;
    if (before) steps.optics = classified_before(s, t, steps.value);
    if (look.lit && (before || volume->table || !look.medium.clear(steps.value, steps.value))) steps.lit = light_on(look, *walker, s, t);
  }

  /// Draws a stretch in fixed steps; what belongs to a step that goes on is kept.
  void step_through(const Stretch& s, RayState& state) {
    const double h = volume->step;
    for (double t = s.from; t < s.to;) {
      long k = long(std::floor((t - steps.origin) / h + 1e-9));
      if (steps.open && k != steps.step) flush(state);
      const double end = std::min(s.to, steps.origin + double(k + 1) * h);
      if (!steps.open) {
        steps.covered = 0, steps.from = t, steps.step = k, steps.open = true, steps.first = s.value(t);
        steps.parts.clear(), steps.lit = {}, steps.optics = {};
      }
      steps.covered += end - t;
      steps.last = s.value(end);
      steps.parts.push_back({s, t, end});
      if (!(end > t)) break;
      t = end;
    }
  }
};

Caster::Caster(const std::vector<CastVolume>& volumes) {
  std::vector<char> taken(volumes.size(), 0);
  for (size_t i = 0; i < volumes.size(); ++i) {
    const CastVolume& v = volumes[i];
    if (taken[i]) continue;
    if (v.item->mode == RayFunction::composite) {
      composite_.push_back(std::make_shared<Active>(v, v.source->walker()));
      continue;
    }
    // Parts of a collection have one maximum, one first hit, one mean.
    std::vector<const RaySource*> parts{v.source.get()};
    for (size_t k = i + 1; v.item->group && k < volumes.size(); ++k)
      if (volumes[k].item->group == v.item->group && volumes[k].item->mode == v.item->mode)
        parts.push_back(volumes[k].source.get()), taken[k] = 1;
    others_.push_back(std::make_shared<Active>(v, parts.size() > 1 ? std::make_unique<JoinedField>(parts) : v.source->walker()));
  }
}

void Caster::put(float t, Vec3f color, float alpha, uint32_t id) {
  if (!(alpha > 0)) return;
  const Fragment f{t, {color.x * alpha, color.y * alpha, color.z * alpha, alpha}, id};
  fragments_.insert(
      std::upper_bound(fragments_.begin(), fragments_.end(), f,
                       [](const Fragment& a, const Fragment& b) { return a.depth < b.depth || (a.depth == b.depth && a.id < b.id); }),
      f);
}

void Caster::collect(Active& active, const CastRay& ray) {
  const CastVolume& v = *active.volume;
  active.start(ray);
  RayField& walker = *active.walker;
  const float base = v.source->base;
  // A scalar is drawn in the full colour of its value, unless its opacity there is zero.
  const auto put_value = [&](double value, double t, float second = NAN) {
    if (!(v.medium->tau(float(value)) > 0)) return;
    const Vec3f c = v.color_at(float(value), second);
    const float fade = v.effects && active.look.lit ? v.effects->fade(ray.origin + ray.direction * t) : 0;
    put(float(t), fade > 0 ? c * (1 - fade) + active.lights.background * fade : c, 1, v.id);
  };
  const auto at = [](const Found& f) { return Stretch{f.t, f.t + 1e-6, {}, f.cell}; };
  const auto put_surface = [&](float stored, float second, double t, Vec3f gradient, float alpha) {
    Vec3f c = v.color_at(stored, second);
    if (active.look.lit) {  // a surface by definition
      const Lit l = v.effects ? light_at(active.lights, t, gradient, HUGE_VALF, 1) : light_at(active.lights, gradient, HUGE_VALF, 1);
      c = l.color(c);
      if (l.opacity != 1 && alpha < 1) alpha = 1 - std::pow(1 - alpha, l.opacity);
    }
    put(float(t), c, alpha, v.id);
  };
  switch (v.item->mode) {
    case RayFunction::maximum:
    case RayFunction::minimum: {
      const Found f = v.item->mode == RayFunction::maximum ? largest(walker) : smallest(walker);
      if (f.found) put_value(f.value, f.t, walker.second(at(f), f.t));
      break;
    }
    case RayFunction::average:
    case RayFunction::sum: {
      const Sum s = integral(walker);
      if (!(s.length > 0)) break;
      // The medium reads stored values, those of a sum, a distance or a length as they are.
      put_value(v.item->mode == RayFunction::average ? s.integral / s.length : s.integral + double(base) * s.length, s.first);
      break;
    }
    case RayFunction::first_hit:
    case RayFunction::distance: {
      const Found f = first_at_least(walker, v.levels->front());
      if (!f.found) break;
      if (v.item->mode == RayFunction::distance) {
        put_value(f.t - f.first, f.t);
        break;
      }
      put_surface(float(f.value), walker.second(at(f), f.t), f.t, walker.gradient(at(f), f.t), 1);
      break;
    }
    case RayFunction::accumulate: {
      const Sum s = length_at_least(walker, v.levels->front());
      if (s.length > 0) put_value(s.length, s.first);
      break;
    }
    case RayFunction::isosurface: {
      all_crossings(walker, *v.levels, crossings_);
      for (const Crossing& c : crossings_) {
        const double value = (*v.levels)[c.level] + double(base);
        put_surface(float((*v.levels)[c.level]), c.second, c.t, c.gradient, float(std::clamp(v.item->opacity.at(value), 0.0, 1.0)));
      }
      break;
    }
    case RayFunction::maximum_difference: maximum_difference(active); break;
    case RayFunction::composite: break;
  }
}

/// Bruckner and Groeller 2009: a new maximum lets what lies before it fade by beta = (1 - new)/(1 - old), values taken over the colour
/// range: for one rise from 0 that is their 1 - delta, and it does not depend on the number of steps in which a rise is seen.
void Caster::maximum_difference(Active& active) {
  const CastVolume& v = *active.volume;
  const double lo = v.item->color.lo - double(v.source->base), hi = v.item->color.hi - double(v.source->base);
  const double per_range = hi != lo ? 1 / (hi - lo) : 0, step = 0.25 * v.source->edge;
  double highest = 0, r = 0, g = 0, b = 0, pass = 1, at = -1;
  while (active.peek()) {
    const Stretch s = active.front();
    ++active.next;
    const int n = int(std::clamp(std::ceil((s.to - s.from) / step), 1.0, 64.0));
    const double h = (s.to - s.from) / n;
    for (int k = 0; k < n; ++k) {
      const double t = s.from + (k + 0.5) * h;
      const float value = s.value(t);
      const Optics o = v.medium->at(value);
      const double place = std::clamp((double(value) - lo) * per_range, 0.0, 1.0);
      if (place > highest) {
        const double beta = highest < 1 ? (1 - place) / (1 - highest) : 1;
        r *= beta, g *= beta, b *= beta, pass = 1 - beta * (1 - pass), highest = place;
        at = t;
      }
      if (!(o.tau > 0)) continue;
      Lit l;
      if (active.look.lit) l = light_on(active.look, *active.walker, s, t);
      const double alpha = double(1 - exp_minus(float(double(o.tau * l.opacity) * h)));
      const Vec3f c = l.color(o.color);
      r += pass * alpha * double(c.x), g += pass * alpha * double(c.y), b += pass * alpha * double(c.z);
      pass *= 1 - alpha;
      if (at < 0) at = t;
    }
  }
  const double alpha = 1 - pass;
  if (alpha > 0) put(float(at), {float(r / alpha), float(g / alpha), float(b / alpha)}, float(alpha), v.id);
}

/// Stretches of all composite volumes up to `to`.
void Caster::until(double to, RayState& state) {
  for (;;) {
    // Where does something begin or end next?
    double from = HUGE_VAL;
    for (Active* a : active_)
      if (a->peek()) from = std::min(from, a->front().from);
    if (!(from < to)) break;
    double end = to;
    joint_.clear();
    Active* only = nullptr;
    for (Active* a : active_) {
      if (!a->peek()) continue;
      Stretch& s = a->front();
      if (s.from > from) {
        end = std::min(end, s.from);
        continue;
      }
      end = std::min(end, s.to);
      only = a;
      joint_.push_back({&a->look, a->walker.get(), {}});
    }
    size_t k = 0;
    for (Active* a : active_) {
      if (!a->peek() || a->front().from > from) continue;
      Stretch& s = a->front();
      const bool whole = !(s.to > end);
      joint_[k++].stretch = whole ? s : part_of(s, from, end);
      if (whole) ++a->next;
      else s = part_of(s, end, s.to);
    }
    for (Active* a : active_)
      if (joint_.size() > 1 || a != only) a->flush(state);
    if (joint_.size() == 1 && only->volume->step > 0 && !only->look.detail) only->step_through(joint_[0].stretch, state);
    else if (joint_.size() == 1) composite(only->look, joint_[0].stretch, *only->walker, state);
    else composite_joint(joint_, state);
    if (state.sum.transmittance < joint_[0].look->budget.stop_below) return;
  }
  for (Active* a : active_) a->flush(state);
}

void Caster::cast(const CastRay& ray, const std::vector<Fragment>& fragments, RayState& state) {
  fragments_ = fragments;
  for (auto& a : others_) collect(*a, ray);
  active_.clear();
  for (auto& a : composite_) a->start(ray), active_.push_back(a.get());
  for (const Fragment& f : fragments_) {
    until(double(f.depth), state);
    state.sum.behind(f.rgba);
    if (state.sum.transmittance < 0.5f && state.surface < 0) state.surface = double(f.depth), state.surface_id = f.id;
    if (state.sum.transmittance < 1e-4f) return;
  }
  until(HUGE_VAL, state);
}

}  // namespace sg::volume
