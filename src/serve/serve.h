// SPDX-License-Identifier: Apache-2.0
// The server as a command starts it.
#pragma once
#include <string>
#include <vector>

#include "base/context.h"
#include "base/schema/schema.h"
#include "pipeline/file/pipeline_file.h"

namespace sg::serve {

struct ServeParams {
  std::string address = "127.0.0.1";
  int port = 0;
  bool browser = true;  ///< of view
  std::string users;    ///< of serve
  int workers = 0;
  std::string worker_memory;  ///< "4G"; "": any
  double most_seconds = 600;  ///< of serve
  std::vector<std::string> origin;
};
void describe(Schema& s, ServeParams& p);

/// Opens a window on a pipeline in the system's browser and serves it until the context is cancelled. `coloring`: as
/// PictureOptions::coloring. Its address goes to standard output. Throws Error.
void view(PipelineFile file, const std::vector<std::string>& coloring, const std::string& title, const ServeParams& p, Context& context);

/// How this program is started as a worker of a server: its first word.
inline constexpr const char* worker_command = "draw-for-a-server";

/// Serves the files below a folder, each in a session of its own.
void serve(const std::string& folder, const ServeParams& p, Context& context);

}  // namespace sg::serve
