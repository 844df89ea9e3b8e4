// SPDX-License-Identifier: Apache-2.0
#include "render/volume/natural_units.h"

#include <fmt/core.h>

#include <cmath>
#include <cstring>

#include "base/parallel.h"
#include "color/widgets/transfer_widget.h"
#include "data/bricked.h"
#include "data/memory/memo.h"
#include "render/volume/effects/effects.h"
#include "render/volume/prepare_cast.h"

namespace sg::volume {

namespace {

/// Exponents of two. Slopes are told by the largest value and the diagonal: those between samples are steeper.
struct Window {
  int least, most;
  bool holds(int e) const { return e >= least && e <= most; }
};
constexpr Window values_near{-20, 30}, lengths_near{-20, 20}, slopes_near{-30, 25};

/// The exponent of a size; 0 for what is none.
int exponent(double size) { return size > 0 && std::isfinite(size) ? std::ilogb(size) : 0; }
/// The power of two that brings a number of that exponent near 1.
double factor_of(int e) { return std::ldexp(1.0, std::clamp(-e, -1020, 1020)); }

double size_of(const Dataset& d, const Field& f, int component) {
  double size = 0;
  for (int c = 0; c < f.components(); ++c) {
    if (component >= 0 && c != component) continue;
    const Range r = d.range(f, c);
    if (!r.empty()) size = std::max({size, std::abs(r.lo), std::abs(r.hi)});
  }
  return size;
}

/// The values that matter: a few that lie far beyond all that colours, opacity and levels tell apart do not.
double size_of(const VolumeItem& item, const Field& field) {
  const double all = size_of(*item.data, field, item.component);
  // The axis of these is not the values'.
  if (info_of(item.mode).collects()) return all;
  double told = std::max(std::abs(item.color.lo), std::abs(item.color.hi));
  for (const Vec2& p : item.opacity.points) told = std::max(told, std::abs(p.x));
  for (double l : item.levels) told = std::max(told, std::abs(l));
  return told > 0 ? std::min(all, told) : all;
}

/// In floats of the same width; what is a power of two larger or smaller is so exactly.
Array scaled(const Array& a, double factor) {
  if (a.empty() || factor == 1) return a;
  const auto times = [&]<class T>(T) {
    T* out = nullptr;
    Array r = Array::make<T>(a.count(), a.components(), &out);
    const Array packed = a.converted(std::is_same_v<T, float> ? ElementType::f32 : ElementType::f64).made_packed();
    const T* in = reinterpret_cast<const T*>(packed.raw());
    parallel_for(a.count() * size_t(a.components()), 65536, [&](size_t begin, size_t end) {
      for (size_t i = begin; i < end; ++i) out[i] = T(double(in[i]) * factor);
    });
    return r;
  };
  return a.type() == ElementType::f32 ? times(float()) : times(double());
}

Points scaled(Points p, double factor) {
  p.xyz = scaled(p.xyz, factor), p.origin = p.origin * factor;
  return p;
}

Mesh scaled(const Mesh& mesh, double factor) {
  if (factor == 1) return mesh;
  Mesh r = mesh;
  if (auto* uniform = std::get_if<UniformGrid>(&r))
    uniform->origin = uniform->origin * factor, uniform->spacing = uniform->spacing * factor;
  else if (auto* axes = std::get_if<RectilinearGrid>(&r))
    axes->x = scaled(axes->x, factor), axes->y = scaled(axes->y, factor), axes->z = scaled(axes->z, factor);
  else if (auto* curved = std::get_if<CurvilinearGrid>(&r)) curved->points = scaled(curved->points, factor);
  else if (auto* cells = std::get_if<UnstructuredMesh>(&r)) cells->points = scaled(cells->points, factor);
  else if (auto* surface = std::get_if<SurfaceMesh>(&r)) surface->points = scaled(surface->points, factor);
  else if (auto* cloud = std::get_if<PointCloud>(&r)) cloud->points = scaled(cloud->points, factor);
  else if (auto* amr = std::get_if<AmrGrid>(&r)) {
    amr->origin = amr->origin * factor;
    for (AmrGrid::Level& l : amr->levels) l.spacing = l.spacing * factor;
  }
  return r;
}

BrickedPtr scaled(const BrickedPtr& from, double value, double length) {
  auto r = std::make_shared<BrickedVolume>(*from);
  for (BrickedVolume::Level& l : r->levels) l.origin = l.origin * length, l.spacing = l.spacing * length;
  if (value == 1 || !is_float(from->type)) return r;
  for (BrickedVolume::Extremes& e : r->extremes) e.lo = float(double(e.lo) * value), e.hi = float(double(e.hi) * value);
  r->read = [from, value](size_t level, std::array<size_t, 3> lo, std::array<size_t, 3> count, std::byte* out) {
    from->read(level, lo, count, out);
    const size_t n = count[0] * count[1] * count[2];
    const auto times = [&]<class T>(T number) {
      for (size_t i = 0; i < n; ++i) {
        std::memcpy(&number, out + i * sizeof(T), sizeof(T));
        number = T(double(number) * value);
        std::memcpy(out + i * sizeof(T), &number, sizeof(T));
      }
    };
    from->type == ElementType::f32 ? times(float()) : times(double());
  };
  return r;
}

struct ScaledField {
  const Field* field;
  double factor;
};

/// The dataset with these fields and lengths in other units; made once.
DatasetPtr scaled(const DatasetPtr& data, const std::vector<ScaledField>& fields, double length) {
  std::string key = fmt::format("volume natural units: {}", length);
  for (const ScaledField& f : fields) key += fmt::format(" {} {} {}", int(f.field->association), f.factor, f.field->name);
  if (const auto kept = data->memo().find<DatasetPtr>(key)) return *kept;
  DatasetParts parts = data->parts();
  parts.mesh = scaled(parts.mesh, length);
  size_t bytes = 0;
  for (const ScaledField& f : fields) {
    if (f.factor == 1) continue;
    Field field = *f.field;
    field.array = scaled(field.array, f.factor);
    bytes += field.array.bytes();
    parts.fields.add(std::move(field));
  }
  BrickedPtr bricks = data->bricks();
  if (bricks) {
    double value = 1;
    for (const ScaledField& f : fields)
      if (f.field->name == bricks->field) value = f.factor;
    bricks = scaled(bricks, value, length);
  }
  return *data->memo().keep(key, make_dataset(std::move(parts), std::move(bricks)), bytes);
}

void scale_colors(ColorScale& s, double factor) {
  s.lo *= factor, s.hi *= factor, s.linear_threshold *= factor;
  for (double& l : s.limits) l *= factor;
}

void scale_places(OpacityCurve& c, double factor) {
  for (Vec2& p : c.points) p.x *= factor;
}

/// How the second axis of a transfer function grows with values and lengths.
double second_factor(SecondAxis axis, double value, double length, double other) {
  switch (axis) {
    case SecondAxis::gradient: return value / length;
    case SecondAxis::second_derivative: return value / length / length;
    case SecondAxis::curvature: return 1 / length;
    case SecondAxis::field: return other;
    case SecondAxis::none: break;
  }
  return 1;
}

void scale(VolumeItem& item, double value, double length) {
  const Field& field = field_of(item);
  std::vector<ScaledField> fields{{&field, value}};
  double other = 1;
  if (item.detail.second == SecondAxis::field) {
    if (const Field* second = item.data->fields().find(item.detail.second_field); second && second != &field) {
      const int e = exponent(size_of(*item.data, *second, -1));
      other = values_near.holds(e) ? 1 : factor_of(e);
      fields.push_back({second, other});
    } else if (second) {
      other = value;
    }
  }
  item.data = scaled(item.data, fields, length);
  // The axis of colours and opacity: values, values times lengths, or lengths.
  double shown = value;
  if (info_of(item.mode).axis == RayFunctionInfo::Axis::value_times_length) shown = value * length;
  if (info_of(item.mode).axis == RayFunctionInfo::Axis::length) shown = length;
  scale_colors(item.color, shown), scale_places(item.opacity, shown);
  for (double& l : item.levels) l *= value;
  item.unit_distance *= length, item.sampling.step *= length;
  for (ClipPlane& p : item.clip) p.offset *= length;
  TransferDetail& d = item.detail;
  const double second = second_factor(d.second, value, length, other);
  scale_colors(d.second_color, d.color_by_second ? second : 1), scale_places(d.second_factor, second);
  d.second_lo *= second, d.second_hi *= second;
  for (TransferWidget& w : d.widgets) {
    w.lo *= shown, w.hi *= shown, w.second_lo *= second, w.second_hi *= second;
    w.radius *= shown, w.second_radius *= second;
    for (Vec2& p : w.line) p.x *= shown, p.y *= second;
  }
}

}  // namespace

std::optional<NaturalScene> natural_scene(const Scene& scene) {
  Box3 bounds;
  std::vector<double> sizes(scene.items.size(), 0);
  const auto volume = [&](size_t i) { return std::get_if<VolumeItem>(&scene.items[i]); };
  for (size_t i = 0; i < scene.items.size(); ++i) {
    const VolumeItem* item = volume(i);
    if (!item) continue;
    check(*item);
    const Field& field = field_of(*item);
    const Box3& box = item->data->bounds();
    if (!box.empty()) bounds.add(box.lo), bounds.add(box.hi);
    // Labels are names, whatever numbers they have.
    if (item->color.labels.empty()) sizes[i] = size_of(*item, field);
  }
  NaturalScene natural;
  const int length = bounds.empty() ? 0 : exponent(bounds.diagonal());
  bool other_lengths = !lengths_near.holds(length), needed = other_lengths, shadows = false;
  std::vector<double> values(sizes.size(), 1);
  for (size_t i = 0; i < sizes.size(); ++i) {
    if (!volume(i)) continue;
    double size = sizes[i];
    for (size_t k = 0; k < sizes.size(); ++k)  // parts of a collection share their values
      if (volume(k) && volume(i)->group && volume(k)->group == volume(i)->group) size = std::max(size, sizes[k]);
    const int value = exponent(size);
    const bool steep = !slopes_near.holds(value - length);
    if (steep || !values_near.holds(value)) values[i] = factor_of(value);
    other_lengths = other_lengths || steep;
    needed = needed || steep || values[i] != 1, shadows = shadows || volume(i)->light.shadows > 0 || scatters_by_map(*volume(i));
  }
  if (other_lengths) natural.length = factor_of(length);
  if (!needed) return {};
  natural.scene = scene;
  for (size_t i = 0; i < scene.items.size(); ++i) {
    Item& item = natural.scene.items[i];
    if (volume(i)) scale(std::get<VolumeItem>(item), values[i], natural.length);
    else if (auto* surface = std::get_if<SurfaceItem>(&item); surface && shadows && natural.length != 1 && surface->data)
      surface->data = scaled(surface->data, {}, natural.length);
  }
  return natural;
}

Projection NaturalScene::projection(const Projection& world) const {
  Projection p = world;
  p.eye = p.eye * length, p.near_plane *= length, p.far_plane *= length;
  if (p.parallel) p.scale /= length;
  return p;
}

FragmentLists NaturalScene::fragments(FragmentLists world) const {
  for (Fragment& f : world.fragments) f.depth = float(double(f.depth) * length);
  return world;
}

}  // namespace sg::volume
