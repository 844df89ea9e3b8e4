// SPDX-License-Identifier: Apache-2.0
#include "scene/show/picture.h"

#include <fmt/core.h>
#include <sys/stat.h>

#include <cmath>

#include "base/error.h"
#include "base/file/file.h"
#include "data/fields/texture_coordinates.h"
#include "data/memory/memo.h"
#include "data/memory/memory_budget.h"
#include "image/texture/texture_file.h"

namespace sg {

void describe(Schema& s, PictureShow& p) {
  s("picture", p.picture,
    "Picture on the surface, by its texture coordinates: a file (PNG, JPEG, Radiance HDR, or a grid of one layer, in its own colours or "
    "coloured by its field). It takes the place of colours by a field; "
    "color= "
    "tints it, and what it leaves transparent is not drawn.")
      .unit("file");
  s("pattern", p.pattern,
    "Pattern in the place of a picture: checker, two by two squares in a unit of the coordinates, or noise, a cloud. Default: none.");
  s("picture_coordinates", p.picture_coordinates,
    "Point field of 2 components or more: where in the picture each point lies, (0, 0) at its lower left, (1, 1) at its upper right. "
    "Default: the texture coordinates that the data has.")
      .takes(fields::point_vectors);
  s("picture_repeats", p.picture_repeats,
    "How often the picture stands in a unit of the coordinates: one number, or across and up. Default: once.")
      .items(0, 2);
  s("picture_wrap", p.picture_wrap, "What lies beyond the picture: it is repeated, mirrored, or its border goes on.");
  s("picture_filter", p.picture_filter,
    "How a pixel sees it: the nearest texel, between the four nearest, also between smaller copies for what is far away, or these along "
    "the "
    "longer side of what the pixel sees, too.");
  s("picture_encoding", p.picture_encoding, "Whether its numbers are those of a screen's colours, or light itself. HDR is always light.");
  s("normal_picture", p.normal_picture,
    "Picture of directions, as glTF has them, by which light sees the surface bent: a file; the same coordinates, repeats and wrap.")
      .unit("file");
  s("normal_scale", p.normal_scale, "How strongly it is bent; negative: what stood out is a hollow.").range(-100, 100);
  s("material_picture", p.material_picture,
    "Picture that multiplies the roughness by its green and the share of metal by its blue, as glTF has them, where the picture has an "
    "integrator: a file; the same coordinates, repeats and wrap.")
      .unit("file");
}

void check(const PictureShow& p) {
  if (!p.picture.empty() && p.pattern) fail_usage("both a picture and a pattern are stated", "picture", "give one of them");
  for (const double r : p.picture_repeats)
    if (!std::isfinite(r) || r == 0) fail_usage(fmt::format("picture_repeats={} is no number of times", r), "picture");
}

const Field& picture_coordinates(const Dataset& d, const FieldName& wanted) {
  const Field* f = nullptr;
  if (!wanted.empty()) {
    f = &d.fields().require(wanted.name, Association::point);
  } else {
    for (const Field& g : d.fields())
      if (!f && g.role == Role::tcoords && g.association == Association::point && g.components() >= 2) f = &g;
    if (!f)
      fail_usage("the data has no texture coordinates, so that a picture has no place on it", "picture",
                 "-f texture_coordinates makes some; picture_coordinates=NAME takes a point field of 2 components");
  }
  if (f->components() < 2)
    fail_usage(fmt::format("field '{}' has one component; a place in a picture has two", f->name), "picture_coordinates");
  return *f;
}

namespace {

/// Another one when the file was written again.
int64_t time_of_change(const std::string& path) {
  struct stat now {};
  return ::stat(path.c_str(), &now) == 0 ? int64_t(now.st_mtim.tv_sec) * 1'000'000'000 + now.st_mtim.tv_nsec : 0;
}

std::shared_ptr<const Texture> texture_in_file(const Dataset& d, const std::string& path, TexelEncoding encoding) {
  const MappedFile file(path);
  const std::string key = fmt::format("pictures/{}/{}/{}/{}", path, time_of_change(path), file.size(), int(encoding));
  if (auto kept = d.memo().find<Texture>(key)) return kept;
  need_memory(texture_memory({file.data(), file.size()}), "a picture on a surface", path, "make it smaller");
  Texture t = decode_texture({file.data(), file.size()}, path, encoding, true);
  const size_t bytes = t.bytes();
  return d.memo().keep<Texture>(key, std::move(t), bytes);
}

SurfacePicture placed(const Dataset& d, const PictureShow& p) {
  SurfacePicture on;
  on.coordinates = picture_coordinates(d, p.picture_coordinates).name;
  if (!p.picture_repeats.empty()) on.place = {p.picture_repeats.front(), 0, 0, 0, p.picture_repeats.back(), 0};
  if (runs_down(on.coordinates)) {
    auto& q = on.place;
    q[2] += q[1], q[1] = -q[1], q[5] += q[4], q[4] = -q[4];
  }
  on.lookup.wrap_u = on.lookup.wrap_v = p.picture_wrap, on.lookup.filter = p.picture_filter;
  return on;
}

}  // namespace

SurfacePicture picture_in_file(const Dataset& d, const PictureShow& p, const std::string& path, TexelEncoding encoding) {
  SurfacePicture on = placed(d, p);
  const auto grid = p.grids.find({path, encoding});
  on.texture = grid != p.grids.end() ? grid->second : texture_in_file(d, path, encoding);
  return on;
}

std::shared_ptr<const SurfacePictures> pictures_of(const Dataset& d, const PictureShow& p) {
  if (!p.any() && !p.any_other()) return nullptr;
  check(p);
  auto pictures = std::make_shared<SurfacePictures>();
  if (!p.normal_picture.empty())
    pictures->normal = picture_in_file(d, p, p.normal_picture, TexelEncoding::linear), pictures->normal_scale = float(p.normal_scale);
  if (!p.material_picture.empty())
    pictures->factors.push_back({picture_in_file(d, p, p.material_picture, TexelEncoding::linear),
                                 {{MaterialFactor::roughness, 1}, {MaterialFactor::metalness, 2}}});
  if (p.pattern) {
    // Of the surface's own colour, and dark.
    constexpr Vec3f light{1, 1, 1}, dark{0.12f, 0.12f, 0.12f};
    SurfacePicture on = placed(d, p);
    on.texture = std::make_shared<const Texture>(pattern_texture(*p.pattern, light, dark));
    on.lookup.sharp = *p.pattern == TexturePattern::checker;
    pictures->color = std::move(on);
  } else if (!p.picture.empty()) {
    pictures->color = picture_in_file(d, p, p.picture, p.picture_encoding);
    pictures->alpha = SurfacePictures::Alpha::coverage;
  }
  return pictures;
}

}  // namespace sg
