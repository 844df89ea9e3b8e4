// SPDX-License-Identifier: Apache-2.0
#include "render/volume/volume.h"

#include "base/error.h"
#include "base/parallel.h"
#include "render/volume/lattice/packets.h"

namespace sg::volume {

namespace {

constexpr int tile = 16;  // pixels; rays of a tile meet the same voxels

struct Picture {
  const Scene& scene;
  const Projection& projection;
  const FragmentLists& fragments;
  Frame& frame;
  const Knobs& knobs;
  std::vector<Volume> volumes;  // composite ones first
  size_t composite = 0;         // how many those are
  bool shaded = false;
  struct Lamp {
    Vec3 direction;  // world, unit
    float intensity;
  };
  std::vector<Lamp> lamps;
};

/// What a tile's rays reuse.
struct Scratch {
  LitRay lit;
  std::vector<Course> courses;
  std::vector<double> cuts;
  std::vector<Fragment> fragments;
  std::vector<const Volume*> active;
  std::vector<const Course*> active_courses;
};

void light(const Picture& picture, Vec3 direction, LitRay& lit) {
  lit.direction = Vec3f(direction);
  lit.lights.clear();
  for (const Picture::Lamp& l : picture.lamps)
    lit.lights.push_back({Vec3f(l.direction), Vec3f(normalize(l.direction - direction)), l.intensity});
}

/// Fragments of a pixel and the maxima of the volumes of that mode, from near to far.
void gather_fragments(const Picture& picture, size_t pixel, double first_depth, double per_length, Scratch& s) {
  s.fragments.clear();
  if (!picture.fragments.empty())
    s.fragments.assign(picture.fragments.fragments.begin() + picture.fragments.start[pixel],
                       picture.fragments.fragments.begin() + picture.fragments.start[pixel + 1]);
  for (size_t i = picture.composite; i < picture.volumes.size(); ++i) {
    const Volume& v = picture.volumes[i];
    const Maximum m = maximum_along(v, s.courses[i], picture.knobs);
    if (!m.found) continue;
    const Transfer::Medium& medium = v.transfer[0].medium(v.transfer[0].index(m.value));
    if (medium.density == 0) continue;
    const Fragment f{float(first_depth + m.t * per_length), {medium.r, medium.g, medium.b, 1}, v.id};
    s.fragments.insert(
        std::upper_bound(s.fragments.begin(), s.fragments.end(), f,
                         [](const Fragment& a, const Fragment& b) { return a.depth < b.depth || (a.depth == b.depth && a.id < b.id); }),
        f);
  }
}

/// Volumes between two cuts; none, one or several are there.
void between(const Picture& picture, double from, double to, Scratch& s, RayState& state) {
  s.active.clear(), s.active_courses.clear();
  const double middle = 0.5 * (from + to);
  for (size_t i = 0; i < picture.composite; ++i)
    if (s.courses[i].enter <= middle && middle < s.courses[i].leave)
      s.active.push_back(&picture.volumes[i]), s.active_courses.push_back(&s.courses[i]);
  if (s.active.size() == 1) march(*s.active[0], *s.active_courses[0], from, to, s.lit, picture.knobs, state);
  else if (s.active.size() > 1)
    march_together(s.active.data(), s.active_courses.data(), s.active.size(), from, to, s.lit, picture.knobs, state);
}

void pixel(const Picture& picture, int x, int y, Scratch& s) {
  const size_t p = size_t(y) * size_t(picture.frame.width) + size_t(x);
  const Projection& projection = picture.projection;
  const Projection::Ray ray = projection.ray(x + 0.5, y + 0.5);
  // depth = first_depth + t * per_length along the ray.
  const double per_length = dot(ray.direction, projection.forward), first_depth = dot(ray.origin - projection.eye, projection.forward);
  const double from = (projection.near_plane - first_depth) / per_length;
  const double opaque = double(picture.frame.depth[p]);
  const double to = (std::min(projection.far_plane, opaque) - first_depth) / per_length;
  bool any = !picture.fragments.empty() && picture.fragments.start[p] < picture.fragments.start[p + 1];
  s.courses.clear();
  for (const Volume& v : picture.volumes) {
    s.courses.push_back(course(v, ray.origin, ray.direction, from, to));
    any = any || s.courses.back().leave > s.courses.back().enter;
  }
  if (!any) return;
  if (picture.shaded) light(picture, ray.direction, s.lit);
  gather_fragments(picture, p, first_depth, per_length, s);

  RayState state;
  if (s.fragments.empty() && picture.composite == 1) {
    const Course& c = s.courses[0];
    if (c.leave > c.enter) march(picture.volumes[0], c, c.enter, c.leave, s.lit, picture.knobs, state);
  } else {
    // Where something begins, ends or lies: between two such places the same volumes are there all along.
    s.cuts.clear();
    for (size_t i = 0; i < picture.composite; ++i)
      if (s.courses[i].leave > s.courses[i].enter) s.cuts.push_back(s.courses[i].enter), s.cuts.push_back(s.courses[i].leave);
    const auto place = [&](const Fragment& f) { return (double(f.depth) - first_depth) / per_length; };
    for (const Fragment& f : s.fragments) s.cuts.push_back(place(f));
    std::sort(s.cuts.begin(), s.cuts.end());
    size_t next = 0;
    for (size_t i = 0; i < s.cuts.size() && state.sum.transmittance >= picture.knobs.stop_below; ++i) {
      if (i > 0 && s.cuts[i] > s.cuts[i - 1]) between(picture, s.cuts[i - 1], s.cuts[i], s, state);
      for (; next < s.fragments.size() && place(s.fragments[next]) <= s.cuts[i]; ++next) {
        state.sum.behind(s.fragments[next].rgba);
        if (state.sum.transmittance < 0.5f && state.surface < 0) state.surface = s.cuts[i], state.surface_id = s.fragments[next].id;
      }
    }
  }
  float* out = &picture.frame.rgba[4 * p];
  state.sum.behind(out);
  out[0] = state.sum.r, out[1] = state.sum.g, out[2] = state.sum.b, out[3] = 1 - state.sum.transmittance;
  // A volume that hides what is behind it can be picked.
  if (state.surface >= 0 && !(opaque < HUGE_VAL))
    picture.frame.depth[p] = float(first_depth + state.surface * per_length), picture.frame.ids[p] = state.surface_id;
}

bool any_fragments(const FragmentLists& fragments, const Frame& frame, int x0, int y0, int x1, int y1) {
  if (fragments.empty()) return false;
  for (int y = y0; y < y1; ++y) {
    const size_t row = size_t(y) * size_t(frame.width);
    if (fragments.start[row + size_t(x0)] < fragments.start[row + size_t(x1)]) return true;
  }
  return false;
}

}  // namespace

Course course(const Volume& v, Vec3 origin, Vec3 direction, double from, double to) {
  Course c{v.q(origin), v.to_q * direction, from, to};
  for (int a = 0; a < 3; ++a) {
    if (c.along[a] == 0) {
      // In a face: the upper one belongs to the box like the lower one.
      if (c.start[a] < v.lo[a] || c.start[a] > v.hi[a]) c.leave = c.enter - 1;
      continue;
    }
    const double t0 = (v.lo[a] - c.start[a]) / c.along[a], t1 = (v.hi[a] - c.start[a]) / c.along[a];
    c.enter = std::max(c.enter, std::min(t0, t1)), c.leave = std::min(c.leave, std::max(t0, t1));
  }
  return c;
}

void composite_volumes(const Scene& scene, const Projection& projection, const FragmentLists& fragments, Frame& frame, Context& context,
                       const Knobs& knobs) {
  if (frame.width != projection.width || frame.height != projection.height)
    fail_internal(
        fmt::format("a frame of {} x {} for a projection of {} x {}", frame.width, frame.height, projection.width, projection.height));
  check_fragments(fragments, frame);
  Picture picture{scene, projection, fragments, frame, knobs, {}, 0, false, {}};
  for (const auto mode : {VolumeItem::Mode::composite, VolumeItem::Mode::maximum}) {
    for (size_t i = 0; i < scene.items.size(); ++i)
      if (const auto* item = std::get_if<VolumeItem>(&scene.items[i]); item && item->mode == mode) {
        context.check();
        picture.volumes.push_back(prepare(*item, uint32_t(i + 1), knobs));
        picture.shaded = picture.shaded || (item->shaded && mode == VolumeItem::Mode::composite);
      }
    if (mode == VolumeItem::Mode::composite) picture.composite = picture.volumes.size();
  }
  if (picture.volumes.empty()) return composite_fragments(fragments, frame, context);
  for (const Light& l : lights_of(scene)) {
    const Vec3 d = l.follows_camera ? projection.right * l.direction.x + projection.up * l.direction.y - projection.forward * l.direction.z
                                    : l.direction;
    picture.lamps.push_back({normalize(d), l.intensity});
  }
  // One volume alone goes in packets of rays.
  PacketPlan plan{picture.volumes[0], projection, knobs, {}, {}};
  if (picture.shaded)
    for (const Picture::Lamp& l : picture.lamps) plan.lamps.push_back({l.direction, l.intensity});
  const bool packets = picture.volumes.size() == 1 && in_packets(plan);
  const size_t across = size_t(frame.width + tile - 1) / tile, down = size_t(frame.height + tile - 1) / tile;
  parallel_for(
      across * down, 1,
      [&](size_t begin, size_t end) {
        Scratch scratch;
        for (size_t t = begin; t < end; ++t) {
          const int x0 = int(t % across) * tile, y0 = int(t / across) * tile;
          const int x1 = std::min(x0 + tile, frame.width), y1 = std::min(y0 + tile, frame.height);
          if (packets && !any_fragments(fragments, frame, x0, y0, x1, y1)) {
            march_tile(plan, x0, y0, x1, y1, frame);
            continue;
          }
          for (int y = y0; y < y1; ++y)
            for (int x = x0; x < x1; ++x) pixel(picture, x, y, scratch);
        }
      },
      &context);
}

}  // namespace sg::volume

namespace sg {

void composite_volumes(const Scene& scene, const Projection& projection, const FragmentLists& fragments, Frame& frame, Context& context) {
  volume::composite_volumes(scene, projection, fragments, frame, context, volume::Knobs{});
}

}  // namespace sg
