// SPDX-License-Identifier: Apache-2.0
#include "filter/mesh/transform/transform_fields.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/parallel.h"
#include "base/text/text.h"
#include "filter/tensor/tensor_field.h"

namespace sg {

namespace {

constexpr size_t values_per_chunk = 1 << 13;

bool listed(const std::vector<std::string>& names, const std::string& name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

std::string lower(std::string s) {
  for (char& c : s)
    if (c >= 'A' && c <= 'Z') c = char(c - 'A' + 'a');
  return s;
}

// Names of three numbers that are not a direction in space.
bool says_colors_or_texture(const std::string& name) {
  const std::string s = lower(name);
  for (const char* word : {"color", "colour", "rgb", "hsv", "albedo", "diffuse_", "texture", "texcoord", "tcoord"})
    if (s.find(word) != std::string::npos) return true;
  return s == "uv" || s == "uvw" || s == "st" || s == "str" || s == "diffuse" || s == "specular" || s == "ambient";
}

FieldLaw vector_law(const Field& f) {
  const std::string s = lower(f.name);
  if (s.starts_with("gradient(") || s == "gradient") return FieldLaw::gradient;
  if (s.starts_with("curl(") || s == "curl" || s.find("vorticity") != std::string::npos) return FieldLaw::axial;
  return FieldLaw::vector;
}

FieldLaw tensor_law(const Field& f) {
  const std::string s = lower(f.name);
  const bool full = f.components() == 9 || f.components() == 4;
  if (full && (s.starts_with("gradient(") || s == "gradient")) return FieldLaw::vector_gradient;
  if (s.starts_with("hessian(") || s == "hessian") return FieldLaw::hessian;
  return FieldLaw::tensor;
}

bool tensor_size(int n) { return n == 9 || n == 7 || n == 6 || n == 4; }

FieldLaw named_law(const Field& f, const FieldLawParams& p) {
  const int n = f.components();
  if (listed(p.gradients, f.name))
    return n == 9 || n == 4 ? FieldLaw::vector_gradient : tensor_size(n) ? FieldLaw::hessian : FieldLaw::gradient;
  if (listed(p.axial, f.name)) return FieldLaw::axial;
  if (f.role == Role::normals && n == 3) return FieldLaw::normal;
  if (tensor_size(n) || (n == 3 && p.order == TensorOrder::plane)) return tensor_law(f);
  return vector_law(f);
}

// The linear maps on the left and on the right of a value as a column or a matrix.
struct Maps {
  Mat3 left, right;  // T' = left T right^T; vectors: left v
};
Maps maps_of(FieldLaw law, const Mat3& m) {
  const Mat3 dual = transpose(inverse(m));
  switch (law) {
    case FieldLaw::normal:
    case FieldLaw::gradient: return {dual, dual};
    case FieldLaw::hessian: return {dual, dual};
    case FieldLaw::vector_gradient: return {m, dual};
    case FieldLaw::axial: {
      const double d = determinant(m), s = (d < 0 ? -1 : 1) / std::cbrt(std::abs(d));
      Mat3 r = m;
      for (auto& row : r.m)
        for (double& x : row) x *= s;
      return {r, r};
    }
    default: return {m, m};
  }
}

bool leaves_plane(const Mat3& m) { return m.m[2][0] != 0 || m.m[2][1] != 0; }

bool is_tensor(FieldLaw law) { return law == FieldLaw::tensor || law == FieldLaw::vector_gradient || law == FieldLaw::hessian; }

ElementType float_type(ElementType t) { return is_float(t) ? t : element_size(t) <= 2 ? ElementType::f32 : ElementType::f64; }

// f(in, out) for every tuple: `components` numbers to `wanted` numbers.
template <class F>
Array changed(const Array& a, int wanted, const Context& ctx, F&& f) {
  const ElementType type = float_type(a.type());
  std::byte* to = nullptr;
  Array r = Array::make_raw(type, a.count(), wanted, &to);
  dispatch(a, [&](auto v) {
    parallel_for(
        v.count, values_per_chunk,
        [&](size_t begin, size_t end) {
          double in[9], out[9];
          for (size_t i = begin; i < end; ++i) {
            for (int c = 0; c < v.components; ++c) in[c] = double(v(i, c));
            f(in, out);
            for (int c = 0; c < wanted; ++c) {
              const size_t at = i * size_t(wanted) + size_t(c);
              if (type == ElementType::f32) reinterpret_cast<float*>(to)[at] = float(out[c]);
              else reinterpret_cast<double*>(to)[at] = out[c];
            }
          }
        },
        &ctx);
  });
  return r;
}

Array changed_vectors(const Field& f, FieldLaw law, const Maps& maps, const Context& ctx) {
  const bool flat = f.components() == 2;
  return changed(f.array, flat && leaves_plane(maps.left) ? 3 : f.components(), ctx, [&](const double* in, double* out) {
    Vec3 v = maps.left * Vec3(in[0], in[1], flat ? 0 : in[2]);
    if (law == FieldLaw::normal) v = normalize(v);
    out[0] = v.x, out[1] = v.y, out[2] = v.z;
  });
}

// An explicit order applies to fields of its size.
bool order_fits(std::optional<TensorOrder> order, int n) {
  if (order == TensorOrder::rows) return n == 9 || n == 4;
  if (order == TensorOrder::masked) return n == 7;
  if (order == TensorOrder::plane) return n == 3;
  return n == 6;
}

Array changed_tensors(const Field& f, const FieldLawParams& p, const Maps& maps, const Context& ctx) {
  const int n = f.components();
  const TensorPlaces places = tensor_places(f, order_fits(p.order, n) ? p.order : std::nullopt, "transform");
  const bool leaves = n < 6 && (leaves_plane(maps.left) || leaves_plane(maps.right));
  const TensorPlaces to = leaves ? TensorPlaces{0, 4, 8, 1, 5, 2, 3, 7, 6} : places;
  return changed(f.array, leaves ? 9 : n, ctx, [&](const double* in, double* out) {
    const auto get = [&](size_t k, double other) { return places[k] < 0 ? other : in[places[k]]; };
    const double xy = get(3, 0), yz = get(4, 0), xz = get(5, 0);
    Mat3 t;
    t.m[0][0] = get(0, 0), t.m[1][1] = get(1, 0), t.m[2][2] = get(2, 0);
    t.m[0][1] = xy, t.m[1][2] = yz, t.m[0][2] = xz;
    t.m[1][0] = get(6, xy), t.m[2][1] = get(7, yz), t.m[2][0] = get(8, xz);
    const Mat3 r = maps.left * t * transpose(maps.right);
    if (n == 7) out[0] = in[0];  // the mask
    const double value[9] = {r.m[0][0], r.m[1][1], r.m[2][2], r.m[0][1], r.m[1][2], r.m[0][2], r.m[1][0], r.m[2][1], r.m[2][0]};
    for (size_t k = 0; k < 9; ++k)
      if (to[k] >= 0) out[to[k]] = value[k];
  });
}

void check_names(const Dataset& d, const FieldLawParams& p) {
  for (const auto* names : {&p.turn, &p.keep, &p.gradients, &p.axial})
    for (const std::string& name : *names) d.fields().require(name);
  for (const auto* names : {&p.turn, &p.gradients, &p.axial})
    for (const std::string& name : *names)
      for (const Field& f : d.fields())
        if (f.name == name && f.association != Association::whole) {
          const int n = f.components();
          const bool fits = names == &p.axial ? n == 3 : n == 2 || n == 3 || tensor_size(n);
          if (!fits)
            fail_usage(fmt::format("field '{}' has {} component{}, which cannot be transformed", name, n, n == 1 ? "" : "s"), "transform",
                       "vectors have 2 or 3 components, axial vectors 3, tensors 9, 7, 6 or 4");
        }
}

}  // namespace

FieldLaw field_law(const Dataset& d, const Field& f, const FieldLawParams& p) {
  const int n = f.components();
  if (f.association == Association::whole || listed(p.keep, f.name)) return FieldLaw::none;
  if (listed(p.turn, f.name) || listed(p.gradients, f.name) || listed(p.axial, f.name)) return named_law(f, p);
  if (f.role == Role::normals) return n == 3 ? FieldLaw::normal : FieldLaw::none;
  if (f.role == Role::vectors) return n == 2 || n == 3 ? vector_law(f) : FieldLaw::none;
  if (f.role == Role::tensors) return tensor_size(n) || n == 3 ? tensor_law(f) : FieldLaw::none;
  const bool plain = f.role == Role::none || f.role == Role::scalars;
  if (!p.unmarked || !plain || !is_float(f.array.type()) || says_colors_or_texture(f.name)) return FieldLaw::none;
  if (n == 3) return vector_law(f);
  if (n == 9 || n == 6) return tensor_law(f);
  if (n == 2 && d.bounds().size().z == 0) return vector_law(f);  // a flow of the plane
  return FieldLaw::none;
}

void transform_fields(const Dataset& d, const Mat3& linear, const FieldLawParams& p, FieldSet& out, Context& ctx) {
  check_names(d, p);
  if (linear == Mat3()) return;
  std::string guessed;
  for (const Field& f : d.fields()) {
    const FieldLaw law = field_law(d, f, p);
    if (law == FieldLaw::none) continue;
    const Maps maps = maps_of(law, linear);
    FieldLawParams order = p;
    if (f.components() == 3 && f.role == Role::tensors && !p.order) order.order = TensorOrder::plane;
    Array a = is_tensor(law) ? changed_tensors(f, order, maps, ctx) : changed_vectors(f, law, maps, ctx);
    if (a.components() != f.components())
      ctx.info(fmt::format("transform: '{}' leaves the plane and now has {} components", f.name, a.components()));
    if ((f.role == Role::none || f.role == Role::scalars) && !listed(p.turn, f.name) && !listed(p.gradients, f.name) &&
        !listed(p.axial, f.name))
      guessed += fmt::format("{}'{}' ({})", guessed.empty() ? "" : ", ", f.name, is_tensor(law) ? "tensors" : "vectors");
    out.add(f.with(std::move(a)));
  }
  if (!guessed.empty())
    ctx.info(fmt::format("transform: also transforms {}, though they are not marked as such; keep=NAME leaves a field unchanged", guessed));
}

}  // namespace sg
