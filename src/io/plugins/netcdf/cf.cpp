// SPDX-License-Identifier: Apache-2.0
#include "io/plugins/netcdf/cf.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <optional>

#include "base/parallel.h"
#include "base/text/text.h"
#include "data/fields/label_names.h"
#include "data/lattice.h"
#include "data/lattice_crop.h"
#include "io/mesh/unread.h"

namespace sg::nc {

namespace {

constexpr size_t points_per_chunk = 1 << 15;

// Numbers in the file's order of dimensions (lengths n, slowest first) to the mesh's: order[a] is the dimension along axis a.
Array permuted(const Array& a, const std::vector<size_t>& n, const std::vector<int>& order) {
  size_t stride[3] = {0, 0, 0}, count[3] = {1, 1, 1};
  bool same = true;
  size_t expected = 1;
  for (size_t axis = 0; axis < 3; ++axis) {
    if (order[axis] < 0) continue;
    const auto d = size_t(order[axis]);
    count[axis] = n[d];
    stride[axis] = 1;
    for (size_t k = d + 1; k < n.size(); ++k) stride[axis] *= n[k];
    if (count[axis] > 1 && stride[axis] != expected) same = false;
    expected *= count[axis];
  }
  if (same) return a;
  std::byte* out = nullptr;
  Array r = Array::make_raw(a.type(), a.count(), 1, &out);
  const size_t size = element_size(a.type());
  parallel_for(count[1] * count[2], std::max<size_t>(1, points_per_chunk / std::max<size_t>(count[0], 1)), [&](size_t begin, size_t end) {
    for (size_t row = begin; row < end; ++row) {
      const size_t from = row % count[1] * stride[1] + row / count[1] * stride[2];
      for (size_t i = 0; i < count[0]; ++i) std::memcpy(out + (row * count[0] + i) * size, a.raw() + (from + i * stride[0]) * size, size);
    }
  });
  return r;
}

bool wanted(const ReadOptions& options, const std::string& name) {
  return options.fields.empty() || std::find(options.fields.begin(), options.fields.end(), name) != options.fields.end();
}

std::string unit_of(const NcFile& file, const Variable& v) {
  const std::string unit = file.text(&v, "units");
  return unit == "1" || unit == "none" ? std::string() : unit;
}

/// What is read along one axis: `count` entries from `lo`, every stride-th.
struct Span {
  size_t lo = 0, count = 1, stride = 1;
};

/// The numbers of one step, in the file's order of the variable's axes; `n` receives their lengths. `spans`: one for each axis; none =
/// all of it. Along the slowest axis only what is wanted is read, along the others the range that holds it.
Array read_step(const NcFile& file, const CfVariable& c, size_t step, const std::vector<Span>& spans, std::vector<size_t>& n,
                bool header_only) {
  const Variable& v = *c.v;
  std::vector<size_t> start(v.shape.size(), 0), count(v.shape.size(), 1);
  std::array<size_t, 3> box{1, 1, 1}, kept{1, 1, 1}, stride{1, 1, 1};  // fastest first
  size_t slabs = 1, total = 1;
  bool sparse = false;
  for (size_t k = 0; k < c.axes.size(); ++k) {
    const auto p = size_t(c.axes[k]);
    const Span s = spans.empty() ? Span{0, v.shape[p], 1} : spans[k];
    start[p] = s.lo;
    count[p] = (s.count - 1) * s.stride + 1;
    const size_t fast = c.axes.size() - 1 - k;
    box[fast] = count[p], kept[fast] = s.count, stride[fast] = s.stride;
    sparse = sparse || s.stride > 1;
    n.push_back(s.count);
    total *= s.count;
  }
  if (header_only) return unread_values(decoded_type(file, v), total);
  if (c.time >= 0) start[size_t(c.time)] = std::min(step, v.shape[size_t(c.time)] - 1);
  if (!sparse) return decoded(file, v, file.read(v, start, count, v.element()));
  const auto slowest = size_t(c.axes[0]);
  const size_t last = c.axes.size() - 1, between = stride[last], first = start[slowest];
  if (between > 1) slabs = kept[last], box[last] = kept[last] = stride[last] = count[slowest] = 1;
  std::byte* out = nullptr;
  const Array all = Array::make_raw(v.element(), total, 1, &out);
  for (size_t s = 0; s < slabs; ++s) {
    start[slowest] = first + s * between;
    const Array slab = crop_block(file.read(v, start, count, v.element()), box, {0, 0, 0}, kept, stride);
    std::memcpy(out + s * slab.bytes(), slab.raw(), slab.bytes());
  }
  return decoded(file, v, all);
}

// Axes of the mesh (places in the grid's dims) as places among this variable's own axes.
std::vector<int> own_order(const CfGrid& grid, const CfVariable& c, const std::vector<int>& order) {
  std::vector<int> own(3, -1);
  for (size_t a = 0; a < 3; ++a) {
    if (order[a] < 0) continue;
    for (size_t k = 0; k < c.axes.size(); ++k)
      if (c.v->dims[size_t(c.axes[k])] == grid.dims[size_t(order[a])]) own[a] = int(k);
  }
  return own;
}

// The IRI Data Library's CLIST: a line with the name of each whole number from valid_min to valid_max.
std::optional<LabelNames> classes_of(const NcFile& file, const Variable& v) {
  const std::string list = file.text(&v, "CLIST");
  const auto lo = file.number(&v, "valid_min"), hi = file.number(&v, "valid_max");
  if (list.empty() || !lo || !hi || *lo != std::round(*lo) || std::abs(*lo) > 1e15) return {};
  const std::vector<std::string_view> lines = split(trim(list), '\n');
  if (*hi - *lo + 1 != double(lines.size())) return {};
  LabelNames names(v.name);
  for (size_t i = 0; i < lines.size(); ++i) names.add(int64_t(*lo) + int64_t(i), std::string(lines[i]));
  return names;
}

// CF section 3.5: each of flag_values has a word in flag_meanings. Masks, whose bits mean something one by one, have no names for values.
std::optional<LabelNames> flags_of(const NcFile& file, const Variable& v) {
  if (auto classes = classes_of(file, v)) return classes;
  const std::vector<double> values = file.numbers(&v, "flag_values");
  const std::vector<std::string> meanings = file.words(&v, "flag_meanings");
  if (values.empty() || values.size() != meanings.size() || !file.numbers(&v, "flag_masks").empty()) return {};
  LabelNames names(v.name);
  for (size_t i = 0; i < values.size(); ++i) {
    if (values[i] != std::round(values[i]) || std::abs(values[i]) > 1e15) return {};
    std::string word = meanings[i];
    std::replace(word.begin(), word.end(), '_', ' ');
    names.add(int64_t(values[i]), word);
  }
  return names;
}

DatasetPtr read_grid(const NcFile& file, const CfModel& model, const CfGrid& grid, bool main, size_t step, std::optional<double> time,
                     const ReadOptions& options, Context& context) {
  CfMesh mesh = cf_mesh(file, model, grid, context);
  DatasetParts parts;
  std::vector<const Variable*> auxiliary;  // coordinates that are not those of the mesh come last
  std::array<Span, 3> region;              // of the mesh's axes
  const bool part = !options.region.whole() && is_lattice(mesh.mesh) && !std::holds_alternative<CurvilinearGrid>(mesh.mesh);
  if (part) {
    const LatticeRegion& r = options.region;
    const DatasetPtr cut = crop_lattice(*make_dataset(mesh.mesh), r.lo, r.hi, r.stride);
    const auto dims = lattice_dims(cut->mesh());
    for (size_t a = 0; a < 3; ++a) region[a] = {r.lo[a], dims[a], r.stride[a]};
    mesh.mesh = cut->mesh();
  }
  const auto add = [&](const CfVariable& c) {
    context.check();
    std::vector<size_t> n;
    const std::vector<int> own = own_order(grid, c, mesh.order);
    std::vector<Span> spans;
    for (size_t k = 0; part && k < c.axes.size(); ++k) {
      spans.push_back({0, c.v->shape[size_t(c.axes[k])], 1});
      for (size_t a = 0; a < 3; ++a)
        if (own[a] == int(k)) spans[k] = region[a];
    }
    Array a = read_step(file, c, step, spans, n, options.header_only);
    if (!options.header_only) a = permuted(a, n, own);
    const std::optional<LabelNames> flags = flags_of(file, *c.v);
    if (flags) mesh.notes.push_back(flags->note());
    parts.fields.add({c.v->name, mesh.association, std::move(a), unit_of(file, *c.v), flags ? Role::labels : Role::none});
    if (!c.first.empty()) {
      std::string held;
      for (const int p : c.first) held += (held.empty() ? "" : ", ") + file.dimensions()[size_t(c.v->dims[size_t(p)])].name;
      mesh.notes.emplace_back(c.v->name, "first entry along " + held);
    }
  };
  std::vector<std::string> coordinates;
  for (const CfVariable& c : grid.variables)
    for (const std::string& w : file.words(c.v, "coordinates")) coordinates.push_back(w);
  for (const bool last : {false, true})
    for (const CfVariable& c : grid.variables) {
      const bool is_coordinate = std::find(coordinates.begin(), coordinates.end(), c.v->name) != coordinates.end();
      if (is_coordinate != last || !wanted(options, c.v->name)) continue;
      if (std::find(mesh.used.begin(), mesh.used.end(), c.v) == mesh.used.end()) add(c);
    }
  if (main)
    for (const CfVariable& c : model.loose()) {
      if (!wanted(options, c.v->name)) continue;
      std::vector<size_t> n;
      parts.fields.add(
          {c.v->name, Association::whole, read_step(file, c, step, {}, n, options.header_only), unit_of(file, *c.v), Role::none});
    }
  parts.mesh = std::move(mesh.mesh);
  parts.point_ghost = mesh.point_ghost, parts.cell_ghost = mesh.cell_ghost;
  for (const char* name : {"title", "institution", "source", "history", "references", "comment", "Conventions"})
    if (std::string text = file.text(nullptr, name); !text.empty()) parts.notes.emplace_back(name, std::move(text));
  parts.notes.insert(parts.notes.end(), mesh.notes.begin(), mesh.notes.end());
  if (model.time_dim() >= 0) {
    parts.time = time;
    if (const Variable* t = model.coordinate(model.time_dim())) {
      const std::string unit = file.text(t, "units"), calendar = file.text(t, "calendar");
      if (!unit.empty()) parts.notes.emplace_back("time", calendar.empty() ? unit : fmt::format("{} ({} calendar)", unit, calendar));
    }
  }
  const DatasetPtr d = make_dataset(std::move(parts));
  if (options.region.whole() || part || !is_lattice(d->mesh())) return d;
  return crop_lattice(*d, options.region.lo, options.region.hi, options.region.stride);
}

std::vector<double> times_of(const NcFile& file, const CfModel& model) {
  const int d = model.time_dim();
  if (d < 0) return {};
  std::vector<double> times;
  if (const Variable* v = model.coordinate(d)) {
    const Array a = decoded(file, *v, file.read(*v, v->element())).converted(ElementType::f64);
    times.assign(a.view<double>().data, a.view<double>().data + a.count());
  }
  // Without (good) times the steps are counted.
  if (times.empty() || !std::all_of(times.begin(), times.end(), [](double t) { return std::isfinite(t); })) {
    times.resize(file.dimensions()[size_t(d)].length);
    for (size_t i = 0; i < times.size(); ++i) times[i] = double(i);
  }
  return times;
}

}  // namespace

std::vector<double> cf_times(const NcFile& file) { return times_of(file, CfModel(file)); }

Data read_cf(const NcFile& file, const ReadOptions& options, Context& context) {
  const CfModel model(file);
  if (model.grids().empty()) {
    if (file.has_group("minc-2.0")) file.fail("is a MINC 2 file, which the reader for HDF5 reads", {}, "name it .h5");
    file.fail("contains no variable on a grid", {}, "expected a numeric variable with at least one dimension longer than 1");
  }
  const std::vector<double> times = times_of(file, model);
  size_t step = 0;
  std::optional<double> time;
  if (!times.empty() || options.step > 0) {
    step = chosen_step(times, options, file.path());
    time = times[step];
  }
  const auto one = [&](size_t i) { return read_grid(file, model, model.grids()[i], i == 0, step, time, options, context); };
  // Grids with nothing that is requested are left out.
  std::vector<size_t> chosen;
  for (size_t i = 0; i < model.grids().size() && !options.fields.empty(); ++i) {
    const auto& variables = model.grids()[i].variables;
    if (std::any_of(variables.begin(), variables.end(), [&](const CfVariable& c) { return wanted(options, c.v->name); }))
      chosen.push_back(i);
  }
  if (chosen.empty())
    for (size_t i = 0; i < model.grids().size(); ++i) chosen.push_back(i);
  if (chosen.size() == 1) return one(chosen[0]);
  Collection all;
  for (const size_t i : chosen) {
    std::string name;
    for (const int d : model.grids()[i].dims) name += (name.empty() ? "" : " x ") + file.dimensions()[size_t(d)].name;
    all.parts.push_back({name, one(i)});
  }
  return std::make_shared<const Collection>(std::move(all));
}

}  // namespace sg::nc
