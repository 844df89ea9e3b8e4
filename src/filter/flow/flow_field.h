// SPDX-License-Identifier: Apache-2.0
// FlowField: a vector field of any mesh at one time. FlowCursor: asks it at places, one per thread.
//
// All that moves things through a flow (lines, fronts, particles, textures, maps) is a template over a *flow*: anything with
//   bool operator()(Vec3 x, double t, Vec3& v)   velocity at a place and time; false where there is none
//   double cell_length() const                   size of the cell of the last answer that was true
//   Vec3 snap(Vec3 x)                            x itself, or the nearest place of a mesh of surfaces
// FlowCursor is one (it does not look at t), UnsteadyCursor (unsteady/) another, and so is any lambda in a test (see AnalyticFlow).
#pragma once
#include <memory>
#include <span>
#include <string>

#include "base/context.h"
#include "data/dataset.h"
#include "index/cell_locator.h"

namespace sg {

class FlowAccess;

/// Shared and immutable. Velocities are interpolated by the cells' shape functions between the points; a cell field is first averaged to
/// the points (cell_to_point). Two components get z = 0.
class FlowField {
 public:
  /// `field` empty: the active vector field (role vectors, else the first of 3, else of 2 components). `index`: a locator of the same mesh
  /// that is to be used again (next time step); null makes one. Throws Error(usage) when there is no such field or it does not have 2 or 3
  /// components, or when the mesh has no cells. Velocities that are infinite, or too large to be squared, count as none, with a note.
  FlowField(DatasetPtr dataset, const std::string& field, Context& context, std::shared_ptr<const CellLocator> index = {});

  const DatasetPtr& dataset() const { return dataset_; }
  const Field& field() const { return field_; }  ///< on points
  /// Made on first use.
  const std::shared_ptr<const CellLocator>& locator() const;
  int dimension() const { return dimension_; }  ///< 3 with solid cells, else 2 (or 1): the mesh is a surface, flat or curved
  double largest_speed() const { return largest_speed_; }
  /// Median of the speeds that are not 0, of some thousand points; 0 where there are none.
  double usual_speed() const;
  /// A cell's size along an axis, as if all were alike; positive.
  double usual_cell() const;
  /// Velocity at a point of the mesh; NaN where it has no value.
  Vec3 at_point(size_t id) const {
    if (f32_) {
      const float* v = f32_ + id * size_t(components_);
      return {v[0], v[1], components_ > 2 ? v[2] : 0.0};
    }
    const double* v = f64_ + id * size_t(components_);
    return {v[0], v[1], components_ > 2 ? v[2] : 0.0};
  }
  const float* f32() const { return f32_; }  ///< packed, or null
  const double* f64() const { return f64_; }
  int components() const { return components_; }
  const FlowAccess& access() const { return *access_; }

 private:
  void measure_speeds(Context& context);
  DatasetPtr dataset_;
  Field field_;
  Array packed_;
  std::shared_ptr<const FlowAccess> access_;
  const float* f32_ = nullptr;
  const double* f64_ = nullptr;
  int components_ = 3, dimension_ = 3;
  double largest_speed_ = 0;
};

/// The field that flow operations take: `name`, else the active vectors. Throws Error(usage) naming `who`.
const Field& flow_field_of(const Dataset& dataset, const std::string& name, std::string_view who);

class FlowCursor {
 public:
  explicit FlowCursor(const FlowField& field);
  FlowCursor(FlowCursor&&) noexcept;
  ~FlowCursor();

  /// Velocity at x; false outside the mesh, in hidden cells, and where it is NaN. On surfaces: at the nearest place within a cell's size
  /// (not beyond their border), and only the part along the surface.
  bool operator()(Vec3 x, Vec3& v);
  bool operator()(Vec3 x, double, Vec3& v) { return (*this)(x, v); }
  /// The same with the velocity gradient, m[i][j] = dv_i/dx_j: that of the cell's interpolant.
  bool gradient(Vec3 x, Vec3& v, Mat3& j);
  /// Of the last place: the cell, its size (the d-th root of the volume of its box, in grids of its own volume), ids and weights of its
  /// points. Where several cells hold the place, any of them.
  int64_t cell() const;
  double cell_length() const;
  std::span<const int64_t> ids() const;
  std::span<const double> weights() const;
  Vec3 snap(Vec3 x);
  /// The same; false when there is no place of the mesh within a cell's size.
  bool snap(Vec3 x, Vec3& at);
  const FlowField& field() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// A flow given by a function v(x, t), for tests and for analytic sources; everywhere, or inside a box.
template <class F>
struct AnalyticFlow {
  F velocity;
  double length = 1;
  Box3 box{};  ///< empty: everywhere
  bool operator()(Vec3 x, double t, Vec3& v) {
    if (!box.empty())
      for (int a = 0; a < 3; ++a)
        if (!(x[a] >= box.lo[a] && x[a] <= box.hi[a])) return false;
    v = velocity(x, t);
    return true;
  }
  double cell_length() const { return length; }
  Vec3 snap(Vec3 x) { return x; }
};

}  // namespace sg
