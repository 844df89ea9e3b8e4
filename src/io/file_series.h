// SPDX-License-Identifier: Apache-2.0
// Several files as one time series. A path that is not a file itself names them:
//   flow_{n}.vtk   {n} stands for a whole number        flow_*.vtk, run_?/flow.vtk   * for any text, ? for one letter
//   a.vtu,b.vtu    a list (a comma inside a name is written "\,"), or a list of patterns
// read_data() and file_times() take such paths, so everything that reads files does; one step is read at a time.
#pragma once
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "io/io.h"

namespace sg {

/// Whether it is a pattern or a list, and not an existing file.
bool names_series(const std::string& path);
/// The files: those of a pattern so that numbers in names count ("s2" before "s10"), those of a list in its order. Throws Error(data) when
/// there is none: what was looked for, where, and what is there that is near.
std::vector<std::string> series_files(const std::string& path);
/// The list of these files as a path; natural order when `sorted`.
std::string series_path(std::vector<std::string> files, bool sorted);
/// path_beside() for each file or pattern of a path.
std::string series_beside(const std::string& beside, const std::string& path);
/// f(file or pattern) in place of each one of a path.
std::string map_series(const std::string& path, const std::function<std::string(const std::string&)>& f);

/// Times of all steps of all files: those of ReadOptions::times ("START:STEP", or as many as there are steps), else those that the files
/// have, else (or when all files have the same) 0, 1, 2, ... Throws Error(data) naming the two files when times do not grow from file to
/// file. Files are looked into once, as long as they do not change.
std::vector<double> times_of_series(const std::string& path, const ReadOptions& options, Context& context);
/// The step that `options` request. Its time is that of the series; a note "file" names where it comes from.
Data read_of_series(const std::string& path, const ReadOptions& options, Context& context);

}  // namespace sg
