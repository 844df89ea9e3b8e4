// SPDX-License-Identifier: Apache-2.0
// One value for all: what operations choose from their data is chosen once for all inputs of a picture and all steps of a series.
#pragma once
#include <span>
#include <vector>

#include "pipeline/file/pipeline_file.h"

namespace sg {

/// Writes into the steps of `file` what they leave open and choose from the data (Operation::choose), as chosen over the data of all
/// `moments` and of all steps that do the same, with the same words, to another input: the same field gets the same values. What a single
/// step would choose of a single moment stays open. `moments`: `file` at some of its times, none where it has none; they get the same
/// words. Data of the first moment are added to `held`, so that the cache finds them again. What cannot be chosen, for an error that
/// running will report, stays open. Throws Error(usage) for mistakes of the file.
void settle_choices(PipelineFile& file, std::span<PipelineFile> moments, const GraphOptions& graph, const StepResults& results,
                    std::vector<Data>& held, Context& context);

}  // namespace sg
