// SPDX-License-Identifier: Apache-2.0
// `scene:` of a pipeline file: what is shown stands where its nodes say.
#pragma once
#include <map>
#include <memory>
#include <vector>

#include "pipeline/file/pipeline_file.h"
#include "scene/graph/scene_graph.h"
#include "scene/items/surface_copy.h"

namespace sg {

/// The nodes with their words understood, at the moments that they state; instances at the points of steps are not in yet. Throws one
/// Error(usage) with all mistakes, each with "origin:line".
std::vector<SceneNode> stated_scene(const PipelineFile& file);

/// The steps at whose points nodes have their instances, as targets; one for each node that has them, in the order of the scene.
std::vector<Target> place_targets(const PipelineGraph& graph);

/// What is a moved copy of what.
using Copies = std::map<const Dataset*, std::shared_ptr<const SurfaceCopy>>;

/// The results of all shows as they lie in the world: of a show in a node one dataset for each part and place, of hidden nodes none.
/// `points`: the results of place_targets(). Surfaces that stand at several places are told in `copies`, if that is not null. Throws
/// Error(usage) as world_places() and transform().
std::vector<Data> placed(const PipelineFile& file, const std::vector<Data>& points, std::vector<Data> results, Copies* copies,
                         Context& context);

/// The same of shows alone, for which the points are computed; `at_hand` as of build_graph().
std::vector<Data> placed(const PipelineFile& file, std::vector<Data> results, const StepResults& at_hand, Context& context);

/// Where in the world that stands which the i-th show shows.
std::vector<Affine> places_of_show(const PipelineFile& file, size_t show, const std::shared_ptr<Cache>& cache, Context& context);

}  // namespace sg
