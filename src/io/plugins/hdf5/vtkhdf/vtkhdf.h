// SPDX-License-Identifier: Apache-2.0
// What the readers of the VTKHDF dataset kinds share. Format: VTK documentation, "VTKHDF file format".
#pragma once
#include "io/io.h"
#include "io/plugins/hdf5/h5.h"
#include "io/steps/steps.h"

namespace sg::vtkhdf {

/// The chosen step of a group: `index` into the tables of Steps.
struct Step {
  bool any = false;
  uint64_t index = 0;
  std::optional<double> time;
};

/// One group that holds a dataset, and what is wanted of it.
struct Group {
  const h5::File& file;
  std::string path;  ///< "/VTKHDF" or a block below it
  const ReadOptions& options;
  Context& context;
  Step step;

  std::string at(std::string_view name) const { return path + "/" + std::string(name); }
  /// Entry [step][column] of Steps/NAME; `otherwise` when there are no steps or no such table.
  uint64_t step_entry(const std::string& name, uint64_t otherwise, uint64_t column = 0) const;
  bool wants(const std::string& field) const;
};

/// Time values of a group with Steps; empty without.
std::vector<double> step_values(const h5::File& file, const std::string& group);

/// Names of the numeric datasets in PointData, CellData or FieldData that are wanted; those that cost reading only when values are.
std::vector<std::string> field_names(const Group& g, const std::string& data);
/// Role that the attributes of PointData or CellData give an array.
Role role_of(const Group& g, const std::string& data, const std::string& name);
/// A field with its role and its unit (an attribute "units" of the array, ours).
Field field_of(const Group& g, const std::string& data, const std::string& name, Association association, Array values);
/// Rows [begin, begin+n) of an array of `data`, from the start given by the step's table, else from `otherwise` on.
Array read_field(const Group& g, const std::string& data, const std::string& name, uint64_t otherwise, uint64_t begin, uint64_t n);
/// FieldData: arrays of the whole, and texts as notes.
void read_whole_fields(const Group& g, DatasetParts& parts);

void read_image(const Group& g, DatasetParts& parts);
void read_unstructured(const Group& g, DatasetParts& parts);
void read_polydata(const Group& g, DatasetParts& parts);
void read_amr(const Group& g, DatasetParts& parts);

std::unique_ptr<StepsWriter> write_steps(const std::string& path, StepsPlan plan, const WriteOptions& options, Context& context);

}  // namespace sg::vtkhdf

namespace sg {
Data read_vtkhdf(const std::string& path, const ReadOptions& options, Context& context);
std::vector<double> times_of_vtkhdf(const std::string& path, const ReadOptions& options, Context& context);
void write_vtkhdf(const std::string& path, const Data& data, const WriteOptions& options, Context& context);
}  // namespace sg
