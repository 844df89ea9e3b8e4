// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "pipeline/offline/pack/json_text.h"
#include "pipeline/offline/pack/pack_items.h"
#include "pipeline/offline/pack/page_lattice.h"
#include "render/volume/sources/item_checks.h"

namespace sg::offline {

namespace {

constexpr size_t histogram_bins = 256;

// Values that colours, opacity and levels tell apart, with a margin in which opacity may be moved.
Range told_values(const VolumeItem& item, Range all) {
  const RayFunctionInfo& info = info_of(item.mode);
  if (all.empty() || info.collects() || item.mode == RayFunction::average) return all;
  Range told;
  const auto take = [&](double v) { told.add(Range{v, v}); };
  if (item.color.labels.empty()) take(item.color.lo), take(item.color.hi);
  for (const double l : item.color.labels) take(l);
  for (const Vec2& p : item.opacity.points) take(p.x);
  for (const double l : item.levels) take(l);
  const double margin = 0.1 * (told.hi - told.lo);
  const double lo = std::max(all.lo, told.lo - margin), hi = std::min(all.hi, told.hi + margin);
  return lo < hi ? Range{lo, hi} : all;
}

// Cells that a sample without value touches; where samples are cells, those samples themselves.
std::vector<uint8_t> left_out(const PageLattice& l, bool& any) {
  any = !l.hidden.empty() && std::any_of(l.hidden.begin(), l.hidden.end(), [](uint8_t h) { return h; });
  const auto is_nan = [&](size_t i, size_t j, size_t k) {
    const float v = l.values[i + l.dims[0] * (j + l.dims[1] * k)];
    return v != v;
  };
  const size_t less = l.cells ? 0 : 1, nx = l.dims[0] - less, ny = l.dims[1] - less, nz = l.dims[2] - less;
  std::vector<uint8_t> out(nx * ny * nz);
  for (size_t k = 0, n = 0; k < nz; ++k)
    for (size_t j = 0; j < ny; ++j)
      for (size_t i = 0; i < nx; ++i, ++n) {
        bool gone = is_nan(i, j, k);
        for (size_t c = 1; c < 8 && !l.cells && !gone; ++c) gone = is_nan(i + (c & 1), j + (c >> 1 & 1), k + (c >> 2));
        if (!l.cells && !l.hidden.empty()) gone = gone || l.hidden[n];
        out[n] = gone ? 255 : 0, any = any || gone;
      }
  return out;
}

// Samples without a value take the mean of those around, so that interpolation beside them stays near what there is.
void fill_gaps(PageLattice& l) {
  const std::vector<float> before = l.values;
  const auto n = l.dims;
  parallel_for(n[2], 1, [&](size_t k, size_t) {
    for (size_t j = 0; j < n[1]; ++j)
      for (size_t i = 0; i < n[0]; ++i) {
        float& v = l.values[i + n[0] * (j + n[1] * k)];
        if (v == v) continue;
        double sum = 0;
        int count = 0;
        for (size_t c = k ? k - 1 : 0; c <= std::min(k + 1, n[2] - 1); ++c)
          for (size_t b = j ? j - 1 : 0; b <= std::min(j + 1, n[1] - 1); ++b)
            for (size_t a = i ? i - 1 : 0; a <= std::min(i + 1, n[0] - 1); ++a)
              if (const float w = before[a + n[0] * (b + n[1] * c)]; w == w) sum += double(w), ++count;
        v = count ? float(sum / count) : NAN;
      }
  });
}

template <class T>
std::vector<T> lattice_codes(const PageLattice& l, Range told, double most) {
  std::vector<T> codes(l.values.size());
  const double lo = told.lo - l.base, per = told.hi > told.lo ? most / (told.hi - told.lo) : 0;
  parallel_for(codes.size(), 1 << 16, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      const double v = double(l.values[i]);
      codes[i] = v == v ? T(std::lround(std::clamp((v - lo) * per, 0.0, most))) : T(0);
    }
  });
  return codes;
}

Json packed_histogram(const PageLattice& l, Range told) {
  std::vector<double> bins(histogram_bins);
  const double per = told.hi > told.lo ? double(histogram_bins) / (told.hi - told.lo) : 0;
  for (const float v : l.values)
    if (v == v) bins[size_t(std::clamp((double(v) + l.base - told.lo) * per, 0.0, double(histogram_bins - 1)))] += 1;
  return numbers(bins);
}

Json packed_matrix(const Mat3& m) {
  std::vector<double> rows;
  for (const auto& row : m.m) rows.insert(rows.end(), row, row + 3);
  return numbers(rows);
}

Json packed_points(const OpacityCurve& curve) {
  std::vector<Json> list;
  for (const Vec2& p : curve.points) list.push_back(numbers({p.x, p.y}));
  return Json(std::move(list));
}

// What the page draws in another way than the picture.
void note_differences(const VolumeItem& item, const Packing& p) {
  using enum RayFunction;
  const VolumeLight& light = item.light;
  if (!item.detail.plain()) p.note("a volume's opacity by a second axis is left out: the page draws that of the value alone");
  if (item.method != VolumeMethod::ray) p.note(fmt::format("a volume drawn by '{}' is drawn by rays", word_of(item.method)));
  if (light.shadows > 0 || light.occlusion > 0) p.note("shadows and occlusion inside a volume are left out");
  if (light.style != LightStyle::none || light.depth_cue > 0) p.note("a volume's illustrative light is left out");
  if (item.mode == maximum_difference) p.note("maximum_difference is drawn as composite");
}

}  // namespace

Json pack_volume(const VolumeItem& item, const Packing& p, Context& context) {
  const size_t points = item.data->point_count();
  const Quality& q = p.quality(points);
  PageLattice l = page_lattice(item, q.volume, context);
  if (l.values.empty()) return {};
  if (!l.note.empty()) p.note(l.note);
  note_differences(item, p);
  bool any_gap = false;
  const std::vector<uint8_t> gaps = left_out(l, any_gap);
  for (int pass = 0; any_gap && pass < 2; ++pass) fill_gaps(l);
  const Range told = told_values(item, l.range);
  const bool labels = !item.color.labels.empty();
  // Values of bytes are as they are.
  const Field& field = volume::field_of(item);
  const bool bytes = field.array.type() == ElementType::u8 && l.range.hi - l.range.lo <= 255;
  const int bits = q.volume_bits == 8 || bytes ? 8 : 16;
  Range coded = told;
  if (bytes && l.dims == l.samples) coded = {told.lo, told.lo + 255};
  const double most = bits == 8 ? 255 : 65535;
  const uint64_t array =
      bits == 8 ? p.arrays.add(lattice_codes<uint8_t>(l, coded, most)) : p.arrays.add(lattice_codes<uint16_t>(l, coded, most));
  if (l.dims != l.samples || (bits == 8 && !bytes))
    p.note(fmt::format("a volume of {}x{}x{} has {}x{}x{} values of {} bits", l.samples[0], l.samples[1], l.samples[2], l.dims[0],
                       l.dims[1], l.dims[2], bits));
  const Range data = item.data->range(field, item.component);
  Json::Members m{{"kind", text("volume")},
                  {"mode", text(word_of(item.mode))},
                  {"dims", numbers({double(l.dims[0]), double(l.dims[1]), double(l.dims[2])})},
                  {"samples", numbers({double(l.samples[0]), double(l.samples[1]), double(l.samples[2])})},
                  {"array", Json(array)},
                  {"bits", Json(uint64_t(bits))},
                  {"least", Json(coded.lo)},
                  {"most", Json(coded.hi > coded.lo ? coded.hi : coded.lo + 1)},
                  {"to_u", packed_matrix(l.to_u)},
                  {"origin", numbers(l.origin)},
                  {"lo", numbers(l.lo)},
                  {"hi", numbers(l.hi)},
                  {"cells", Json(l.cells)},
                  {"nearest", Json(labels)},
                  {"scale", Json(p.scales.add(item.color))},
                  {"opacity", packed_points(item.opacity)},
                  {"unit", Json(l.unit)},
                  {"edge", Json(l.edge)},
                  {"surface_from", Json(std::max(0.002 * (data.hi - data.lo), 1e-300))},
                  {"levels", numbers(item.levels)},
                  {"lit", Json(item.shaded)},
                  {"material", numbers({item.light.ambient, item.light.diffuse, item.light.specular, item.light.power})},
                  {"field", text(item.field)},
                  {"told", numbers({told.lo, told.hi})},
                  {"histogram", packed_histogram(l, told)}};
  std::vector<double> planes;
  for (const ClipPlane& c : item.clip) planes.insert(planes.end(), {c.normal.x, c.normal.y, c.normal.z, c.offset});
  m.emplace_back("clip", numbers(planes));
  if (any_gap) m.emplace_back("left_out", Json(p.arrays.add(gaps)));
  return Json(std::move(m));
}

}  // namespace sg::offline
