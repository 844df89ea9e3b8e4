// SPDX-License-Identifier: Apache-2.0
// Transfer function files: the words of a volume's look as a map of YAML, "opacity: '@-500:0,@200:0.4'" and so on.
#pragma once
#include "pipeline/file/pipeline_file.h"
#include "scene/items/volume_item.h"

namespace sg {

/// Whether a value of `transfer` means a file, rather than one of TransferChoice.
bool names_transfer_file(const std::string& word);

/// In the shows of volumes, `transfer=FILE.yaml` becomes the words of the file, in front of the stated ones (which win); so a recipe does
/// not depend on the file. Paths begin at the pipeline file. Throws Error(usage) for unknown words, with the line; Error(data) for no such
/// file.
void load_transfer_files(PipelineFile& file);

/// Writes the look of the item (see transfer_words) as such a file.
void save_transfer_file(const std::string& path, const VolumeItem& item);

}  // namespace sg
