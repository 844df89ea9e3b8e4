// SPDX-License-Identifier: Apache-2.0
// Operation: a source or filter as the graph, the command line and the help see it. The table is made from operations.def
// at compile time; nothing registers itself.
#pragma once
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/context.h"
#include "base/schema/schema.h"
#include "base/text/help_word.h"
#include "data/dataset.h"
#include "pipeline/graph/request.h"
#include "pipeline/operation/data_kinds.h"

namespace sg {

enum class OperationKind { source, filter };

/// What running is expected to cost.
struct Estimate {
  uint64_t bytes = 0;  ///< of the result
  double seconds = 0;
};

struct Operation {
  std::string_view name, family, sentence;
  OperationKind kind = OperationKind::filter;
  int version = 1;                     ///< raised when the same parameters give other numbers than before: part of the key
  int min_inputs = 1, max_inputs = 1;  ///< max_inputs -1 = any number
  ParamSet (*make_params)() = nullptr;
  Data (*run)(const std::vector<Data>& inputs, const ParamSet& params, Context& context) = nullptr;
  /// Takes the whole time series of its first input, see graph/series_input.h; null: it takes one moment. A parameter `time` that is
  /// left open follows the request, a parameter `times` (a word) says which times to take where the input has none of its own.
  Data (*run_series)(const Series& series, const std::vector<Data>& others, const ParamSet& params, Context& context) = nullptr;
  /// What it needs of its inputs to answer `wanted`; null = everything, at the same time.
  Request (*request)(const ParamSet& params, const Request& wanted) = nullptr;
  /// From the bytes of the inputs; null = each byte is touched once at 2 GB/s and the result is as large as the largest input.
  Estimate (*estimate)(const ParamSet& params, std::span<const uint64_t> input_bytes) = nullptr;
  /// Its parameter `time` chooses a moment out of what its input holds whole (lines with times, ...): a film states it there, and leaves
  /// what lies above as it is.
  bool shows_moment = false;
  /// The language of its parameters, for help: operators and functions of expressions; null: none.
  std::vector<HelpWord> (*words)() = nullptr;
  /// What its first input and each further one may be; a collection: each of its parts (check_inputs.h).
  KindSet takes = kinds::meshes, takes_further = kinds::meshes;
  /// What would be right in place of a kind that `takes` leaves out; "": by the kind alone.
  std::string_view takes_hint = {};
  /// What comes out: a first input of a kind in `keeps` gives the same kind, any other, and no input at all, one of `makes`; a collection,
  /// where it is taken part by part, one of such parts.
  KindSet keeps = kinds::meshes, makes = {};
  bool makes_parts = false;  ///< one input may give a collection of named parts of these kinds
};

/// All operations of this build, in the order of operations.def.
std::span<const Operation> operations();
/// Null for an unknown name.
const Operation* known_operation(std::string_view name, std::span<const Operation> table = operations());
/// Throws Error(usage) with "did you mean" for an unknown name.
const Operation& find_operation(std::string_view name, std::span<const Operation> table = operations());

/// Defaults changed by "key=value" words; all mistakes in one Error(usage).
ParamSet make_params(const Operation& operation, const std::vector<std::string>& words);
/// Checks the number of inputs and runs.
Data run_operation(const Operation& operation, const std::vector<Data>& inputs, const std::vector<std::string>& words, Context& context);
/// The request that goes up to the inputs of `operation`.
Request upstream_request(const Operation& operation, const ParamSet& params, const Request& wanted);

/// "the same kind of mesh"; "of a surface or a point cloud the same kind, else an unstructured mesh".
std::string makes_text(const Operation& operation);
/// "Takes: a mesh with cells; makes: a surface."
std::string kinds_help(const Operation& operation);
/// One operation for people: sentence, kinds and parameters. "" = all operations by family.
std::string ops_help(std::string_view name = {}, std::span<const Operation> table = operations());
/// Its words, each with its sentence, by group; "" when it has none.
std::string words_help(const Operation& operation);

/// Same tree with f applied to every dataset; an Error that leaves f names the part. Null results are dropped. A lone table
/// is an Error(usage) naming `who`. In a collection, a part of points and lines alone that f refuses (Error(usage)) is left out
/// with a note while f takes any other part; what f tells of parts of which nothing is left is told only when nothing is left
/// of any; and equal notes are told once.
Data map_parts(const Data& data, std::string_view who, Context& context, const std::function<Data(const DatasetPtr&, Context&)>& f);

}  // namespace sg
