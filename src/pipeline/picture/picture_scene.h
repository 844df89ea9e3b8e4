// SPDX-License-Identifier: Apache-2.0
// `scene:` of a pipeline file: what is shown stands where its nodes say.
#pragma once
#include <vector>

#include "pipeline/file/pipeline_file.h"
#include "scene/graph/scene_graph.h"

namespace sg {

/// The nodes with their words understood, at the moments that they state; instances at the points of steps are not in yet. Throws one
/// Error(usage) with all mistakes, each with "origin:line".
std::vector<SceneNode> stated_scene(const PipelineFile& file);

/// The steps at whose points nodes have their instances, as targets; one for each node that has them, in the order of the scene.
std::vector<Target> place_targets(const PipelineGraph& graph);

/// The results of all shows as they lie in the world: of a show in a node one dataset for each part and place, of hidden nodes none.
/// `points`: the results of place_targets(). Throws Error(usage) as world_places() and transform().
std::vector<Data> placed(const PipelineFile& file, const std::vector<Data>& points, std::vector<Data> results, Context& context);

/// Where what the i-th show shows stands in the world.
std::vector<Affine> places_of_show(const PipelineFile& file, const std::vector<Data>& points, size_t show);

}  // namespace sg
