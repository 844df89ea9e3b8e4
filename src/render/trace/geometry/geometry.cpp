// SPDX-License-Identifier: Apache-2.0
#include "render/trace/geometry/geometry.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/error.h"
#include "render/trace/geometry/object.h"
#include "render/trace/geometry/triangles.h"
#include "render/trace/tree/bvh.h"

namespace sg::trace {

static_assert(Geometry::most_together == stream_rays);

namespace {

/// The scene's diagonal without what it depends on: the boxes of the arrays, lines and points without their radius.
double diagonal_of(const PreparedScene& scene) {
  Box3 box;
  for (const raster::PreparedItem& p : scene.items)
    if (p.data) box.add(p.data->bounds());
  const double d = box.diagonal();
  return d > 0 && std::isfinite(d) ? d : 1;
}

Box3 world_box(const Geometry::Object& o) {
  Box3 b;
  const Box3f local = o.bounds();
  if (!local.empty()) b.add(o.local.world(local.lo)), b.add(o.local.world(local.hi));
  return b;
}

}  // namespace

Geometry::Geometry() = default;
Geometry::Geometry(Geometry&&) noexcept = default;
Geometry& Geometry::operator=(Geometry&&) noexcept = default;
Geometry::~Geometry() = default;

Geometry Geometry::make(const PreparedScene& scene, const GeometryOptions& options, Context& context) {
  const double pixel = options.pixel > 0 ? options.pixel : diagonal_of(scene) / 1000;
  Geometry g;
  Box3 box = options.around;
  const size_t items = scene.items.size();
  for (size_t i = 0; i < items + options.more.size(); ++i) {
    context.check();
    std::shared_ptr<Object> o = i < items ? make_object(scene.items[i], options, pixel, context) : options.more[i - items];
    if (!o || o->bounds().empty()) continue;
    o->item = uint32_t(i);
    box.add(world_box(*o));
    g.objects_.push_back(std::move(o));
  }
  g.placement_ =
      g.objects_.size() == 1 && options.around.empty() ? g.objects_[0]->local : Placement::of(box);  // alone it need not be moved
  for (const auto& o : g.objects_) {
    o->place(g.placement_);
    for (int a = 0; a < 3; ++a) {
      g.bounds_.lo[a] = std::min(g.bounds_.lo[a], o->box().lo[a]);
      g.bounds_.hi[a] = std::max(g.bounds_.hi[a], o->box().hi[a]);
    }
  }
  if (constexpr size_t few = 8; g.objects_.size() > few) {
    std::vector<Box3f> boxes;
    for (const auto& o : g.objects_) boxes.push_back(o->box());
    g.tree_ = std::make_unique<WideBvh>(Bvh(boxes, {.most = wide, .least = 1, .of_node = 0.1f}, context).take());
  }
  return g;
}

bool Geometry::ask(const Object& o, const Ray& ray, float& t_max, bool& found, Hit& hit) const {
  const Ray inner = o.inward(ray);
  Hit h;
  h.t = t_max * float(o.ratio());
  if (!o.nearest(inner, h)) return false;
  h.t = h.t / float(o.ratio());
  if (found && h.t == t_max && o.item > hit.object) return false;
  hit = h, hit.object = o.item, t_max = h.t, found = true;
  return true;
}

bool Geometry::nearest(const Ray& ray, Hit& hit) const {
  bool found = false;
  float t_max = ray.t_max;
  if (tree_) {
    walk_leaves(*tree_, ray, t_max, true, [&](uint32_t first, uint32_t count) {
      for (uint32_t i = first; i < first + count; ++i) ask(*objects_[tree_->order()[i]], ray, t_max, found, hit);
      return false;
    });
    return found;
  }
  const BoxRay boxes(ray);
  for (const auto& o : objects_)
    if (boxes.enter(&o->box().lo.x, &o->box().hi.x, t_max) <= t_max) ask(*o, ray, t_max, found, hit);
  return found;
}

uint64_t Geometry::nearest(const Ray* rays, int count, Hit* hits) const {
  if (count < 0 || count > stream_rays) fail_internal("at most 64 rays are followed together");
  uint64_t found = 0;
  if (tree_) {
    for (int i = 0; i < count; ++i) found |= uint64_t(nearest(rays[i], hits[i])) << i;
    return found;
  }
  Ray inner[stream_rays];
  Hit h[stream_rays];
  float t_max[stream_rays];
  for (int i = 0; i < count; ++i) t_max[i] = rays[i].t_max;
  for (const auto& o : objects_) {
    for (int i = 0; i < count; ++i) inner[i] = o->inward(rays[i]), h[i] = {}, h[i].t = t_max[i] * float(o->ratio());
    const uint64_t met = o->nearest_rays(inner, count, h);
    for (int i = 0; i < count; ++i) {
      const float t = h[i].t / float(o->ratio());
      if (!(met >> i & 1) || ((found >> i & 1) && t == t_max[i])) continue;
      hits[i] = h[i], hits[i].t = t_max[i] = t, hits[i].object = o->item;
      found |= uint64_t(1) << i;
    }
  }
  return found;
}

bool Geometry::blocked(const Ray& ray) const {
  if (tree_) {
    bool stopped = false;
    walk_leaves(*tree_, ray, ray.t_max, false, [&](uint32_t first, uint32_t count) {
      for (uint32_t i = first; i < first + count && !stopped; ++i) {
        const Object& o = *objects_[tree_->order()[i]];
        stopped = o.blocked(o.inward(ray));
      }
      return stopped;
    });
    return stopped;
  }
  const BoxRay boxes(ray);
  for (const auto& o : objects_)
    if (boxes.enter(&o->box().lo.x, &o->box().hi.x, ray.t_max) <= ray.t_max && o->blocked(o->inward(ray))) return true;
  return false;
}

uint64_t Geometry::blocked(const Ray* rays, int count) const {
  if (count < 0 || count > stream_rays) fail_internal("at most 64 rays are followed together");
  uint64_t stopped = 0;
  if (tree_) {
    for (int i = 0; i < count; ++i) stopped |= uint64_t(blocked(rays[i])) << i;
    return stopped;
  }
  if (objects_.size() == 1 && objects_[0]->as_placed()) return objects_[0]->blocked_rays(rays, count);
  for (const auto& o : objects_) {
    Ray inner[stream_rays];
    int number[stream_rays], going = 0;
    for (int i = 0; i < count; ++i) {
      const bool meets = BoxRay(rays[i]).enter(&o->box().lo.x, &o->box().hi.x, rays[i].t_max) <= rays[i].t_max;
      if (meets && !(stopped >> i & 1)) inner[going] = o->inward(rays[i]), number[going++] = i;
    }
    const uint64_t here = o->blocked_rays(inner, going);
    for (int k = 0; k < going; ++k) stopped |= (here >> k & 1) << number[k];
  }
  return stopped;
}

SurfacePoint Geometry::at(const Ray& ray, const Hit& hit) const {
  const auto object =
      std::lower_bound(objects_.begin(), objects_.end(), hit.object, [](const auto& o, uint32_t item) { return o->item < item; });
  if (object != objects_.end() && (*object)->item == hit.object) {
    const auto& o = *object;
    Hit h = hit;
    h.t = hit.t * float(o->ratio());
    const Object::Place p = o->at(o->inward(ray), h);
    const Rounded r = rounded(o->outward(p.place), p.error * (1 / o->ratio()) + o->moving_error(p.place));
    SurfacePoint s;
    s.position = r.position, s.error = r.error, s.face_normal = Vec3f(p.normal);
    s.shading_normal = dot(p.shading, p.normal) < 0 ? -Vec3f(p.shading) : Vec3f(p.shading);
    s.tangent = tangent_of(s.shading_normal, Vec3f(normalize(p.along)));
    s.object = hit.object, s.primitive = hit.primitive, s.u = hit.u, s.v = hit.v;
    return s;
  }
  fail_internal("a hit of no object of this scene");
}

size_t Geometry::bytes() const {
  size_t sum = 0;
  for (const auto& o : objects_) sum += o->bytes();
  return sum;
}

}  // namespace sg::trace
