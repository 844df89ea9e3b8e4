// SPDX-License-Identifier: Apache-2.0
#include "scene/choose/view/stretch.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "data/fields/axis_notes.h"
#include "data/lattice.h"
#include "filter/mesh/transform/transform.h"

namespace sg {

namespace {

constexpr double height_of_map = 0.3;  // of what stands on it, as a share of the map's larger side

double cosine_of_middle(const Box3& box) {
  const double middle = 0.5 * (box.lo.y + box.hi.y), c = std::cos(middle * std::numbers::pi / 180);
  return box.lo.y < -90.01 || box.hi.y > 90.01 || c < 0.05 ? 1 : c;  // no latitudes, or a pole
}

}  // namespace

Vec3 chosen_stretch(std::span<const DatasetPtr> data, const Box3& box) {
  Vec3 f{1, 1, 1};
  if (box.empty()) return f;
  for (const DatasetPtr& d : data) {
    const auto x = axis_note(*d, 0), y = axis_note(*d, 1), z = axis_note(*d, 2);
    if (!x && !y && !z) continue;
    const bool map = x && y && x->in_degrees() && y->in_degrees();
    if (map) f.x = cosine_of_middle(box);
    for (int a = 0; a < 2; ++a)  // sections and profiles: depth or pressure along y
      if (const auto& note = a == 0 ? x : y; note && note->down()) f[a] = -f[a];
    const Vec3 s = box.size();
    if (z && s.z > 0) {
      const double wide = std::max(s.x * std::abs(f.x), s.y);
      const bool other = map && !z->in_degrees() && wide > 0;
      f.z = (z->down() ? -1 : 1) * (other ? height_of_map * wide / s.z : 1);
    }
    return f;
  }
  return f;
}

bool is_unstated_depth(const Dataset& d, const Field& field) {
  constexpr double fewer = 0.9, slack = 1.02;
  const auto x = axis_note(d, 0), y = axis_note(d, 1), z = axis_note(d, 2);
  if (!is_lattice(d.mesh()) || !x || !y || !z || !x->in_degrees() || !y->in_degrees() || z->unit != "m" || !z->positive.empty() ||
      z->down())
    return false;
  const auto dims = lattice_dims(d.mesh());
  if (field.association != Association::point || dims[2] < 3 || d.bounds().lo.z < 0) return false;
  const size_t layer = dims[0] * dims[1];
  std::vector<double> values(dims[2], 0.0);
  for (size_t k = 0; k < dims[2]; ++k)
    for (size_t i = 0; i < layer; ++i) values[k] += std::isfinite(field.array.get(k * layer + i));
  for (size_t k = 1; k < dims[2]; ++k)
    if (values[k] > slack * values[k - 1]) return false;
  return values.back() < fewer * values.front();
}

DatasetPtr stretched(const DatasetPtr& data, Vec3 factors, const Context& context) {
  if (factors == Vec3{1, 1, 1}) return data;
  TransformParams p;
  p.scale = factors;
  p.fields.unmarked = false;
  for (const Field& f : data->fields())
    if (f.role != Role::normals) p.fields.keep.push_back(f.name);
  Context quiet(context, 0, 1);
  quiet.on_log = nullptr;
  return transform(data, p, quiet);
}

}  // namespace sg
