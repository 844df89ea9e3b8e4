// SPDX-License-Identifier: Apache-2.0
// The file of EnSight's server of servers (.sos): which case files hold the portions of one model. Source: EnSight How To Manual, "Use
// Server of Servers", "Format of the SOS Casefile", and "Load Spatially Decomposed Case Files".
#pragma once
#include <string>
#include <vector>

namespace sg::ensight {

/// One portion of a model: a case file as it is named, and the folder that stands before it ("" = none is named).
struct ServerCase {
  size_t number = 1;  ///< as counted in the file
  std::string case_file, data_path;
};

/// The case files in the order of the file, repeated ones too. Throws Error(data) that names the line, for other formats of the servers
/// than EnSight Gold and 6, and when fewer are described than announced.
std::vector<ServerCase> parse_servers(const std::string& path);

}  // namespace sg::ensight
