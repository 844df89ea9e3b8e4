// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include "base/error.h"
#include "base/text/text.h"
#include "data/cells/mesh_dimension.h"
#include "filter/tensor/diffusion/diffusion_model.h"
#include "filter/tensor/diffusion/gradient_table.h"
#include "filter/tensor/tensor_field.h"
#include "scene/choose/coloring.h"
#include "scene/choose/telling_field.h"
#include "scene/look/look_parts.h"
#include "scene/show/surface.h"

namespace sg {

namespace {

void add_cell_edges(const Dataset& d, Look& look) {
  if (mesh_dimension(d) == 0 || d.cell_count() == 0) return;
  SurfaceShow edges;
  edges.style = SurfaceStyle::wireframe, edges.coloring.color = "#808080";
  add_show(look, edges, true);
}

bool determine_tensor(const Dataset& d) {
  try {
    constexpr double b0 = 50;
    DiffusionModel{read_gradients(d, "", "", b0)};
    return true;
  } catch (const Error&) {
    return false;
  }
}

}  // namespace

bool look_at_diffusion(const Dataset& d, Look& look) {
  constexpr size_t most = 50'000'000;  // values, which are all read
  const Field *strengths = d.fields().find("bval", Association::whole), *directions = d.fields().find("bvec", Association::whole);
  if (!strengths || !directions || d.point_count() * strengths->array.count() > most || !determine_tensor(d)) return false;
  look.source = "gradient_images";
  look.prepare = {"tensor_fit"};
  look.filter = {"tensor_glyphs"};
  add_show(look, SurfaceShow(), false);
  look.reason = fmt::format(
      "a diffusion series of {} volumes: a glyph for each tensor fitted to them, red along x, green along y, blue along z; --show volume "
      "shows a volume of the series",
      strengths->array.count());
  return true;
}

bool look_at_tensors(const Dataset& d, Look& look) {
  constexpr size_t most = 1000, few = 64;
  const Field* tensors = find_tensors(d, {});
  if (!tensors || tensors->role != Role::tensors || tensors->array.count() > most) return false;
  if (const Field* f = automatic_field(d); f && telling(d, *f) == Telling::values && tensors->array.count() > few) return false;
  look.filter = {"tensor_glyphs", "field=" + tensors->name};
  add_show(look, SurfaceShow(), false);
  add_cell_edges(d, look);
  look.reason =
      fmt::format("tensors '{}': a glyph for each; --show surface shows the {} mesh and its other fields", tensors->name, d.kind());
  return true;
}

bool look_at_stress(const Dataset& d, Look& look) {
  const Field* stress = find_tensors(d, {});
  if (!stress || mesh_dimension(d) != 3 || to_lower(stress->name).find("stress") == std::string::npos) return false;
  for (const Field& f : d.fields())
    if (f.association != Association::whole && f.components() == 1 && telling(d, f) == Telling::values && !f.name.starts_with(stress->name))
      return false;
  look.filter = {"stress_measures", "field=" + stress->name};
  SurfaceShow surface;
  surface.edges = d.cell_count() <= 100000;
  surface.coloring.field.name = "von Mises stress";
  add_show(look, surface, false);
  look.reason = fmt::format("von Mises stress of the tensors '{}' on the outer surface; -f tensor_glyphs shows the tensors", stress->name);
  return true;
}

}  // namespace sg
