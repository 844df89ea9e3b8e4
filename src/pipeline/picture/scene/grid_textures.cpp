// SPDX-License-Identifier: Apache-2.0
#include "pipeline/picture/scene/grid_textures.h"

#include <fmt/core.h>

#include <algorithm>

#include "base/error.h"
#include "base/file/file.h"
#include "data/field_ops.h"
#include "data/memory/memory_budget.h"
#include "image/image.h"
#include "image/texture/texture_file.h"
#include "io/io.h"
#include "scene/show/field_color.h"

namespace sg {

namespace {

struct Layer {
  DatasetPtr data;
  size_t width, height;
};

Layer layer_in(const std::string& path, Context& context) {
  const Data data = read_data(path, {}, context);
  const auto* dataset = std::get_if<DatasetPtr>(&data);
  const auto* grid = dataset ? (*dataset)->as<UniformGrid>() : nullptr;
  const auto flat = grid ? std::count(grid->dims.begin(), grid->dims.end(), size_t(1)) : 0;
  if (flat != 1)
    fail_data("is no picture and no uniform grid of one layer", path, "PNG, JPEG and Radiance HDR are pictures; slice makes one layer");
  // Points run along the first axis that has several.
  const size_t width = grid->dims[grid->dims[0] == 1 ? 1 : 0], height = (*dataset)->point_count() / width;
  need_memory(double(width) * double(height) * 16 * 4 / 3, "a picture on a surface", path, "make it smaller: -f resample");
  return {*dataset, width, height};
}

/// Components as numbers from 0 to 1, whole ones by the largest of their type.
std::vector<Vec4f> numbers_of(const Field& f) {
  const ElementType type = f.array.type();
  const double full = type == ElementType::u8 ? 255 : type == ElementType::u16 ? 65535 : 1;
  const int n = f.components();
  std::vector<Vec4f> texels(f.array.count());
  for (size_t i = 0; i < texels.size(); ++i) {
    for (int c = 0; c < 3; ++c) texels[i][c] = float(f.array.get(i, n < 3 ? 0 : c) / full);
    texels[i].w = n == 4 ? float(f.array.get(i, 3) / full) : 1;
  }
  return texels;
}

const Field& point_field(const Layer& layer, const std::string& path) {
  const Field* f = automatic_field(*layer.data);
  if (!f || f->association != Association::point)
    for (const Field& g : layer.data->fields())
      if (g.association == Association::point && (!f || f->association != Association::point)) f = &g;
  if (!f || f->association != Association::point) fail_data("has no field on its points", path, "-f cell_to_point makes some");
  return *f;
}

std::shared_ptr<const Texture> colors_of(const std::string& path, TexelEncoding encoding, Context& context) {
  const Layer layer = layer_in(path, context);
  const Field& f = point_field(layer, path);
  std::vector<Vec4f> texels;
  // Three or four bytes a point are colours, also where the format does not say so.
  if (is_direct_color(f) || (f.components() >= 3 && f.components() <= 4 && f.array.type() == ElementType::u8)) {
    texels = numbers_of(f);
  } else {
    ColoringParams by;
    by.field.name = f.name;
    const FieldColor color = field_color(*layer.data, by, context).value();
    const Array values = scalar_of(f, color.component, ElementType::f64);
    for (size_t i = 0; i < values.count(); ++i) texels.push_back(color.scale.color(values.get(i)));
    context.info(fmt::format("the picture {} is coloured by '{}'", path, f.name));
    encoding = TexelEncoding::srgb;
  }
  for (Vec4f& t : texels)
    for (int c = 0; c < 3; ++c) t[c] = (encoding == TexelEncoding::srgb ? srgb_decode(t[c]) : t[c]) * t.w;
  return std::make_shared<const Texture>(int(layer.width), int(layer.height), std::move(texels));
}

std::shared_ptr<const Texture> numbers_in(const std::string& path, Context& context) {
  const Layer layer = layer_in(path, context);
  return std::make_shared<const Texture>(int(layer.width), int(layer.height), numbers_of(point_field(layer, path)));
}

bool is_data(const std::string& path) {
  if (path.empty()) return false;
  if (is_folder(path)) return true;
  const MappedFile file(path);
  return !is_picture({file.data(), file.size()});
}

}  // namespace

void read_grid_textures(PictureShow& p, const VaryingMaterial& v, Context& context) {
  const auto take = [&](const std::string& path, bool colors, TexelEncoding encoding) {
    if (!colors) encoding = TexelEncoding::linear;
    if (p.grids.contains({path, encoding}) || !is_data(path)) return;
    p.grids[{path, encoding}] = colors ? colors_of(path, encoding, context) : numbers_in(path, context);
  };
  take(p.picture, true, p.picture_encoding), take(p.normal_picture, false, {}), take(p.material_picture, false, {});
  for (size_t f = 0; f < v.pictures.size(); ++f) {
    const auto factor = MaterialFactor(f);
    take(v.pictures[f], factor == MaterialFactor::coat_color || factor == MaterialFactor::transmission_color, TexelEncoding::srgb);
  }
  take(v.emission_picture, true, TexelEncoding::srgb);
}

}  // namespace sg
