// SPDX-License-Identifier: Apache-2.0
// TensorSampler: a tensor field of any mesh at any place. TensorCursor: asks it, one per thread.
#pragma once
#include <memory>
#include <span>

#include "filter/tensor/tensor_field.h"
#include "filter/tensor/tensor_interpolation.h"
#include "index/cell_locator.h"

namespace sg {

/// Shared and immutable. Between the points tensors are interpolated by the cells' shape functions: component by component, or (log) their
/// logarithms, which keeps determinants monotone and tensors positive (log-Euclidean; Arsigny et al. 2006). On surface meshes only a 3D
/// tensor's part in the surface counts: two eigenvectors lie in it, the third is its normal.
class TensorSampler {
 public:
  /// For log, eigenvalues below 1e-6 of the largest of the field count as that, with one warning.
  /// Throws Error(usage) naming `who` for what read_tensors refuses and for meshes without cells of surfaces or volume.
  TensorSampler(const DatasetPtr& dataset, const TensorSource& source, TensorInterpolation interpolation, std::string who, Context& ctx);

  const DatasetPtr& dataset() const { return dataset_; }
  const TensorField& tensors() const { return tensors_; }
  const CellLocator& locator() const { return *locator_; }
  int dimension() const { return dimension_; }  ///< of the cells: 3, or 2 on surfaces
  bool logarithmic() const { return logarithmic_; }

 private:
  DatasetPtr dataset_;
  TensorField tensors_;
  std::unique_ptr<const CellLocator> locator_;
  int dimension_ = 3;
  bool logarithmic_ = false;
};

class TensorCursor {
 public:
  explicit TensorCursor(const TensorSampler& sampler) : sampler_(&sampler), locator_(sampler.locator()) {}

  /// The tensor at x; false outside the mesh, in hidden cells and where it is NaN.
  bool tensor(Vec3 x, SymTensor& d);
  /// Its eigenvalues and vectors; on surfaces the third is the normal.
  bool eigen(Vec3 x, Eigen3& e);
  /// Size of the cell of the last place that was found: the d-th root of the volume of its box.
  double cell_length() const { return length_; }
  int64_t cell() const { return cell_; }
  std::span<const int64_t> ids() const { return locator_.ids(); }
  std::span<const double> weights() const { return locator_.weights(); }
  /// x, or the nearest place of a mesh of surfaces.
  Vec3 snap(Vec3 x);

 private:
  bool find(Vec3 x);
  void measure();
  const TensorSampler* sampler_;
  LocatorCursor locator_;
  int64_t cell_ = -1, measured_ = -1;
  double length_ = 0;
};

/// Highest dimension of the cells of a mesh; 0 for points.
int dimension_of_cells(const DatasetPtr& d);

}  // namespace sg
