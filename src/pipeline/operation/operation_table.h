// SPDX-License-Identifier: Apache-2.0
// The macros that turn one line into an Operation. For operations.cpp and for tests that bring operations of their own:
//
//   #include "pipeline/operation/operation_table.h"
//   constexpr Operation table[] = { SG_FILTER(contour, ContourParams, contour, "scalar", "Surfaces of equal value.", op_version<2>) };
//
// `function` may have any of these shapes (R = DatasetPtr, CollectionPtr, TablePtr or Data):
//   R f(const DatasetPtr&, const P&, Context&)                     applied to each part of a collection
//   R f(const DatasetPtr&, const DatasetPtr&, const P&, Context&)  two inputs: each part of the first, with the second
//   R f(const Data&, const P&, Context&)                           sees collections whole
//   R f(const std::vector<Data>&, const P&, Context&)              any number of inputs
//   R f(const Series&, const P&, Context&)                         all time steps of the input, one at a time
//   R f(const Series&, const std::vector<Data>&, const P&, Context&)  the same, and further inputs as they are
// Behind the sentence come hooks: op_version<2>, op_inputs<1, -1>, needs_only_named_fields, lists_fields("fields"), shows_moment,
// takes(KINDS), makes(KINDS), or any callable that changes an Operation&. Kinds are in pipeline/operation/data_kinds.h: without these two
// an operation takes any mesh and gives the same kind; a source makes a uniform grid.
#pragma once
#include <tuple>
#include <type_traits>

#include "data/fields/place_notes.h"
#include "pipeline/operation/operation.h"

namespace sg {

namespace detail {

template <class P, class F>
constexpr bool takes_list = std::is_invocable_v<F, const std::vector<Data>&, const P&, Context&>;
template <class P, class F>
constexpr bool takes_whole = std::is_invocable_v<F, const Data&, const P&, Context&>;
template <class P, class F>
constexpr bool takes_two = std::is_invocable_v<F, const DatasetPtr&, const DatasetPtr&, const P&, Context&>;
template <class P, class F>
constexpr bool takes_part = std::is_invocable_v<F, const DatasetPtr&, const P&, Context&>;

template <class P, class F>
constexpr bool takes_series_alone = std::is_invocable_v<F, const Series&, const P&, Context&>;
template <class P, class F>
constexpr bool takes_series_and = std::is_invocable_v<F, const Series&, const std::vector<Data>&, const P&, Context&>;
template <class P, class F>
constexpr bool takes_series = takes_series_alone<P, F> || takes_series_and<P, F>;

/// Data at hand as a series of one step.
Series one_step(const Data& data);

/// Parameters of operations that take data elsewhere say `static constexpr bool moves_space = true;`; what others make lies where their
/// first input does, in the same units.
template <class P>
Data placed(const auto& from, Data result) {
  if constexpr (requires { P::moves_space; }) return result;
  else return with_place_of(from, std::move(result));
}

template <class P, class F>
Data run_series_filter(F f, const Series& series, const std::vector<Data>& others, const ParamSet& params, Context& context) {
  const P& p = params.as<P>();
  if constexpr (takes_series_alone<P, F>) return f(series, p, context);
  else return f(series, others, p, context);
}

template <class P, class F>
Data run_filter(F f, std::string_view name, const std::vector<Data>& inputs, const ParamSet& params, Context& context) {
  const P& p = params.as<P>();
  if constexpr (takes_series<P, F>)
    return run_series_filter<P>(f, one_step(inputs[0]), std::vector<Data>(inputs.begin() + 1, inputs.end()), params, context);
  else if constexpr (takes_list<P, F>) return placed<P>(inputs[0], f(inputs, p, context));
  else if constexpr (takes_whole<P, F>) return placed<P>(inputs[0], f(inputs[0], p, context));
  else if constexpr (takes_two<P, F>) {
    const DatasetPtr second = single_dataset(inputs[1], name);
    return map_parts(inputs[0], name, context,
                     [&](const DatasetPtr& d, Context& part) -> Data { return placed<P>(*d, f(d, second, p, part)); });
  } else {
    static_assert(takes_part<P, F>, "see the shapes in pipeline/operation/operation_table.h");
    return map_parts(inputs[0], name, context, [&](const DatasetPtr& d, Context& part) -> Data { return placed<P>(*d, f(d, p, part)); });
  }
}

template <class P, class F, class Run, class... Hooks>
constexpr Operation make_filter(std::string_view name, std::string_view family, std::string_view sentence, F, Run run, Hooks... hooks) {
  Operation o{name, family, sentence};
  o.make_params = make_param_set<P>;
  o.run = run;
  if constexpr (takes_series<P, F>)
    o.run_series = [](const Series& series, const std::vector<Data>& others, const ParamSet& params, Context& context) -> Data {
      return run_series_filter<P>(F(), series, others, params, context);
    };
  if constexpr (takes_list<P, F> || takes_series_and<P, F>) o.max_inputs = -1;
  else if constexpr (!takes_series<P, F> && !takes_whole<P, F> && takes_two<P, F>) o.min_inputs = o.max_inputs = 2;
  (hooks(o), ...);
  return o;
}

template <class P, class Run, class... Hooks>
constexpr Operation make_source(std::string_view name, std::string_view sentence, Run run, Hooks... hooks) {
  Operation o{name, "source", sentence, OperationKind::source, 1, 0, 0};
  o.make_params = make_param_set<P>;
  o.run = run;
  o.keeps = {}, o.makes = kinds::uniform;
  (hooks(o), ...);
  return o;
}

template <class... Names>
constexpr void put_names(FieldNeeds::Names& to, Names... names) {
  static_assert(sizeof...(names) <= std::tuple_size_v<FieldNeeds::Names>);
  size_t i = 0;
  ((to[i++] = names), ...);
}

}  // namespace detail

/// Hook: result version, part of the cache key; raise it when equal parameters give other numbers.
template <int N>
constexpr auto op_version = [](Operation& o) { o.version = N; };
// What an operation reads of its inputs. Without a hook: the fields wanted of its result, which it is taken to carry, and those that its
// parameters of type field name; everything while one of these is left open. tests/pipeline/operation/narrowed_test.cpp runs all operations
// with nothing but that.

/// Hook: the result has no field of the input.
constexpr auto needs_only_named_fields = [](Operation& o) { o.fields.result = FieldNeeds::Result::own; };
/// Hook: it depends on every field of the input.
constexpr auto needs_every_field = [](Operation& o) { o.fields.result = FieldNeeds::Result::every; };
/// Hook: parameters of type field that name none while they are left open.
constexpr auto may_lack(auto... parameters) {
  return [=](Operation& o) { detail::put_names(o.fields.may_lack, parameters...); };
}
/// Hook: words, and lists of words, that name fields.
constexpr auto lists_fields(auto... parameters) {
  return [=](Operation& o) { detail::put_names(o.fields.lists, parameters...); };
}
/// Hook: the same, where no name stands for every field.
constexpr auto lists_fields_or_all(auto... parameters) {
  return [=](Operation& o) { detail::put_names(o.fields.lists_or_all, parameters...); };
}
/// Hook: fields that it takes by name where they are there.
constexpr auto finds_fields(auto... names) {
  return [=](Operation& o) { detail::put_names(o.fields.found, names...); };
}
/// Hook: inputs behind the first N are shapes alone, without fields.
template <int N>
constexpr auto fields_of_first = [](Operation& o) { o.fields.inputs_with_fields = N; };
// What it does with a piece of its input, when several processes share the work. Without a hook: it needs the whole, and a piece of the
// result is cut out of that.

/// Hook: the result of a piece is a piece of the result; of `N` layers of cells around it the operation needs to know.
template <int N>
constexpr auto piecewise = [](Operation& o) { o.pieces.result = PieceWork::Result::of_piece, o.pieces.ghost_levels = N; };
/// Hook, behind piecewise: where ghosts of the result are wanted it needs the whole, since it leaves ghost cells out.
constexpr auto drops_ghosts = [](Operation& o) { o.pieces.keeps_ghosts = false; };
/// Hook, behind piecewise: all inputs come in pieces, not the first alone.
constexpr auto all_in_pieces = [](Operation& o) { o.pieces.inputs = INT32_MAX; };
/// Hook, behind piecewise: parameters that are chosen from all of the data while they are open (over_all() in data/ranks/over_all.h).
constexpr auto chosen_from_all(auto... parameters) {
  return [=](Operation& o) { detail::put_names(o.pieces.chosen, parameters...); };
}
/// Hook, behind piecewise: the same where a function of the parameters tells it; `always`: it counts through all of the data.
template <auto F>
constexpr auto chooses_from_all = [](Operation& o) { o.pieces.chooses = F; };
constexpr bool always(const ParamSet&) { return true; }
/// Hook: numbers of all pieces, which processes get together through Context::communicator.
constexpr auto reduces = [](Operation& o) { o.pieces.result = PieceWork::Result::of_all; };
/// Hook: what it asks for is changed by a function, see Operation::ask.
template <auto F>
constexpr auto asks = [](Operation& o) { o.ask = F; };
/// Hook: while `parameter` is open, F chooses it alike for several inputs and for all steps of a series, see Operation::choose.
template <auto F>
constexpr auto chooses_alike(std::string_view parameter) {
  return [=](Operation& o) { o.alike = parameter, o.choose = F; };
}
/// Hook: `time` chooses a moment of the input, see Operation::shows_moment.
constexpr auto shows_moment = [](Operation& o) { o.shows_moment = true; };
/// Hook: what a simulator will take, from its parameters alone: RunCost F(const P&).
template <class P, auto F>
constexpr auto costs = [](Operation& o) {
  o.estimate = [](const ParamSet& params, std::span<const uint64_t>) {
    const auto cost = F(params.as<P>());
    return Estimate{cost.bytes, cost.seconds, cost.frames, cost.steps, cost.stored, cost.guess};
  };
};
/// Hook: the same of one in data: RunCost F(const P&, uint64_t bytes of the first input).
template <class P, auto F>
constexpr auto costs_in_data = [](Operation& o) {
  o.estimate = [](const ParamSet& params, std::span<const uint64_t> inputs) {
    const auto cost = F(params.as<P>(), inputs.empty() ? 0 : inputs[0]);
    return Estimate{cost.bytes, cost.seconds, cost.frames, cost.steps, cost.stored, cost.guess};
  };
};
/// Hook: how many inputs a filter over a list takes; MAX -1 = any number.
template <int MIN, int MAX>
constexpr auto op_inputs = [](Operation& o) { o.min_inputs = MIN, o.max_inputs = MAX; };
/// Hook: the kinds that the first input may be; `hint`: what would be right in place of others (default: by the kind that was given).
constexpr auto takes(KindSet kinds, std::string_view hint = {}) {
  return [=](Operation& o) { o.takes = kinds, o.takes_hint = hint; };
}
/// Hook: the kinds that the second input and further ones may be.
constexpr auto takes_further(KindSet kinds) {
  return [=](Operation& o) { o.takes_further = kinds; };
}
/// Hook: the kinds that come out, but inputs of the kinds in `keeps` give the same kind.
constexpr auto makes(KindSet kinds, KindSet keeps = {}) {
  return [=](Operation& o) { o.makes = kinds, o.keeps = keeps; };
}
/// Hook: one input may give a collection of several parts.
constexpr auto makes_parts = [](Operation& o) { o.makes_parts = true; };

}  // namespace sg

// A lambda around the name lets `function` be overloaded.
#define SG_CALL(function) \
  [](auto&&... a) -> decltype(function(static_cast<decltype(a)>(a)...)) { return function(static_cast<decltype(a)>(a)...); }

#define SG_FILTER(name, Params, function, family, sentence, ...)                                                                     \
  ::sg::detail::make_filter<Params>(#name, family, sentence, SG_CALL(function),                                                      \
                                    [](const std::vector<::sg::Data>& in, const ::sg::ParamSet& p, ::sg::Context& c) -> ::sg::Data { \
                                      return ::sg::detail::run_filter<Params>(SG_CALL(function), #name, in, p, c);                   \
                                    } __VA_OPT__(, ) __VA_ARGS__)

#define SG_SOURCE(name, Params, function, sentence, ...)                                                                          \
  ::sg::detail::make_source<Params>(#name, sentence,                                                                              \
                                    [](const std::vector<::sg::Data>&, const ::sg::ParamSet& p, ::sg::Context& c) -> ::sg::Data { \
                                      return function(p.as<Params>(), c);                                                         \
                                    } __VA_OPT__(, ) __VA_ARGS__)
