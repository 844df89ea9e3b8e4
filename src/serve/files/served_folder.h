// SPDX-License-Identifier: Apache-2.0
// The folder of `sightglass serve`: what clients see of it, and what they open.
#pragma once
#include <string>

#include "serve/guard/confined_path.h"

namespace sg::serve {

class ServedFolder {
 public:
  /// Throws Error(usage) when it is no folder.
  explicit ServedFolder(const std::string& folder) : folder_(folder) {}

  const std::string& path() const { return folder_.path(); }
  /// {"folders":[...],"files":[{"name","bytes","series"}],"more":false} of one of its folders, "" for itself: what a reader may know, by
  /// its extension, of a few files without one by content. A folder that a reader takes as data is listed as a file of 0 bytes, too.
  /// "more": there is more than the first 20,000. Throws Error(data) for a name that is not confined or not there.
  std::string list_json(const std::string& below) const;
  /// The absolute path of a listed file, folder of data or series ("flow_{n}.vtk", of which every file is confined). Throws Error(data).
  std::string to_open(const std::string& name) const;

 private:
  ConfinedFolder folder_;
};

}  // namespace sg::serve
