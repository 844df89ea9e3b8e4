// SPDX-License-Identifier: Apache-2.0
// What a file cannot hold of the data written to it, reported in one warning.
#pragma once
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "base/context.h"
#include "data/dataset.h"

namespace sg {

/// Whether each number of `a` is the same after conversion to `type` (NaN counts as the same). In parallel.
bool survives(const Array& a, ElementType type);
/// Whether positions are the same as f32, origin included.
bool survives_f32(const Points& points);

/// Collects while a writer works; tell() warns once, and only when something is lost:
///   out.glb: glTF leaves out 'T' (cells); rounds 'id' (i64 to f32); renames 'a/b' to 'a_b'; drops the units of 'p'
/// Each field is named once for each kind of loss, whatever the number of parts.
class WriteLosses {
 public:
  WriteLosses(std::string path, std::string format) : path_(std::move(path)), format_(std::move(format)) {}

  void leaves_out(const Field& f);
  /// All fields that lie there.
  void leaves_out(const Dataset& d, Association a);
  /// All fields but one, and its unit unless the format keeps it.
  void keeps_only(const Dataset& d, const Field& kept, bool keeps_unit);
  /// The point field that a file of one array at the points of a uniform grid keeps: the active scalar, or else the first. Throws
  /// Error(usage) where there is none.
  const Field& one_point_field(const Dataset& d, bool keeps_unit);
  /// Says so when values change.
  void rounds(const Field& f, ElementType type);
  void rounds(std::string_view what, ElementType from, ElementType to);
  /// Says so when the names differ.
  void renames(const Field& f, std::string_view name);
  /// A field in several.
  void splits(const Field& f);
  /// Says so when there is a unit.
  void drops_unit(const Field& f);
  /// Anything else, as a verb and what it is done to: "drops the time".
  void also(std::string sentence);

  void tell(Context& context) const;

 private:
  void add(std::string_view verb, std::string item);
  std::string path_, format_;
  std::vector<std::pair<std::string, std::vector<std::string>>> said_;  // verb, what
};

}  // namespace sg
