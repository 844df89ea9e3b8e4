// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <tuple>

#include "base/text/text.h"
#include "io/plugins/netcdf/cf.h"

namespace sg::nc {

namespace {

bool one_of(std::string_view s, std::initializer_list<std::string_view> list) {
  return std::find(list.begin(), list.end(), s) != list.end();
}

}  // namespace

CfModel::CfModel(const NcFile& file) : file_(file) {
  find_roles();
  find_letters();
  find_grids();
}

const Variable* CfModel::coordinate(int dim) const {
  const Variable* v = file_.find(file_.dimensions()[size_t(dim)].name);
  return v && v->is_number() && v->dims.size() == 1 && v->dims[0] == dim ? v : nullptr;
}

void CfModel::find_roles() {
  is_data_.assign(file_.variables().size(), true);
  const auto drop = [&](std::string_view name) {
    if (const Variable* v = file_.find(name)) is_data_[size_t(v - file_.variables().data())] = false;
  };
  for (const Variable& v : file_.variables()) {
    file_.check_backed(v);
    if (!v.is_number() || v.count() == 0) drop(v.name);
    if (v.dims.size() == 1 && file_.dimensions()[size_t(v.dims[0])].name == v.name) drop(v.name);
    for (const char* attribute : {"bounds", "climatology", "grid_mapping"})
      for (const std::string& name : file_.words(&v, attribute)) drop(name);
    if (!file_.text(&v, "grid_mapping_name").empty() || !file_.text(&v, "cf_role").empty()) drop(v.name);
  }
}

// What a coordinate variable measures, by CF's rules in their order: axis, units, positive, standard name; then by its name.
char CfModel::letter_of(const Variable& v) const {
  const std::string axis = to_lower(file_.text(&v, "axis")), units = to_lower(file_.text(&v, "units"));
  const std::string standard = to_lower(file_.text(&v, "standard_name")), name = to_lower(v.name);
  if (axis.size() == 1 && axis.find_first_of("xyzt") == 0) return axis[0];
  if (units.find(" since ") != std::string::npos || standard == "time") return 't';
  if (one_of(units, {"degrees_east", "degree_east", "degree_e", "degrees_e", "degreee", "degreese"})) return 'x';
  if (one_of(units, {"degrees_north", "degree_north", "degree_n", "degrees_n", "degreen", "degreesn"})) return 'y';
  if (one_of(standard, {"longitude", "projection_x_coordinate", "grid_longitude"})) return 'x';
  if (one_of(standard, {"latitude", "projection_y_coordinate", "grid_latitude"})) return 'y';
  if (!file_.text(&v, "positive").empty() || one_of(standard, {"depth", "height", "altitude", "air_pressure"})) return 'z';
  if (name == "t" || name.starts_with("time") || name.ends_with("_time")) return 't';
  if (one_of(name, {"x", "lon", "longitude", "long", "rlon", "nav_lon", "xlong"})) return 'x';
  if (one_of(name, {"y", "lat", "latitude", "rlat", "nav_lat", "xlat"})) return 'y';
  if (one_of(name, {"z", "lev", "level", "depth", "height", "altitude", "plev"}) || name.starts_with("depth")) return 'z';
  return ' ';
}

void CfModel::find_letters() {
  const auto& dims = file_.dimensions();
  for (size_t d = 0; d < dims.size(); ++d) {
    if (const Variable* v = coordinate(int(d))) letters_.push_back(letter_of(*v));
    else {
      const std::string name = to_lower(dims[d].name);
      letters_.push_back(name == "t" || name.starts_with("time") || dims[d].unlimited ? 't' : ' ');
    }
  }
}

void CfModel::find_grids() {
  std::map<std::vector<int>, size_t> known;  // dimensions longer than 1 -> grid
  for (const Variable& v : file_.variables()) {
    if (!is_data_[size_t(&v - file_.variables().data())]) continue;
    CfVariable c{&v, -1, {}, {}};
    for (size_t k = 0; k < v.dims.size(); ++k) {
      if (letters_[size_t(v.dims[k])] == 't' && c.time < 0) c.time = int(k);
      else c.axes.push_back(int(k));
    }
    const auto is_long = [&](int place) { return v.shape[size_t(place)] > 1; };
    while (c.axes.size() > 3) {  // an ensemble's first member
      auto drop = std::find_if(c.axes.begin(), c.axes.end(), [&](int p) { return !is_long(p); });
      if (drop == c.axes.end())
        drop = std::find_if(c.axes.begin(), c.axes.end(), [&](int p) { return letters_[size_t(v.dims[size_t(p)])] == ' '; });
      if (drop == c.axes.end()) drop = c.axes.begin();
      c.first.push_back(*drop);
      c.axes.erase(drop);
    }
    std::vector<int> key, dims;
    size_t points = 1;
    for (const int p : c.axes) {
      dims.push_back(v.dims[size_t(p)]);
      points *= v.shape[size_t(p)];
      if (is_long(p)) key.push_back(dims.back());
    }
    if (key.empty()) {
      loose_.push_back(std::move(c));
      continue;
    }
    std::sort(key.begin(), key.end());  // the same axes in another order are the same grid
    const auto [at, fresh] = known.emplace(key, grids_.size());
    if (fresh) grids_.push_back({});
    CfGrid& grid = grids_[at->second];
    if (dims.size() > grid.dims.size()) grid.dims = dims;
    grid.points = points;
    grid.variables.push_back(std::move(c));
  }
  for (CfGrid& g : grids_) find_positions(g);
  // The grid of the quantities: most axes that are long, then most variables.
  const auto rank = [&](const CfGrid& g) {
    const auto n = std::count_if(g.dims.begin(), g.dims.end(), [&](int d) { return file_.dimensions()[size_t(d)].length > 1; });
    const auto timed = std::count_if(g.variables.begin(), g.variables.end(), [](const CfVariable& v) { return v.time >= 0; });
    return std::tuple(n > 1 || g.lon, timed > 0, g.variables.size(), g.points);
  };
  std::stable_sort(grids_.begin(), grids_.end(), [&](const CfGrid& a, const CfGrid& b) { return rank(a) > rank(b); });
  // Profiles along an axis of the main grid are not grids.
  for (size_t i = 1; i < grids_.size();) {
    const CfGrid& g = grids_[i];
    const auto& main = grids_[0].dims;
    const bool profile = !g.lon && g.points == file_.dimensions()[size_t(g.dims[0])].length && g.dims.size() == 1 &&
                         std::find(main.begin(), main.end(), g.dims[0]) != main.end();
    if (profile) {
      loose_.insert(loose_.end(), g.variables.begin(), g.variables.end());
      grids_.erase(grids_.begin() + ptrdiff_t(i));
    } else ++i;
  }
  if (!grids_.empty())
    for (const CfVariable& v : grids_[0].variables)
      if (v.time >= 0 && time_ < 0) time_ = v.v->dims[size_t(v.time)];
}

// Listed longitudes and latitudes: named by "coordinates", else any pair on the same dimensions; only where the dimensions have no
// coordinate variables of their own.
void CfModel::find_positions(CfGrid& grid) const {
  std::vector<int> last;
  for (const int d : grid.dims)
    if (file_.dimensions()[size_t(d)].length > 1) last.push_back(d);
  if (last.empty()) return;
  if (last.size() > 2) last.erase(last.begin(), last.end() - 2);
  const auto search = [&](std::vector<int> on) {
    bool known = true;
    for (const int d : on) known = known && coordinate(d);
    if (known) return false;
    const Variable* found[2] = {nullptr, nullptr};
    const auto consider = [&](const Variable* v) {
      if (!v || !v->is_number()) return;
      std::vector<int> dims;
      for (size_t k = 0; k < v->dims.size(); ++k)
        if (v->shape[k] > 1 && letters_[size_t(v->dims[k])] != 't') dims.push_back(v->dims[k]);
      const char l = dims == on ? letter_of(*v) : ' ';
      if (l == 'x' && !found[0]) found[0] = v;
      if (l == 'y' && !found[1]) found[1] = v;
    };
    for (const CfVariable& c : grid.variables)
      for (const std::string& name : file_.words(c.v, "coordinates")) consider(file_.find(name));
    for (const Variable& v : file_.variables()) consider(&v);
    if (!found[0] || !found[1]) return false;
    grid.lon = found[0], grid.lat = found[1];
    return true;
  };
  if (last.size() == 2 && search(last)) return;
  if (search({last.back()})) {  // a list of places; the preceding dimensions are not drawn
    const int d = last.back();
    grid.points = file_.dimensions()[size_t(d)].length;
    for (CfVariable& c : grid.variables) {
      std::vector<int> keep;
      for (const int p : c.axes) (c.v->dims[size_t(p)] == d ? keep : c.first).push_back(p);
      c.axes = keep;
    }
    grid.dims = {d};
  }
}

}  // namespace sg::nc
