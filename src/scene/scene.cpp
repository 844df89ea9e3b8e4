// SPDX-License-Identifier: Apache-2.0
#include "scene/scene.h"

#include <algorithm>
#include <numbers>

namespace sg {

namespace {

void add_bounds(const auto& item, Box3& box) {
  if (item.data) box.add(item.data->bounds());
}

void add_bounds(const GlyphsItem& item, Box3& box) {
  if (!item.data) return;
  if (item.in_pixels) {  // their size is known only in the picture: leave room for one of usual size
    const Box3 places = item.data->bounds();
    const Vec3 room = Vec3{1, 1, 1} * (0.05 * places.diagonal());
    if (!places.empty()) box.add(places.lo - room), box.add(places.hi + room);
    return;
  }
  box.add(glyph_bounds(*glyph_instances(item.data, item.rule, item.shapes.size()), shape_boxes(item)));
}

}  // namespace

std::vector<Box3> shape_boxes(const GlyphsItem& item) {
  std::vector<Box3> boxes;
  for (const DatasetPtr& shape : item.shapes) boxes.push_back(shape ? shape->bounds() : Box3{});
  return boxes;
}

Box3 scene_bounds(const Scene& scene) {
  Box3 box;
  for (const Item& item : scene.items) std::visit([&](const auto& i) { add_bounds(i, box); }, item);
  return box;
}

bool scatters_light(const Scene& scene) {
  return std::any_of(scene.items.begin(), scene.items.end(), [](const Item& item) {
    const auto* v = std::get_if<VolumeItem>(&item);
    return v && (v->scattering.light == VolumeLighting::single || v->scattering.light == VolumeLighting::path);
  });
}

std::vector<Light> lights_of(const Scene& scene) {
  if (!scene.lights.empty()) return scene.lights;
  const Lighting& stated = scene.lighting;
  std::vector<PlacedLight> placed;
  if (!stated.lights.empty()) placed = place_lights(stated, scene_bounds(scene));
  else if (const auto* sky = stated.environment ? std::get_if<SkyEnvironmentParams>(&*stated.environment) : nullptr)
    if (const PlacedLight sun = place_sun(stated, *sky); sun.elevation > 0) placed.push_back(sun);
  std::vector<Light> lamps;
  constexpr double white = 0.9;  // as bright as the first of the default ones
  for (const PlacedLight& p : placed) {
    const double share = 0.2126 * double(p.color.x) + 0.7152 * double(p.color.y) + 0.0722 * double(p.color.z);
    // What stands in the middle itself shines from the front.
    const bool nowhere = !(length(p.way) > 0);
    const double brightness = p.brightness * share;
    lamps.push_back(
        {nowhere ? Vec3{0, 0, 1} : p.way, nowhere || p.follows_camera, float(white * brightness), float(std::numbers::pi * brightness)});
  }
  if (!lamps.empty()) return lamps;
  return {{{-0.4, 0.75, 1.0}, true, 0.9f}, {{0.9, 0.1, 0.5}, true, 0.22f}};
}

}  // namespace sg
