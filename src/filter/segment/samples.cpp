// SPDX-License-Identifier: Apache-2.0
#include "filter/segment/samples.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "base/text/text.h"
#include "data/lattice.h"

namespace sg {

namespace {

constexpr size_t values_per_chunk = 1 << 15;

std::vector<uint8_t> states_of_bits(const Array& ghost, uint8_t hidden_bits) {
  if (ghost.empty()) return {};
  std::vector<uint8_t> s(ghost.count());
  const auto v = ghost.view<uint8_t>();
  parallel_for(s.size(), values_per_chunk, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i)
      s[i] = v[i] & hidden_bits ? sample_hidden : v[i] & ghost_duplicate ? sample_duplicate : sample_seen;
  });
  return s;
}

// A point is as visible as the most visible cell around it.
std::vector<uint8_t> points_of_cells(const std::array<size_t, 3>& d, const std::vector<uint8_t>& cells) {
  std::vector<uint8_t> s(d[0] * d[1] * d[2]);
  const size_t c[3] = {std::max<size_t>(d[0], 2) - 1, std::max<size_t>(d[1], 2) - 1, std::max<size_t>(d[2], 2) - 1};
  parallel_for(d[1] * d[2], std::max<size_t>(1, values_per_chunk / d[0]), [&](size_t begin, size_t end) {
    for (size_t row = begin; row < end; ++row)
      for (size_t i = 0; i < d[0]; ++i) {
        const size_t p[3] = {i, row % d[1], row / d[1]};
        uint8_t best = sample_hidden;
        for (int n = 0; n < 8; ++n) {
          size_t q[3];
          bool inside = true;
          for (int a = 0; a < 3; ++a) {
            q[a] = p[a] - (n >> a & 1);
            inside = inside && q[a] < c[a];
          }
          if (inside) best = std::min(best, cells[q[0] + c[0] * (q[1] + c[1] * q[2])]);
        }
        s[i + d[0] * row] = best;
      }
  });
  return s;
}

std::vector<double> cell_centers(const std::vector<double>& x) {
  if (x.size() < 2) return x;
  std::vector<double> c(x.size() - 1);
  for (size_t i = 0; i < c.size(); ++i) c[i] = (x[i] + x[i + 1]) / 2;
  return c;
}

}  // namespace

std::vector<uint8_t> sample_states(const Dataset& in, Association association) {
  if (association == Association::whole) fail_usage("a field of the whole dataset has no samples", "sample_states");
  std::vector<uint8_t> cells = states_of_bits(in.cell_ghost(), ghost_hidden_cell | ghost_refined_cell);
  if (association == Association::cell) return cells;
  std::vector<uint8_t> points = states_of_bits(in.point_ghost(), ghost_hidden_point);
  if (cells.empty() || !is_lattice(in.mesh())) return points;
  std::vector<uint8_t> both = points_of_cells(lattice_dims(in.mesh()), cells);
  if (!points.empty())
    for (size_t i = 0; i < both.size(); ++i) both[i] = std::max(both[i], points[i]);
  return both;
}

double SampleImage::spacing(size_t axis) const {
  const auto& x = at[axis];
  return x.size() > 1 ? std::abs(x.back() - x.front()) / double(x.size() - 1) : 1.0;
}

SampleImage sample_image(const Dataset& in, const FieldName& name, std::string_view who, bool want_labels) {
  const std::string where(who);
  const auto* uniform = in.as<UniformGrid>();
  const auto* rectilinear = in.as<RectilinearGrid>();
  if (!uniform && !rectilinear)
    fail_usage(fmt::format("works on uniform and rectilinear grids, this is {}", in.kind()), where,
               "use resample to put the field on a grid");
  const Field* field = nullptr;
  if (!name.empty()) {
    field = with_context(who, [&] { return &in.fields().require(name.name); });
  } else {
    if (want_labels) {
      field = in.fields().with_role(Role::labels);
      if (field && (field->components() != 1 || field->association == Association::whole)) field = nullptr;
    }
    if (!field) field = in.fields().active(1);
    if (!field) fail_usage("the grid has no scalar field", where, "name one: field=NAME");
  }
  if (field->association == Association::whole)
    fail_usage(fmt::format("field '{}' belongs to the whole mesh, not to points or cells", field->name), where);
  if (field->components() != 1)
    fail_usage(fmt::format("field '{}' has {} components, but one is needed", field->name, field->components()), where,
               "take one of them with component, or use magnitude");
  SampleImage image;
  image.field = *field;
  image.field.array = field->array.made_packed();
  const auto dims = lattice_dims(in.mesh());
  for (size_t a = 0; a < 3; ++a) {
    auto& x = image.at[a];
    x.resize(dims[a]);
    const Array* axis = rectilinear ? (a == 0 ? &rectilinear->x : a == 1 ? &rectilinear->y : &rectilinear->z) : nullptr;
    for (size_t i = 0; i < dims[a]; ++i) x[i] = axis ? axis->get(i) : double(i) * uniform->spacing[int(a)];
    if (field->association == Association::cell) x = cell_centers(x);
    image.dims[a] = x.size();
  }
  image.state = sample_states(in, field->association);
  return image;
}

const Field& companion_field(const Dataset& in, const SampleImage& image, const FieldName& name, std::string_view who) {
  const Field& f = with_context(who, [&]() -> const Field& { return in.fields().require(name.name, image.field.association); });
  if (f.components() != 1)
    fail_usage(fmt::format("field '{}' has {} components, but one is needed", f.name, f.components()), std::string(who));
  return f;
}

namespace {

// Labels that do not fit 32 bits (or of which one is the reserved code) get places in a sorted table.
template <class Wanted>
LabelCodes codes_by_table(const View<int64_t>& v, Wanted&& wanted) {
  LabelCodes r;
  for (size_t i = 0; i < v.count; ++i)
    if (wanted(i, v[i]) && (r.table.empty() || r.table.back() != v[i])) r.table.push_back(v[i]);
  std::sort(r.table.begin(), r.table.end());
  r.table.erase(std::unique(r.table.begin(), r.table.end()), r.table.end());
  if (r.table.size() >= size_t(INT32_MAX)) fail_usage("more than two billion labels");
  r.code.resize(v.count);
  parallel_for(v.count, values_per_chunk, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i)
      r.code[i] = wanted(i, v[i]) ? int32_t(std::lower_bound(r.table.begin(), r.table.end(), v[i]) - r.table.begin()) + 1 : 0;
  });
  return r;
}

}  // namespace

LabelCodes label_codes(const SampleImage& image, std::optional<double> background, const std::vector<int64_t>& wanted, std::string_view who,
                       const Context& context) {
  std::vector<int64_t> list = wanted;
  std::sort(list.begin(), list.end());
  const size_t n = image.count();
  LabelCodes r;
  // A pass in the native type checks whether all numbers are whole and fit 32 bits.
  struct Check {
    size_t bad = SIZE_MAX;
    bool wide = false;
  };
  const Check check = dispatch(image.field.array, [&](auto v) {
    using T = std::remove_cvref_t<decltype(v[0])>;
    if constexpr (sizeof(T) <= 2 || std::is_same_v<T, int8_t>) return Check{};
    else
      return parallel_reduce(
          n, values_per_chunk, Check{},
          [&](size_t begin, size_t end) {
            Check c;
            for (size_t i = begin; i < end; ++i) {
              const T x = v[i];
              if (x != x || image.hidden(i)) continue;
              if constexpr (std::is_floating_point_v<T>) {
                if (!(x == std::floor(x)) || !(std::abs(x) < T(9007199254740992.0))) {
                  c.bad = std::min(c.bad, i);
                  continue;
                }
              }
              if constexpr (std::is_same_v<T, uint64_t>)
                if (x > uint64_t(INT64_MAX)) c.bad = std::min(c.bad, i);
              if (!(double(x) > double(INT32_MIN) && double(x) <= double(INT32_MAX))) c.wide = true;
            }
            return c;
          },
          [](Check a, Check b) {
            return Check{std::min(a.bad, b.bad), a.wide || b.wide};
          },
          &context);
  });
  if (check.bad != SIZE_MAX)
    fail_usage(fmt::format("field '{}' is not a label field: sample {} is {}", image.field.name, check.bad,
                           short_number(image.field.array.get(check.bad))),
               std::string(who), "labels must be whole numbers; make them from intensities with otsu or classify");
  auto is_wanted = [&](int64_t x) {
    if (background && double(x) == *background) return false;
    return list.empty() || std::binary_search(list.begin(), list.end(), x);
  };
  if (check.wide) {
    const Array wide = image.field.array.converted(ElementType::i64);
    const bool floats = is_float(image.field.array.type());
    return codes_by_table(wide.view<int64_t>(), [&](size_t i, int64_t x) {
      return !image.hidden(i) && !(floats && std::isnan(image.field.array.get(i))) && is_wanted(x);
    });
  }
  r.code.resize(n);
  dispatch(image.field.array, [&](auto v) {
    using T = std::remove_cvref_t<decltype(v[0])>;
    parallel_for(
        n, values_per_chunk,
        [&](size_t begin, size_t end) {
          T last{};
          int32_t code = 0;
          bool known = false;
          for (size_t i = begin; i < end; ++i) {
            const T x = v[i];
            if (x != x || image.hidden(i)) {
              r.code[i] = 0;
              continue;
            }
            if (!known || x != last)
              last = x, known = true, code = !is_wanted(int64_t(x)) ? 0 : int64_t(x) == 0 ? LabelCodes::zero_code : int32_t(x);
            r.code[i] = code;
          }
        },
        &context);
  });
  return r;
}

std::vector<std::array<int, 3>> neighbors_before(int connectivity) {
  const int most = connectivity == 6 ? 1 : connectivity == 18 ? 2 : 3;
  std::vector<std::array<int, 3>> r;
  for (int z = -1; z <= 0; ++z)
    for (int y = -1; y <= 1; ++y)
      for (int x = -1; x <= 1; ++x) {
        const int far = std::abs(x) + std::abs(y) + std::abs(z);
        if (far > 0 && far <= most && (z < 0 || y < 0 || (y == 0 && x < 0))) r.push_back({x, y, z});
      }
  return r;
}

}  // namespace sg
