// SPDX-License-Identifier: Apache-2.0
// The ways to show a dataset: each is a parameter struct with one declaration, and a function that adds items to a scene.
#pragma once
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <typeinfo>
#include <vector>

#include "base/context.h"
#include "base/schema/schema.h"
#include "color/legend_content.h"
#include "scene/choose/coloring.h"
#include "scene/scene.h"

namespace sg {

/// One way to show, as all doors see it. The struct and function of each are in the header of its name.
struct ShowKind {
  std::string_view name, sentence;
  ParamSet (*make_params)() = nullptr;
  bool (*has_params)(const std::type_info& type) = nullptr;
  /// Another set of the same parameters, with what no word states, too.
  ParamSet (*copy)(const ParamSet& params) = nullptr;
  /// Throws Error(usage) for what no data could make right; all mistakes at once. Null: nothing beyond ranges and choices.
  void (*check)(const ParamSet& params) = nullptr;
  /// How its values become colours; null: it has one colour.
  ColoringParams* (*coloring)(const ParamSet& params) = nullptr;
  /// The field that colours when none is named; null: automatic_field().
  const Field* (*automatic)(const ParamSet& params, const Dataset& data) = nullptr;
  /// What unites the parts of a collection in one picture, besides colours: changes the parameters of each.
  void (*share)(const std::vector<DatasetPtr>& parts, std::vector<ParamSet>& params) = nullptr;
  /// Adds items for the dataset; returns what the legend shows when a field is mapped to colours.
  std::optional<Legend> (*add)(Scene&, const DatasetPtr&, const ParamSet& params, Context&) = nullptr;

  /// Whether its parameters are of this struct: kind.is<VolumeShow>().
  template <class P>
  bool is() const {
    return has_params(typeid(P));
  }
};
std::span<const ShowKind> show_kinds();
/// The one whose parameters are of this struct.
const ShowKind& show_kind(const std::type_info& type);
template <class P>
const ShowKind& show_kind() {
  return show_kind(typeid(P));
}
/// Throws Error(usage) with "did you mean".
const ShowKind& find_show(std::string_view name);

/// The field of `data` that colours, as `params` name it or by itself; null for none and for one colour.
const Field* shown_field(const ShowKind& kind, const ParamSet& params, const Dataset& data);

/// Defaults changed by "key=value" words, and checked; all mistakes in one Error(usage).
ParamSet show_params(const ShowKind& kind, const std::vector<std::string>& words);
/// Adds items for the dataset, as "key=value" words request.
std::optional<Legend> add_show(Scene& scene, std::string_view kind, const DatasetPtr& data, const std::vector<std::string>& words,
                               Context& context);

}  // namespace sg
