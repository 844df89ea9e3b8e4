// SPDX-License-Identifier: Apache-2.0
// The case file of EnSight Gold: which files hold the geometry and the variables, and at which times. Source: EnSight User Manual,
// "EnSight Gold Casefile Format".
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "data/dataset.h"

namespace sg::ensight {

/// A TIME section. Step k has the file number `file_numbers[k]` (empty: no pattern is used) and the time `times[k]`.
struct TimeSet {
  int number = 1;
  std::vector<double> times;
  std::vector<int64_t> file_numbers;
};

/// A FILE section: steps that lie one after the other in one file. `index` and `steps` are equally long; index -1 = no pattern.
struct FileSet {
  int number = 1;
  std::vector<int64_t> index, steps;
};

/// A file name, perhaps with a pattern ("p.****"), and the sets that determine its content at a time; 0 = none.
struct FileRef {
  std::string name;
  int time_set = 0, file_set = 0;
};

enum class VariableKind { scalar, vector, tensor_symm, tensor_asym, constant };

struct Variable {
  std::string name;
  VariableKind kind = VariableKind::scalar;
  Association association = Association::point;
  bool complex = false, measured = false;
  FileRef file, imaginary;        ///< `imaginary` of complex variables only
  std::vector<double> constants;  ///< of a constant: one per step of its time set, or one
  int components() const;
};

struct CaseFile {
  std::string path;
  bool gold = true;  ///< false: EnSight 6, whose geometry and variables are laid out otherwise
  FileRef model;
  std::optional<FileRef> measured;
  std::vector<Variable> variables;
  std::vector<TimeSet> time_sets;
  std::vector<FileSet> file_sets;
  std::vector<std::string> left_out;  ///< lines that are understood but not read

  /// All times of all sets, ascending, each once.
  std::vector<double> times() const;
};

/// "p.***" for 7 is "p.007": the asterisks become the number, with leading zeros up to their count.
std::string with_number(const std::string& pattern, int64_t number);

/// Throws Error(data) that names the line.
CaseFile parse_case(const std::string& path);

/// Which file, and which step in it (-1 = the file holds one step without marks), at a time.
struct FileStep {
  std::string path;
  int64_t step = -1;
};
FileStep file_at(const CaseFile& c, const FileRef& ref, std::optional<double> time);
/// The step of a set that is valid at a time: the last one not after it, else the first.
size_t step_at(const TimeSet& set, std::optional<double> time);
const TimeSet* find_time_set(const CaseFile& c, int number);

}  // namespace sg::ensight
