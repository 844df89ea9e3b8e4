// SPDX-License-Identifier: Apache-2.0
// Operation: a source or filter as the graph, the command line and the help see it. The table is made from operations.def
// at compile time; nothing registers itself.
#pragma once
#include <array>
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
  std::optional<uint64_t> frames = {};  ///< of a simulator: that it computes one from another
  uint64_t steps = 0;                   ///< of all of them together, about; 0: that is not known
  uint64_t stored = 0;                  ///< the frame that a stored state goes on from: `frames` are those left
  std::string guess = {};               ///< what `steps` was guessed from; "": it is known
};

/// Which fields an operation reads of its inputs, beside those that its parameters of type field name. Names are of parameters but for
/// `found`.
struct FieldNeeds {
  using Names = std::array<std::string_view, 4>;  ///< the unused ones are ""
  enum class Result : uint8_t {
    carries,  ///< the result has fields of the input: those wanted of it are asked for
    own,      ///< it has none of them
    every     ///< it depends on all fields of the input, or nobody knows beforehand on which
  } result = Result::carries;
  Names may_lack{};                    ///< of type field: none while left open; any other asks for every field then, since the data decide
  Names lists{};                       ///< further parameters that hold names of fields: words or lists of words
  Names lists_or_all{};                ///< lists that stand for every field while they are empty
  Names found{};                       ///< fields that it takes by these names where the input has them
  int inputs_with_fields = INT32_MAX;  ///< of those behind, the mesh alone is read
};

/// How an operation goes with one of several pieces of its input, when processes share the work.
struct PieceWork {
  enum class Result : uint8_t {
    of_whole,  ///< needs the whole input; a piece is cut out of the result
    of_piece,  ///< the result of a piece is a piece of the result
    of_all     ///< a number of all pieces, which every process gets through the communicator
  } result = Result::of_whole;
  int ghost_levels = 0;                               ///< layers of cells that it needs around a piece
  bool keeps_ghosts = true;                           ///< ghosts of the input are ghosts of the result
  int inputs = 1;                                     ///< so many inputs, from the first, come in pieces; further ones whole
  FieldNeeds::Names chosen{};                         ///< parameters that are chosen from all of the data while they are open ...
  bool (*chooses)(const ParamSet& params) = nullptr;  ///< ... or whether something is: that no process does alone
};

struct Operation {
  std::string_view name, family, sentence;
  OperationKind kind = OperationKind::filter;
  int version = 1;                     ///< raised when the same parameters give other numbers than before: part of the key
  int min_inputs = 1, max_inputs = 1;  ///< max_inputs -1 = any number
  ParamSet (*make_params)() = nullptr;
  /// Whether its parameters are of this struct.
  template <class P>
  bool is() const {
    return make_params().fresh == make_param_set<P>;
  }
  Data (*run)(const std::vector<Data>& inputs, const ParamSet& params, Context& context) = nullptr;
  /// Takes the whole time series of its first input, see graph/series_input.h; null: it takes one moment. A parameter `time` that is
  /// left open follows the request, a parameter `times` (a word) says which times to take where the input has none of its own.
  Data (*run_series)(const Series& series, const std::vector<Data>& others, const ParamSet& params, Context& context) = nullptr;
  FieldNeeds fields = {};
  PieceWork pieces = {};
  /// Changes what goes up to an input, where `fields` cannot say it: names in expressions, a region of space.
  void (*ask)(const ParamSet& params, const Request& wanted, size_t input, Request& up) = nullptr;
  /// A parameter that several inputs, and the steps of a series, have alike where it is left open; "": none.
  std::string_view alike = {};
  /// Its value, as a word has it, chosen from the first input and all parts beside it (data/ranks/over_all.h); "" where there is none.
  /// Throws what running throws.
  std::string (*choose)(const Dataset& data, const ParamSet& params, const Context& context) = nullptr;
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
/// Whether the piece that `wanted` is of can be made of pieces of the inputs; else of the whole. `together`: all pieces are asked for at
/// the same time by processes that can speak (Context::communicator).
bool works_by_piece(const Operation& operation, const ParamSet& params, const Request& wanted, bool together);
/// The request that goes up to an input of `operation`.
Request upstream_request(const Operation& operation, const ParamSet& params, const Request& wanted, size_t input = 0,
                         bool together = false);

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
