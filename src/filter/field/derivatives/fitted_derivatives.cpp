// SPDX-License-Identifier: Apache-2.0
#include "filter/field/derivatives/fitted_derivatives.h"

#include <fmt/core.h>

#include <algorithm>
#include <atomic>
#include <functional>
#include <optional>

#include "base/parallel.h"
#include "data/cells/cell_reader.h"
#include "data/cells/point_cells.h"
#include "data/cells/point_positions.h"
#include "filter/field/derivatives/quadratic_fit.h"

namespace sg {

namespace {

// Ids without repetition, in the order in which they came: that order depends only on the mesh.
class IdList {
 public:
  void clear() {
    ids_.clear();
    if (++stamp_ == 0) std::fill(table_.begin(), table_.end(), Entry{}), stamp_ = 1;
  }
  void add(int64_t id) {
    if (2 * ids_.size() >= table_.size()) grow();
    if (claim(id)) ids_.push_back(id);
  }
  bool contains(int64_t id) const {
    const size_t mask = table_.size() - 1;
    for (size_t at = place(id);; ++at) {
      const Entry& e = table_[at & mask];
      if (e.stamp != stamp_) return false;
      if (e.id == id) return true;
    }
  }
  const std::vector<int64_t>& ids() const { return ids_; }

 private:
  struct Entry {
    int64_t id = -1;
    uint32_t stamp = 0;
  };
  static size_t place(int64_t id) { return size_t(uint64_t(id) * 0x9e3779b97f4a7c15u >> 40); }
  bool claim(int64_t id) {
    const size_t mask = table_.size() - 1;
    for (size_t at = place(id) & mask;; at = (at + 1) & mask) {
      Entry& e = table_[at];
      if (e.stamp == stamp_ && e.id == id) return false;
      if (e.stamp == stamp_) continue;
      e = {id, stamp_};
      return true;
    }
  }
  void grow() {
    table_.assign(table_.size() * 2, {});
    stamp_ = 1;
    for (const int64_t id : ids_) claim(id);
  }
  std::vector<Entry> table_ = std::vector<Entry>(256);
  std::vector<int64_t> ids_;
  uint32_t stamp_ = 0;
};

// Dimensions of the cells of a mesh whose cells have several; otherwise none is kept.
class CellDimensions {
 public:
  explicit CellDimensions(const CellReader& all) {
    std::vector<uint8_t> each(all.count());
    parallel_for(each.size(), 1 << 14, [&](size_t begin, size_t end) {
      CellReader reader = all;
      for (size_t c = begin; c < end; ++c) {
        reader.open(c);
        each[c] = uint8_t(reader.dimension());
      }
    });
    if (std::adjacent_find(each.begin(), each.end(), std::not_equal_to<>()) != each.end()) each_ = std::move(each);
  }
  bool same(size_t a, size_t b) const { return each_.empty() || each_[a] == each_[b]; }

 private:
  std::vector<uint8_t> each_;
};

// What surrounds a place, ring by ring: other places, the dimension of the cells there, and across surfaces their normal.
// Cells of less dimension than the place's own do not count: the points of a line that ends on a surface do not belong to the surface.
class Surroundings {
 public:
  Surroundings(const CellReader& reader, Association on, const PointCells& cells, const CellDimensions* dimensions, const Array& at)
      : reader_(reader), on_(on), cells_(cells), dimensions_(dimensions), at_(at.view<double>()) {}

  /// The first ring about a place, the place itself in it.
  void open(size_t i) {
    found_.clear();
    found_.add(int64_t(i));
    dimension_ = 0, begin_ = 0;
    normal_ = {0, 0, 0};
    if (on_ == Association::cell) {
      open_cell(i);
      dimension_ = cell_dimension_;
      if (dimension_ == 2) add_normal(0, reader_.at().size());
      grow();
      return;
    }
    for (const uint32_t c : cells_[i]) {
      open_cell(c);
      if (cell_dimension_ < dimension_) continue;
      if (cell_dimension_ > dimension_) {  // what was found before does not count
        dimension_ = cell_dimension_;
        found_.clear(), found_.add(int64_t(i));
      }
      add_points(int64_t(i));
      if (dimension_ == 2) about(int64_t(i), [&](size_t begin, size_t end) { add_normal(begin, end); });
    }
    begin_ = 1;
  }
  /// One ring more; false when there is none.
  bool grow() {
    const size_t end = found_.ids().size();
    if (begin_ == 1) visited_.clear();
    for (size_t k = begin_; k < end; ++k) add_around(size_t(found_.ids()[k]));
    begin_ = end;
    return found_.ids().size() > end;
  }
  const std::vector<int64_t>& found() const { return found_.ids(); }
  int dimension() const { return dimension_; }
  Vec3 normal() const { return normal_; }
  Vec3 position(size_t i) const { return {at_(i, 0), at_(i, 1), at_(i, 2)}; }

 private:
  void open_cell(size_t cell) {
    if (opened_ == cell) return;
    reader_.open(cell);
    opened_ = cell;
    if (reader_.type() != type_) type_ = reader_.type(), cell_dimension_ = reader_.dimension();
  }
  // How many nodes before and after one of its points the open cell's neighbours are: all, but of polylines and strips, which may be as
  // long as the mesh, those of the segments or triangles that use it.
  size_t reach() const { return reader_.type() == CellType::poly_line ? 1 : reader_.type() == CellType::triangle_strip ? 2 : SIZE_MAX; }
  // f(begin, end) for the nodes of the open cell within reach of one of its points.
  template <class F>
  void about(int64_t point, F&& f) {
    const auto ids = reader_.ids();
    const size_t near = reach();
    if (near >= ids.size()) return f(size_t(0), ids.size());
    for (size_t k = 0; k < ids.size(); ++k)
      if (ids[k] == point) f(k - std::min(k, near), std::min(k + near + 1, ids.size()));
  }
  void add_points(int64_t about_point) {
    about(about_point, [&](size_t begin, size_t end) {
      for (const int64_t p : reader_.ids().subspan(begin, end - begin)) found_.add(p);
    });
  }
  void add_normal(size_t begin, size_t end) {
    const auto at = reader_.at().subspan(begin, end - begin);
    Vec3 n{0, 0, 0};
    for (size_t k = 1; k + 1 < at.size(); ++k) {
      // Points of pixels and strips go to and fro, and so do these triangles.
      const Vec3 t = cross(at[k] - at[0], at[k + 1] - at[0]);
      n = dot(t, n) < 0 ? n - t : n + t;
    }
    normal_ = dot(n, normal_) < 0 ? normal_ - n : normal_ + n;
  }
  void add_around(size_t i) {
    if (on_ == Association::point) {
      for (const uint32_t c : cells_[i]) {
        if (visited_.contains(c)) continue;
        open_cell(c);
        if (reach() == SIZE_MAX) visited_.add(c);
        if (cell_dimension_ != dimension_) continue;
        add_points(int64_t(i));
      }
      return;
    }
    open_cell(i);
    points_.assign(reader_.ids().begin(), reader_.ids().end());
    for (const int64_t p : points_)
      for (const uint32_t c : cells_[size_t(p)])
        if (dimensions_->same(i, c)) found_.add(int64_t(c));
  }

  CellReader reader_;
  Association on_;
  const PointCells& cells_;
  const CellDimensions* dimensions_;
  View<double> at_;
  IdList found_, visited_;    // places; cells that gave theirs
  size_t begin_ = 0;          // of the last ring
  size_t opened_ = SIZE_MAX;  // the reader's cell
  CellType type_ = CellType::empty;
  int cell_dimension_ = 0;
  std::vector<int64_t> points_;
  int dimension_ = 0;
  Vec3 normal_;
};

Array cell_centers(const CellReader& all) {
  double* out = nullptr;
  Array a = Array::make<double>(all.count(), 3, &out);
  parallel_for(all.count(), 1 << 12, [&](size_t begin, size_t end) {
    CellReader reader = all;
    for (size_t c = begin; c < end; ++c) {
      reader.open(c);
      Vec3 sum{0, 0, 0};
      for (const Vec3& p : reader.at()) sum = sum + p;
      for (int k = 0; k < 3; ++k) out[3 * c + size_t(k)] = sum[k] / double(std::max<size_t>(reader.at().size(), 1));
    }
  });
  return a;
}

constexpr int most_rings = 4;
// By which a ring must better the fit for another one to be tried: a mesh of one layer of cells gains nothing by more of it.
constexpr double worth_a_ring = 1.2, least_gain = 0.01;

// One place: all components share the geometry unless values are missing.
class Worker {
 public:
  Worker(Surroundings around, View<double> values) : around_(std::move(around)), f_(values) {}
  FittedGaps gaps;

  void derive(size_t i, double* gradient, double* hessian) {
    ++gaps.places;
    wants_hessian_ = hessian != nullptr;
    bool opened = false, alone = false, slopes = false, bends = false;
    for (int c = 0; c < f_.components; ++c) {
      Vec3 g{NAN, NAN, NAN};
      double h[6] = {NAN, NAN, NAN, NAN, NAN, NAN};
      if (std::isfinite(f_(i, c))) {
        if (!opened || !same_values(c)) place(i, c);
        opened = true;
        if (used_.empty()) {
          alone = true;
        } else {
          slopes |= !fit_.linear(), bends |= !fit_.quadratic();
          differences_.clear();
          for (const int64_t q : used_) differences_.push_back(f_(size_t(q), c) - f_(i, c));
          fit_.solve(differences_, g, hessian ? h : nullptr);
        }
      }
      for (int a = 0; a < 3; ++a) gradient[3 * c + a] = g[a];
      if (hessian) std::copy_n(h, 6, hessian + 6 * c);
    }
    gaps.alone += alone, gaps.slopes += slopes && !alone, gaps.bends += bends && !slopes && !alone;
  }

 private:
  // Whether component c has values where the one that the fit was made for has.
  bool same_values(int c) const {
    const auto& found = around_.found();
    return std::all_of(found.begin(), found.end(),
                       [&](int64_t q) { return std::isfinite(f_(size_t(q), c)) == std::isfinite(f_(size_t(q), fitted_)); });
  }
  // Neighbours whose component c is a number and that do not lie on the place itself, from `seen_` on.
  void choose(size_t i, int c) {
    const auto& found = around_.found();
    const Vec3 here = around_.position(i);
    for (; seen_ < found.size(); ++seen_) {
      const auto q = size_t(found[seen_]);
      const Vec3 d = around_.position(q) - here;
      if (!(dot(d, d) > 0) || !std::isfinite(f_(q, c))) continue;
      used_.push_back(int64_t(q));
      offsets_.push_back(d);
    }
  }
  void place(size_t i, int c) {
    fitted_ = c, seen_ = 0;
    used_.clear(), offsets_.clear();
    around_.open(i);
    choose(i, c);
    const int dimension = around_.dimension();
    if (dimension == 0) return used_.clear();
    // A few more than a parabola needs, so that it is a fit; borders and corners of tets have less around them.
    const size_t enough = QuadraticFit::needed(dimension) + 3;
    int rings = 1;
    if (used_.size() < enough) around_.grow(), ++rings, choose(i, c);
    fit_.place(offsets_, dimension, around_.normal());
    while (fit_.determined() < QuadraticFit::well_determined && rings < most_rings) {
      const size_t before = used_.size();
      const double determined = fit_.determined();
      if (!around_.grow()) break;
      ++rings;
      choose(i, c);
      if (used_.size() == before) continue;
      fit_.place(offsets_, dimension, around_.normal());
      if (before < enough || fit_.determined() > worth_a_ring * determined + least_gain) continue;
      // Nothing gained in the worst direction, as in a mesh of one layer of cells; perhaps in another one. Else nearer places do.
      const size_t undetermined = fit_.undetermined();
      fit_.place(std::span(offsets_).first(before), dimension, around_.normal());
      if (undetermined < fit_.undetermined()) {
        fit_.place(offsets_, dimension, around_.normal());
        continue;
      }
      used_.resize(before), offsets_.resize(before);
      break;
    }
    if (wants_hessian_ && fit_.quadratic() && on_one_side()) place_cubic(i, c, rings);
  }
  // At a border the third derivatives on either side of a place do not cancel.
  bool on_one_side() const {
    constexpr double aside = 0.2;
    Vec3 sum;
    double lengths = 0;
    for (const Vec3& d : offsets_) sum += d, lengths += length(d);
    return length(sum) > aside * lengths;
  }
  // Second derivatives of second order, where as many rings as that takes are there; else all stays as it is.
  void place_cubic(size_t i, int c, int rings) {
    const size_t before = used_.size(), enough = QuadraticFit::needed_by_cubic(around_.dimension()) + 3;
    for (;; ++rings) {
      if (used_.size() >= enough) fit_.place(offsets_, around_.dimension(), around_.normal(), true);
      if (fit_.cubic()) return;
      if (rings == most_rings || !around_.grow()) break;
      choose(i, c);
    }
    used_.resize(before), offsets_.resize(before);
    fit_.place(offsets_, around_.dimension(), around_.normal());
  }

  Surroundings around_;
  View<double> f_;
  QuadraticFit fit_;
  bool wants_hessian_ = false;
  int fitted_ = 0;   // the component that it was made for
  size_t seen_ = 0;  // of what was found
  std::vector<int64_t> used_;
  std::vector<Vec3> offsets_;
  std::vector<double> differences_;
};

// Of the places at(0), at(1) ...
template <class At>
FittedGaps derive(const DatasetPtr& d, Association on, const Array& values, size_t count, At&& at, double* gradient, double* hessian,
                  Context& context) {
  const PointCells cells(d);
  const CellReader reader(d);
  const bool of_cells = on == Association::cell;
  const Array positions = of_cells ? cell_centers(reader) : point_positions(d->mesh());
  std::optional<CellDimensions> dimensions;
  if (of_cells) dimensions.emplace(reader);
  const auto f = values.view<double>();
  const auto n = size_t(f.components);
  std::atomic<size_t> alone{0}, slopes{0}, bends{0};
  constexpr size_t places_per_task = 64;  // a fit takes some microseconds
  parallel_for(
      count, places_per_task,
      [&](size_t begin, size_t end) {
        Worker w(Surroundings(reader, on, cells, dimensions ? &*dimensions : nullptr, positions), f);
        for (size_t i = begin; i < end; ++i) w.derive(at(i), gradient + 3 * n * i, hessian ? hessian + 6 * n * i : nullptr);
        alone += w.gaps.alone, slopes += w.gaps.slopes, bends += w.gaps.bends;
      },
      &context);
  return {count, alone, slopes, bends};
}

}  // namespace

FittedGaps fitted_derivatives(const DatasetPtr& d, Association on, const Array& values, double* gradient, double* hessian,
                              Context& context) {
  return derive(
      d, on, values, values.count(), [](size_t i) { return i; }, gradient, hessian, context);
}

FittedGaps fitted_derivatives_at(const DatasetPtr& d, Association on, std::span<const uint32_t> places, const Array& values,
                                 double* gradient, double* hessian, Context& context) {
  return derive(
      d, on, values, places.size(), [&](size_t i) { return size_t(places[i]); }, gradient, hessian, context);
}

void warn_of_gaps(const FittedGaps& gaps, Association on, const char* who, const Context& context) {
  std::string text;
  const auto say = [&](size_t count, const char* what) {
    if (count > 0) text += fmt::format("{}{} {}", text.empty() ? "" : "; ", count, what);
  };
  say(gaps.alone, "have no neighbours and get NaN");
  say(gaps.slopes, "have neighbours along one line or plane only: derivatives across it are set to 0");
  say(gaps.bends,
      "have too few neighbours to separate slope from curvature: derivatives are first-order, undetermined second derivatives 0");
  if (!text.empty()) context.warn(fmt::format("{}: of {} {}s {}", who, gaps.places, association_name(on), text));
}

}  // namespace sg
