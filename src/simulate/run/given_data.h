// SPDX-License-Identifier: Apache-2.0
// The data that a run was given beside its parameters: what tells it from other data, in memory and in a stored state.
#pragma once
#include <string>
#include <utility>
#include <vector>

#include "data/dataset.h"

namespace sg {

class GivenData {
 public:
  GivenData() = default;
  /// The mesh of a dataset and these of its fields matter to the run. `as`: what it is to the run, where parameters do not say that.
  void add(DatasetPtr data, std::vector<const Field*> fields = {}, std::string as = {}) {
    parts_.push_back({std::move(data), std::move(fields), std::move(as)});
  }
  bool empty() const { return parts_.empty(); }
  /// Which objects they are. The run has to hold them: no others get their addresses then.
  std::string objects() const;
  /// What is in them (data/content_hash.h).
  std::string content() const;

 private:
  struct Part {
    DatasetPtr data;
    std::vector<const Field*> fields;
    std::string as;
  };
  std::vector<Part> parts_;
};

}  // namespace sg
