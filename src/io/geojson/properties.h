// SPDX-License-Identifier: Apache-2.0
// What features of GeoJSON say of themselves, as fields.
#pragma once
#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "base/text/json.h"
#include "data/dataset.h"
#include "io/io.h"

namespace sg::geojson {

/// Columns over the features, in the order in which their names are met.
class Properties {
 public:
  /// The members of an object; null has none. `feature`: ascending from call to call. Nothing is copied: the values must live on.
  void add(size_t feature, const Json& properties);
  void set(size_t feature, const std::string& name, const Json& value);
  bool has(const std::string& name) const { return index_.count(name) > 0; }

  /// A field of each column that is asked for, with the value of `feature[i]` at place i: numbers (i32 or i64, where all are whole and none
  /// is missing, else f64 with NaN) and words as categories. Columns of lists and objects, and of too many words, are left out and told.
  void add_fields(std::span<const int32_t> feature, Association on, size_t features, const ReadOptions& options, Context& context,
                  DatasetParts& parts) const;

 private:
  struct Column {
    std::string name;
    std::vector<std::pair<size_t, const Json*>> values;  ///< of the features that have one
  };
  std::vector<Column> columns_;
  std::map<std::string, size_t> index_;
};

}  // namespace sg::geojson
