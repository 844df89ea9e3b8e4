// SPDX-License-Identifier: Apache-2.0
#include "render/trace/integrators/world.h"

#include <algorithm>
#include <cmath>

#include "render/prepare/picture_set.h"
#include "render/trace/integrators/surface_color.h"
#include "render/trace/integrators/varied_matter.h"
#include "render/trace/light/fade.h"
#include "render/trace/light/luminance.h"

namespace sg::trace {

namespace {

// The triangles of items that shine are lights, too.
std::vector<AnyLight> with_emitters(const PreparedScene& scene, const std::vector<std::shared_ptr<const Material>>& materials,
                                    const Placement& placement, std::vector<AnyLight> lights) {
  for (size_t i = 0; i < scene.items.size(); ++i) {
    const raster::PreparedItem& item = scene.items[i];
    if (!materials[i]->emits() || item.kind != raster::PreparedItem::Kind::surface || item.glyphs) continue;
    const raster::PlacedPicture* picture = item.pictures && item.pictures->emission ? &*item.pictures->emission : nullptr;
    const Vec4f mean = picture ? picture->texture->levels().back().texels[0] : Vec4f{1, 1, 1, 1};
    const float share = luminance(materials[i]->emission() * Vec3f{mean.x, mean.y, mean.z}) / luminance(materials[i]->emission());
    if (!(share > 0)) continue;
    const auto corner = [&](uint32_t point) {
      const float* x = item.triangles.xyz() + 3 * size_t(point);
      return placement.traced(Vec3{x[0], x[1], x[2]} + item.triangles.origin);
    };
    for (uint32_t t = 0; t < item.triangles.count; ++t) {
      const uint32_t* p = item.triangles.indices() + 3 * size_t(t);
      TriangleLight l{corner(p[0]), corner(p[1]),       corner(p[2]), materials[i]->emission(), uint32_t(i), t,
                      picture,      {p[0], p[1], p[2]}, share};
      const float area = length(cross(l.b - l.a, l.c - l.a));
      if (area > 0 && std::isfinite(area)) lights.emplace_back(l);
    }
  }
  return lights;
}

Box3f bounds_of(const Geometry& geometry, const Media* media) {
  Box3f all = geometry.bounds();
  if (media && media->any() && !media->bounds().empty())
    for (const Vec3 corner : {media->bounds().lo, media->bounds().hi}) {
      const Vec3f c = geometry.placement().traced(corner);
      for (int a = 0; a < 3; ++a) all.lo[a] = std::min(all.lo[a], c[a]), all.hi[a] = std::max(all.hi[a], c[a]);
    }
  return all;
}

// Half of the diagonal.
float reach_of(const Geometry& geometry, const Media* media) {
  const Box3f all = bounds_of(geometry, media);
  return all.empty() ? 1 : float(length(Vec3(all.hi) - Vec3(all.lo)) / 2);
}

}  // namespace

World::World(PreparedScenePtr scene, Geometry geometry, std::vector<std::shared_ptr<const Material>> materials,
             std::vector<AnyLight> lights, Environment environment, std::shared_ptr<const Media> media,
             std::vector<Isosurfaces::Look> isosurfaces, std::vector<uint32_t> shows, PictureLook look)
    : scene_(std::move(scene)),
      geometry_(std::move(geometry)),
      materials_(std::move(materials)),
      lights_(with_emitters(*scene_, materials_, geometry_.placement(), std::move(lights)), std::move(environment),
              reach_of(geometry_, media.get())),
      media_(std::move(media)),
      isosurfaces_(std::move(isosurfaces)),
      shows_(std::move(shows)),
      look_(std::move(look)) {
  if (const Environment& around = lights_.environment(); around.soft() && !around.dark()) {
    std::vector<AnyLight> all;
    for (uint32_t i = 0; i < lights_.count(); ++i) all.push_back(lights_.light(i));
    lamps_.emplace(std::move(all), around, reach_of(geometry_, media_.get()), false);
  }
  for (size_t i = 0; i < scene_->items.size(); ++i) {
    const raster::PreparedItem& item = scene_->items[i];
    translucent_ = translucent_ || item.translucent || item.opacity < 1 || item.color.translucent || look_.fades(i);
  }
  for (const Isosurfaces::Look& look : isosurfaces_) {
    for (const Vec4f& c : look.colors) translucent_ = translucent_ || c.w < 1;
    translucent_ = translucent_ || (look.patches && look.patches->all().pictures->translucent());
  }
  palettes_.resize(materials_.size());
  for (size_t i = 0; i < materials_.size(); ++i) {
    const raster::PreparedItem* item = matter_of(i);
    if (!item) continue;
    pictures_ = pictures_ || item->pictures;
    palettes_[i] = palette_of(*item, geometry_.placement().scale, 1);
    translucent_ = translucent_ || (palettes_[i] && item->made_of->transmission_weight > 0);
  }
  for (const auto& m : materials_) translucent_ = translucent_ || m->passes_straight();
  find_boundaries();
}

bool World::walks_below() const {
  return std::any_of(materials_.begin(), materials_.end(), [](const auto& m) { return !m->thin() && m->shares.subsurface > 0; });
}

Box3f World::bounds() const { return bounds_of(geometry_, media_.get()); }

const raster::PreparedItem* World::matter_of(size_t object) const {
  const size_t items = scene_->items.size();
  if (object < items) return &scene_->items[object];
  const auto& patches = isosurfaces_[object - items].patches;
  return patches ? &patches->all() : nullptr;
}

void World::find_boundaries() {
  const auto orders = [](const Material& m) { return m.priority() > 0 && m.has_inside(); };
  const size_t items = scene_->items.size();
  for (const auto& m : materials_)
    insides_matter_ = insides_matter_ || (m->has_inside() && (m->absorption() != Vec3f() || m->priority() > 0));
  for (size_t i = 0; i < materials_.size(); ++i) {
    const Material& of = *materials_[i];
    const std::optional<SurfaceMaterial>& made_of = i < items ? scene_->items[i].made_of : isosurfaces_[i - items].made_of;
    if (!orders(of) || !made_of) continue;
    translucent_ = true;  // light passes hidden surfaces
    for (const auto& in : materials_) {
      if (in.get() == &of || !orders(*in) || in->priority() > of.priority() || matter(uint32_t(i), in.get()).material != &of) continue;
      const double scale = geometry_.placement().scale, around = double(in->ior());
      boundaries_.push_back({uint32_t(i), in->ior(), std::make_unique<const Material>(*made_of, scale, around),
                             matter_of(i) ? palette_of(*matter_of(i), scale, around) : nullptr});
    }
  }
}

World::Matter World::matter(uint32_t object, const Material* in) const {
  if (in)
    for (const Boundary& b : boundaries_)
      if (b.object == object && b.ior == in->ior()) return {b.material.get(), b.palette.get()};
  return {materials_[object].get(), palettes_[object].get()};
}

Insides World::insides_at(Vec3f place, Vec3f direction) const {
  if (!insides_matter_) return {};
  std::vector<ClearBody> entered, around;
  Hit hit;
  for (Ray ray{place, direction}; geometry_.nearest(ray, hit); hit = Hit()) {
    const SurfacePoint point = geometry_.at(ray, hit);
    const Material* material = materials_[hit.object].get();
    if (material->has_inside()) {
      const bool in = dot(direction, point.face_normal) < 0;
      const auto match = std::find_if(entered.begin(), entered.end(), [&](const ClearBody& b) { return b.object == hit.object; });
      if (in) entered.push_back({material, hit.object});
      else if (match != entered.end()) entered.erase(match);
      else around.push_back({material, hit.object});
    }
    ray.origin = leave(point, direction);
  }
  Insides insides;
  for (auto b = around.rbegin(); b != around.rend(); ++b) insides.enter(*b);
  return insides;
}

Insides Vertex::onward(const Insides& around, Vec3f from, Vec3f to) const {
  Insides next = around;
  const bool in = dot(to, point.face_normal) < 0;
  if (!body.material || (dot(from, point.face_normal) < 0) != in) return next;
  if (in) next.enter(body);
  else next.leave(body);
  return next;
}

World::Seen World::seen(const Ray& ray, const Hit& hit, const SurfacePoint* point) const {
  const size_t items = scene_->items.size();
  Seen s;
  s.hit = hit;
  if (hit.object < items) {
    s.item = &scene_->items[hit.object];
    return s;
  }
  const Isosurfaces::Look& look = isosurfaces_[hit.object - items];
  const Vec3 place = geometry_.placement().world(point ? point->position : ray.origin + ray.direction * hit.t);
  s.color = look.color_at ? look.color_at(hit.primitive, place) : look.colors[hit.primitive];
  if (!look.patches || (!point && !look.patches->all().pictures->color)) return s;
  const Vec3f normal = point ? point->face_normal : geometry_.at(ray, hit).face_normal;
  s.patch = look.patches->at(place, Vec3(normal), s.color);
  if (s.patch) s.item = s.patch.get(), s.hit.primitive = 0, s.hit.u = s.hit.v = 0;
  return s;
}

Vec4f World::color(const Seen& s, const Ray& ray, const RayFootprint& footprint) const {
  if (!s.item) return s.color;
  Vec4f color = surface_color(*s.item, ray, s.hit, footprint, geometry_.placement().scale);
  if (look_.changes(s.hit.object))
    look_.apply(*s.item, s.hit.object, s.hit.primitive, geometry_.placement().world(ray.origin + ray.direction * s.hit.t), color);
  return color;
}

Vec4f World::color(const Ray& ray, const Hit& hit, const RayFootprint& footprint) const {
  return color(seen(ray, hit, nullptr), ray, footprint);
}

uint32_t World::id(const Hit& hit) const {
  const size_t items = scene_->items.size();
  return hit.object < items ? scene_->items[hit.object].id : isosurfaces_[hit.object - items].id;
}

bool World::same_surface(const SurfacePoint& point, const Hit& hit) const {
  const auto is_level = [&](uint32_t object) { return object >= scene_->items.size(); };
  if (is_level(point.object) != is_level(hit.object) || (is_level(hit.object) && point.primitive != hit.primitive)) return false;
  if (point.object == hit.object) return true;
  Hit first;
  first.object = point.object;
  const uint32_t a = id(first) - 1, b = id(hit) - 1;  // items of the scene
  return a < shows_.size() && b < shows_.size() && shows_[a] == shows_[b] && !is_line(point.object) && !is_line(hit.object);
}

Vertex World::at(const Ray& ray, const Hit& hit, const RayFootprint& footprint, bool walks, const Insides& around) const {
  Vertex v;
  v.point = geometry_.at(ray, hit);
  const Material& body = *materials_[hit.object];
  const Material* in = nullptr;  // what the body is in
  if (body.has_inside()) v.body = {&body, hit.object}, v.hidden = around.hides(v.body), in = around.around(v.body);
  const Matter matter = this->matter(hit.object, in);
  v.material = matter.material, v.emission = body.emission();
  v.below_radius = body.subsurface_radius(), v.below_anisotropy = body.subsurface_anisotropy();
  const Seen seen = this->seen(ray, hit, &v.point);
  const Vec4f color = this->color(seen, ray, footprint);
  const MaterialShares shares = seen.item && seen.item->pictures
                                    ? take_pictures(*seen.item, ray, seen.hit, footprint, geometry_.placement().scale, matter.palette, v)
                                    : v.material->shares;
  // At a silhouette the shading normal may look away from a viewer who sees the face.
  const bool above = dot(ray.direction, v.point.face_normal) < 0, shaded_above = dot(ray.direction, v.point.shading_normal) < 0;
  v.frame = LocalFrame::about(above == shaded_above ? v.point.shading_normal : v.point.face_normal, v.point.tangent);
  v.bsdf = make_bsdf(*v.material, shares, {color.x, color.y, color.z}, color.w, walks && above);
  return v;
}

Vec3f World::passes(Ray ray, Insides insides) const {
  Vec3f share{1, 1, 1};
  if (!translucent_) return geometry_.blocked(ray) ? Vec3f() : fade(insides.absorption(), ray.t_max);
  while (!(share == Vec3f())) {
    Hit hit;
    const bool met = geometry_.nearest(ray, hit);
    share = share * fade(insides.absorption(), met ? hit.t : ray.t_max);
    if (!met) break;
    const Vertex v = at(ray, hit, {}, false, insides);
    if (!v.hidden) share = share * v.bsdf.straight_on(v.frame.to_local(-ray.direction));
    if (v.hidden || v.material->passes_straight()) insides = v.onward(insides, ray.direction, ray.direction);
    ray.t_max -= hit.t;
    ray.origin = leave(v.point, ray.direction);
    if (!(ray.t_max > 0)) break;
  }
  return share;
}

}  // namespace sg::trace
