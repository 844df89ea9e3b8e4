// SPDX-License-Identifier: Apache-2.0
// The readers behind read_colormaps(); each takes the whole text and throws Error(data) naming `path`. Names are filled in by the
// caller where the file has none.
#pragma once
#include "color/map_files/colormap_file.h"
#include "color/map_files/colormap_nodes.h"

namespace sg {

FileColormap parse_cpt(std::string_view text, const std::string& path);
/// ParaView's list of maps, or niivue's object of lists.
std::vector<FileColormap> parse_json_maps(std::string_view text, const std::string& path);
/// Rules like ".YlGn .q0-3{fill:rgb(247,252,185)}": one map "YlGn-3" per list of colours, and "YlGn" for the longest.
std::vector<FileColormap> parse_css_maps(std::string_view text, const std::string& path);

}  // namespace sg
