// SPDX-License-Identifier: Apache-2.0
// World: all that integrators ask of a scene. What rays meet, of what it is made there, and what shines.
#pragma once
#include <memory>
#include <optional>
#include <vector>

#include "base/context.h"
#include "render/prepare/prepared.h"
#include "render/trace/geometry/geometry.h"
#include "render/trace/integrators/picture_look.h"
#include "render/trace/integrators/ray_footprint.h"
#include "render/trace/isosurface/isosurface.h"
#include "render/trace/light/lights.h"
#include "render/trace/material/bsdf.h"
#include "render/trace/material/insides.h"
#include "render/trace/material/material_palette.h"
#include "render/trace/media/media.h"
#include "render/trace/sampling/local_frame.h"

namespace sg::trace {

/// A place where a path turns.
struct Vertex {
  SurfacePoint point;
  LocalFrame frame;  ///< z along the shading normal, on the side of the face normal
  Bsdf bsdf;
  Vec3f emission;  ///< radiance that the surface gives off itself, to both sides
  const Material* material = nullptr;
  Vec3f below_radius;          ///< mean free paths of light below the surface, of red, green and blue
  float below_anisotropy = 0;  ///< mean cosine of its turns there
  ClearBody body;              ///< behind the surface; without a material: none
  bool hidden = false;         ///< the surface lies within another body: rays pass it

  /// The bodies of a path that came through `around` along `from`, and goes on along `to`.
  Insides onward(const Insides& around, Vec3f from, Vec3f to) const;
};

class World {
 public:
  /// `lights` in traced coordinates of `geometry`; triangles of emissive items are added to them. One material an object of the geometry:
  /// items, then isosurfaces. `shows`: as of Scene.
  World(PreparedScenePtr scene, Geometry geometry, std::vector<std::shared_ptr<const Material>> materials, std::vector<AnyLight> lights,
        Environment environment, std::shared_ptr<const Media> media = nullptr, std::vector<Isosurfaces::Look> isosurfaces = {},
        std::vector<uint32_t> shows = {}, PictureLook look = {});

  const Geometry& geometry() const { return geometry_; }
  const Lights& lights() const { return lights_; }
  /// The same for paths that go on into every direction: they do not ask for a soft environment, which they meet by chance as well as by
  /// asking.
  const Lights& lamps() const { return lamps_ ? *lamps_ : lights_; }
  /// Linear colour and opacity of what was met, and the id of its item (its number + 1).
  Vec4f color(const Ray& ray, const Hit& hit, const RayFootprint& footprint = {}) const;
  uint32_t id(const Hit& hit) const;
  /// Whether both are of the surface of one body: shown by one entry, of isosurfaces at one level.
  bool same_surface(const SurfacePoint& point, const Hit& hit) const;
  /// Null where there are none.
  Media::Borrowed borrow_media() const { return media_ ? media_->borrow() : Media::Borrowed(); }
  bool has_media() const { return media_ && media_->any(); }
  /// Of all that light may meet, traced.
  Box3f bounds() const;
  bool empty() const { return geometry_.bounds().empty() && !has_media(); }
  /// With `walks` the part of light that wanders below a surface which is met from outside is the integrator's (walk_below()). `around`:
  /// the bodies that the ray came through.
  Vertex at(const Ray& ray, const Hit& hit, const RayFootprint& footprint = {}, bool walks = false, const Insides& around = {}) const;
  /// The bodies that are around a place: those that a ray from there comes out of before it has entered them. Nothing where it does not
  /// matter to light: where no body absorbs or has a priority.
  Insides insides_at(Vec3f place, Vec3f direction) const;
  /// Where paths from the camera begin. What is there: insides_of_viewer().
  void look_from(const Ray& ray) { insides_of_viewer_ = insides_at(ray.origin, ray.direction); }
  const Insides& insides_of_viewer() const { return insides_of_viewer_; }
  /// Whether an item lets some light pass straight on, so that shadows have shades.
  bool translucent() const { return translucent_; }
  /// Whether light wanders below some surface.
  bool walks_below() const;
  /// Whether colours depend on what a ray stands for.
  bool has_pictures() const { return pictures_; }
  /// Share of light that surfaces let pass along the ray up to t_max, and clear bodies from those on that it begins in: 0 behind anything
  /// opaque.
  Vec3f passes(Ray ray, Insides insides = {}) const;

 private:
  bool is_line(uint32_t object) const {
    return object < scene_->items.size() && scene_->items[object].kind != raster::PreparedItem::Kind::surface;
  }
  // The material of an object of the geometry, or what it varies between.
  struct Matter {
    const Material* material = nullptr;
    const MaterialPalette* palette = nullptr;
  };
  void find_boundaries();
  Matter matter(uint32_t object, const Material* in) const;
  // An item of which something was met, and where; of a level set a patch of it, or none where it has one colour and material.
  struct Seen {
    std::shared_ptr<const raster::PreparedItem> patch;
    const raster::PreparedItem* item = nullptr;
    Hit hit;
    Vec4f color;  // without an item
  };
  // `point`: null where colours alone are wanted.
  Seen seen(const Ray& ray, const Hit& hit, const SurfacePoint* point) const;
  Vec4f color(const Seen& seen, const Ray& ray, const RayFootprint& footprint) const;
  // The item with the material and the pictures of an object of the geometry; null: a level set without pictures.
  const raster::PreparedItem* matter_of(size_t object) const;

  PreparedScenePtr scene_;
  Geometry geometry_;
  std::vector<std::shared_ptr<const Material>> materials_;
  std::vector<std::unique_ptr<const MaterialPalette>> palettes_;  ///< as materials_; null where one will do
  Lights lights_;
  std::optional<Lights> lamps_;  ///< where they are others
  std::shared_ptr<const Media> media_;
  std::vector<Isosurfaces::Look> isosurfaces_;
  std::vector<uint32_t> shows_;
  PictureLook look_;
  struct Boundary {
    uint32_t object;
    float ior;  ///< of what it is in
    std::unique_ptr<const Material> material;
    std::unique_ptr<const MaterialPalette> palette;
  };
  Insides insides_of_viewer_;
  bool insides_matter_ = false;
  std::vector<Boundary> boundaries_;  ///< of bodies with priorities, against each other
  bool translucent_ = false, pictures_ = false;
};

}  // namespace sg::trace
