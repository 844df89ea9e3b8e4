// SPDX-License-Identifier: Apache-2.0
// Scene: what is to be seen. Plain data; renderers read it.
#pragma once
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "color/color_scale.h"
#include "data/dataset.h"
#include "filter/glyph/instances.h"
#include "scene/camera.h"
#include "scene/items/material.h"
#include "scene/items/surface_copy.h"
#include "scene/items/surface_material.h"
#include "scene/items/surface_texture.h"
#include "scene/items/volume_item.h"
#include "scene/light/lighting.h"

namespace sg {

/// Colour by a field of the item's dataset. One component -> `scale`; `direct`: components are RGB(A) (u8 0..255 or float 0..1).
struct FieldColor {
  std::string field;
  Association association = Association::point;
  int component = -1;  ///< -1: the only one, or the magnitude
  ColorScale scale;
  bool direct = false;
};

struct SurfacePictures;

/// Polygons and strips of a SurfaceMesh.
struct SurfaceItem {
  DatasetPtr data;
  std::optional<FieldColor> color_by;
  Vec3f color{0.80f, 0.80f, 0.82f};  ///< sRGB, without color_by
  double opacity = 1;
  Material material;
  std::optional<SurfaceMaterial> made_of;  ///< for integrators; empty = plastic of its colours
  std::string normals;                     ///< point field of normals; "" = its field of role normals, else smooth (below feature_angle)
  bool flat = false;                       ///< face normals
  double feature_angle = 40;               ///< degrees; edges sharper than this are not smoothed when normals are computed
  DatasetPtr part_of;                      ///< a SurfaceMesh of the same points, whose polygons it is smoothed with; null = its own alone
  bool edges = false;                      ///< draw the edges of the polygons
  /// A SurfaceMesh whose lines are drawn instead (of curved cells: see Skin), or where it has polygons their edges; null = the edges of
  /// the polygons drawn.
  DatasetPtr edge_lines;
  std::optional<Vec3f> edge_color;                  ///< sRGB; empty = that of the surface under it, darker, or lighter on a dark surface
  std::optional<SurfaceTexture> lic;                ///< directions of a vector field as a texture
  std::shared_ptr<const SurfaceCopy> copy_of;       ///< what `data` is a moved copy of; null = of nothing that is drawn elsewhere
  std::shared_ptr<const SurfacePictures> pictures;  ///< what its colour and material are multiplied with; null = nothing
};

/// Lines of a SurfaceMesh; constant width on the picture.
struct LinesItem {
  DatasetPtr data;
  std::optional<FieldColor> color_by;
  Vec3f color{0.15f, 0.15f, 0.17f};
  double opacity = 1;
  double width = 1.5;                      ///< pixels
  std::optional<SurfaceMaterial> made_of;  ///< as of surfaces, here and below
  bool lit = false;                        ///< light by the direction of the line
  double halo = 0;                         ///< pixels of border around lines that hide what is behind
  Vec3f halo_color{0.05f, 0.05f, 0.06f};   ///< sRGB
  bool mark = false;                       ///< of the picture and not of the data, as axes are: it has no part in light
};

/// Every point of the dataset (or the vertices of a SurfaceMesh) as a round dot.
struct PointsItem {
  DatasetPtr data;
  std::optional<FieldColor> color_by;
  Vec3f color{0.15f, 0.15f, 0.17f};
  double opacity = 1;
  std::optional<SurfaceMaterial> made_of;
  double size = 4;     ///< pixels across
  bool shaded = true;  ///< as little spheres
  /// Point fields of normals (3 components) and radii (world lengths): with both, and opaque, the points are oriented discs.
  std::string disc_normals, disc_radius;
};

/// The same few shapes at all points of a dataset: turned, scaled and coloured by its fields. Instances are drawn without making their
/// geometry.
struct GlyphsItem {
  DatasetPtr data;                 ///< its points are the places; any mesh
  std::vector<DatasetPtr> shapes;  ///< SurfaceMesh datasets of unit size along +x: polygons, strips and lines; 1 to 255
  GlyphRule rule;
  bool in_pixels = false;              ///< rule.scale is in pixels of the picture, the same at any distance
  std::optional<FieldColor> color_by;  ///< a point field; one colour a glyph
  Vec3f color{0.80f, 0.80f, 0.82f};    ///< sRGB, without color_by
  double opacity = 1;
  Material material;
  std::optional<SurfaceMaterial> made_of;
  bool flat = false;          ///< face normals
  double feature_angle = 40;  ///< degrees; edges sharper than this are not smoothed
  double line_width = 1.5;    ///< pixels; of the shapes' lines
};
/// The boxes of the shapes, for glyph_bounds().
std::vector<Box3> shape_boxes(const GlyphsItem& item);

/// Text at a place, over the picture where nothing hides the place.
struct TextItem {
  Vec3 at;
  Vec3 along;  ///< world direction of reading, turned round where it would be upside down; zero = along the picture's rows
  std::string text;
  double size = 1;             ///< times the size of the picture's other numbers
  std::optional<Vec3f> color;  ///< sRGB; empty = that of the other texts
};

using Item = std::variant<SurfaceItem, LinesItem, PointsItem, VolumeItem, GlyphsItem>;

struct Light {
  Vec3 direction{0.3, 0.5, 1};  ///< towards the light; in eye space (x right, y up, z towards the viewer) when `follows_camera`
  bool follows_camera = true;
  float intensity = 1;
  /// Of a surface that faces it, in units in which pi makes a white one as bright as white. By default a white one is as bright as 0.75
  /// times the intensity: the rest of its light comes from all around.
  std::optional<float> irradiance = {};
};

struct Scene {
  std::vector<Item> items;
  std::vector<uint32_t> shows;  ///< of the first items: the number, from 1, of the entry under `show` that they are of
  std::vector<TextItem> texts;
  std::vector<Light> lights;  ///< empty = those of `lighting`, else one over the viewer's left shoulder and a weak one from the right
  Lighting lighting;          ///< lights of all kinds, and what is around; renderers without paths take directions from it
  Vec3f background{1, 1, 1};  ///< sRGB, bottom
  std::optional<Vec3f> background_top;  ///< sRGB; a vertical gradient when set
  bool transparent = false;             ///< no background at all
};

/// Bounds of everything in the scene.
Box3 scene_bounds(const Scene& scene);
/// Whether a volume asks for light that only paths find (VolumeScattering::light).
bool scatters_light(const Scene& scene);

/// The lights that renderers without paths use: the scene's own, or directions towards what is stated, or the default two.
std::vector<Light> lights_of(const Scene& scene);

}  // namespace sg
