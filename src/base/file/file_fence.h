// SPDX-License-Identifier: Apache-2.0
// Which files may be read and written besides those that the user names; docs/security.md explains why.
//
// - A file may name files below its own folder, or below the working folder; `named_file` refuses others.
// - While a recipe from a picture is followed, the whole process is fenced in: `set_file_fence`.
// `allow_reading_anywhere` lifts both for reading.
#pragma once
#include <string>
#include <string_view>
#include <vector>

namespace sg {

/// The path of a file that the file `beside` names: path_beside(), but throws Error(data) when it is absolute or lies neither below the
/// folder of `beside`, nor below a folder of `trust_folder_of`, nor below the working folder. Symbolic links are followed: whoever can
/// create one could as well copy a file there.
std::string named_file(std::string_view beside, std::string_view name);
/// The same for a name in a recipe out of a picture, which may be absolute (so windows write it) where it leads below those folders. Those
/// of trust_folder_of() do not count: others, in a program that has read much, are no less the user's own.
std::string file_of_recipe(std::string_view picture, std::string_view name);

/// The user has named this file: what it leads to may name the files below its folder.
void trust_folder_of(const std::string& path);

/// Files may name any file. $SIGHTGLASS_READ_ANYWHERE=1 does the same (plug-ins see it there).
void allow_reading_anywhere();

struct FileFence {
  std::vector<std::string> read_below;  ///< folders; resolved paths count, so that no symbolic link leads out. Never the root.
  std::vector<std::string> write;       ///< the only files that may be written, as AtomicFile is given them
  std::string who;                      ///< "the recipe in 'a.png'", for messages
};
/// Confines all reading and writing of this process from now on; to be called before threads read.
void set_file_fence(FileFence fence);
void remove_file_fence();

/// Throws Error(data) when there is a fence and the path is outside it. For code that opens files itself; MappedFile,
/// folder_entries and AtomicFile do it.
void check_may_read(const std::string& path);
void check_may_write(const std::string& path);

/// A descriptor for reading a plain file: never waits for the other end of a pipe, never opens a device. Throws Error(data) for what is
/// not a plain file, and outside of the fence.
int open_plain_file(const std::string& path);
/// Whether there is a plain file, or a link to one.
bool is_plain_file(const std::string& path);

}  // namespace sg
