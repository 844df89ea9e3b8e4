// SPDX-License-Identifier: Apache-2.0
// Integration along a ray. A run of 16 samples is evaluated at once (places, values, table entries), then composited one by one
// from near to far, so that the result depends neither on the width of the machine's vectors nor on what was passed over.
#include "render/volume/lattice/lattice_volume.h"
#include "render/volume/lattice/runs.h"

namespace sg::volume {

namespace {

using Four = float __attribute__((vector_size(16)));

/// Sample s of a stretch lies at q = first + s * by; s = 0 is half a step after its start.
struct Stretch {
  const Volume& v;
  Vec3 first, by;             // q
  float first_u[3], by_u[3];  // affine: the same as float
  double per_by[3];           // 1/by

  Stretch(const Volume& volume, const Course& c, double t, double step) : v(volume), first(c.start + c.along * t), by(c.along * step) {
    for (int a = 0; a < 3; ++a) first_u[a] = float(first[a]), by_u[a] = float(by[a]), per_by[a] = by[a] != 0 ? 1 / by[a] : 0;
  }

  float place(int a, int s) const {
    if (v.affine) return first_u[a] + float(s) * by_u[a];
    return v.u(a, first[a] + double(s) * by[a]);
  }

  /// The first sample from s on whose brick draws something, or `end`.
  int next_drawn(int s, int end) const {
    while (s < end) {
      size_t brick[3];
      for (int a = 0; a < 3; ++a) {
        const float u = std::max(0.0f, std::min(place(a, s), float(v.voxels.dims[size_t(a)] - 1)));
        brick[a] = std::min(size_t(u) >> MinMaxBricks::shift, v.bricks().dims[size_t(a)] - 1);
      }
      const int d = v.distance[v.bricks().id(brick[0], brick[1], brick[2])];
      if (d == 0) return s;
      // All bricks nearer than d are empty: leave their cube, but for a margin wider than rounding errors.
      double out = double(end);
      for (int a = 0; a < 3; ++a) {
        if (per_by[a] == 0) continue;
        const ptrdiff_t side = ptrdiff_t(brick[a]) + (per_by[a] > 0 ? d : 1 - d);
        if (side < 0 || side > ptrdiff_t(v.bricks().dims[size_t(a)])) continue;
        const double q = v.border[a][size_t(side)] + (per_by[a] > 0 ? -v.margin[a] : v.margin[a]);
        out = std::min(out, (q - first[a]) * per_by[a]);
      }
      s = std::max(s + 1, out >= double(end) ? end : int(std::ceil(out)));
    }
    return end;
  }

  void places(int s, Run& run) const {
    if (v.affine) {
      for (int n = 0; n < run_length; ++n) {
        const float f = float(s + n);
        run.ux[n] = first_u[0] + f * by_u[0], run.uy[n] = first_u[1] + f * by_u[1], run.uz[n] = first_u[2] + f * by_u[2];
      }
    } else {
      for (int n = 0; n < run_length; ++n) run.ux[n] = place(0, s + n), run.uy[n] = place(1, s + n), run.uz[n] = place(2, s + n);
    }
  }

  /// Values and table entries of the samples s .. s+run_length.
  void evaluate(int s, Run& run) const {
    if (v.direct) return v.kernels.entries(v.voxels, v.transfer[0].linear_table(), first_u, by_u, s, run);
    places(s, run);
    finish_values(v, run);
    const Transfer& transfer = v.transfer[0];
    for (int n = 0; n < run_length; ++n) run.entry[n] = transfer.index(run.value[n]);
  }
};

/// Notes where half of the light was gone; `pass` of the samples [0, count) in turn, the first of them at t.
template <class Pass>
void note_surface(RayState& state, uint32_t id, float before, int count, double t, double step, Pass pass) {
  if (state.surface >= 0) return;
  for (int n = 0; n < count; ++n) {
    before *= pass(n);
    if (before < 0.5f) {
      state.surface = t + n * step, state.surface_id = id;
      return;
    }
  }
}

/// Samples [0, count) of a run, each `length` long, unshaded.
void composite_plain(const Volume& v, const Run& run, int count, Gathered& sum) {
  const auto* steps = reinterpret_cast<const Four*>(v.transfer[0].steps());
  Four color = {sum.r, sum.g, sum.b, 0};
  float pass = sum.transmittance;
  for (int n = 0; n < count; ++n) {
    const Four step = steps[run.entry[n]];
    color += step * pass;
    pass *= step[3];
  }
  sum = {color[0], color[1], color[2], pass};
}

void composite_shaded(const Volume& v, const Stretch& stretch, int s, const Run& run, int count, const LitRay& lit, const Knobs& knobs,
                      Gathered& sum) {
  // Which samples are seen at all?
  int seen[run_length], n_seen = 0;
  float weight[run_length];
  float pass = sum.transmittance;
  for (int n = 0; n < count; ++n) {
    const float p = v.transfer[0].steps()[run.entry[n]].pass;
    if (p == 1) continue;
    seen[n_seen] = n, weight[n_seen++] = pass;
    pass *= p;
    if (pass < knobs.stop_below) break;
  }
  if (n_seen == 0) return;
  Gradients g;
  gradients(
      v, run, seen, n_seen, [&](int axis, int n) { return stretch.first[axis] + double(s + n) * stretch.by[axis]; }, g);
  Shading shading;
  v.kernels.shade(v.shade_plan, lit, g, shading);
  for (int m = 0; m < n_seen; ++m) {
    const Transfer::Step& step = v.transfer[0].steps()[run.entry[seen[m]]];
    const float flash = shading.specular[m] * (1 - step.pass), w = weight[m], d = shading.diffuse[m];
    sum.r += w * (step.r * d + flash), sum.g += w * (step.g * d + flash), sum.b += w * (step.b * d + flash);
  }
  sum.transmittance = pass;
}

/// One sample of any length.
void composite_odd(const Volume& v, const Stretch& stretch, double length, const LitRay& lit, Gathered& sum) {
  Run run;
  stretch.evaluate(0, run);
  const Transfer::Medium& m = v.transfer[0].medium(run.entry[0]);
  if (m.density == 0) return;
  const float alpha = segment_alpha(m.density, length);
  float diffuse = 1, flash = 0;
  if (v.shaded) {
    const int seen[1] = {0};
    Gradients g;
    gradients(
        v, run, seen, 1, [&](int axis, int) { return stretch.first[axis]; }, g);
    Shading shading;
    v.kernels.shade(v.shade_plan, lit, g, shading);
    diffuse = shading.diffuse[0], flash = shading.specular[0];
  }
  sum.behind((m.r * diffuse + flash) * alpha, (m.g * diffuse + flash) * alpha, (m.b * diffuse + flash) * alpha, alpha);
}

/// How many whole steps fit, and what is left; a rest of rounding errors is none.
int whole_steps(double length, double step, double& rest) {
  const int n = int(length / step);
  rest = std::max(0.0, length - n * step);
  return n;
}

}  // namespace

void march(const Volume& v, const Course& c, double from, double to, const LitRay& lit, const Knobs& knobs, RayState& state) {
  double rest = 0;
  const int steps = whole_steps(to - from, v.step, rest);
  const Stretch stretch(v, c, from + 0.5 * v.step, v.step);
  Gathered& sum = state.sum;
  Run run;
  for (int s = 0; s < steps;) {
    if (knobs.skip_empty) s = stretch.next_drawn(s, steps);
    if (s >= steps) break;
    stretch.evaluate(s, run);
    const int count = std::min(run_length, steps - s);
    const float before = sum.transmittance;
    if (v.shaded) composite_shaded(v, stretch, s, run, count, lit, knobs, sum);
    else composite_plain(v, run, count, sum);
    if (sum.transmittance < 0.5f)
      note_surface(state, v.id, before, count, from + (s + 0.5) * v.step, v.step,
                   [&](int n) { return v.transfer[0].steps()[run.entry[n]].pass; });
    if (sum.transmittance < knobs.stop_below) return;
    s += count;
  }
  if (!(rest > 0)) return;
  const Stretch last(v, c, to - 0.5 * rest, rest);
  if (knobs.skip_empty && last.next_drawn(0, 1) == 1) return;
  composite_odd(v, last, rest, lit, sum);
  if (sum.transmittance < 0.5f) note_surface(state, v.id, 0, 1, to - 0.5 * rest, rest, [](int) { return 0.0f; });
}

void march_together(const Volume* const* volumes, const Course* const* courses, size_t count, double from, double to, const LitRay& lit,
                    const Knobs& knobs, RayState& state) {
  double step = HUGE_VAL, rest = 0;
  for (size_t i = 0; i < count; ++i) step = std::min(step, volumes[i]->step);
  const int steps = whole_steps(to - from, step, rest);
  Gathered& sum = state.sum;
  for (int s = 0; s <= steps; ++s) {
    const double length = s < steps ? step : rest, t = from + s * step + 0.5 * length;
    if (!(length > 0)) break;
    // Media add: densities add up, the colour is their mean by density.
    double density = 0;
    Vec3 glow{0, 0, 0};
    uint32_t id = 0;
    double densest = 0;
    for (size_t i = 0; i < count; ++i) {
      const Volume& v = *volumes[i];
      const Stretch here(v, *courses[i], t, length);
      if (knobs.skip_empty && here.next_drawn(0, 1) == 1) continue;
      Run run;
      here.evaluate(0, run);
      const Transfer::Medium& m = v.transfer[0].medium(run.entry[0]);
      if (m.density == 0) continue;
      double diffuse = 1, flash = 0;
      if (v.shaded) {
        const int seen[1] = {0};
        Gradients g;
        gradients(
            v, run, seen, 1, [&](int axis, int) { return here.first[axis]; }, g);
        Shading shading;
        v.kernels.shade(v.shade_plan, lit, g, shading);
        diffuse = shading.diffuse[0], flash = shading.specular[0];
      }
      const double d = double(m.density);
      density += d;
      glow += Vec3{m.r * diffuse + flash, m.g * diffuse + flash, m.b * diffuse + flash} * d;
      if (d > densest) densest = d, id = v.id;
    }
    if (density == 0) continue;
    glow = glow / density;
    const float alpha = float(1 - exp_negative(density * length));
    sum.behind(float(glow.x) * alpha, float(glow.y) * alpha, float(glow.z) * alpha, alpha);
    if (sum.transmittance < 0.5f && state.surface < 0) state.surface = t, state.surface_id = id;
    if (sum.transmittance < knobs.stop_below) return;
  }
}

}  // namespace sg::volume
