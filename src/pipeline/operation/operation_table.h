// SPDX-License-Identifier: Apache-2.0
// The macros that turn one line into an Operation. For operations.cpp and for tests that bring operations of their own:
//
//   #include "pipeline/operation/operation_table.h"
//   constexpr Operation table[] = { SG_FILTER(contour, ContourParams, contour, "scalar", "Surfaces of equal value.", carries_fields) };
//
// `function` may have any of these shapes (R = DatasetPtr, CollectionPtr, TablePtr or Data):
//   R f(const DatasetPtr&, const P&, Context&)                     applied to each part of a collection
//   R f(const DatasetPtr&, const DatasetPtr&, const P&, Context&)  two inputs: each part of the first, with the second
//   R f(const Data&, const P&, Context&)                           sees collections whole
//   R f(const std::vector<Data>&, const P&, Context&)              any number of inputs
//   R f(const Series&, const P&, Context&)                         all time steps of the input, one at a time
//   R f(const Series&, const std::vector<Data>&, const P&, Context&)  the same, and further inputs as they are
// Behind the sentence come hooks: op_version<2>, op_inputs<1, -1>, carries_fields, needs_only_named_fields, shows_moment, takes(KINDS),
// makes(KINDS), or any callable that changes an Operation&. Kinds stand in pipeline/operation/data_kinds.h. Without these two an operation
// takes any mesh and gives the same kind; a source makes a uniform grid.
#pragma once
#include <type_traits>

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
  else if constexpr (takes_list<P, F>) return f(inputs, p, context);
  else if constexpr (takes_whole<P, F>) return f(inputs[0], p, context);
  else if constexpr (takes_two<P, F>) {
    const DatasetPtr second = single_dataset(inputs[1], name);
    return map_parts(inputs[0], name, context, [&](const DatasetPtr& d, Context& part) -> Data { return f(d, second, p, part); });
  } else {
    static_assert(takes_part<P, F>, "see the shapes in pipeline/operation/operation_table.h");
    return map_parts(inputs[0], name, context, [&](const DatasetPtr& d, Context& part) -> Data { return f(d, p, part); });
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

/// The fields wanted of the result and those that the parameters name; everything when a field parameter is left open.
Request request_carried(const ParamSet& params, const Request& wanted);
/// Only the fields that the parameters name; everything when a field parameter is left open.
Request request_named(const ParamSet& params, const Request& wanted);

}  // namespace detail

/// Hook: the numbers changed N-1 times.
template <int N>
constexpr auto op_version = [](Operation& o) { o.version = N; };
/// Hook: the result has the fields of the input, and beside them the operation reads only those its parameters name.
constexpr auto carries_fields = [](Operation& o) { o.request = detail::request_carried; };
/// Hook: the result has no field of the input; the operation reads only those its parameters name.
constexpr auto needs_only_named_fields = [](Operation& o) { o.request = detail::request_named; };
/// Hook: `time` chooses a moment of the input, see Operation::shows_moment.
constexpr auto shows_moment = [](Operation& o) { o.shows_moment = true; };
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
