// SPDX-License-Identifier: Apache-2.0
#include "filter/stats/table_to_points.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>

#include "base/error.h"
#include "base/text/text.h"
#include "data/field_ops.h"
#include "data/fields/label_names.h"
#include "filter/stats/vector_columns.h"

namespace sg {

namespace {

class Columns {
 public:
  explicit Columns(const Table& t) : table_(t) {
    for (size_t i = 0; i < t.columns.size(); ++i) {
      names_.push_back(t.columns[i].name);
      if (!t.words(i) && t.columns[i].components() == 1) numbers_.push_back(i);
    }
  }
  /// The requested column, one with a usual name, or the nth numeric column; -1 when there is none.
  int find(const std::string& asked, std::initializer_list<std::string_view> usual, size_t nth) const {
    if (!asked.empty()) {
      for (size_t i = 0; i < names_.size(); ++i)
        if (names_[i] == asked) {
          if (table_.words(i))
            fail_usage(fmt::format("column '{}' contains text", asked), "table_to_points", "coordinates must be numbers");
          return int(i);
        }
      fail_usage(fmt::format("there is no column '{}'", asked), "table_to_points", unknown_name_hint(asked, names_));
    }
    for (std::string_view u : usual)
      for (const size_t i : numbers_)
        if (to_lower(names_[i]) == u) return int(i);
    return nth < numbers_.size() ? int(numbers_[nth]) : -1;
  }

 private:
  const Table& table_;
  std::vector<std::string> names_;
  std::vector<size_t> numbers_;
};

}  // namespace

DatasetPtr table_to_points(const Data& in, const TableToPointsParams& p, Context& ctx) {
  auto* table = std::get_if<TablePtr>(&in);
  if (!table) fail_usage("needs a table", "table_to_points", "read a .csv or .json file");
  const Table& t = **table;
  const Columns columns(t);
  // Ours, where a field is named x; usual ones; ParaView's.
  const std::array<int, 3> at = {columns.find(p.x, {"position_x", "x", "longitude", "lon", "points_0", "points:0"}, 0),
                                 columns.find(p.y, {"position_y", "y", "latitude", "lat", "points_1", "points:1"}, 1),
                                 columns.find(p.z, {"position_z", "z", "points_2", "points:2"}, SIZE_MAX)};
  if (at[0] < 0 || at[1] < 0) fail_usage("has fewer than two numeric columns", "table_to_points", "name the coordinates: x=... y=...");
  std::vector<int64_t> rows, ids, offsets{0};
  std::vector<double> xyz;
  const auto end_line = [&] {
    if (int64_t(ids.size()) - offsets.back() >= 2) offsets.push_back(int64_t(ids.size()));
    else ids.resize(size_t(offsets.back()));
  };
  const size_t n = t.columns[0].array.count();
  for (size_t r = 0; r < n; ++r) {
    double v[3] = {0, 0, 0};
    for (int a = 0; a < 3; ++a)
      if (at[size_t(a)] >= 0) v[a] = t.columns[size_t(at[size_t(a)])].array.get(r);
    if (std::isnan(v[0] + v[1] + v[2])) {
      end_line();
      continue;
    }
    ids.push_back(int64_t(rows.size())), rows.push_back(int64_t(r));
    xyz.insert(xyz.end(), v, v + 3);
  }
  end_line();
  if (rows.size() < n) ctx.info(fmt::format("table_to_points: {} rows have no coordinates", n - rows.size()));
  Points points;
  points.xyz = Array::from_vector(std::move(xyz), 3);
  DatasetParts parts;
  const std::vector<VectorColumns> vectors = p.vectors ? vector_columns(t, at) : std::vector<VectorColumns>();
  for (size_t i = 0; i < t.columns.size(); ++i) {
    const auto of = std::find_if(vectors.begin(), vectors.end(), [&](const VectorColumns& v) {
      return std::find(v.columns.begin(), v.columns.end(), i) != v.columns.end();
    });
    if (of != vectors.end()) {
      if (of->columns[0] != i) continue;
      Field f = joined(t, *of);
      f.array = gather(f.array, rows);
      parts.fields.add(std::move(f));
      continue;
    }
    Field f = t.columns[i];
    if (const std::vector<std::string>* words = t.words(i)) {
      LabelNames names(f.name);
      for (size_t k = 0; k < words->size(); ++k) names.add(int64_t(k), (*words)[k]);
      if (!names.empty()) parts.notes.push_back(names.note());
    }
    f.association = Association::point;
    f.array = gather(f.array, rows);
    f.role = t.words(i) ? Role::labels : int(i) == at[0] || int(i) == at[1] || int(i) == at[2] ? Role::none : Role::scalars;
    parts.fields.add(std::move(f));
  }
  if (p.line) {
    SurfaceMesh mesh;
    mesh.points = std::move(points);
    mesh.lines.connectivity = Array::from_vector(std::move(ids)), mesh.lines.offsets = Array::from_vector(std::move(offsets));
    parts.mesh = std::move(mesh);
  } else {
    parts.mesh = PointCloud{std::move(points)};
  }
  return make_dataset(std::move(parts));
}

}  // namespace sg
