// SPDX-License-Identifier: Apache-2.0
#include "serve/renderer/questions/selection.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "base/error.h"
#include "base/parallel.h"
#include "base/text/text.h"
#include "base/text/utf8.h"
#include "data/cells/cell_reader.h"
#include "data/cells/point_positions.h"
#include "data/field_ops.h"
#include "data/lattice.h"
#include "filter/field/sampling/point_cell.h"
#include "filter/mesh/select/cell_centers.h"
#include "filter/mesh/slice/implicit_function.h"
#include "filter/mesh/slice/lasso_region.h"
#include "serve/renderer/questions/place_values.h"
#include "serve/renderer/tell.h"

namespace sg::serve {

namespace {

constexpr size_t most_corners = 2000, values_per_chunk = 1 << 14;

// Digits beyond what an outline's own size needs are noise of the projection, and long words.
void shorten(std::vector<double>& corners) {
  double reach = 0;
  for (size_t i = 3; i < corners.size(); ++i) reach = std::max(reach, std::abs(corners[i] - corners[i % 3]));
  if (!(reach > 1e-280 && reach < 1e280)) return;
  const double unit = std::pow(10.0, std::floor(std::log10(reach)) - 8);
  for (double& x : corners) {
    const double rounded = std::round(x / unit);
    // Divided by a power of ten, decimals are exact where multiplied by one they are not.
    x = std::abs(rounded) < 9e15 ? (unit < 1 ? rounded / std::round(1 / unit) : rounded * unit) : x;
  }
}

// Places of the data, with the place that they are seen from in perspective.
void take_places(const Json& outline, const Json& eye, Selection& s) {
  for (const Json& at : outline.items()) {
    const Vec3 corner = place_of(at, "lasso");
    s.lasso.insert(s.lasso.end(), {corner.x, corner.y, corner.z});
  }
  if (!eye.is_null()) s.lasso_eye = place_of(eye, "lasso_eye");
}

// Pixels of a view.
void take_pixels(const Json& outline, const DrawnArea* area, Selection& s) {
  if (!area) fail_usage("the view has no picture in which an outline could lie", "lasso");
  const Projection& p = area->projection;
  // At the depth of what is seen, distances from the outline are about those in space.
  double depth = p.parallel || area->bounds.empty() ? 1 : p.to_eye(area->bounds.center()).z;
  if (!(depth > 0)) depth = 1;
  Vec3 normal;
  for (const Json& at : outline.items()) {
    const double x = at[0].number(), y = at[1].number();
    if (!at[0].is_number() || !at[1].is_number() || !(std::abs(x) < 1e6 && std::abs(y) < 1e6))
      fail_usage("a corner is no pixel", "lasso", "each has two numbers: [x,y]");
    const Projection::Ray ray = p.ray(x - area->x, y - area->y);
    Vec3 corner = ray.origin + ray.direction * (p.parallel ? 0.0 : depth * ray.per_depth), along = ray.direction;
    for (int a = 0; a < 3; ++a) corner[a] /= area->stretch[a], along[a] /= area->stretch[a];
    // Across the rays, which stretching turns: the polygon is swept along its normal.
    if (p.parallel) {
      if (s.lasso.empty()) normal = normalize(along);
      else corner += normal * dot(normal, Vec3(s.lasso[0], s.lasso[1], s.lasso[2]) - corner);
    }
    s.lasso.insert(s.lasso.end(), {corner.x, corner.y, corner.z});
  }
  shorten(s.lasso);
  if (!p.parallel) s.lasso_eye = Vec3(p.eye.x / area->stretch.x, p.eye.y / area->stretch.y, p.eye.z / area->stretch.z);
}

void take_lasso(const Json& among, const DrawnArea* area, Selection& s) {
  const Json& outline = among["lasso"];
  if (outline.size() < 3 || outline.size() > most_corners)
    fail_usage(fmt::format("an outline of {} corners", outline.size()), "lasso",
               fmt::format("3 to {} pixels [x,y] or places [x,y,z]", most_corners));
  if (outline[0].size() == 3) take_places(outline, among["lasso_eye"], s);
  else take_pixels(outline, area, s);
  (void)LassoRegion(s.lasso, s.lasso_eye, "selection");  // refuses what has no inside
}

std::string words_of(std::span<const double> numbers) {
  std::string words;
  for (const double x : numbers) words += (words.empty() ? "" : ",") + exact_number(x);
  return words;
}

// A byte for each tuple: whether its number, of several components the magnitude, is in range.
std::vector<uint8_t> in_range(const Field& f, const Selection& s) {
  const Array numbers = scalar_of(f, -1, ElementType::f64);
  const auto v = numbers.view<double>();
  std::vector<uint8_t> yes(v.count);
  parallel_for(v.count, values_per_chunk, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) yes[i] = v[i] >= s.lo && v[i] <= s.hi;
  });
  return yes;
}

const Field& field_of(const Dataset& d, const Selection& s) {
  const Field* f = d.fields().find(s.field);
  if (!f || f->association == Association::whole) fail_usage(fmt::format("there is no field '{}'", printable(s.field)), "value");
  return *f;
}

std::function<bool(Vec3)> place_test(const Selection& s, const DatasetPtr& d, Context& context) {
  ImplicitFunction in_box;
  if (!s.box.empty()) {
    ImplicitParams p;
    p.box = s.box;
    in_box = implicit_function(p, d, nullptr, "selection", context);
  }
  std::shared_ptr<const LassoRegion> lasso;
  if (!s.lasso.empty()) lasso = std::make_shared<const LassoRegion>(s.lasso, s.lasso_eye, "selection");
  return [in_box, lasso, boxed = !s.box.empty()](Vec3 x) { return (!boxed || in_box(x) <= 0) && (!lasso || lasso->holds(x)); };
}

void keep_places(const Dataset& d, const std::function<bool(Vec3)>& holds, std::vector<uint8_t>& keep, Context& context) {
  const auto each = [&](auto&& position) {
    parallel_for(
        keep.size(), values_per_chunk,
        [&](size_t begin, size_t end) {
          for (size_t i = begin; i < end; ++i) keep[i] = keep[i] && holds(position(i));
        },
        &context);
  };
  if (is_lattice(d.mesh())) {
    const Lattice lattice(d.mesh());
    const LatticeView v = lattice.view();
    each([&](size_t i) { return v.position(i % v.dims[0], i / v.dims[0] % v.dims[1], i / v.dims[0] / v.dims[1]); });
  } else {
    const Array points = point_positions(d.mesh());
    each([&](size_t i) { return Vec3(points.get(i, 0), points.get(i, 1), points.get(i, 2)); });
  }
}

// Marks what is not kept, and counts what is and was not hidden before.
size_t hide(Array& ghost, const std::vector<uint8_t>& keep, uint8_t bit) {
  uint8_t* marks = nullptr;
  const Array before = ghost;
  const uint8_t* old = before.empty() ? nullptr : before.view<uint8_t>().data;
  ghost = Array::make<uint8_t>(keep.size(), 1, &marks);
  return parallel_reduce(
      keep.size(), values_per_chunk, size_t(0),
      [&](size_t begin, size_t end) {
        size_t count = 0;
        for (size_t i = begin; i < end; ++i) {
          marks[i] = uint8_t((old ? old[i] : 0) | (keep[i] ? 0 : bit));
          count += marks[i] == 0;
        }
        return count;
      },
      std::plus<>());
}

// The points of the cells that are kept.
std::vector<uint8_t> points_of(const DatasetPtr& d, const std::vector<uint8_t>& cells) {
  std::vector<uint8_t> points(d->point_count());
  CellReader reader(d);
  for (size_t c = 0; c < cells.size(); ++c) {
    if (!cells[c]) continue;
    reader.open(c);
    for (const int64_t id : reader.ids()) points[size_t(id)] = 1;
  }
  return points;
}

}  // namespace

Selection selection_from(const Json& among, const DrawnArea* area) {
  Selection s;
  if (!among.is_null() && !among.is_object()) fail_usage("'among' is no object", "measures", "it may have value, box and lasso");
  if (const Json& value = among["value"]; !value.is_null()) {
    s.field = bytes_of_text(value["field"].text()), s.lo = value["range"][0].number(), s.hi = value["range"][1].number();
    if (s.field.empty() || !value["range"][0].is_number() || !value["range"][1].is_number() || !(s.lo <= s.hi))
      fail_usage("a range of values needs a field, and the smaller number first", "value", R"({"field":"ct","range":[0,100]})");
  }
  if (const Json& box = among["box"]; !box.is_null()) {
    for (const Json& x : box.items()) s.box.push_back(x.is_number() ? x.number() : NAN);
    ImplicitParams p;
    p.box = s.box;
    Context context;
    if (s.box.empty()) fail_usage("a box has six numbers", "box", "[x0,x1,y0,y1,z0,z1]");
    UniformGrid anything;
    (void)implicit_function(p, make_dataset(anything), nullptr, "selection", context);  // refuses what is no box
  }
  if (!among["lasso"].is_null()) take_lasso(among, area, s);
  return s;
}

Json steps_of(const Selection& s) {
  std::vector<Json> steps;
  const auto add = [&](const char* operation, Json::Members set) {
    steps.emplace_back(Json::Members{{"operation", text(operation)}, {"set", Json(std::move(set))}});
  };
  if (!s.box.empty()) add("extract", {{"box", text(words_of(s.box))}, {"by_center", text("true")}});
  if (!s.lasso.empty()) {
    Json::Members set{{"lasso", text(words_of(s.lasso))}, {"by_center", text("true")}};
    if (s.lasso_eye) {
      const double eye[] = {s.lasso_eye->x, s.lasso_eye->y, s.lasso_eye->z};
      set.emplace_back("lasso_eye", text(words_of(eye)));
    }
    add("extract", std::move(set));
  }
  if (!s.field.empty())
    add("threshold",
        {{"field", text(s.field)}, {"min", text(exact_number(s.lo))}, {"max", text(exact_number(s.hi))}, {"mean", text("true")}});
  return Json(std::move(steps));
}

Selected selected_of(const DatasetPtr& d, const Selection& s, Context& context) {
  const bool cloud = d->as<PointCloud>() != nullptr;
  if (s.all()) {
    const auto seen = [](const Array& ghost, size_t all) {
      return ghost.empty() ? all : size_t(std::count(ghost.view<uint8_t>().data, ghost.view<uint8_t>().data + all, uint8_t(0)));
    };
    return {cloud ? nullptr : d, d, cloud ? 0 : seen(d->cell_ghost(), d->cell_count()), seen(d->point_ghost(), d->point_count())};
  }
  std::vector<uint8_t> cells(d->cell_count(), 1), points(d->point_count(), 1);
  if (!s.field.empty()) {
    const Field& f = field_of(*d, s);
    if (f.association == Association::point) {
      points = in_range(f, s);
      if (!cloud) cells = in_range(point_to_cell(d, {{f.name}}, context)->fields().require(f.name, Association::cell), s);
    } else {
      cells = in_range(f, s);
      points = points_of(d, cells);
    }
  }
  if (!s.box.empty() || !s.lasso.empty()) {
    const auto holds = place_test(s, d, context);
    keep_centers(d, holds, cells, context);
    keep_places(*d, holds, points, context);
  }
  Selected r;
  DatasetParts parts = d->parts();
  if (!cloud) {
    r.cell_count = hide(parts.cell_ghost, cells, ghost_hidden_cell);
    r.cells = make_dataset(parts);
  }
  r.point_count = hide(parts.point_ghost, points, ghost_hidden_point);
  r.points = make_dataset(std::move(parts));
  return r;
}

}  // namespace sg::serve
