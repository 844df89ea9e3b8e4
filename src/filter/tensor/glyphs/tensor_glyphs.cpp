// SPDX-License-Identifier: Apache-2.0
#include "filter/tensor/glyphs/tensor_glyphs.h"

#include <fmt/core.h>

#include <map>

#include "base/error.h"
#include "base/parallel.h"
#include "data/cells/point_positions.h"
#include "data/cells/shape/cell_map.h"
#include "data/field_ops.h"
#include "data/lattice.h"
#include "filter/tensor/glyphs/glyph_shapes.h"
#include "filter/tensor/tensor_measures.h"
#include "filter/tensor/tensor_shape.h"

namespace sg {

namespace {

struct Chosen {
  std::vector<int64_t> ids;
  std::vector<Vec3> at;
  std::vector<Eigen3> eigen;
  double spacing = 0;
  size_t with_negative = 0;
  bool negative() const { return with_negative > 0; }
  /// Stress rather than diffusion with some noise.
  bool mostly_signed() const { return 10 * with_negative > ids.size(); }
};

double fa_of(const Eigen3& e, int dimension) { return dimension == 2 ? fractional_anisotropy_2d(e.value) : fractional_anisotropy(e.value); }
double largest_of(const Eigen3& e) { return std::max({std::abs(e.value[0]), std::abs(e.value[1]), std::abs(e.value[2])}); }

// The colour of a direction, paler the less it is preferred: black balls would hide their shape.
void paled_direction(Vec3 v, double fa, uint8_t* rgb) {
  direction_color(v, 1, rgb);
  const double w = std::min(1.0, 1.5 * fa);
  for (int c = 0; c < 3; ++c) rgb[c] = uint8_t(std::round(w * rgb[c] + (1 - w) * 215));
}

double signed_share(const Eigen3& e) {
  const double* l = e.value;
  return (l[0] + l[1] + l[2]) / (std::abs(l[0]) + std::abs(l[1]) + std::abs(l[2]));
}

// Where the tensors lie, one place a tuple.
std::vector<Vec3> places_of(const DatasetPtr& in, Association a) {
  std::vector<Vec3> at;
  if (a == Association::point) {
    const Array xyz = point_positions(in->mesh());
    at.resize(xyz.count());
    for (size_t i = 0; i < at.size(); ++i) at[i] = {xyz.get(i, 0), xyz.get(i, 1), xyz.get(i, 2)};
    return at;
  }
  at.resize(in->cell_count());
  CellMap map(in);
  for (size_t c = 0; c < at.size(); ++c) map.open(c), at[c] = map.center();
  return at;
}

std::vector<uint8_t> usable(const DatasetPtr& in, const TensorField& t, const TensorGlyphsParams& p, size_t& unusable) {
  std::vector<uint8_t> good(t.d.size());
  const Association a = t.field.association;
  const Array& ghost = a == Association::point ? in->point_ghost() : in->cell_ghost();
  const uint8_t hiding = a == Association::point ? ghost_hidden_point : ghost_hidden_cell | ghost_refined_cell | ghost_duplicate;
  Array mask;
  if (!p.mask.empty()) mask = in->fields().require(p.mask.name, a).array;
  unusable = 0;
  for (size_t i = 0; i < good.size(); ++i) {
    const bool hidden = !ghost.empty() && (uint8_t(ghost.get(i)) & hiding);
    good[i] = !hidden && t.d[i].finite() && t.d[i].max_abs() > 0 && (mask.empty() || mask.get(i) > 0);
    if (good[i] && p.min_fa > 0) good[i] = fa_of(t.eigen(i), t.dimension) >= p.min_fa;
    unusable += !good[i];
  }
  return good;
}

// Every stride-th place along the axes of a grid. Stride 0: the finest with no more than `count` places that can be used.
std::vector<int64_t> on_lattice(std::array<size_t, 3> dims, const std::vector<uint8_t>& good, int64_t stride, int64_t count,
                                int64_t& used) {
  for (used = std::max<int64_t>(stride, 1);; ++used) {
    std::vector<int64_t> ids;
    const size_t s = size_t(used);
    // The places left over are shared by both ends.
    size_t first[3];
    for (size_t a = 0; a < 3; ++a) first[a] = (dims[a] - 1) % s / 2;
    for (size_t k = first[2]; k < dims[2]; k += s)
      for (size_t j = first[1]; j < dims[1]; j += s)
        for (size_t i = first[0]; i < dims[0]; i += s) {
          const size_t at = i + dims[0] * (j + dims[1] * k);
          if (good[at]) ids.push_back(int64_t(at));
        }
    if (stride > 0 || int64_t(ids.size()) <= count || used > 1000000) return ids;
  }
}

int extents(const Box3& box, double& volume) {
  const Vec3 size = box.size();
  const double most = std::max({size.x, size.y, size.z});
  int dimension = 0;
  volume = 1;
  for (int a = 0; a < 3; ++a)
    if (size[a] > 1e-6 * most) volume *= size[a], ++dimension;
  return dimension;
}

// A long and narrow box is small on the picture: no more glyphs along it than can be distinguished.
int64_t fitting(const DatasetPtr& in, const TensorGlyphsParams& p) {
  if (p.count > 0) return p.count;
  const Vec3 size = in->bounds().size();
  const double step = std::max({size.x, size.y, size.z}) / 30;
  double most = 1;
  if (step > 0)
    for (int a = 0; a < 3; ++a) most *= std::max(size[a] / step, 1.0);
  return step > 0 && most < 600 ? std::max<int64_t>(int64_t(most), 40) : 600;  // 600 for a box beyond doubles
}

// The usable place nearest to the middle of each cube; the cubes grow until there are few enough.
std::vector<int64_t> in_cubes(const std::vector<Vec3>& at, const std::vector<uint8_t>& good, int64_t count, double& edge) {
  Box3 box;
  for (size_t i = 0; i < at.size(); ++i)
    if (good[i]) box.add(at[i]);
  std::vector<int64_t> all;
  for (size_t i = 0; i < at.size(); ++i)
    if (good[i]) all.push_back(int64_t(i));
  edge = 0;
  if (int64_t(all.size()) <= count || box.empty()) return all;
  double volume = 1;
  const int dimension = extents(box, volume);
  for (edge = std::pow(volume / double(count), 1.0 / std::max(dimension, 1)) * 0.8;; edge *= 1.05) {
    std::map<std::array<int64_t, 3>, std::pair<double, int64_t>> nearest;
    for (int64_t i : all) {
      const Vec3 q = (at[size_t(i)] - box.lo) / edge;
      const std::array<int64_t, 3> cube{int64_t(q.x), int64_t(q.y), int64_t(q.z)};
      const Vec3 off = q - Vec3(double(cube[0]) + 0.5, double(cube[1]) + 0.5, double(cube[2]) + 0.5);
      const std::pair<double, int64_t> mine{dot(off, off), i};
      const auto [there, fresh] = nearest.try_emplace(cube, mine);
      if (!fresh) there->second = std::min(there->second, mine);
    }
    if (int64_t(nearest.size()) > count) continue;
    std::vector<int64_t> ids;
    for (const auto& [cube, place] : nearest) ids.push_back(place.second);
    std::sort(ids.begin(), ids.end());
    return ids;
  }
}

// Median distance to the nearest other place: keeps glyphs on curves and in clusters separate. 0 when there are too many to look at.
double usual_distance(const std::vector<Vec3>& at) {
  if (at.size() < 2 || at.size() > 5000) return 0;
  std::vector<double> nearest(at.size(), HUGE_VAL);
  for (size_t i = 0; i < at.size(); ++i)
    for (size_t j = i + 1; j < at.size(); ++j) {
      const Vec3 off = at[i] - at[j];
      const double d = dot(off, off);
      nearest[i] = std::min(nearest[i], d), nearest[j] = std::min(nearest[j], d);
    }
  std::nth_element(nearest.begin(), nearest.begin() + ptrdiff_t(nearest.size() / 2), nearest.end());
  return std::sqrt(nearest[nearest.size() / 2]);
}

Chosen choose(const DatasetPtr& in, const TensorField& t, const TensorGlyphsParams& p, Context& ctx) {
  Chosen c;
  size_t unusable = 0;
  const std::vector<uint8_t> good = usable(in, t, p, unusable);
  const std::vector<Vec3> at = places_of(in, t.field.association);
  const bool cells = t.field.association == Association::cell;
  if (is_lattice(in->mesh())) {
    auto dims = lattice_dims(in->mesh());
    if (cells)
      for (size_t& n : dims) n = std::max<size_t>(n, 2) - 1;
    int64_t stride = 0;
    c.ids = on_lattice(dims, good, p.stride, fitting(in, p), stride);
    // The shortest distance between neighbours along the axes, at the middle of the grid.
    c.spacing = HUGE_VAL;
    const size_t middle = dims[0] / 2 + dims[0] * (dims[1] / 2 + dims[1] * (dims[2] / 2));
    const size_t step[3] = {1, dims[0], dims[0] * dims[1]};
    for (size_t a = 0; a < 3; ++a)
      if (dims[a] > 1) c.spacing = std::min(c.spacing, length(at[middle] - at[middle - step[a]]) * double(stride));
    if (!std::isfinite(c.spacing)) c.spacing = 1;
    if (stride > 1 && p.stride == 0)
      ctx.info(fmt::format("tensor_glyphs: stride {} along each axis ({} of {})", stride, c.ids.size(), at.size()));
  } else {
    std::vector<uint8_t> kept = good;
    if (p.stride > 1)
      for (size_t i = 0; i < kept.size(); ++i) kept[i] = kept[i] && i % size_t(p.stride) == 0;
    double edge = 0;
    c.ids = in_cubes(at, kept, p.stride > 0 ? int64_t(at.size()) : fitting(in, p), edge);
    Box3 box;
    std::vector<Vec3> chosen;
    for (int64_t i : c.ids) box.add(at[size_t(i)]), chosen.push_back(at[size_t(i)]);
    double volume = 1;
    const int dimension = box.empty() ? 0 : extents(box, volume);
    c.spacing = usual_distance(chosen);
    if (!(c.spacing > 0)) c.spacing = dimension > 0 ? std::pow(volume / double(c.ids.size()), 1.0 / dimension) : 1;
    if (edge > 0) ctx.info(fmt::format("tensor_glyphs: {} of {} points, about {:.3g} apart", c.ids.size(), at.size(), c.spacing));
  }
  if (unusable > 0)
    ctx.info(fmt::format("tensor_glyphs: {} of {} tensors get no glyph (zero, no value, hidden, masked or FA below min_fa)", unusable,
                         at.size()));
  for (int64_t i : c.ids) {
    c.at.push_back(at[size_t(i)]);
    c.eigen.push_back(t.eigen(size_t(i)));
    const double* v = c.eigen.back().value;
    c.with_negative += std::min(v[1], v[2]) < -1e-6 * largest_of(c.eigen.back());
  }
  return c;
}

// Half axis by eigenvalue of each glyph.
std::vector<double> factors(const Chosen& c, TensorShape shape, const TensorGlyphsParams& p, Context& ctx) {
  std::vector<double> m;
  for (const Eigen3& e : c.eigen) m.push_back(shape == TensorShape::hwy ? std::abs(e.value[0] - e.value[2]) / 2 : largest_of(e));
  std::vector<double> f(m.size(), p.factor.value_or(1));
  if (m.empty() || p.factor) return f;
  std::vector<double> sorted = m;
  std::sort(sorted.begin(), sorted.end());
  const double most = sorted.back(), median = sorted[sorted.size() / 2], half = p.size * c.spacing / 2;
  double longest = most;  // larger ones are drawn as if they were that large
  const bool wide = most > (c.with_negative == 0 ? 5 : 2.5) * median;
  const TensorScale scale = p.scale.value_or(wide ? TensorScale::log : TensorScale::eigenvalues);
  if (!p.scale) {
    if (scale == TensorScale::eigenvalues && c.with_negative == 0) longest = std::min(most, 1.6 * median);
    ctx.info(fmt::format("tensor_glyphs: scale={}; the largest eigenvalue is {:.3g} times the median{}", word_of(scale), most / median,
                         longest < most ? "; those above 1.6 times it are drawn at that size" : ""));
  }
  const double low = median > 0 ? median / 50 : most;
  for (size_t i = 0; i < m.size(); ++i) {
    if (!(m[i] > 0)) f[i] = 0;
    else if (scale == TensorScale::eigenvalues) f[i] = half / std::max(m[i], longest);
    else if (scale == TensorScale::normalized) f[i] = half / m[i];
    else f[i] = half * std::log1p(m[i] / low) / std::log1p(most / low) / m[i];
  }
  return f;
}

struct Surface {
  SurfaceMesh mesh;
  Array normals, relative, sign;
};

Surface build(const Chosen& c, const GlyphPattern& pattern, const std::vector<double>& factor, bool shear, const Context& ctx) {
  const size_t n = c.ids.size(), nv = pattern.vertices(), corners = pattern.ids().size(), faces = pattern.offsets().size() - 1;
  if (n * std::max(corners, nv) >= (size_t(1) << 31))
    fail_usage(fmt::format("{} glyphs of {} corners are too many for one surface", n, corners), "tensor_glyphs",
               "reduce count or resolution, or increase stride");
  Surface s;
  float *xyz = nullptr, *normals = nullptr, *relative = nullptr;
  int8_t* sign = nullptr;
  int32_t *ids = nullptr, *offsets = nullptr;
  s.mesh.points.xyz = Array::make<float>(n * nv, 3, &xyz);
  s.normals = Array::make<float>(n * nv, 3, &normals);
  s.relative = Array::make<float>(n * nv, 1, &relative);
  s.sign = Array::make<int8_t>(n * nv, 1, &sign);
  Box3 box;
  for (Vec3 p : c.at) box.add(p);
  const Vec3 origin = box.empty() ? Vec3() : box.center();
  s.mesh.points.origin = origin;
  if (n > 0) {
    s.mesh.polygons.connectivity = Array::make<int32_t>(n * corners, 1, &ids);
    s.mesh.polygons.offsets = Array::make<int32_t>(n * faces + 1, 1, &offsets);
    offsets[n * faces] = int32_t(n * corners);
  }
  parallel_for(
      n, 16,
      [&](size_t begin, size_t end) {
        std::vector<GlyphVertex> v(nv);
        for (size_t g = begin; g < end; ++g) {
          const Eigen3& e = c.eigen[g];
          pattern.make(e, factor[g], v.data());
          const double most = largest_of(e);
          for (size_t i = 0; i < nv; ++i) {
            const size_t to = g * nv + i;
            double nsn = 0, square = 0;
            for (int k = 0; k < 3; ++k) {
              const double x = dot(v[i].direction, e.vector[k]);
              nsn += e.value[k] * x * x, square += e.value[k] * e.value[k] * x * x;
            }
            for (int a = 0; a < 3; ++a)
              xyz[3 * to + size_t(a)] = float(c.at[g][a] + v[i].at[a] - origin[a]), normals[3 * to + size_t(a)] = float(v[i].normal[a]);
            relative[to] = float((shear ? std::sqrt(std::max(0.0, square - nsn * nsn)) : nsn) / most);
            sign[to] = int8_t(nsn > 0 ? 1 : nsn < 0 ? -1 : 0);
          }
          for (size_t i = 0; i < corners; ++i) ids[g * corners + i] = int32_t(g * nv) + pattern.ids()[i];
          for (size_t i = 0; i < faces; ++i) offsets[g * faces + i] = int32_t(g * corners) + pattern.offsets()[i];
        }
      },
      &ctx);
  return s;
}

template <class T, class F>
Array repeated(const Chosen& c, size_t nv, int components, F&& f) {
  T* out = nullptr;
  Array a = Array::make<T>(c.ids.size() * nv, components, &out);
  for (size_t g = 0; g < c.ids.size(); ++g) {
    T v[4];
    f(g, v);
    for (size_t i = 0; i < nv; ++i, out += components) std::copy_n(v, components, out);
  }
  return a;
}

}  // namespace

void describe(Schema& s, TensorGlyphsParams& p) {
  describe_tensors(s, p.tensors);
  s("shape", p.shape,
    "Shape of a tensor: half axes by the eigenvalues, or lobes by the normal (reynolds) or shear stress (hwy) across each direction.");
  s("gamma", p.gamma, "Sharpness of the edges of superquadrics; 0: ellipsoids.").at_least(0);
  s("min_ratio", p.min_ratio, "Half axes below this share of the longest are drawn at it, so that thin glyphs stay visible; not for lobes.")
      .range(0, 1);
  s("count", p.count, "Approximate maximum number of glyphs if no stride is given; 0: 600, fewer in long and narrow data.").range(0, 1e7);
  s("stride", p.stride, "Place a glyph at every n-th point along each axis; 0: from count.").at_least(0);
  s("mask", p.mask, "Field that is above 0 where glyphs may be placed.");
  s("min_fa", p.min_fa, "Place no glyphs where the fractional anisotropy is below this.").range(0, 10);
  s("scale", p.scale,
    "Size by the eigenvalues, by their logarithm, or normalized (all of one size); auto: log if the largest is more than 5 times the "
    "median (2.5 times with negative ones), else eigenvalues, limited to 1.6 times the median for positive tensors.");
  s("size", p.size, "Length of the longest glyph, as a share of the distance between glyphs.").positive();
  s("factor", p.factor, "Half axes are the absolute eigenvalues times this, instead of scale and size.").positive();
  s("color", p.color,
    "Colour by direction (red x, green y, blue z), FA, sign, none, or the name of a field; auto: the relative stress for lobes, the signed "
    "share if more than a tenth have negative eigenvalues, else direction.");
  s("resolution", p.resolution, "Number of rows of faces from pole to pole.").range(2, 200);
}

DatasetPtr tensor_glyphs(const DatasetPtr& in, const TensorGlyphsParams& p, Context& ctx) {
  const TensorField t = read_tensors(*in, p.tensors, "tensor_glyphs", ctx);
  const TensorShape shape = p.shape;
  const bool lobes = shape == TensorShape::reynolds || shape == TensorShape::hwy, shear = shape == TensorShape::hwy;
  const std::optional<TensorColor> color = value_of_word<TensorColor>(p.color.value_or(""));
  const bool named = p.color && !color;
  if (named) in->fields().require(*p.color, t.field.association);
  const Chosen c = choose(in, t, p, ctx);
  const bool relative = !p.color && (c.mostly_signed() || lobes);
  const bool by_direction = p.color ? color == TensorColor::direction : !relative;
  const GlyphPattern pattern(shape, p.resolution, p.gamma, p.min_ratio);
  Surface s = build(c, pattern, factors(c, shape, p, ctx), shear, ctx);
  const size_t nv = pattern.vertices();

  DatasetParts parts;
  parts.mesh = std::move(s.mesh);
  auto add = [&](std::string name, Array a, Role role = Role::none, std::string unit = "") {
    parts.fields.add({std::move(name), Association::point, std::move(a), std::move(unit), role});
  };
  const Role chosen = relative ? Role::scalars : Role::none;
  if (relative && !lobes)
    ctx.info("tensor_glyphs: 'signed share' is 1 where all eigenvalues are positive (tension), -1 where all are negative (compression)");
  if (lobes) add(shear ? "relative shear stress" : "relative normal stress", s.relative, chosen);
  if (c.negative())
    add("signed share", repeated<float>(c, nv, 1, [&](size_t g, float* v) { *v = float(signed_share(c.eigen[g])); }),
        lobes ? Role::none : chosen);
  if (c.negative() || lobes || color == TensorColor::sign) add("sign", s.sign, color == TensorColor::sign ? Role::scalars : Role::none);
  const int d = t.dimension;
  add("FA", repeated<float>(c, nv, 1, [&](size_t g, float* v) { *v = float(fa_of(c.eigen[g], d)); }),
      color == TensorColor::fa ? Role::scalars : Role::none);
  for (int k = 0; k < d; ++k)
    add(fmt::format("eigenvalue {}", k + 1), repeated<float>(c, nv, 1, [&](size_t g, float* v) { *v = float(c.eigen[g].value[k]); }),
        Role::none, t.field.unit);
  if (by_direction)
    add("direction",
        repeated<uint8_t>(c, nv, 3, [&](size_t g, uint8_t* v) { paled_direction(c.eigen[g].vector[0], fa_of(c.eigen[g], d), v); }),
        Role::colors);
  add("Normals", s.normals, Role::normals);
  std::vector<int64_t> ids(c.ids.size() * nv);
  for (size_t i = 0; i < ids.size(); ++i) ids[i] = c.ids[i / nv];
  for (const Field& f : in->fields()) {
    if (f.association != t.field.association || f.name == t.field.name || f.role == Role::normals ||
        parts.fields.find(f.name, Association::point))
      continue;
    const Role role = named && f.name == *p.color ? Role::scalars : f.role == Role::scalars || f.role == Role::colors ? Role::none : f.role;
    add(f.name, gather(f.array, ids), role, f.unit);
  }
  add(t.field.association == Association::point ? "original_point" : "original_cell", Array::from_vector(std::move(ids)), Role::global_ids);
  parts.time = in->time();
  return make_dataset(std::move(parts));
}

}  // namespace sg
