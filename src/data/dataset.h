// SPDX-License-Identifier: Apache-2.0
// Dataset: a mesh and its fields, immutable. Collection: named parts. Series: time steps on demand.
#pragma once
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "data/field.h"
#include "data/mesh.h"

namespace sg {

class Dataset;
class Memo;
struct BrickedVolume;
using DatasetPtr = std::shared_ptr<const Dataset>;

/// Bits of ghost arrays, as in VTK files.
enum GhostBits : uint8_t { ghost_duplicate = 1, ghost_hidden_point = 2, ghost_refined_cell = 8, ghost_hidden_cell = 32 };

/// What goes into a Dataset; fill it and call make_dataset.
struct DatasetParts {
  Mesh mesh;
  FieldSet fields;
  Array point_ghost, cell_ghost;                           ///< u8 GhostBits per point / cell, or empty
  std::vector<std::pair<std::string, std::string>> notes;  ///< from the file: title, unit of length, history
  std::optional<double> time;
};

class Dataset {
 public:
  const Mesh& mesh() const { return parts_.mesh; }
  const FieldSet& fields() const { return parts_.fields; }
  const Array& point_ghost() const { return parts_.point_ghost; }
  const Array& cell_ghost() const { return parts_.cell_ghost; }
  const std::vector<std::pair<std::string, std::string>>& notes() const { return parts_.notes; }
  std::optional<double> time() const { return parts_.time; }
  const DatasetParts& parts() const { return parts_; }  ///< copy, change, make_dataset: arrays are shared, not copied

  template <class M>
  const M* as() const {
    return std::get_if<M>(&parts_.mesh);
  }

  std::string_view kind() const { return mesh_kind(parts_.mesh); }
  size_t point_count() const { return points_; }
  size_t cell_count() const { return cells_; }
  /// Computed once, on first use.
  const Box3& bounds() const;
  /// Range of the finite, not hidden values; computed once per field, on first use.
  const FieldStats& stats(const Field& field) const;
  /// The volume that the mesh and its values are one coarse level of (data/bricked.h); null for all others.
  const std::shared_ptr<const BrickedVolume>& bricks() const { return bricks_; }
  /// Indexes and the like that were made from this dataset and live as long as it does.
  Memo& memo() const { return *memo_; }
  /// Range of one component, or of the magnitude when component is -1 and there are several.
  Range range(const Field& field, int component = -1) const;

 private:
  friend DatasetPtr make_dataset(DatasetParts parts, std::shared_ptr<const BrickedVolume> bricks);
  Dataset(DatasetParts parts, std::shared_ptr<const BrickedVolume> bricks);
  DatasetParts parts_;
  std::shared_ptr<const BrickedVolume> bricks_;
  size_t points_ = 0, cells_ = 0;
  mutable std::mutex mutex_;
  mutable std::optional<Box3> bounds_;
  mutable std::vector<std::pair<const std::byte*, std::unique_ptr<FieldStats>>> stats_;
  std::shared_ptr<Memo> memo_;
};

/// Validates (mesh, field lengths) and freezes. Throws Error(data).
DatasetPtr make_dataset(DatasetParts parts);
/// `parts` are one level of a bricked volume: renderers may read finer values of it; bounds() and the range of its field are the volume's.
/// What filters make of it is not a level of the volume any more.
DatasetPtr make_dataset(DatasetParts parts, std::shared_ptr<const BrickedVolume> bricks);
DatasetPtr make_dataset(Mesh mesh, FieldSet fields = {});

struct Collection;
using CollectionPtr = std::shared_ptr<const Collection>;
/// Columns of equal length. A column of words holds i32 indices into its list of labels, -1 where there is none.
struct Table {
  std::vector<Field> columns;
  std::vector<std::vector<std::string>> labels;  ///< one list per column (empty for numbers), or none at all
  /// The labels of a column of words; null for numbers.
  const std::vector<std::string>* words(size_t column) const {
    return column < labels.size() && !labels[column].empty() ? &labels[column] : nullptr;
  }
};
using TablePtr = std::shared_ptr<const Table>;

using DataKinds = std::variant<DatasetPtr, CollectionPtr, TablePtr>;

/// What flows between operations. A class as Mesh is, for the same reason.
class Data : public DataKinds {
 public:
  using DataKinds::DataKinds, DataKinds::operator=;
  Data() = default;
  Data(const Data&);
  Data(Data&&) noexcept;
  Data& operator=(const Data&);
  Data& operator=(Data&&) noexcept;
  ~Data();
};

/// Named parts (multiblock, parallel pieces), nested to any depth.
struct Collection {
  struct Part {
    std::string name;
    Data data;
  };
  std::vector<Part> parts;
};

/// Time values and a way to load a step.
struct Series {
  std::vector<double> times;
  std::function<Data(size_t step)> load;
};

/// Calls f(name, dataset) for every dataset in order; name is the path of part names ("wing/left"), "" for a lone dataset.
void for_each_dataset(const Data& data, const std::function<void(const std::string&, const DatasetPtr&)>& f);
/// Same tree with every dataset replaced by f(dataset); parts for which f returns null are dropped. Tables pass through.
Data map_datasets(const Data& data, const std::function<DatasetPtr(const DatasetPtr&)>& f);
/// The dataset itself, or the only one of a collection; throws Error(usage) naming `who` when there are none or several.
DatasetPtr single_dataset(const Data& data, std::string_view who);

/// One line for logs and errors: "uniform 256x256x94, 6160384 points, 1 field".
std::string summary(const Dataset& dataset);

}  // namespace sg
