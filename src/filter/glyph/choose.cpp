// SPDX-License-Identifier: Apache-2.0
#include "filter/glyph/choose.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/text/text.h"
#include "data/cells/point_positions.h"
#include "data/field_ops.h"

namespace sg {

const Field* automatic_vectors(const Dataset& d) {
  auto fits = [](const Field& f, int components) {
    return f.association != Association::whole && f.components() == components && f.role != Role::normals && f.role != Role::tcoords &&
           f.role != Role::colors && f.role != Role::global_ids && f.role != Role::labels;
  };
  for (const Association a : {Association::point, Association::cell})
    for (const Field& f : d.fields())
      if (f.role == Role::vectors && f.association == a && (fits(f, 3) || fits(f, 2))) return &f;
  for (const Association a : {Association::point, Association::cell})
    for (const int components : {3, 2})
      for (const Field& f : d.fields())
        if (f.association == a && fits(f, components) && is_float(f.array.type())) return &f;
  return nullptr;
}

namespace {

bool needs_direction(const GlyphShapeParams& p) {
  const std::optional<GlyphShape> shape = known_shape(p);
  if (!shape) return !p.shape;
  switch (*shape) {
    case GlyphShape::arrow:
    case GlyphShape::cone:
    case GlyphShape::needle:
    case GlyphShape::line:
    case GlyphShape::arrow2d:
    case GlyphShape::barbs: return true;
    case GlyphShape::cylinder:
    case GlyphShape::disc:
    case GlyphShape::sphere:
    case GlyphShape::cube:
    case GlyphShape::superquadric: return false;
  }
  return false;
}

const Field* wanted_vectors(const Dataset& d, const GlyphParams& p) {
  if (!p.frames.empty()) return nullptr;
  if (p.vectors.none()) return nullptr;
  if (p.vectors.empty()) {
    const Field* f = automatic_vectors(d);
    if (!f && needs_direction(p.shape)) {
      std::string has;
      for (const std::string& n : d.fields().names()) has += (has.empty() ? "" : ", ") + n;
      fail_usage("there is no vector field to show", "glyphs",
                 has.empty() ? "the data has no fields" : fmt::format("fields: {}; shape=sphere size_by=NAME shows scalars", has));
    }
    return f;
  }
  const Field& f = d.fields().require(p.vectors.name);
  if (f.association == Association::whole || (f.components() != 2 && f.components() != 3))
    fail_usage(fmt::format("field '{}' has {} component{}", f.name, f.components(), f.components() == 1 ? "" : "s"), "glyphs: vectors",
               "vectors have 2 or 3");
  return &f;
}

// Flat data whose vectors lie in its plane: that axis, else -1.
int plane_of(const Dataset& d, const Field* vectors) {
  int axis = -1;
  if (extended_axes(d.bounds(), &axis) != 2) return -1;
  if (!vectors || vectors->components() == 2) return axis;
  const Range all = d.range(*vectors, -1), across = d.range(*vectors, axis);
  if (all.empty()) return axis;
  return std::max(std::abs(across.lo), std::abs(across.hi)) > 0.05 * all.hi ? -1 : axis;
}

GlyphPointsParams placement(const Dataset& d, const GlyphParams& p, const Field* vectors, int flat_axis, bool barbs, std::string& how) {
  GlyphPointsParams q;
  q.every = p.every, q.seed = p.seed, q.spacing = p.spacing;
  int64_t fitting = barbs ? 180 : flat_axis >= 0 ? 900 : 2500;
  // A long and narrow box is small on the picture: no more of them along it than can be distinguished.
  const Vec3 size = d.bounds().size();
  const double along = (barbs ? 22 : 45), step = d.bounds().empty() ? 0 : std::max({size.x, size.y, size.z}) / along;
  if (step > 0) {
    double most = 1;
    for (int a = 0; a < 3; ++a) most *= std::max(size[a] / step, 1.0);
    if (most < double(fitting)) fitting = std::max<int64_t>(int64_t(most), 60);  // not for a box beyond doubles
  }
  q.count = p.count > 0 ? p.count : fitting;
  const bool all_fit = p.count == 0 && p.spacing == 0 && d.point_count() <= size_t(q.count);
  q.mode = p.place.value_or(all_fit ? GlyphPlaces::all : GlyphPlaces::even);
  if (q.mode == GlyphPlaces::all && vectors && vectors->association == Association::cell) q.mode = GlyphPlaces::cells;
  how = q.mode == GlyphPlaces::even    ? "placed evenly"
        : q.mode == GlyphPlaces::all   ? "at all points"
        : q.mode == GlyphPlaces::cells ? "one per cell"
        : q.mode == GlyphPlaces::lines ? "along the lines"
        : q.mode == GlyphPlaces::every ? fmt::format("at every {}th point", q.every)
                                       : fmt::format("placed {}", word_of(q.mode));
  return q;
}

// Sizes by which the glyphs differ: lengths or absolute values at the places, ascending, finite and above 0.
std::vector<double> size_factors(const Dataset& d, const std::string& name) {
  const Field& f = d.fields().require(name, Association::point);
  const Array a = scalar_of(f, f.components() > 1 ? -1 : 0, ElementType::f64);
  std::vector<double> v;
  for (size_t i = 0; i < a.count(); ++i)
    if (const double x = std::abs(a.get(i)); x > 0 && std::isfinite(x)) v.push_back(x);
  std::sort(v.begin(), v.end());
  return v;
}

void choose_scale_rule(const GlyphParams& p, const Field* vectors, bool barbs, ChosenGlyphs& out) {
  GlyphRule& r = out.rule;
  const std::optional<GlyphSize> by = p.size_by           ? value_of_word<GlyphSize>(*p.size_by)
                                      : vectors && !barbs ? GlyphSize::length
                                                          : GlyphSize::constant;
  if (by == GlyphSize::constant) return;
  if (by == GlyphSize::length) {
    if (!vectors)
      fail_usage("there are no vectors whose length could be the size", "glyphs: size_by", "size_by=constant, or the name of a field");
    r.size = GlyphRule::Size::length;
    return;
  }
  const std::string& name = *p.size_by;
  if (!out.data->fields().find(name, Association::point)) {
    std::vector<std::string> names{"auto", "constant", "length"};
    for (const std::string& n : out.data->fields().names()) names.push_back(n);
    fail_usage(fmt::format("'{}' is neither 'length', 'constant' nor a field", name), "glyphs: size_by", unknown_name_hint(name, names));
  }
  r.size = GlyphRule::Size::field, r.size_field = name;
}

constexpr double faint = 0.02;  // of the largest: hardly seen

// Where most of the data is still, places enough that about as many glyphs are seen as were meant.
DatasetPtr place(const DatasetPtr& data, GlyphPointsParams q, bool may_add, const Field* vectors, Context& context) {
  DatasetPtr places = glyph_points(data, q, context);
  if (!may_add || !vectors || q.mode != GlyphPlaces::even) return places;
  for (int round = 0; round < 2; ++round) {
    const std::vector<double> lengths = size_factors(*places, vectors->name);
    if (lengths.empty()) return places;
    const auto seen = double(lengths.end() - std::lower_bound(lengths.begin(), lengths.end(), faint * lengths.back()));
    const double share = seen / double(places->point_count());
    if (share > 0.5 || seen > 0.12 * double(q.count)) return places;
    GlyphPointsParams more = q;
    more.count = int64_t(std::min(0.18 * double(q.count) / share, std::min(2e5, double(data->point_count()))));
    if (double(more.count) < 1.2 * double(places->point_count())) return places;
    places = glyph_points(data, more, context);
  }
  return places;
}

// Half of the places have their nearest neighbour nearer than that; never more than their mean share of the box allows.
double distance_of_places(const Dataset& input, const Dataset& places) {
  const size_t n = places.point_count();
  const double mean = typical_spacing(input, std::max<size_t>(n, 1));
  if (n < 20 || n > 50000) return mean;
  const Array xyz = point_positions(places.mesh());
  auto at = [&](size_t i) { return Vec3{xyz.get(i, 0), xyz.get(i, 1), xyz.get(i, 2)}; };
  std::vector<Vec3> all;
  for (size_t i = 0; i < n; ++i) all.push_back(at(i));
  std::vector<double> nearest;
  for (size_t k = 0; k < 101; ++k) {
    const size_t i = k * (n - 1) / 100;
    double least = HUGE_VAL;
    for (size_t j = 0; j < n; ++j)
      if (const Vec3 d = all[j] - all[i]; j != i) least = std::min(least, dot(d, d));
    if (std::isfinite(least) && least > 0) nearest.push_back(std::sqrt(least));
  }
  if (nearest.empty()) return mean;
  std::nth_element(nearest.begin(), nearest.begin() + ptrdiff_t(nearest.size() / 2), nearest.end());
  return std::min(mean, 1.25 * nearest[nearest.size() / 2]);
}

// Scale of the rule from the requested size, or from the distance between points.
void choose_size(const Dataset& input, const GlyphParams& p, bool in_pixels, int flat_axis, ChosenGlyphs& out) {
  if (p.size > 0 && p.factor > 0) fail_usage("size and factor both set the size of glyphs", "glyphs", "give one of them");
  GlyphRule& r = out.rule;
  const std::string by = r.size == GlyphRule::Size::length ? r.vectors : r.size == GlyphRule::Size::field ? r.size_field : "";
  const std::vector<double> factors = by.empty() ? std::vector<double>{1} : size_factors(*out.data, by);
  if (factors.empty()) {
    out.note = fmt::format("; '{}' is zero or not finite everywhere, so there are no glyphs", by);
    return;
  }
  double most = factors.back();
  if (p.factor > 0) {
    r.scale = p.factor;
  } else {
    const double apart = p.spacing > 0 ? p.spacing : distance_of_places(input, *out.data);
    const bool round = !needs_direction(p.shape);
    double size = p.size > 0  ? p.size
                  : in_pixels ? (out.barbs ? 34 : 40)
                              : apart * (out.barbs        ? 0.8
                                         : round          ? 0.6
                                         : flat_axis >= 0 ? 1.0
                                                          : 1.4);
    // A few giants would make all others invisible.
    const auto seen = std::lower_bound(factors.begin(), factors.end(), faint * most) - factors.begin();
    const double usual = factors[size_t(seen) + size_t(0.95 * double(factors.size() - size_t(seen) - 1))];
    if (p.size == 0 && most > 1.5 * usual) {
      r.largest = 1.6 * size, most = usual;
      out.note += fmt::format("; those above {} are drawn at that length", short_number(1.6 * usual, 3));
    }
    r.scale = size / most;
  }
  out.longest = r.scale * most, out.of = by.empty() ? 0 : most;
}

}  // namespace

void describe(Schema& s, GlyphParams& p) {
  s("vectors", p.vectors, "Field of 2 or 3 components that glyphs point along; default: the active vectors; 'none' for none.")
      .takes(fields::vectors);
  s("frames", p.frames, "Point field of 9 numbers, a matrix by rows that rotates and stretches the shape, instead of vectors.")
      .takes(fields::tensors);
  describe(s, p.shape);
  s("size_by", p.size_by,
    "What the size of a glyph shows: length (of its vector), constant, or the name of a scalar field; auto: length, for barbs constant.");
  s("size", p.size, "Length of the largest glyph; 0: about the distance between glyphs. For barbs in pictures: in pixels.")
      .unit("length")
      .at_least(0);
  s("factor", p.factor, "Length of a glyph of value 1, instead of size; 0: by size.").at_least(0);
  s("place", p.place,
    "Where glyphs are placed: all points, every n-th, evenly, cells, random, apart (no overlap), lines (along them); auto: evenly, or all "
    "points if few.");
  s("count", p.count, "Approximate number of glyphs placed evenly or at random; 0: chosen automatically.").range(0, 1e9);
  s("every", p.every, "place=every: one glyph per this many points.").range(1, 1e12);
  s("seed", p.seed, "place=random: another number gives other points.");
  s("spacing", p.spacing, "Distance between glyphs placed evenly or along lines; 0: from the count.").unit("length").at_least(0);
  describe(s, p.barbs);
}

ChosenGlyphs choose_glyphs(const DatasetPtr& data, const GlyphParams& given, bool in_pixels, Context& context) {
  GlyphParams p = given;
  ChosenGlyphs out;
  const Field* vectors = wanted_vectors(*data, p);
  const int flat_axis = plane_of(*data, vectors);
  out.barbs = known_shape(p.shape) == GlyphShape::barbs;
  if (out.barbs && !vectors) fail_usage("barbs need a wind", "glyphs", "name a vector field with vectors=");
  if (!p.shape.shape)
    p.shape.shape = word_of(!p.frames.empty() ? GlyphShape::superquadric : flat_axis >= 0 ? GlyphShape::arrow2d : GlyphShape::arrow);
  out.flat = out.barbs || known_shape(p.shape) == GlyphShape::arrow2d;
  std::string how;
  GlyphPointsParams places = placement(*data, p, vectors, flat_axis, out.barbs, how);
  const double size_given = p.size > 0 ? p.size : 0;
  if (places.mode == GlyphPlaces::apart && size_given > 0 && !in_pixels && places.spacing == 0) places.spacing = size_given;
  out.data = place(data, places, p.count == 0 && p.spacing == 0 && !out.barbs, vectors, context);
  if (vectors) out.vectors = out.rule.vectors = vectors->name;
  if (places.mode == GlyphPlaces::lines && vectors == nullptr && p.vectors.empty() && p.frames.empty()) out.rule.vectors = "tangent";
  out.rule.frames = p.frames.name;
  if (flat_axis >= 0 && out.flat)
    out.rule.normal = Vec3{flat_axis == 0 ? 1.0 : 0.0, flat_axis == 1 ? 1.0 : 0.0, flat_axis == 2 ? 1.0 : 0.0};
  choose_scale_rule(p, vectors, out.barbs, out);
  choose_size(*data, p, in_pixels, flat_axis, out);
  if (out.barbs) {
    out.data = barb_places(out.data, out.rule.vectors, p.barbs, context);
    out.shapes = barb_shapes();
    out.rule.frames = "barb frame", out.rule.choice = "barb", out.rule.vectors.clear();
  } else {
    out.shapes = {glyph_shape_mesh(p.shape, context)};
  }
  const std::string of = out.vectors.empty() ? "" : fmt::format(" of '{}'", out.vectors);
  std::string note = fmt::format("{} {}{} {}", glyph_instances(out.data, out.rule, out.shapes.size())->standing,
                                 out.barbs ? "barbs" : "glyphs (" + *p.shape.shape + ")", of, how);
  if (out.of > 0) {
    const Field* unit = out.data->fields().find(out.rule.size == GlyphRule::Size::length ? out.rule.vectors : out.rule.size_field);
    note += fmt::format("; one of {}{} is {}{} long", short_number(out.of, 3), unit && !unit->unit.empty() ? " " + unit->unit : "",
                        short_number(out.longest, 3), in_pixels ? " pixels" : "");
  }
  out.note = note + out.note;
  return out;
}

DatasetPtr glyphs(const DatasetPtr& data, const GlyphsParams& p, Context& context) {
  const ChosenGlyphs c = choose_glyphs(data, p, false, context);
  context.info(c.note);
  return glyph_geometry(c.data, c.rule, c.shapes, context);
}

}  // namespace sg
